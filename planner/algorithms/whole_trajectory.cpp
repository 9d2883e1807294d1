#include "planner/algorithms/whole_trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mvtp {
namespace {

constexpr double kBrakingSample =
    0.2;  ///< [s] between two looks at vehicles that brake in lock-step

/// Everything that one vehicle's plan is tested against, gathered once.
class Surroundings {
 public:
  Surroundings(const RoadScene& scene, const RoadVehicle& vehicle,
               std::span<const JointPlan::Entry> before, const WholeTrajectoryOptions& options)
      : grid_(scene.grid), vehicle_(vehicle), body_(scene.body(vehicle)), options_(options) {
    for (const Forecast& f : scene.forecasts) add(scene, f.vehicle, f.trajectory, true);
    for (const JointPlan::Entry& e : before) {
      if (e.key != vehicle.key) add(scene, scene.vehicle(e.key), *e.trajectory, false);
    }
  }

  /// Is the decision to drive from `from` with acceleration `a` during steps k .. k + n free of
  /// contact, and everyone's braking in lock-step after it as well?
  [[nodiscard]] bool step_is_clear(std::int64_t k, const InertialState& from, double a,
                                   const InertialState& to) const {
    const double reach =
        to.s + stopping_distance(to.v, body_.max_decel) + to.v * options_.forecast_reaction;
    for (const Other& other : others_) {
      const InertialState other_now = other.trajectory->at(k);
      if (!other.contacts->relevant(from.s, reach, other_now.s)) continue;
      // A leader of another driver may always be answered with full braking.
      if (other.forecast && a <= -body_.max_decel + 1e-9) continue;
      if (touches_in_step(other, k, from, a)) return false;
      if (touches_in_lock_step(other, k + grid_.steps_per_decision, to)) return false;
    }
    return true;
  }

  /// Could the vehicle brake from `state` at step k and then stand clear of all planned futures?
  [[nodiscard]] bool can_wait(std::int64_t k, const InertialState& state) const {
    const double b = body_.max_decel;
    const double rest = state.s + stopping_distance(state.v, b);
    const auto steps = std::int64_t(std::ceil(state.v / b / grid_.dt));
    for (const Other& other : others_) {
      if (!other.contacts->relevant(state.s, rest, other.trajectory->at(k).s)) continue;
      for (std::int64_t i = 1; i < steps; ++i) {
        const double s = braked_position(state, b, double(i) * grid_.dt);
        if (other.contacts->touches(s, other.trajectory->at(k + i).s)) return false;
      }
      const double from = other.trajectory->at(k + steps).s;
      const double to = other.trajectory->states.back().s;
      if (from <= to && other.contacts->blocks(rest, from, to)) return false;
    }
    return true;
  }

  /// On a common exit lane: is the one behind far enough from the one ahead, whichever of the two
  /// this vehicle is? Both ways, since a vehicle planned later may slip in ahead.
  [[nodiscard]] bool keeps_headway(std::int64_t k, const InertialState& state) const {
    const double d = state.s - vehicle_.s_exit_lane;
    if (d <= 0.0) return true;
    for (const Other& other : others_) {
      if (other.vehicle->exit_lane != vehicle_.exit_lane) continue;
      const InertialState o = other.trajectory->at(k);
      const double d_other = o.s - other.vehicle->s_exit_lane;
      if (o.s >= PathTrajectory::kGone || d_other <= 0.0) continue;
      const bool behind = d <= d_other;
      const double gap = behind ? d_other - d - other.body->length() : d - d_other - body_.length();
      const double wanted =
          behind ? headway(d, state.v, body_.max_decel, o.v, other.body->max_decel)
                 : headway(d_other, o.v, other.body->max_decel, state.v, body_.max_decel);
      if (gap < wanted) return false;
    }
    return true;
  }

  /// Will the driver who takes over at step k in this state have his headway to those ahead who are
  /// not ours? They may have slowed down since the plan was made.
  [[nodiscard]] bool leaves_forecasts_room(std::int64_t k, const InertialState& state) const {
    const double d = state.s - vehicle_.s_exit_lane;
    for (const Other& other : others_) {
      const InertialState o = other.trajectory->at(k);
      const double ahead = o.s - other.vehicle->s_exit_lane - d;
      if (!other.forecast || other.vehicle->exit_lane != vehicle_.exit_lane || ahead <= 0.0 ||
          o.s >= PathTrajectory::kGone) {
        continue;
      }
      const double braking = stopping_distance(state.v, body_.max_decel) -
                             stopping_distance(o.v, other.body->max_decel);
      const double wanted = vehicle_.min_gap + vehicle_.tau * state.v + std::max(0.0, braking);
      if (ahead - other.body->length() < wanted) return false;
    }
    return true;
  }

 private:
  struct Other {
    const ContactTable* contacts;
    const PathTrajectory* trajectory;
    const RoadVehicle* vehicle;
    const Vehicle* body;
    bool forecast;
  };

  void add(const RoadScene& scene, const RoadVehicle& vehicle, const PathTrajectory& trajectory,
           bool forecast) {
    const ContactTable& contacts = scene.library->contacts(vehicle_.path, vehicle.path);
    const bool same_exit = vehicle.exit_lane >= 0 && vehicle.exit_lane == vehicle_.exit_lane;
    // Whoever follows us on our exit lane keeps clear of us, not we of him.
    const double d = vehicle.now.s - vehicle.s_exit_lane;
    if (forecast && same_exit && d > 0.0 && d < vehicle_.now.s - vehicle_.s_exit_lane) return;
    if (contacts.empty() && !same_exit) return;
    others_.push_back({&contacts, &trajectory, &vehicle, &scene.body(vehicle), forecast});
  }

  [[nodiscard]] bool touches_in_step(const Other& other, std::int64_t k, const InertialState& from,
                                     double a) const {
    for (int i = 1; i <= grid_.steps_per_decision; ++i) {
      const double s = advance(from, a, i * grid_.dt).s;
      if (other.contacts->touches(s, other.trajectory->at(k + i).s)) return true;
    }
    return false;
  }

  [[nodiscard]] bool touches_in_lock_step(const Other& other, std::int64_t k,
                                          const InertialState& state) const {
    const InertialState o = other.trajectory->at(k);
    if (o.s >= PathTrajectory::kGone) return false;
    const double reaction = other.forecast ? options_.forecast_reaction : 0.0;
    const double b = body_.max_decel;
    const double b_other = other.body->max_decel;
    const double rest = std::max(reaction + state.v / b, o.v / b_other);
    const InertialState late = advance(state, 0.0, reaction);
    for (double tau = kBrakingSample;; tau += kBrakingSample) {
      const double s =
          tau <= reaction ? state.s + state.v * tau : braked_position(late, b, tau - reaction);
      if (other.contacts->touches(s, braked_position(o, b_other, tau))) return true;
      if (tau >= rest) return false;
    }
  }

  [[nodiscard]] double headway(double d_behind, double v, double b, double v_ahead,
                               double b_ahead) const {
    const double ramp = std::clamp(d_behind / options_.headway_ramp, 0.0, 1.0);
    const double braking = v * v / (2.0 * b) - v_ahead * v_ahead / (2.0 * b_ahead);
    return ramp * (options_.exit_gap + options_.exit_headway * v + std::max(0.0, braking));
  }

  DecisionGrid grid_;
  const RoadVehicle& vehicle_;
  const Vehicle& body_;
  const WholeTrajectoryOptions& options_;
  std::vector<Other> others_;
};

/// The search for one vehicle: the best of its approaches.
class VehiclePlanner {
 public:
  VehiclePlanner(const RoadScene& scene, const RoadVehicle& vehicle, const Surroundings& around,
                 const WholeTrajectoryOptions& options)
      : grid_(scene.grid),
        start_(scene.step),
        vehicle_(vehicle),
        body_(scene.body(vehicle)),
        around_(around),
        options_(options),
        max_decisions_(int(options.horizon / scene.grid.decision())) {}

  [[nodiscard]] std::optional<PathTrajectory> plan() {
    std::optional<PathTrajectory> best;
    for (const double share : options_.approach_speeds) {
      blocked_ = false;
      if (approach(share)) {
        const double cost = cost_of(states_);
        if (cost < best_cost_) {
          best = PathTrajectory{.begin = start_, .states = states_};
          best_cost_ = cost;
        }
      }
      if (!blocked_) break;  // nothing stood in its way: no timing can be better
    }
    return best;
  }

  [[nodiscard]] PathTrajectory alone() {
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
      if (decisions() >= max_decisions_ || least_cost() >= best_cost_) return false;
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
        if (go()) return true;
      }
      if (chosen == choices.count) return false;
      append(from, choices[chosen]);
    }
    return true;
  }

  /// Runs to the end as fast as the rules allow, or leaves the states as they were.
  bool go() {
    const std::size_t kept = states_.size();
    while (states_.back().s < vehicle_.s_end) {
      const InertialState from = states_.back();
      const Accelerations choices = accelerations(from, 1e9);
      const std::int64_t k = now();
      std::size_t c = 0;
      while (c < choices.count && !allowed(k, from, choices[c], /*must_wait=*/false)) ++c;
      if (c == choices.count || decisions() >= max_decisions_) {
        states_.resize(kept);
        return false;
      }
      append(from, choices[c]);
    }
    return true;
  }

  [[nodiscard]] bool allowed(std::int64_t k, const InertialState& from, double a,
                             bool must_wait) const {
    const InertialState to = advance(from, a, grid_.decision());
    const std::int64_t k_to = k + grid_.steps_per_decision;
    // Firm braking is never refused for the sake of headway: it is what restores it.
    const bool brakes = a < -0.4 * body_.max_decel;
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

  /// What the states so far will cost at least: nobody is faster than at cruise speed.
  [[nodiscard]] double least_cost() const {
    const double left = std::max(0.0, vehicle_.s_handback - states_.back().s);
    return decisions() * grid_.decision() + left / vehicle_.cruise_speed;
  }

  /// Time of hand-back, and what it takes to be at cruise speed again.
  [[nodiscard]] double cost_of(const std::vector<InertialState>& states) const {
    const auto exit = std::ranges::find_if(
        states, [&](const InertialState& x) { return x.s >= vehicle_.s_handback; });
    const double missing = std::max(0.0, vehicle_.cruise_speed - exit->v);
    return double(exit - states.begin()) * grid_.dt +
           missing * missing / (2.0 * body_.max_accel * vehicle_.cruise_speed);
  }

  DecisionGrid grid_;
  std::int64_t start_;
  const RoadVehicle& vehicle_;
  const Vehicle& body_;
  const Surroundings& around_;
  const WholeTrajectoryOptions& options_;
  int max_decisions_;
  std::vector<InertialState> states_;
  bool blocked_ = false;
  double best_cost_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::optional<PathTrajectory> plan_vehicle(const RoadScene& scene, const RoadVehicle& vehicle,
                                           std::span<const JointPlan::Entry> before,
                                           const WholeTrajectoryOptions& options) {
  const Surroundings around(scene, vehicle, before, options);
  return VehiclePlanner(scene, vehicle, around, options).plan();
}

PathTrajectory plan_alone(const RoadScene& scene, const RoadVehicle& vehicle,
                          const WholeTrajectoryOptions& options) {
  const Surroundings around(scene, vehicle, {}, options);
  return VehiclePlanner(scene, vehicle, around, options).alone();
}

bool still_fits(const RoadScene& scene, const RoadVehicle& vehicle,
                const PathTrajectory& trajectory, std::span<const JointPlan::Entry> before,
                const WholeTrajectoryOptions& options) {
  const Surroundings around(scene, vehicle, before, options);
  const int n = scene.grid.steps_per_decision;
  for (std::int64_t k = scene.step; k + n < trajectory.end(); k += n) {
    const InertialState from = trajectory.at(k);
    const InertialState to = trajectory.at(k + n);
    if (!around.step_is_clear(k, from, held_acceleration(from, to, scene.grid.decision()), to)) {
      return false;
    }
  }
  const std::int64_t k = arrival_step(trajectory, vehicle.s_handback);
  return k >= trajectory.end() || around.leaves_forecasts_room(k, trajectory.at(k));
}

double held_acceleration(const InertialState& from, const InertialState& to, double h) {
  const bool stopped = to.v == 0.0 && to.s > from.s;
  return stopped ? -from.v * from.v / (2.0 * (to.s - from.s)) : (to.v - from.v) / h;
}

class WaitTest::Impl {
 public:
  Impl(const RoadScene& scene, const RoadVehicle& vehicle,
       std::span<const JointPlan::Entry> planned, const WholeTrajectoryOptions& options)
      : step(scene.step),
        all(scene, vehicle, planned, options),
        forecasts(scene, vehicle, {}, options) {}

  std::int64_t step;
  Surroundings all;
  Surroundings forecasts;
};

WaitTest::WaitTest(const RoadScene& scene, const RoadVehicle& vehicle,
                   std::span<const JointPlan::Entry> planned, const WholeTrajectoryOptions& options)
    : impl_(std::make_unique<Impl>(scene, vehicle, planned, options)) {}
WaitTest::~WaitTest() = default;

bool WaitTest::can_wait(std::int64_t k, const InertialState& state) const {
  return impl_->all.can_wait(k, state);
}

bool WaitTest::clear_of_forecasts(const InertialState& from, double a,
                                  const InertialState& to) const {
  return impl_->forecasts.step_is_clear(impl_->step, from, a, to);
}

std::int64_t arrival_step(const PathTrajectory& trajectory, double s) {
  const auto there = std::ranges::partition_point(trajectory.states,
                                                  [s](const InertialState& x) { return x.s < s; });
  return trajectory.begin + (there - trajectory.states.begin());
}

}  // namespace mvtp
