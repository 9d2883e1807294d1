#include "coordinator/signals/phase_choice.hpp"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace mvtp {
namespace {

constexpr double kLead =
    4.5;  ///< [s] before they are at their lines a phase begins for two who need lights that cross
constexpr double kGap = 5.0;   ///< [s] in which nobody comes who needs a phase: it ends
constexpr double kLook = 1.0;  ///< [s] between two ends of a green that are compared,
constexpr double kFar = 20.0;  ///< [s] and the last of them

}  // namespace

PhaseChoice::PhaseChoice(Traffic& traffic, const LaneGraph& graph, const SignalHeads& heads,
                         IsControlled is_controlled)
    : traffic_(traffic),
      graph_(graph),
      heads_(heads),
      phases_(traffic, graph, heads),
      choices_(phases_.signals().size()),
      lanes_(phases_.signals().size()) {
  std::vector<int> all;
  for (int k = 0; k < graph.links(); ++k) {
    const int signal = phases_.signal_of(k);
    if (signal == LaneGraph::kNone) continue;
    std::vector<int>& lanes = lanes_[std::size_t(signal)];
    const int from = graph.link(k).from;
    if (std::ranges::count(lanes, from) > 0) continue;
    lanes.push_back(from);
    all.push_back(from);
  }
  detector_.emplace(traffic, graph, heads, std::move(is_controlled), all);
}

/// The phase that is on at the signal of a connection; nullptr: each light goes alone.
const GreenPhase* PhaseChoice::present(int link) const {
  const int signal = phases_.signal_of(link);
  if (signal == LaneGraph::kNone) return nullptr;
  const Choice& choice = choices_[std::size_t(signal)];
  if (choice.alone) return nullptr;
  return &phases_.signals()[std::size_t(signal)].phases[std::size_t(choice.phase)];
}

bool PhaseChoice::allows(int link) const {
  const GreenPhase* phase = present(link);
  return phase == nullptr || phase->links.contains(link);
}

bool PhaseChoice::is_on(int link) const {
  const GreenPhase* phase = present(link);
  return phase != nullptr && phase->links.contains(link);
}

const std::set<int>& PhaseChoice::beside(int link) const {
  static const std::set<int> kNobody;
  const GreenPhase* phase = present(link);
  return phase == nullptr ? kNobody : phase->links;
}

bool PhaseChoice::yields(int link) const {
  const GreenPhase* phase = present(link);
  return phase != nullptr && phase->yielding.contains(link);
}

double PhaseChoice::barred_until(int link) const {
  return heads_.barred_until(link, [&](int other) { return phases_.yields_to(link, other); });
}

bool PhaseChoice::go_together(int link, int other) const {
  if (!is_on(link) || !is_on(other) || !phases_.permits(link, other)) return false;
  const auto says_so = [&](int k, int to) {
    return !phases_.yields_to(k, to) || heads_.light(k) != Light::kGreen || heads_.yields(k);
  };
  return says_so(link, other) && says_so(other, link);
}

bool PhaseChoice::may_be_green_together(int link, int other) const {
  return go_together(link, other) ||
         (is_on(link) && is_on(other) && phases_.protects_both(link, other));
}

void PhaseChoice::decide() {
  detector_->look();
  for (std::size_t s = 0; s < choices_.size(); ++s) decide(int(s));
}

void PhaseChoice::decide(int signal) {
  const Queues queues = detector_->queues(lanes_[std::size_t(signal)]);
  if (choices_[std::size_t(signal)].alone) {
    start(signal, queues);
  } else {
    go_on(signal, queues);
  }
}

/// Do two who need lights that cross come soon?
bool PhaseChoice::is_contested(const Queues& queues) const {
  std::vector<int> needed;
  for (const auto& queue : queues) {
    for (const QueuedVehicle& v : queue) {
      if (v.needs_green && v.arrival < kLead) needed.push_back(v.link);
    }
  }
  return std::ranges::any_of(needed, [&](int k) {
    return std::ranges::any_of(needed, [&](int other) { return heads_.cross(k, other); });
  });
}

/// When the green before would have ended, if the phase got green as soon as the lights allow [s].
double PhaseChoice::can_begin(int signal, const GreenPhase& phase) const {
  const double now = traffic_.time();
  double begun = now - change_time(signal);
  for (int k = 0; k < graph_.links(); ++k) {
    if (phases_.signal_of(k) != signal || phase.links.contains(k)) continue;
    const double since = heads_.light(k) == Light::kGreen ? now : now - heads_.shown_for(k);
    const double yellow = heads_.light(k) == Light::kRed ? yellow_time(signal) : 0.0;
    begun = std::max(begun, since - yellow);
  }
  return begun;
}

/// As soon as two come who need lights that cross, the phase by which those who are seen lose
/// least.
void PhaseChoice::start(int signal, const Queues& queues) {
  if (!is_contested(queues)) return;
  const std::vector<GreenPhase>& phases = phases_.signals()[std::size_t(signal)].phases;
  double least = std::numeric_limits<double>::infinity();
  Choice best;
  for (std::size_t p = 0; p < phases.size(); ++p) {
    const Choice candidate{.phase = int(p), .since = can_begin(signal, phases[p]), .alone = false};
    const double delay = queue_delay(queues, model_of(signal, candidate));
    if (delay < least) std::tie(least, best) = std::pair(delay, candidate);
  }
  choices_[std::size_t(signal)] = best;
}

/// Ends the present phase if every later end costs those who are seen more, or nobody needs it.
void PhaseChoice::go_on(int signal, const Queues& queues) {
  Choice& choice = choices_[std::size_t(signal)];
  const QueuePhases model = model_of(signal, choice);
  if (model.least_end > 0.0) return;
  const GreenPhase& phase =
      phases_.signals()[std::size_t(signal)].phases[std::size_t(choice.phase)];
  const double now = traffic_.time();
  const auto comes = [&](bool to_this, double within) {
    return std::ranges::any_of(queues, [&](const auto& queue) {
      return !queue.empty() && phase.links.contains(queue.front().link) == to_this &&
             (queue.front().arrival < within || (!to_this && queue.front().stands));
    });
  };
  if (!comes(true, kGap)) {
    choice.alone = true;
    return;
  }
  double at_once = std::numeric_limits<double>::infinity();
  double later = std::numeric_limits<double>::infinity();
  int best = choice.phase;
  for (int next = 0; next < model.phases; ++next) {
    if (next == choice.phase) continue;
    const double delay = queue_delay(queues, model, 0.0, next);
    if (delay < at_once) std::tie(at_once, best) = std::pair(delay, next);
    for (double end = kLook; end < kFar; end += kLook) {
      later = std::min(later, queue_delay(queues, model, end, next));
    }
  }
  const bool too_long = now - choice.since > heads_.timing().most_green && comes(false, 0.0);
  if (best == choice.phase || !(at_once < later || too_long)) return;
  choice = {.phase = best, .since = now, .alone = false};
}

/// [s] of yellow, the longest of its lanes.
double PhaseChoice::yellow_time(int signal) const {
  double yellow = 0.0;
  for (const int lane : lanes_[std::size_t(signal)]) {
    yellow = std::max(yellow, heads_.timing().yellow(graph_.lane(lane).speed_limit));
  }
  return yellow;
}

/// [s] of yellow and all red.
double PhaseChoice::change_time(int signal) const {
  return yellow_time(signal) + heads_.timing().all_red;
}

/// Is none of its lights green, nor yellow?
bool PhaseChoice::is_dark(const GreenPhase& phase) const {
  return std::ranges::all_of(phase.links, [&](int k) { return heads_.light(k) == Light::kRed; });
}

QueuePhases PhaseChoice::model_of(int signal, const Choice& choice) const {
  const std::vector<GreenPhase>& phases = phases_.signals()[std::size_t(signal)].phases;
  const double change = change_time(signal);
  const double ready = choice.since + change - traffic_.time();
  // People may keep all its lights red.
  const bool dark = is_dark(phases[std::size_t(choice.phase)]);
  return {.phases = int(phases.size()),
          .present = choice.phase,
          .ready = ready,
          .least_end = dark ? ready : ready + heads_.timing().least_green,
          .first_change = dark ? 0.0 : change,
          .change = change,
          .least_green = heads_.timing().least_green,
          .has_green = [&phases](int p, int k) { return phases[std::size_t(p)].links.contains(k); },
          .yields_to = [this](int k, int other) { return phases_.yields_to(k, other); },
          .free_in = [this](int k) { return barred_until(k) - traffic_.time(); }};
}

}  // namespace mvtp
