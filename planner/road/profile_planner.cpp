#include "planner/road/profile_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "planner/road/surroundings.hpp"

namespace mvtp {
namespace {

/// The search for one vehicle: the best of its approaches.
class VehiclePlanner {
 public:
  VehiclePlanner(const RoadScene& scene, const RoadVehicle& vehicle, const Surroundings& around,
                 const ProfileOptions& options, const PlanLimits& limits = {})
      : grid_(scene.grid),
        start_(scene.step),
        vehicle_(vehicle),
        body_(scene.body(vehicle)),
        around_(around),
        options_(options),
        max_decisions_(int(options.horizon / scene.grid.decision())),
        most_work_(limits.work ? std::max<std::int64_t>(0, limits.work->left) : kUnlimitedWork),
        best_cost_(limits.cost) {}

  [[nodiscard]] std::optional<SpeedProfile> plan() {
    std::optional<SpeedProfile> best;
    if (around_.is_barred(vehicle_.s_end)) return best;
    for (const double share : options_.approach_speeds) {
      blocked_ = false;
      if (approach(share)) {
        const double cost = cost_of(states_);
        if (cost < best_cost_) {
          best = SpeedProfile{.begin = start_, .states = states_};
          best_cost_ = cost;
        }
      }
      if (!blocked_ || out_of_work()) break;  // not blocked: no timing can be better
    }
    return best;
  }

  [[nodiscard]] SpeedProfile alone() {
    states_ = {vehicle_.now};
    while (states_.back().s < vehicle_.s_end && decisions() < max_decisions_) {
      append(states_.back(), accelerations(states_.back(), 1e9)[0]);
    }
    return {.begin = start_, .states = states_};
  }

 private:
  /// Drives at up to `share` of the cruise speed while it can wait, and goes when it is blocked.
  bool approach(double share) {
    states_ = {vehicle_.now};
    while (states_.back().s < vehicle_.s_end) {
      if (decisions() >= max_decisions_ || out_of_work() || least_cost() >= best_cost_) {
        return false;
      }
      const InertialState from = states_.back();
      const Accelerations choices = accelerations(from, share * vehicle_.cruise_speed);
      const std::int64_t k = now();
      std::size_t chosen = choices.count;
      for (std::size_t c = 0; c < choices.count; ++c) {
        if (allowed(k, from, choices[c], /*must_wait=*/true)) {
          chosen = c;
          break;
        }
        if (c > 0) continue;
        blocked_ = true;
        const Run run = go();
        if (run != Run::kFails) return run == Run::kArrives;
      }
      if (chosen == choices.count) return false;
      append(from, choices[chosen]);
    }
    return true;
  }

  enum class Run { kArrives, kFails, kKnown };

  /// Runs to the end as fast as the rules allow, or leaves the states as they were. How a run goes
  /// on depends on nothing but its last state: one that gets where another one failed fails, too,
  /// and one that gets where another one arrived is known.
  Run go() {
    const std::size_t kept = states_.size();
    const auto give_up = [&](Run run) {
      states_.resize(kept);
      return run;
    };
    const int first = decisions();
    while (states_.back().s < vehicle_.s_end) {
      const InertialState from = states_.back();
      if (const std::optional<Run> known = known_run(from)) return give_up(*known);
      runs_[std::size_t(decisions())].push_back({from, Run::kFails});
      const Accelerations choices = accelerations(from, 1e9);
      const std::int64_t k = now();
      std::size_t c = 0;
      while (c < choices.count && !allowed(k, from, choices[c], /*must_wait=*/false)) ++c;
      if (c == choices.count || decisions() >= max_decisions_ || out_of_work()) {
        return give_up(Run::kFails);
      }
      append(from, choices[c]);
    }
    for (int d = first; d < decisions(); ++d) runs_[std::size_t(d)].back().run = Run::kArrives;
    return Run::kArrives;
  }

  /// How a run from this state, at the time of the last one, went.
  std::optional<Run> known_run(const InertialState& from) {
    const auto d = std::size_t(decisions());
    if (d >= runs_.size()) runs_.resize(d + 1);
    const auto known = std::ranges::find_if(
        runs_[d], [&](const Known& k) { return k.from.s == from.s && k.from.v == from.v; });
    if (known == runs_[d].end()) return std::nullopt;
    return known->run == Run::kArrives ? Run::kKnown : Run::kFails;
  }

  [[nodiscard]] bool allowed(std::int64_t k, const InertialState& from, double a,
                             bool must_wait) const {
    const InertialState to = advance(from, a, grid_.decision());
    const std::int64_t k_to = k + grid_.steps_per_decision;
    if (to.v == 0.0 && to.s != vehicle_.now.s && !around_.may_stand_at(to.s)) return false;
    // Firm braking is never refused for the sake of headway, nor is standing: that restores it.
    const bool brakes = a < -0.4 * body_.max_decel || (from.v == 0.0 && to.v == 0.0);
    if (!brakes && !around_.keeps_headway(k_to, to)) return false;
    if (!around_.step_is_clear(k, from, a, to)) return false;
    return !must_wait || around_.can_wait(k_to, to);
  }

  struct Accelerations {
    std::array<double, 5> values;
    std::size_t count = 0;
    double operator[](std::size_t i) const { return values[i]; }
  };

  /// The candidates of one decision, fastest first; the first is clipped to the speed limits.
  [[nodiscard]] Accelerations accelerations(const InertialState& from, double limit) const {
    const double most = clipped(from, body_.max_accel, limit);
    Accelerations choices;
    choices.values[choices.count++] = most;
    for (const double a : {0.5 * body_.max_accel, 0.0, -0.5 * body_.max_decel, -body_.max_decel}) {
      if (a < most - 1e-9 && (a >= 0.0 || from.v > 0.0)) choices.values[choices.count++] = a;
    }
    return choices;
  }

  /// The largest acceleration up to `a` that keeps to the envelope and, but for comfort, to
  /// `limit`.
  [[nodiscard]] double clipped(const InertialState& from, double a, double limit) const {
    const double h = grid_.decision();
    const double comfortable = -0.5 * body_.max_decel;
    if (from.v + a * h > limit) a = std::max(std::min(a, comfortable), (limit - from.v) / h);
    for (int round = 0; round < 3; ++round) {
      double excess = 0.0;  // in acceleration
      for (const double share : {1.0, 0.5}) {
        const InertialState to = advance(from, a, share * h);
        excess = std::max(excess, (to.v - vehicle_.envelope->at(to.s)) / (share * h));
      }
      if (excess <= 1e-9) break;
      a -= excess;
    }
    return std::max(a, -body_.max_decel);
  }

  void append(InertialState from, double a) {
    for (int i = 1; i <= grid_.steps_per_decision; ++i) {
      states_.push_back(advance(from, a, i * grid_.dt));
    }
  }

  [[nodiscard]] int decisions() const { return int(states_.size() - 1) / grid_.steps_per_decision; }
  [[nodiscard]] std::int64_t now() const { return start_ + std::int64_t(states_.size()) - 1; }

  [[nodiscard]] bool out_of_work() const { return around_.work() >= most_work_; }

  /// What the states so far will cost at least: nobody is faster than at cruise speed, and it takes
  /// time to get there, whether before the hand-back or after it.
  [[nodiscard]] double least_cost() const {
    const double left = vehicle_.s_handback - states_.back().s;
    if (left <= 0.0) return 0.0;
    return decisions() * grid_.decision() + left / vehicle_.cruise_speed +
           time_to_cruise(states_.back().v);
  }

  /// What it costs to be slower than cruise speed: time lost until then.
  [[nodiscard]] double time_to_cruise(double v) const {
    const double missing = std::max(0.0, vehicle_.cruise_speed - v);
    return missing * missing / (2.0 * body_.max_accel * vehicle_.cruise_speed);
  }

  /// Time of hand-back, and what it takes to be at cruise speed again.
  [[nodiscard]] double cost_of(const std::vector<InertialState>& states) const {
    const auto exit = std::ranges::find_if(
        states, [&](const InertialState& x) { return x.s >= vehicle_.s_handback; });
    return double(exit - states.begin()) * grid_.dt + time_to_cruise(exit->v);
  }

  DecisionGrid grid_;
  std::int64_t start_;
  const RoadVehicle& vehicle_;
  const Vehicle& body_;
  const Surroundings& around_;
  const ProfileOptions& options_;
  int max_decisions_;
  std::int64_t most_work_;
  std::vector<InertialState> states_;
  struct Known {
    InertialState from;
    Run run;
  };
  std::vector<std::vector<Known>> runs_;  ///< by the number of decisions before
  bool blocked_ = false;
  double best_cost_;  ///< only cheaper plans are of use
};

/// Every decision of the profile, and braking after each.
bool is_clear(const Surroundings& around, const RoadScene& scene, const SpeedProfile& profile) {
  const int n = scene.grid.steps_per_decision;
  for (std::int64_t k = scene.step; k + n < profile.end(); k += n) {
    const InertialState from = profile.at(k);
    const InertialState to = profile.at(k + n);
    const double a = held_acceleration(from, to, scene.grid.decision());
    if (!around.step_is_clear(k, from, a, to)) return false;
  }
  return true;
}

/// When the driver gets the vehicle back: not before now, if it is driven on beyond that place.
std::int64_t handback_step(const RoadPairs& pairs, const RoadVehicle& vehicle,
                           const SpeedProfile& profile) {
  return std::max(pairs.scene().step, arrival_step(profile, vehicle.s_handback));
}

}  // namespace

std::optional<SpeedProfile> plan_vehicle(const RoadPairs& pairs, const RoadVehicle& vehicle,
                                         std::span<const JointPlan::Entry> before,
                                         const ProfileOptions& options, const PlanLimits& limits) {
  const Surroundings around(pairs, vehicle, before, options, Surroundings::Forecasts::kWithSlack);
  auto profile = VehiclePlanner(pairs.scene(), vehicle, around, options, limits).plan();
  if (limits.work) limits.work->left -= around.work();
  return profile;
}

SpeedProfile plan_alone(const RoadPairs& pairs, const RoadVehicle& vehicle,
                        const ProfileOptions& options) {
  const Surroundings around(pairs, vehicle, {}, options);
  return VehiclePlanner(pairs.scene(), vehicle, around, options).alone();
}

bool still_fits(const RoadPairs& pairs, const RoadVehicle& vehicle, const SpeedProfile& profile,
                std::span<const JointPlan::Entry> before, const ProfileOptions& options,
                WorkBudget* work, const std::vector<bool>& waived) {
  const Surroundings around(pairs, vehicle, before, options, Surroundings::Forecasts::kCount,
                            waived);
  const bool clear = is_clear(around, pairs.scene(), profile);
  if (work) work->left -= around.work();
  if (!clear) return false;
  const std::int64_t k = handback_step(pairs, vehicle, profile);
  return k >= profile.end() || around.leaves_room(k, profile.at(k));
}

bool leaves_room(const RoadPairs& pairs, const RoadVehicle& vehicle, const SpeedProfile& profile,
                 std::span<const JointPlan::Entry> others, const ProfileOptions& options) {
  const std::int64_t k = handback_step(pairs, vehicle, profile);
  if (k >= profile.end()) return true;
  const Surroundings around(pairs, vehicle, others, options, Surroundings::Forecasts::kIgnore);
  return around.leaves_room(k, profile.at(k));
}

bool fits_beside(const RoadPairs& pairs, const RoadVehicle& vehicle, const SpeedProfile& profile,
                 std::span<const JointPlan::Entry> others, const ProfileOptions& options,
                 WorkBudget* work) {
  const Surroundings around(pairs, vehicle, others, options, Surroundings::Forecasts::kIgnore);
  const bool clear = is_clear(around, pairs.scene(), profile);
  if (work) work->left -= around.work();
  return clear;
}

SpeedProfile stop_after(const RoadScene& scene, const InertialState& from, double a, double decel) {
  SpeedProfile t{.begin = scene.step, .states = {}, .complete = false};
  for (int i = 0; i <= scene.grid.steps_per_decision; ++i) {
    t.states.push_back(advance(from, a, i * scene.grid.dt));
  }
  const InertialState to = t.states.back();
  const int braking = braking_steps(to.v, decel, scene.grid.dt);
  for (int i = 1; i <= braking; ++i) t.states.push_back(advance(to, -decel, i * scene.grid.dt));
  t.states.back().v = 0.0;
  return t;
}

double held_acceleration(const InertialState& from, const InertialState& to, double h) {
  const bool stopped = to.v == 0.0 && to.s > from.s;
  return stopped ? -from.v * from.v / (2.0 * (to.s - from.s)) : (to.v - from.v) / h;
}

class WaitTest::Impl {
 public:
  Impl(const RoadPairs& pairs, const RoadVehicle& vehicle,
       std::span<const JointPlan::Entry> planned, const ProfileOptions& options)
      : scene(pairs.scene()),
        own(vehicle),
        all(pairs, vehicle, planned, options),
        forecasts(pairs, vehicle, {}, options, Surroundings::Forecasts::kWithSlack) {}

  const RoadScene& scene;
  const RoadVehicle& own;
  Surroundings all;
  Surroundings forecasts;
};

WaitTest::WaitTest(const RoadPairs& pairs, const RoadVehicle& vehicle,
                   std::span<const JointPlan::Entry> planned, const ProfileOptions& options)
    : impl_(std::make_unique<Impl>(pairs, vehicle, planned, options)) {}
WaitTest::~WaitTest() = default;

bool WaitTest::can_wait(std::int64_t k, const InertialState& state) const {
  return impl_->all.can_wait(k, state);
}

bool WaitTest::stands_clear(std::int64_t k, const InertialState& state) const {
  return impl_->all.stands_clear(k, state);
}

bool WaitTest::leaves_passages_free(std::int64_t k, const InertialState& state) const {
  return impl_->forecasts.leaves_passages_free(k, state);
}

bool WaitTest::gets_away(std::int64_t k, InertialState state) const {
  constexpr int kDecisions = 16;
  const Surroundings& forecasts = impl_->forecasts;
  const Vehicle& body = impl_->scene.body(impl_->own);
  const DecisionGrid& grid = impl_->scene.grid;
  const double h = grid.decision();
  for (int n = 0; n < kDecisions; ++n, k += grid.steps_per_decision) {
    if (forecasts.leaves_passages_free(k, state)) return true;
    double a = body.max_accel;
    InertialState to = advance(state, a, h);
    while (a > -body.max_decel && to.v > impl_->own.envelope->at(to.s)) {
      a -= 0.5 * body.max_accel;
      to = advance(state, a, h);
    }
    if (!forecasts.step_is_clear(k, state, a, to)) return false;
    state = to;
  }
  return true;
}

bool WaitTest::clear_of_forecasts(const InertialState& from, double a,
                                  const InertialState& to) const {
  return impl_->forecasts.step_is_clear(impl_->scene.step, from, a, to);
}

std::int64_t arrival_step(const SpeedProfile& profile, double s) {
  const auto there =
      std::ranges::partition_point(profile.states, [s](const InertialState& x) { return x.s < s; });
  return profile.begin + (there - profile.states.begin());
}

}  // namespace mvtp
