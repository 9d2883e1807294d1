#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "planner/road/road_contact.hpp"

namespace mvtp {

struct ProfileOptions {
  /// Shares of the cruise speed at which a vehicle may approach until it can go; more of them find
  /// better timings and cost time in proportion.
  std::vector<double> approach_speeds = {1.0, 0.8, 0.6, 0.45, 0.35, 0.25, 0.15};
  double horizon = 100.0;      ///< [s] within which a plan must be complete
  double exit_gap = 3.0;       ///< [m] behind the vehicle ahead on the exit lane, and
  double exit_headway = 1.2;   ///< [s]; together they spare SUMO's drivers hard braking
  double headway_ramp = 40.0;  ///< [m] of exit lane over which that distance builds up; less where
  double least_ramp = 10.0;    ///< [m] the hand-back is nearer, but no less than this
};

inline constexpr std::int64_t kUnlimitedWork = std::numeric_limits<std::int64_t>::max();

/// How much planning is left to be done, in looks at one other vehicle during one decision: counted
/// instead of timed, so that a result does not depend on the machine. A clock is the last resort.
struct WorkBudget {
  std::int64_t left = kUnlimitedWork;
  std::function<bool()> time_is_up;  ///< none: never

  /// Is searching for something better over?
  [[nodiscard]] bool is_spent() const { return left <= 0 || (time_is_up && time_is_up()); }
};

/// Where the search for one vehicle's plan may end early.
struct PlanLimits {
  WorkBudget* work = nullptr;  ///< when it is used up; with the best plan until then
  double cost = std::numeric_limits<double>::infinity();  ///< [s] from which a plan is of no use
};

/// Plans one vehicle against everything planned `before` it and against the forecasts; nullopt if
/// it finds no complete plan.
///
/// A plan is an approach and a run. On the approach the vehicle WAITs where it must: at every
/// decision it could brake and then stand clear of all planned futures. Once blocked, it tries to
/// GO: a run to the end that needs no place to stand, because it is certain to get through. So no
/// vehicle ever stops where others must pass, unless its plan says when it goes on.
///
/// Safety: at every decision of both parts, "everyone brakes now" is free of contact.
/// Liveness: every plan leads to `s_end`.
[[nodiscard]] std::optional<SpeedProfile> plan_vehicle(const RoadPairs& pairs,
                                                       const RoadVehicle& vehicle,
                                                       std::span<const JointPlan::Entry> before,
                                                       const ProfileOptions& options,
                                                       const PlanLimits& limits = {});

/// The run of a vehicle that is alone on the road.
[[nodiscard]] SpeedProfile plan_alone(const RoadPairs& pairs, const RoadVehicle& vehicle,
                                      const ProfileOptions& options);

/// Does `profile` still keep all the rules towards the forecasts and what was planned `before`?
/// @param waived  forecasts that do not count, by number; empty: none.
[[nodiscard]] bool still_fits(const RoadPairs& pairs, const RoadVehicle& vehicle,
                              const SpeedProfile& profile, std::span<const JointPlan::Entry> before,
                              const ProfileOptions& options, WorkBudget* work = nullptr,
                              const std::vector<bool>& waived = {});

/// Has the driver who gets the vehicle back from `profile` his headway to the others?
[[nodiscard]] bool leaves_room(const RoadPairs& pairs, const RoadVehicle& vehicle,
                               const SpeedProfile& profile,
                               std::span<const JointPlan::Entry> others,
                               const ProfileOptions& options);

/// Is `profile` free of contact with the others, whatever the forecasts?
[[nodiscard]] bool fits_beside(const RoadPairs& pairs, const RoadVehicle& vehicle,
                               const SpeedProfile& profile,
                               std::span<const JointPlan::Entry> others,
                               const ProfileOptions& options, WorkBudget* work = nullptr);

/// May a vehicle stop? The WAIT rule of plan_vehicle for planners of single steps.
class WaitTest {
 public:
  WaitTest(const RoadPairs& pairs, const RoadVehicle& vehicle,
           std::span<const JointPlan::Entry> planned, const ProfileOptions& options);
  ~WaitTest();

  /// Could the vehicle brake from `state` at step k and then stand clear of all planned futures?
  [[nodiscard]] bool can_wait(std::int64_t k, const InertialState& state) const;
  /// The same wherever that is: where it is not allowed to come to rest, too.
  [[nodiscard]] bool stands_clear(std::int64_t k, const InertialState& state) const;
  /// The same with nobody but drivers who do not yield.
  [[nodiscard]] bool leaves_passages_free(std::int64_t k, const InertialState& state) const;
  /// From `state` at step k, does the vehicle get out of those passages, or stay ahead of who comes
  /// there, if it drives on as fast as it may?
  [[nodiscard]] bool gets_away(std::int64_t k, InertialState state) const;
  /// Is the decision of now, and braking after it, free of contact with all forecasts?
  [[nodiscard]] bool clear_of_forecasts(const InertialState& from, double a,
                                        const InertialState& to) const;

 private:
  class Impl;
  std::unique_ptr<const Impl> impl_;
};

/// The one acceleration that leads from one decision to the next `h` seconds later; a car that ends
/// at rest may have come to rest before.
[[nodiscard]] double held_acceleration(const InertialState& from, const InertialState& to,
                                       double h);

/// One decision at acceleration `a`, and braking to rest with `decel` after it: safe, not complete.
[[nodiscard]] SpeedProfile stop_after(const RoadScene& scene, const InertialState& from, double a,
                                      double decel);

/// The first step at which the vehicle's rear axle is at or behind s.
[[nodiscard]] std::int64_t arrival_step(const SpeedProfile& profile, double s);

}  // namespace mvtp
