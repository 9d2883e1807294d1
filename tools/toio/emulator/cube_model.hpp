#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "tools/toio/cube/mat_frame.hpp"
#include "tools/toio/cube/protocol.hpp"

namespace mvtp {

/// How one cube differs from the ideal.
struct CubeFlaws {
  double left_gain = 1.0;  ///< of the wheels' speeds
  double right_gain = 1.0;
  std::uint8_t battery = 90;  ///< [%]
  std::string version = "2.4.0";
};

/// A toio Core Cube that exists only here: takes writes, moves, notifies.
///
/// Wheels with a dead zone, a largest speed and a time constant; whole dots and degrees; commands
/// 0x01 to 0x05 with their responses; what the specification leaves open about how a target is
/// approached follows the simulator of the toio SDK for Unity. No radio: delay and loss are for
/// whoever passes the writes on.
class CubeModel {
 public:
  /// @param pose of the axle on the desk, heading where the cube's nose points.
  CubeModel(const Mat& mat, const Cube& cube, const Pose& pose, const CubeFlaws& flaws);

  void write(Characteristic to, std::span<const std::uint8_t> bytes);
  void step(double dt);
  /// What it has notified since the last call, in order.
  [[nodiscard]] std::vector<Notification> take_notifications();

  /// The link ends: settings are forgotten. Wheels go on until the time of their command is up,
  /// which is no better than what a real cube can be expected to do.
  void disconnect();
  /// Holds the wheels fast for a time, whatever the motors do.
  void block(double seconds) { blocked_until_ = time_ + seconds; }
  /// Something hits it.
  void bump() { notify(Motion{.collision = true}); }
  void press(bool pressed) { notify(Button{pressed}); }
  /// Somebody's hand.
  void put(const Pose& pose) { pose_ = pose; }

  [[nodiscard]] const Pose& pose() const { return pose_; }
  /// Of the faster wheel [m/s].
  [[nodiscard]] double wheel_speed_now() const;
  /// The value that a read of a characteristic would give.
  [[nodiscard]] Bytes value(Characteristic from) const;

 private:
  struct Targets {
    TargetMode mode;
    bool many = false;
    std::vector<Target> list;
    std::size_t at = 0;
    double begun = 0.0;   ///< when the current target was
    MatPose from;         ///< where the command was written
    bool placed = false;  ///< x and y of the current target are reached
  };

  void notify(const CubeEvent& event) { notifications_.push_back(encode(event)); }
  void run(const DriveOn& c);
  void run(const DriveFor& c);
  void run(const GoTo& c);
  void run(const GoThrough& c);
  void run(const Accelerate& c);
  void run(const NotifyId& c);
  void run(const NotifyIdMissed& c);
  void run(const NotifyWheelSpeeds& c);
  void run(const AskInterval& c);
  void run(const AskVersion& c);
  void run(const LightOn&) {}
  void run(const LightOff&) {}
  void begin(Targets targets);
  void end_targets(TargetResult result);
  void interrupt();
  void drive_to_targets();
  [[nodiscard]] MatPose goal_of(const Targets& targets) const;
  [[nodiscard]] std::optional<int> turn_left(const Targets& targets, const MatPose& here) const;
  void report_position();
  [[nodiscard]] MatPose reported() const { return rounded(desk_.to_mat(pose_)); }
  [[nodiscard]] bool on_mat() const;

  DeskFrame desk_;
  CubeFlaws flaws_;
  Pose pose_;
  double time_ = 0.0;
  double left_ = 0.0;  ///< wheel speeds [m/s]
  double right_ = 0.0;
  WheelUnits units_;  ///< what the motors are told
  double units_until_ = 0.0;
  double blocked_until_ = 0.0;
  std::optional<Targets> targets_;
  std::optional<Targets> appended_;
  NotifyId id_setting_;
  double next_report_ = 0.0;
  double missed_after_ = 0.07;
  double seen_at_ = 0.0;
  bool missed_told_ = false;
  std::optional<PositionId> last_report_;
  double changed_at_ = 0.0;
  std::deque<Notification> notifications_;
};

}  // namespace mvtp
