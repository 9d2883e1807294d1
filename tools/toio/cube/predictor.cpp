#include "tools/toio/cube/predictor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mvtp {
namespace {

constexpr double kStep = 0.01;   // of the integration [s]
constexpr double kMemory = 2.0;  // older commands have shown [s]

/// What the axle does if the wheels turn at these units, as a car.
Twist twist_of(const Cube& cube, Facing facing, const WheelUnits& units) {
  const double left = wheel_speed(cube, units.left);
  const double right = wheel_speed(cube, units.right);
  const double v = (left + right) / 2.0;
  return {facing == Facing::kNoseFirst ? v : -v, (right - left) / cube.track};
}

}  // namespace

Predictor::Predictor(const Cube& cube, Facing facing, double lag)
    : cube_(cube),
      facing_(facing),
      lag_(lag),
      phases_{{-std::numeric_limits<double>::infinity(), {}, {}}} {}

Twist Predictor::speed(const Phase& phase, double time) {
  const double rest = std::exp(-(time - phase.begin) / kMotorTime);
  return {phase.target.v + (phase.at_begin.v - phase.target.v) * rest,
          phase.target.omega + (phase.at_begin.omega - phase.target.omega) * rest};
}

void Predictor::sent(const WheelUnits& units, double now) {
  phases_.push_back({now, twist_of(cube_, facing_, units), speed(phases_.back(), now)});
  while (phases_.size() > 1 && phases_[1].begin < now - kMemory) phases_.pop_front();
}

void Predictor::measured(const Pose& pose, double now) {
  measured_ = pose;
  measured_at_ = now;
}

std::optional<Pose> Predictor::at(double now) const {
  if (!measured_) return std::nullopt;
  Pose pose = *measured_;
  const double begin = std::max(measured_at_ - lag_, now - kMemory);
  auto phase = std::ranges::upper_bound(phases_, begin, {}, &Phase::begin);
  --phase;  // the first phase began before all time
  for (double time = begin; time < now;) {
    while (phase + 1 != phases_.end() && (phase + 1)->begin <= time) ++phase;
    double end = std::min(now, time + kStep);
    if (phase + 1 != phases_.end()) end = std::min(end, (phase + 1)->begin);
    const Twist twist = speed(*phase, (time + end) / 2.0);
    const double driven = twist.v * (end - time);
    const double turn = twist.omega * (end - time);
    pose = compose(pose, {driven * std::cos(turn / 2), driven * std::sin(turn / 2), turn});
    time = end;
  }
  return pose;
}

}  // namespace mvtp
