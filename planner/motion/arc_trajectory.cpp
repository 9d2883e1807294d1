#include "planner/motion/arc_trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "planner/geometry/frame.hpp"

namespace mvtp {
namespace {

constexpr int kStride = 16;  ///< every so many time steps the exact pose is kept

}  // namespace

std::vector<Arc> by_time_steps(const std::vector<Arc>& arcs, double step_length) {
  std::vector<Arc> steps;
  for (const Arc& arc : arcs) {
    const int pieces = std::max(1, int(std::ceil(std::abs(arc.length) / step_length - 1e-9)));
    steps.insert(steps.end(), std::size_t(pieces), Arc{arc.length / pieces, arc.curvature});
  }
  return steps;
}

ArcTrajectory::ArcTrajectory(const Vehicle& vehicle, const Pose& start, std::vector<Arc> steps,
                             int padding, bool leaves)
    : start_(start), steps_(std::move(steps)) {
  while (!steps_.empty() && steps_.back().length == 0.0) steps_.pop_back();
  boxes_.reserve(steps_.size() + 1 + std::size_t(padding));
  poses_.reserve(steps_.size() / kStride + 1);
  const double ahead = (vehicle.front - vehicle.rear) / 2;
  Frame frame(start);
  double theta = start.theta;
  Frame step;
  for (std::size_t t = 0; t <= steps_.size(); ++t) {
    if (t % kStride == 0) poses_.push_back({frame.x, frame.y, theta});
    boxes_.push_back(box_pose(frame, ahead));
    if (t == steps_.size()) break;
    if (t == 0 || steps_[t] != steps_[t - 1]) step = arc_end(steps_[t]);
    frame = frame.then(step);
    theta += steps_[t].length * steps_[t].curvature;
  }
  if (leaves) departure_ = std::max(1, (arrival() + padding - 1) / padding) * padding;
  end_ = int(boxes_.size()) - 1;
  boxes_.resize(boxes_.size() + std::size_t(padding), boxes_.back());
}

Pose ArcTrajectory::pose(int t) const {
  const std::size_t end = std::size_t(std::min(t, arrival()));
  Pose pose = poses_[end / kStride];
  for (std::size_t k = end / kStride * kStride; k < end; ++k) pose = drive(pose, steps_[k]);
  return pose;
}

}  // namespace mvtp
