// When the greens of human drivers end, and which lights turn green with them.

#include <algorithm>
#include <set>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/signals/phase_choice.hpp"
#include "planner/road.hpp"

namespace mvtp {
namespace {

constexpr double kRests = 0.1;      ///< [m/s]
constexpr double kTogether = 1.0;   ///< [s] after the first of its phase that a light follows
constexpr double kUncertain = 1.0;  ///< [m] by which drivers may judge otherwise if they can stop

}  // namespace

/// Is there a driver without a planned passage who could not stop any more at the next decision?
/// Behind a vehicle under control there may be: a green is shorter then than it should be.
bool HumanDrivers::must_end(int link) const {
  return std::ranges::any_of(agents_, [&](const auto& entry) {
    const Agent& agent = entry.second;
    return !agent.granted && std::ranges::count(agent.links, link) > 0 &&
           !can_stop_after(agent, grid_.decision());
  });
}

/// Whatever he judges, does he stop before his line if his light turns yellow now?
bool HumanDrivers::will_stop_at_yellow(const Agent& agent) const {
  return can_stop_after(agent, grid_.decision()) &&
         stopping_distance(agent.speed, agent.driver().max_decel) + kUncertain < agent.to_line;
}

/// And does he drive over it?
bool HumanDrivers::will_pass_at_yellow(const Agent& agent) const {
  const double yellow =
      heads_.timing().yellow(graph_.lane(graph_.link(agent.links.front()).from).speed_limit);
  return stopping_distance(agent.speed, agent.driver().max_decel) > agent.to_line + kUncertain &&
         agent.to_line < agent.speed * (yellow - grid_.decision());
}

/// May its phase, or nobody's need, end this green?
bool HumanDrivers::may_end(int link) const {
  if (heads_.shown_for(link) < heads_.timing().least_green - 1e-6) return false;
  const bool stays =
      phases_ && phases_->is_on(link) && heads_.yields(link) == phases_->yields(link);
  return !stays || heads_.is_called_before(link, step_);
}

/// Has it come to rest before a light that is not green, though nobody expected that it could?
bool HumanDrivers::has_stopped_after_all(const Agent& agent) const {
  return !agent.inside && agent.speed < kRests && !is_shown_green(agent);
}

/// Where the phase is over, from those who can stop; and from those behind a vehicle under control
/// that waits: it may wait for somebody who would have to wait for them.
void HumanDrivers::take_back_greens() {
  for (auto& [id, agent] : agents_) {
    if (agent.granted && has_stopped_after_all(agent)) agent.granted = false;
  }
  if (!phases_) return;
  for (auto& [id, agent] : agents_) {
    if (!agent.granted || agent.inside || !will_stop_at_yellow(agent)) continue;
    const bool over =
        std::ranges::any_of(agent.links, [&](int k) { return !phases_->allows(k) && may_end(k); });
    agent.granted = !over && !is_behind_one_who_waits(agent);
  }
}

void HumanDrivers::settle() {
  for (auto& [id, agent] : agents_) {
    pass_before_who_waits(agent);
    if (agent.granted) traffic_.rely_on_signal(id, who_waits_for(agent));
  }
  std::set<int> needed;
  for (const auto& [id, agent] : agents_) {
    const bool needs = agent.granted && !agent.inside && !agent.links.empty() &&
                       !(phases_ && will_pass_at_yellow(agent));
    if (needs) needed.insert(agent.links.begin(), agent.links.end());
  }
  for (int k = 0; k < graph_.links(); ++k) {
    if (!heads_.owns(k) || heads_.light(k) != Light::kGreen || needed.contains(k)) continue;
    if (may_end(k) || must_end(k)) heads_.end_green(k);
  }
  if (phases_) complete_phases();
}

/// The lights of a phase turn green together: one that followed alone would have to stay for its
/// least green when the phase ends. Not for a driver who would go before his passage is planned.
void HumanDrivers::complete_phases() {
  for (int k = 0; k < graph_.links(); ++k) {
    if (!heads_.owns(k) || heads_.light(k) != Light::kRed || !phases_->is_on(k)) continue;
    const bool begins = std::ranges::any_of(phases_->beside(k), [&](int other) {
      return heads_.light(other) == Light::kGreen && heads_.shown_for(other) <= kTogether;
    });
    if (begins && may_turn_green(k, Beside::kDrivers) && !heads_.is_called_before(k, step_) &&
        !must_end(k)) {
      heads_.turn_green(k, phases_->yields(k));
    }
  }
}

}  // namespace mvtp
