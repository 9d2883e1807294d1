#include "coordinator/faults/connected_vehicle.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kMemory = 4.0;    ///< [s] of the errors of actuation
constexpr double kMerging = 20.0;  ///< [m] over which it gets onto its path
constexpr double kCatchUp = 1.0;   ///< [m/s^2] to be on its plan again, and
constexpr double kSoon = 1.5;      ///< [s] within which, if it is near

}  // namespace

ConnectedVehicle::ConnectedVehicle(const Pose& pose, double speed, const Vehicle& body,
                                   const FaultModel& model, double dt, Draws draws)
    : body_(body),
      model_(model),
      dt_(dt),
      draws_(std::move(draws)),
      along_(std::exp(-dt / kMemory), FaultModel::kMostDeviations, draws_),
      across_(std::exp(-dt / kMemory), FaultModel::kMostDeviations, draws_),
      planned_(speed),
      pose_(pose),
      speed_(speed) {}

/// The place on the path nearest to where it is, about where it is to be at `step`.
double ConnectedVehicle::nearest_station(std::int64_t step) const {
  constexpr std::int64_t kAround = 40;  // steps
  const std::int64_t last = std::int64_t(plan_->poses.size()) - 1;
  const std::int64_t here = std::clamp<std::int64_t>(step - plan_->begin, 0, last);
  double best = 1e300;
  double station = stations_[std::size_t(here)];
  for (std::int64_t i = std::max<std::int64_t>(0, here - kAround);
       i <= std::min(last, here + kAround); ++i) {
    const Pose seen = relative(plan_->poses[std::size_t(i)].pose, pose_);
    const double off = std::hypot(seen.x, seen.y);
    if (off >= best) continue;
    best = off;
    station = stations_[std::size_t(i)] + seen.x;
  }
  return station;
}

void ConnectedVehicle::receive(std::shared_ptr<const PlanMessage> plan, std::int64_t step) {
  if (plan == plan_ || plan->poses.empty()) return;
  plan_ = std::move(plan);
  stations_.assign(1, 0.0);
  for (std::size_t i = 1; i < plan_->poses.size(); ++i) {
    stations_.push_back(stations_.back() +
                        distance(plan_->poses[i - 1].pose, plan_->poses[i].pose));
  }
  s_ = nearest_station(step) - model_.actuation * along_.value();
  note_offset();
}

/// Where it is beside its path, but for the error of actuation.
void ConnectedVehicle::note_offset() {
  merge_ = s_;
  aside_ = 0.0;
  slope_ = 0.0;
  const double across = FaultModel::kAcross * model_.actuation * across_.value();
  const Pose seen = relative(pose_at(s_), pose_);
  aside_ = seen.y - across;
  slope_ = std::clamp(std::tan(seen.theta), -0.5, 0.5);
}

/// On the plan's path, or straight on before and behind it.
Pose ConnectedVehicle::pose_at(double s) const {
  const auto& poses = plan_->poses;
  const auto behind = std::ranges::upper_bound(stations_, s);
  const std::size_t i = std::size_t(std::max<std::ptrdiff_t>(1, behind - stations_.begin())) - 1;
  Pose pose = compose(poses[i].pose, {s - stations_[i], 0.0, 0.0});
  if (i + 1 < poses.size() && s > stations_[0]) {
    const double share = (s - stations_[i]) / (stations_[i + 1] - stations_[i]);
    const Pose& to = poses[i + 1].pose;
    pose = {poses[i].pose.x + share * (to.x - poses[i].pose.x),
            poses[i].pose.y + share * (to.y - poses[i].pose.y),
            wrap_to_pi(poses[i].pose.theta + share * wrap_to_pi(to.theta - poses[i].pose.theta))};
  }
  // A cubic from the offset and slope at first to none.
  const double u = std::clamp((s - merge_) / kMerging, 0.0, 1.0);
  const double d = (1 - u) * (1 - u) * (aside_ * (1 + 2 * u) + slope_ * kMerging * u);
  const double turn = (1 - u) * (slope_ * (1 - 3 * u) - 6 * aside_ * u / kMerging);
  return compose(pose, {0.0, d, std::atan(turn)});
}

/// By the plan, and towards it.
double ConnectedVehicle::wanted_speed(std::int64_t step) const {
  const std::int64_t i =
      std::clamp<std::int64_t>(step - plan_->begin, 0, std::int64_t(plan_->poses.size()) - 1);
  const double behind = stations_[std::size_t(i)] - s_;  // where it is to be at the end of the step
  const std::int64_t before = std::max<std::int64_t>(0, i - 1);
  const double flow = (stations_[std::size_t(i)] - stations_[std::size_t(before)]) / dt_;
  const double off = behind - flow * dt_;
  if (std::abs(off) < 1e-9) return flow;
  const double correction =
      std::min(std::abs(off) / kSoon, std::sqrt(2.0 * kCatchUp * std::abs(off)));
  return std::max(0.0, flow + std::copysign(correction, off));
}

void ConnectedVehicle::drive(std::int64_t step) {
  double speed = planned_;
  if (will_ == Will::kObeys) speed = wanted_speed(step);
  if (will_ == Will::kBrakes) speed = 0.0;
  // A little beyond what plans use, so that rounding keeps nobody from following one.
  const double slack = 1.02;
  speed = std::clamp(speed, planned_ - slack * body_.max_decel * dt_,
                     planned_ + slack * body_.max_accel * dt_);
  planned_ = std::max(0.0, speed);
  s_ += planned_ * dt_;
  const Pose before = pose_;
  if (planned_ > 0.0) {
    along_.advance(draws_);
    across_.advance(draws_);
    const double across = FaultModel::kAcross * model_.actuation * across_.value();
    pose_ = compose(pose_at(s_ + model_.actuation * along_.value()), {0.0, across, 0.0});
  }
  speed_ = distance(before, pose_) / dt_;
  const std::int64_t i =
      std::clamp<std::int64_t>(step - plan_->begin, 0, std::int64_t(plan_->poses.size()) - 1);
  deviation_ = distance(pose_, plan_->poses[std::size_t(i)].pose);
}

bool ConnectedVehicle::is_through(std::int64_t step) const {
  if (will_ == Will::kHoldsSpeed) return s_ >= stations_.back();
  return plan_->complete && step >= plan_->last();
}

}  // namespace mvtp
