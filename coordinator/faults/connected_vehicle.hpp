#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "coordinator/faults/fault_model.hpp"
#include "coordinator/faults/noise.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// A plan as a vehicle gets it: where it is to be at each step.
struct PlanMessage {
  std::int64_t begin = 0;  ///< step of the first pose
  std::vector<PlannedPose> poses;
  bool complete = true;  ///< behind its end a human drives the vehicle again; else it stays

  [[nodiscard]] std::int64_t last() const { return begin + std::int64_t(poses.size()) - 1; }
};

/// A vehicle that drives by the last plan it has got: by the clock, but where it is off its plan it
/// comes back to it no faster than it can.
class ConnectedVehicle {
 public:
  /// @param pose, speed  when it is taken over.
  ConnectedVehicle(const Pose& pose, double speed, const Vehicle& body, const FaultModel& model,
                   double dt, Draws draws);

  /// From now on it follows this plan.
  void receive(std::shared_ptr<const PlanMessage> plan, std::int64_t step);

  /// What it does in spite of its plan.
  enum class Will { kObeys, kBrakes, kHoldsSpeed };
  void set_will(Will will) { will_ = will; }
  [[nodiscard]] Will will() const { return will_; }

  /// Drives one step. @pre it has a plan
  /// @param step  the one at whose end it will be.
  void drive(std::int64_t step);

  [[nodiscard]] const Pose& pose() const { return pose_; }
  [[nodiscard]] double speed() const { return speed_; }
  [[nodiscard]] bool has_plan() const { return plan_ != nullptr; }
  /// Is it at the end of a plan behind which a human drives it?
  [[nodiscard]] bool is_through(std::int64_t step) const;
  /// How far it is from where its plan has it [m].
  [[nodiscard]] double deviation() const { return deviation_; }

 private:
  [[nodiscard]] double wanted_speed(std::int64_t step) const;
  [[nodiscard]] double nearest_station(std::int64_t step) const;
  [[nodiscard]] Pose pose_at(double s) const;
  void note_offset();

  Vehicle body_;
  FaultModel model_;
  double dt_;
  Draws draws_;
  Noise along_;
  Noise across_;
  std::shared_ptr<const PlanMessage> plan_;
  std::vector<double> stations_;  ///< [m] driven until each pose of the plan
  Will will_ = Will::kObeys;
  double s_ = 0.0;        ///< [m] on the plan's path, without the error of actuation
  double aside_ = 0.0;    ///< [m] beside the path when the plan was received,
  double slope_ = 0.0;    ///< and how aslant,
  double merge_ = 0.0;    ///< at this station
  double planned_ = 0.0;  ///< [m/s] without the error of actuation
  double deviation_ = 0.0;
  Pose pose_;
  double speed_;
};

}  // namespace mvtp
