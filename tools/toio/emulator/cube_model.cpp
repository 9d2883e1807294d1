#include "tools/toio/emulator/cube_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/toio/cube/predictor.hpp"

namespace mvtp {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kReachedDots = 15.0;  // of a target, as the specification promises
constexpr double kReachedDegrees = 4.0;
constexpr double kStopDots = 5.0;     // where the model stops; real cubes come closer, too
constexpr double kAimDegrees = 20.0;  // straight ahead within this much
constexpr int kSlowest = 10;          // largest speeds below are refused

double end_of(double now, std::uint8_t tens_of_ms) {
  return tens_of_ms == 0 ? kNever : now + tens_of_ms / 100.0;
}

double turn_between(double from_degrees, double to_degrees) {
  return std::remainder(to_degrees - from_degrees, 360.0);
}

}  // namespace

CubeModel::CubeModel(const Mat& mat, const Cube& cube, const Pose& pose, const CubeFlaws& flaws)
    : desk_{mat, cube, Facing::kNoseFirst}, flaws_(flaws), pose_(pose) {}

void CubeModel::write(Characteristic to, std::span<const std::uint8_t> bytes) {
  const std::optional<CubeCommand> command = decode_command(to, bytes);
  if (command) std::visit([this](const auto& c) { run(c); }, *command);
}

void CubeModel::run(const DriveOn& c) {
  interrupt();
  units_ = c.speed;
  units_until_ = kNever;
}

void CubeModel::run(const DriveFor& c) {
  interrupt();
  units_ = c.speed;
  units_until_ = end_of(time_, c.tens_of_ms);
}

void CubeModel::run(const GoTo& c) {
  begin({.mode = c.mode, .many = false, .list = {c.target}, .from = reported()});
}

void CubeModel::run(const GoThrough& c) {
  Targets targets{.mode = c.mode, .many = true, .list = c.targets, .from = reported()};
  if (!c.append || !targets_ || !targets_->many) return begin(std::move(targets));
  if (appended_) return notify(TargetDone{true, c.mode.id, TargetResult::kCannotAppend});
  appended_ = std::move(targets);
}

/// Without the ramp: the speed is there at once.
void CubeModel::run(const Accelerate& c) {
  interrupt();
  const double turn = c.turn_deg_s * (c.counter_clockwise ? 1.0 : -1.0) / kDegreesPerRadian;
  const double speed = (c.backwards ? -1.0 : 1.0) * c.speed * desk_.cube.speed_per_unit;
  units_ = wheel_units(desk_.cube, Facing::kNoseFirst, {speed, turn});
  units_until_ = end_of(time_, c.tens_of_ms);
}

void CubeModel::run(const NotifyId& c) {
  id_setting_ = c;
  notify(SettingDone{0x98, 0});
}

void CubeModel::run(const NotifyIdMissed& c) {
  missed_after_ = c.tens_of_ms / 100.0;
  notify(SettingDone{0x99, 0});
}

void CubeModel::run(const NotifyWheelSpeeds&) { notify(SettingDone{0x9c, 0}); }
void CubeModel::run(const AskInterval&) { notify(SettingDone{0xb0, 0}); }
void CubeModel::run(const AskVersion&) { notify(Version{flaws_.version}); }

void CubeModel::interrupt() {
  if (appended_) {
    notify(TargetDone{true, appended_->mode.id, TargetResult::kOverwritten});
    appended_.reset();
  }
  if (targets_) end_targets(TargetResult::kOverwritten);
}

void CubeModel::begin(Targets targets) {
  interrupt();
  if (targets.mode.max_speed < kSlowest) {
    notify(TargetDone{targets.many, targets.mode.id, TargetResult::kTooSlow});
    return;
  }
  targets.begun = time_;
  targets_ = std::move(targets);
}

void CubeModel::end_targets(TargetResult result) {
  notify(TargetDone{targets_->many, targets_->mode.id, result});
  targets_.reset();
  units_ = {};
  if (!appended_ || result != TargetResult::kReached) return;
  targets_ = std::move(appended_);
  appended_.reset();
  targets_->begun = time_;
}

MatPose CubeModel::goal_of(const Targets& targets) const {
  MatPose goal = targets.from;
  for (std::size_t i = 0; i <= targets.at; ++i) {
    if (targets.list[i].x != kSamePlace) goal.x = targets.list[i].x;
    if (targets.list[i].y != kSamePlace) goal.y = targets.list[i].y;
  }
  return goal;
}

/// Degrees still to be turned on the spot, clockwise positive; nullopt: none.
std::optional<int> CubeModel::turn_left(const Targets& targets, const MatPose& here) const {
  const Target& target = targets.list[targets.at];
  double goal = target.degrees;
  switch (target.rule) {
    case AngleRule::kAny:
      return std::nullopt;
    case AngleRule::kKeep:
      goal = targets.from.degrees;
      break;
    case AngleRule::kByClockwise:
      goal = targets.from.degrees + target.degrees;
      break;
    case AngleRule::kByCounterClockwise:
      goal = targets.from.degrees - target.degrees;
      break;
    default:
      break;
  }
  const double left = turn_between(here.degrees, goal);
  if (std::abs(left) <= kReachedDegrees) return std::nullopt;
  return int(left);
}

/// Steers towards the current target, as firmware does: by the angle to it.
void CubeModel::drive_to_targets() {
  Targets& targets = *targets_;
  const double timeout = targets.mode.timeout_s == 0 ? 10.0 : targets.mode.timeout_s;
  if (time_ - targets.begun > timeout) return end_targets(TargetResult::kTimeout);
  if (!on_mat()) return end_targets(TargetResult::kMissed);
  const MatPose here = reported();
  const MatPose goal = goal_of(targets);
  const double dx = goal.x - here.x;
  const double dy = goal.y - here.y;
  const int most = std::min(int(targets.mode.max_speed), desk_.cube.max_unit);

  if (!targets.placed) targets.placed = std::hypot(dx, dy) <= kStopDots;
  if (targets.placed && std::hypot(dx, dy) > kReachedDots) targets.placed = false;
  if (targets.placed) {
    if (const std::optional<int> turn = turn_left(targets, here)) {
      const int speed = *turn > 0 ? 9 : -9;
      units_ = {speed, -speed};
      return;
    }
    targets.placed = false;
    targets.begun = time_;
    if (++targets.at == targets.list.size()) end_targets(TargetResult::kReached);
    return;
  }

  double bearing = turn_between(here.degrees, std::atan2(dy, dx) * kDegreesPerRadian);
  double forward = 1.0;
  if (targets.mode.movement == TargetMovement::kCurve && std::abs(bearing) > 90.0) {
    forward = -1.0;
    bearing = turn_between(180.0, bearing);
  }
  const bool on_the_spot =
      targets.mode.movement == TargetMovement::kTurnThenMove && std::abs(bearing) > kAimDegrees;
  const double ahead = on_the_spot ? 0.0 : forward * most * std::cos(bearing / kDegreesPerRadian);
  const double turn = std::clamp(0.6 * bearing, -0.5 * most, 0.5 * most);
  units_ = {whole_units(desk_.cube, ahead + turn), whole_units(desk_.cube, ahead - turn)};
}

bool CubeModel::on_mat() const {
  const MatPose sensor = desk_.sensor(pose_);
  return sensor.x >= desk_.mat.min_x && sensor.x <= desk_.mat.max_x &&
         sensor.y >= desk_.mat.min_y && sensor.y <= desk_.mat.max_y;
}

void CubeModel::step(double dt) {
  time_ += dt;
  if (targets_) {
    drive_to_targets();
  } else if (time_ >= units_until_) {
    units_ = {};
  }
  const bool blocked = time_ < blocked_until_;
  const auto turned = [&](double& speed, double gain, int units) {
    const double target = blocked ? 0.0 : gain * wheel_speed(desk_.cube, units);
    if (blocked) speed = 0.0;
    const double before = speed - target;
    speed = target + before * std::exp(-dt / kMotorTime);
    return target * dt + (before - (speed - target)) * kMotorTime;  // the speed's integral
  };
  const double left = turned(left_, flaws_.left_gain, units_.left);
  const double right = turned(right_, flaws_.right_gain, units_.right);
  const double driven = (left + right) / 2.0;
  const double turn = (right - left) / desk_.cube.track;
  pose_ = compose(pose_, {driven * std::cos(turn / 2), driven * std::sin(turn / 2), turn});
  report_position();
}

void CubeModel::report_position() {
  if (!on_mat()) {
    if (!missed_told_ && time_ - seen_at_ >= missed_after_) {
      notify(PositionMissed{});
      missed_told_ = true;
      last_report_.reset();
    }
    return;
  }
  seen_at_ = time_;
  missed_told_ = false;
  if (time_ + 1e-9 < next_report_) return;
  next_report_ = time_ + id_setting_.tens_of_ms / 100.0;
  const MatPose centre = reported();
  const MatPose sensor = rounded(desk_.sensor(pose_));
  const auto whole = [](double value) { return static_cast<std::uint16_t>(value); };
  const PositionId report{whole(centre.x), whole(centre.y), whole(centre.degrees),
                          whole(sensor.x), whole(sensor.y), whole(sensor.degrees)};
  const bool changed = !last_report_ || !(*last_report_ == report);
  if (changed) changed_at_ = time_;
  const bool quiet = (id_setting_.when == NotifyWhen::kOnChange && !changed) ||
                     (id_setting_.when == NotifyWhen::kWhileChanging && time_ > changed_at_ + 0.3);
  last_report_ = report;
  if (!quiet) notify(report);
}

std::vector<Notification> CubeModel::take_notifications() {
  std::vector<Notification> taken(std::make_move_iterator(notifications_.begin()),
                                  std::make_move_iterator(notifications_.end()));
  notifications_.clear();
  return taken;
}

void CubeModel::disconnect() {
  targets_.reset();
  appended_.reset();
  if (units_until_ == kNever) units_ = {};  // what has an end goes on until then
  id_setting_ = {};
  missed_after_ = 0.07;
  notifications_.clear();
}

double CubeModel::wheel_speed_now() const { return std::max(std::abs(left_), std::abs(right_)); }

Bytes CubeModel::value(Characteristic from) const {
  switch (from) {
    case Characteristic::kId:
      return encode(last_report_ ? CubeEvent(*last_report_) : CubeEvent(PositionMissed{})).bytes;
    case Characteristic::kButton:
      return encode(Button{false}).bytes;
    case Characteristic::kBattery:
      return encode(Battery{flaws_.battery}).bytes;
    case Characteristic::kSensor:
      return encode(Motion{}).bytes;
    default:
      return {};
  }
}

}  // namespace mvtp
