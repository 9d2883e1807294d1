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

const std::shared_ptr<const ArcTrajectory::Course>& ArcTrajectory::no_course() {
  static const auto none = std::make_shared<const Course>();
  return none;
}

ArcTrajectory::ArcTrajectory(const Vehicle& vehicle, const Pose& start, std::vector<Arc> steps,
                             int padding, bool leaves)
    : start_(start) {
  const auto course = std::make_shared<Course>();
  while (!steps.empty() && steps.back().length == 0.0) steps.pop_back();
  course->boxes.reserve(steps.size() + 1 + std::size_t(padding));
  course->poses.reserve(steps.size() / kStride + 1);
  const double ahead = (vehicle.front - vehicle.rear) / 2;
  Frame frame(start);
  double theta = start.theta;
  Frame step;
  for (std::size_t t = 0; t <= steps.size(); ++t) {
    if (t % kStride == 0) course->poses.push_back({frame.x, frame.y, theta});
    course->boxes.push_back(box_pose(frame, ahead));
    if (t == steps.size()) break;
    if (t == 0 || steps[t] != steps[t - 1]) step = arc_end(steps[t]);
    frame = frame.then(step);
    theta += steps[t].length * steps[t].curvature;
  }
  end_ = int(course->boxes.size()) - 1;
  course->boxes.resize(course->boxes.size() + std::size_t(padding), course->boxes.back());
  course->steps = std::move(steps);
  boxes_ = course->boxes.data();
  course_ = course;
  if (leaves) departure_ = std::max(1, (arrival() + padding - 1) / padding) * padding;
}

Pose ArcTrajectory::pose(int t) const {
  const std::size_t end = std::size_t(std::min(t, arrival()));
  Pose pose = course_->poses[end / kStride];
  for (std::size_t k = end / kStride * kStride; k < end; ++k) pose = drive(pose, steps()[k]);
  return pose;
}

}  // namespace mvtp
