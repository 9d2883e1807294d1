// Which human drivers at signals get green.

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/drivers/room_behind.hpp"
#include "coordinator/signals/phase_choice.hpp"
#include "planner/road.hpp"

namespace mvtp {
namespace {

constexpr double kStands = 0.5;     ///< [m/s]
constexpr double kStopLine = 10.0;  ///< [m] before the end of its lane a driver waits for green
constexpr double kNear = 160.0;     ///< [m] around a driver in which others matter
constexpr double kSoon = 4.0;       ///< [s] in which one ahead is over the line if he goes on

}  // namespace

/// Would it begin to brake for red before the next decision, or does it wait at its line?
bool HumanDrivers::is_due(const Agent& agent) const {
  if (agent.speed < kStands && agent.to_line < kStopLine) return true;
  const double brakes_at = stopping_distance(agent.speed, agent.driver().max_decel) +
                           agent.driver().road.tau * agent.speed;
  return agent.to_line <= brakes_at + agent.speed * grid_.decision() + agent.driver().road.min_gap;
}

/// Is nobody ahead of it in its lane but drivers who have green, and vehicles under control that
/// go on?
bool HumanDrivers::is_first(const Agent& agent) const {
  return std::ranges::none_of(traffic_.vehicles(), [&](const VehicleState& v) {
    return v.lane == agent.lane && v.lane_position > agent.position && !passes(v.id) &&
           !(phases_ && goes_on_ahead(v));
  });
}

/// Does a vehicle under control drive over its line soon?
bool HumanDrivers::goes_on_ahead(const VehicleState& v) const {
  const SpeedProfile* plan = plan_of_(v.id);
  const int lane = graph_.find_lane(v.lane);
  if (plan == nullptr || !plan->complete || lane == LaneGraph::kNone) return false;
  const std::int64_t soon = step_ + std::int64_t(std::lround(kSoon / grid_.dt));
  return plan->at(soon).s - plan->at(step_).s > graph_.lane(lane).length - v.lane_position;
}

/// Is a vehicle under control ahead of it before their line that does not go on soon?
bool HumanDrivers::is_behind_one_who_waits(const Agent& agent) const {
  return std::ranges::any_of(traffic_.vehicles(), [&](const VehicleState& v) {
    return v.lane == agent.lane && v.lane_position > agent.position && plan_of_(v.id) != nullptr &&
           !goes_on_ahead(v);
  });
}

bool HumanDrivers::may_have_green(const Agent& agent) const {
  return std::ranges::all_of(agent.links, [&](int k) {
    if (!heads_.owns(k)) return false;
    if (heads_.light(k) == Light::kYellow || heads_.is_called_before(k, agent.came)) return false;
    if (phases_ && !phases_->allows(k)) return false;
    if (heads_.light(k) != Light::kGreen) return may_turn_green(k, Beside::kPeople);
    return phases_ || heads_.shown_for(k) < heads_.timing().most_green;
  });
}

/// @param beside  kPeople: for one driver whose passage between the people is planned.
bool HumanDrivers::may_turn_green(int link, Beside beside) const {
  if (!phases_) return heads_.may_turn_green(link);
  return heads_.may_turn_green(link, [&](int other) {
    if (other < graph_.links()) return phases_->may_be_green_together(link, other);
    return beside == Beside::kPeople && phases_->phases().yields_to(link, other);
  });
}

bool HumanDrivers::is_shown_green(const Agent& agent) const {
  return heads_.all_show_green(agent.links);
}

bool HumanDrivers::has_to_wait(const std::string& id) const {
  const auto found = agents_.find(id);
  if (found == agents_.end()) return false;
  const Agent& agent = found->second;
  return !agent.granted && !agent.links.empty() &&
         std::ranges::all_of(agent.links, [this](int k) { return heads_.owns(k); });
}

/// Has it green in a phase?
bool HumanDrivers::is_in_phase(const Agent& agent) const {
  return is_shown_green(agent) && phases_ &&
         std::ranges::all_of(agent.links, [&](int k) { return phases_->is_on(k); });
}

/// Is there room for it behind the junction, should everybody there stop?
bool HumanDrivers::has_room_behind(const Agent& agent, const Movement& movement) const {
  const Corridor& corridor = corridors_[movement.corridor];
  const double gap = movement.driver.road.min_gap;
  double needed = movement.s_clear + gap;
  for (const auto& [id, other] : agents_) {
    const bool shares = other.granted && other.id != agent.id && other.links == agent.links;
    if (shares) needed += other.length + gap;
  }
  const double tail = first_tail_at_rest(corridor, graph_, movement.s_clear - agent.length,
                                         movement.driver.max_decel, traffic_.vehicles(),
                                         [&](const VehicleState& v) -> std::optional<double> {
                                           if (distance(v.pose, agent.pose) > kNear || passes(v.id))
                                             return std::nullopt;
                                           return length_of(v.type);
                                         });
  return tail >= needed;
}

bool HumanDrivers::come_from_one_lane(const Agent& a, const Agent& b) const {
  return !a.links.empty() && !b.links.empty() &&
         graph_.link(a.links.front()).from == graph_.link(b.links.front()).from;
}

bool HumanDrivers::may_meet(const Agent& a, const Agent& b) const {
  if (come_from_one_lane(a, b)) return false;
  return std::ranges::any_of(a.movements, [&](const Movement& one) {
    return std::ranges::any_of(b.movements, [&](const Movement& other) {
      const ContactTable& contacts =
          corridors_.library().contacts(one.forecast.vehicle.path, other.forecast.vehicle.path);
      return mvtp::may_meet(contacts, tube_of(one), one.s_clear, tube_of(other), other.s_clear,
                            step_);
    });
  });
}

/// Where will it be when its light turns yellow in so many seconds, and can it stop then?
bool HumanDrivers::can_stop_after(const Agent& agent, double seconds) const {
  const auto steps = std::int64_t(std::ceil(seconds / grid_.dt));
  return std::ranges::all_of(agent.movements, [&](const Movement& movement) {
    const InertialState then = movement.forecast.earliest.at(step_ + steps);
    return then.s + stopping_distance(then.v, movement.driver.max_decel) + then.v * grid_.dt <
           movement.driver.line;
  });
}

/// When it is over its line at the latest, from now on [s].
double HumanDrivers::latest_at_line(const Agent& agent) const {
  std::int64_t over = step_;
  for (const Movement& movement : agent.movements) {
    over = std::max(over, arrival_step(*movement.forecast.latest, movement.driver.line));
  }
  return double(over - step_) * grid_.dt;
}

/// How long its light is green at least if it gets it [s]: until it passes, or where greens are
/// taken back from those who can stop, until the next decision.
double HumanDrivers::green_left(const Agent& first) const {
  const double least = heads_.timing().least_green;
  if (!phases_) return std::max(least, latest_at_line(first));
  const double shown = is_shown_green(first) ? heads_.shown_for(first.links.front()) : 0.0;
  return std::max(grid_.decision(), least - shown);
}

/// Those who pass if the first gets green: it and whoever follows it so closely that he could not
/// stop when the signal turns yellow at the earliest.
std::vector<const HumanDrivers::Agent*> HumanDrivers::with_followers(const Agent& first) const {
  std::vector<const Agent*> group = {&first};
  std::vector<std::pair<double, const Agent*>> behind;  // nullptr: no agent
  for (const VehicleState& v : traffic_.vehicles()) {
    if (v.lane != first.lane || v.lane_position >= first.position) continue;
    const auto agent = agents_.find(v.id);
    behind.emplace_back(-v.lane_position, agent == agents_.end() ? nullptr : &agent->second);
  }
  std::ranges::sort(behind);
  double green = green_left(first);
  for (const auto& [place, agent] : behind) {
    // Whoever turns elsewhere stands at red, and all behind it.
    const bool goes_along = agent != nullptr && !agent->granted && agent->links == first.links;
    if (!goes_along || can_stop_after(*agent, green)) break;
    group.push_back(agent);
    if (!phases_) green = std::max(green, latest_at_line(*agent));
  }
  return group;
}

std::vector<std::vector<std::string>> HumanDrivers::propose() {
  std::vector<const Agent*> candidates;
  std::vector<const Agent*> passing;
  for (const auto& [id, agent] : agents_) {
    if (agent.granted) {
      passing.push_back(&agent);
    } else if (!agent.inside && !agent.links.empty() && is_due(agent) && is_first(agent) &&
               may_have_green(agent) &&
               std::ranges::all_of(agent.movements,
                                   [&agent = agent, this](const Movement& movement) {
                                     return has_room_behind(agent, movement);
                                   })) {
      candidates.push_back(&agent);
    }
  }
  // Greens that are shown already go on first; then whoever came first.
  std::ranges::stable_sort(candidates, {}, [&](const Agent* a) {
    return std::pair(heads_.light(a->links.front()) != Light::kGreen, a->came);
  });
  std::vector<std::vector<std::string>> proposals;
  for (const Agent* first : candidates) {
    const std::vector<const Agent*> group = with_followers(*first);
    const bool clear = std::ranges::all_of(group, [&](const Agent* a) {
      return std::ranges::none_of(passing, [&](const Agent* p) {
        if (go_together(*a, *p)) return false;
        return (!p->granted && cross(*a, *p)) || may_meet(*a, *p);
      });
    });
    if (!clear) continue;
    std::vector<std::string>& ids = proposals.emplace_back();
    for (const Agent* a : group) ids.push_back(a->id);
    passing.insert(passing.end(), group.begin(), group.end());
  }
  return proposals;
}

double HumanDrivers::waited(const std::string& id) const {
  const Agent& agent = agents_.at(id);
  return is_shown_green(agent) ? std::numeric_limits<double>::infinity() : agent.waited;
}

std::vector<std::string> HumanDrivers::first_at_lines() const {
  const auto is_barred = [this](const Agent& agent) {
    return std::ranges::any_of(agent.links, [&](int k) {
      const double until = phases_ ? phases_->barred_until(k) : heads_.barred_until(k);
      return until > traffic_.time() || heads_.is_called_before(k, agent.came) ||
             (phases_ && !phases_->allows(k));
    });
  };
  std::vector<std::string> first;
  for (const auto& [id, agent] : agents_) {
    const bool waits = !agent.inside && !agent.granted && agent.speed < kStands &&
                       agent.to_line < kStopLine && is_first(agent);
    if (waits && !is_barred(agent)) first.push_back(id);
  }
  return first;
}

/// May they pass at once, as one of them yields to the other?
bool HumanDrivers::go_together(const Agent& a, const Agent& b) const {
  return phases_ && std::ranges::any_of(a.links, [&](int k) {
           return std::ranges::any_of(b.links, [&](int l) { return phases_->go_together(k, l); });
         });
}

/// Would their lights exclude each other? Two who get green at once may not cross at all.
bool HumanDrivers::cross(const Agent& a, const Agent& b) const {
  return std::ranges::any_of(a.links, [&](int k) {
    return std::ranges::any_of(b.links, [&](int l) { return heads_.cross(k, l); });
  });
}

bool HumanDrivers::is_crossed_by(const std::string& id, int light) const {
  return std::ranges::any_of(agents_.at(id).links, [&](int k) { return heads_.cross(k, light); });
}

void HumanDrivers::grant(const std::string& id) {
  Agent& agent = agents_.at(id);
  agent.granted = true;
  for (const int k : agent.links) heads_.turn_green(k, phases_ && phases_->yields(k));
}

double HumanDrivers::worth(const std::vector<std::string>& ids) const {
  double worth = 0.0;
  for (const std::string& id : ids) {
    const auto found = agents_.find(id);
    if (found == agents_.end()) continue;
    const Agent& agent = found->second;
    // To end a phase for one who comes to it costs more than whatever he costs others.
    if (is_in_phase(agent)) return std::numeric_limits<double>::infinity();
    worth += agent.waited + 0.5 * agent.speed / agent.driver().max_decel +
             0.5 * agent.speed / agent.driver().max_accel;
  }
  return worth;
}

bool HumanDrivers::may_meet(const std::vector<std::string>& ids, int path,
                            const SpeedProfile& plan) const {
  return std::ranges::any_of(ids, [&](const std::string& id) {
    const auto found = agents_.find(id);
    if (found == agents_.end()) return false;
    const Agent& agent = found->second;
    return std::ranges::any_of(agent.movements, [&](const Movement& movement) {
      const RoadVehicle& road = movement.forecast.vehicle;
      // Of two in one lane the one behind keeps its distance, also if it stands closer than that.
      const PlaceOnPath driver{road.path, road.now.s};
      const PlaceOnPath other{path, plan.at(step_).s};
      const PathLibrary& library = corridors_.library();
      if (drives_ahead(library, other, driver) || drives_ahead(library, driver, other))
        return false;
      const ContactTable& contacts = corridors_.library().contacts(road.path, path);
      return mvtp::may_meet(contacts, tube_of(movement), movement.s_clear, {plan, plan},
                            SpeedProfile::kDeparted / 2.0, step_, slack_before(), slack_behind());
    });
  });
}

/// Vehicles near that come from elsewhere: they have no green, or plans around him. But where one
/// of two drivers with green yields, each looks at the other, unless he goes before him.
std::vector<std::string> HumanDrivers::who_waits_for(const Agent& agent) const {
  std::vector<std::string> ids;
  const auto own = origins_.find(agent.id);
  for (const VehicleState& v : traffic_.vehicles()) {
    if (v.id == agent.id || distance(v.pose, agent.pose) > kNear) continue;
    const auto origin = origins_.find(v.id);
    const bool same =
        origin != origins_.end() && own != origins_.end() && origin->second == own->second;
    const auto other = agents_.find(v.id);
    const bool looks = other != agents_.end() && let_each_other_pass(agent, other->second) &&
                       !agent.goes_before.contains(v.id);
    if (!same && !looks) ids.push_back(v.id);
  }
  return ids;
}

}  // namespace mvtp
