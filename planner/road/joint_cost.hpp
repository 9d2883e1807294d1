#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "planner/road/profile_planner.hpp"

namespace mvtp {

/// What joint plans cost: the time of each vehicle until it is handed back, what it takes to be at
/// cruise speed again, both times its weight, and headways that are missing then. Seconds are those
/// of a vehicle of weight 1.
class JointCost {
 public:
  using Entries = std::vector<JointPlan::Entry>;

  /// @param headway_weight  [s/s] cost of a headway that is missing at hand-back
  JointCost(const RoadPairs& pairs, const ProfileOptions& options, double headway_weight)
      : pairs_(pairs), scene_(pairs.scene()), options_(options), headway_weight_(headway_weight) {}

  /// Of all of them [s].
  [[nodiscard]] double of(const Entries& entries) const;
  /// Time until the control zone is left, and what it takes to be at cruise speed again [s].
  [[nodiscard]] double until_handback(const JointPlan::Entry& e) const;
  /// The same of a vehicle that is alone on the road: nobody is faster.
  [[nodiscard]] double alone(std::int64_t key);
  /// How much later than alone on the road each vehicle leaves [s].
  [[nodiscard]] std::vector<double> delays(const Entries& entries);
  /// What each vehicle loses beside what its leader, the nearest before it, loses already [s], with
  /// a little of that.
  [[nodiscard]] std::vector<double> own_delays(const Entries& entries);

 private:
  struct OnExit {
    const RoadVehicle* vehicle;
    const SpeedProfile* profile;
  };
  [[nodiscard]] double missing_headway(const OnExit& own, const std::vector<OnExit>& all) const;

  const RoadPairs& pairs_;
  const RoadScene& scene_;
  const ProfileOptions& options_;
  double headway_weight_;
  std::map<std::int64_t, double> alone_;
};

}  // namespace mvtp
