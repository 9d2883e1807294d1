#include "planner/search/joint_motion.hpp"

#include <algorithm>
#include <utility>

namespace mvtp {

JointMotion::JointMotion(std::vector<MacroRobot> robots, TimeGrid time)
    : robots_(std::move(robots)),
      time_(time),
      occupancy_(size(), time),
      trajectories_(robots_.size()),
      present_(robots_.size(), 0),
      weights_(robots_.size()),
      position_(robots_.size()),
      soft_costs_(robots_.size()),
      found_(robots_.size() + Occupancy::kPadding) {
  for (const MacroRobot& robot : robots_) shapes_.push_back(robot.car->shape());
}

template <class Visitor>
void JointMotion::for_each_contact(int i, const ArcTrajectory& trajectory, int wait, int from,
                                   Visitor&& visitor) {
  const MotionPrimitives& own = *robot(i).car;
  const int arrival = wait + (trajectory.arrival() + time_.macro_step - 1) / time_.macro_step;
  int last = std::max(occupancy_.horizon(), arrival);
  if (trajectory.departure() != ArcTrajectory::kNever) {
    last = std::min(last, wait + trajectory.departure() / time_.macro_step - 1);
  }
  if (wait > 0) waiting_.assign(std::size_t(time_.macro_step) + 1, *trajectory.boxes(0));
  for (int k = from; k <= last && k < horizon_; ++k) {
    const int t = k * time_.macro_step;
    const int driven = t - wait * time_.macro_step;
    const BoxPose* boxes = driven < 0 ? waiting_.data() : trajectory.boxes(driven);
    const bool rests = driven < 0 || trajectory.arrival() <= driven;
    const BoxPose& middle = rests ? *boxes : *trajectory.boxes(driven + time_.macro_step / 2);
    BoxShape shape = own.shape();
    if (rests) shape.travel = 0.0F;
    const float radius = rests ? shape.half_diagonal() : own.reach();
    const int n = occupancy_.near(k, middle.x, middle.y, radius, found_.data());
    if (n == 0) continue;
    const SweptBox swept = swept_box(boxes, shape, time_.macro_step);
    for (int f = 0; f < n; ++f) {
      const int j = found_[std::size_t(f)];
      const Occupancy::MacroStepSweep& sweep = occupancy_.sweep(k, j);
      if (apart(swept, sweep.swept)) continue;
      BoxShape other = shapes_[std::size_t(j)];
      other.travel = sweep.travel;
      if (!meet(boxes, shape, trajectories_[std::size_t(j)].boxes(t), other, time_.macro_step))
        continue;
      if (!visitor(j, k)) return;
    }
  }
}

void JointMotion::place(int i, ArcTrajectory trajectory) {
  for_each_contact(i, trajectory, 0, 0, [&](int j, int) {
    if (!in_conflict(i, j)) add_conflict(i, j);
    return true;
  });
  occupancy_.place(i, trajectory, shapes_[std::size_t(i)]);
  trajectories_[std::size_t(i)] = std::move(trajectory);
  present_[std::size_t(i)] = 1;
}

int JointMotion::overlaps(int i, const ArcTrajectory& trajectory, int most, int wait) {
  counted_.assign(robots_.size(), 0);
  int count = 0;
  for_each_contact(i, trajectory, wait, 0, [&](int j, int) {
    if (std::exchange(counted_[std::size_t(j)], char{1}) == 0) ++count;
    return count < most;
  });
  return count;
}

ArcTrajectory JointMotion::trajectory_after(int i, int wait, std::span<const Arc> steps_driven,
                                            bool leaves) const {
  std::vector<Arc> steps(std::size_t(wait * time_.macro_step), Arc{});
  steps.insert(steps.end(), steps_driven.begin(), steps_driven.end());
  return {robot(i).car->vehicle(), robot(i).start, std::move(steps), time_.macro_step, leaves};
}

bool JointMotion::place_later(int i, std::span<const Arc> steps_driven, int latest, bool leaves) {
  const ArcTrajectory trajectory = trajectory_after(i, 0, steps_driven, leaves);
  for (int wait = 0; wait * time_.macro_step <= latest; ++wait) {
    if (overlaps(i, trajectory, 1, wait) > 0) continue;
    place(i, trajectory_after(i, wait, steps_driven, leaves));
    return true;
  }
  return false;
}

ArcTrajectory JointMotion::remove(int i) {
  for (const int j : conflicts_of(i)) drop_conflict(i, j);
  occupancy_.remove(i);
  present_[std::size_t(i)] = 0;
  return std::exchange(trajectories_[std::size_t(i)], {});
}

void JointMotion::clear() {
  for (int i = 0; i < size(); ++i) {
    if (present(i)) remove(i);
  }
  horizon_ = lookahead_ = kNoHorizon;
}

void JointMotion::set_horizon(int conflicts, int lookahead) {
  const int before = std::min(horizon_, conflicts);
  horizon_ = conflicts;
  lookahead_ = lookahead;
  for (int i = 0; i < size(); ++i) {
    if (!present(i)) continue;
    for_each_contact(i, trajectory(i), 0, before, [&](int j, int) {
      if (j != i && !in_conflict(i, j)) add_conflict(i, j);
      return true;
    });
  }
}

bool JointMotion::place_all(const std::vector<ArcTrajectory>& trajectories,
                            const Deadline& deadline) {
  clear();
  for (int i = 0; i < size(); ++i) {
    if (deadline.expired()) return false;
    place(i, trajectories[std::size_t(i)]);
  }
  return true;
}

void JointMotion::restore(const State& state) {
  clear();
  set_horizon(state.horizon, state.lookahead);
  for (int i = 0; i < size(); ++i) place(i, state.trajectories[std::size_t(i)]);
}

void JointMotion::add_conflict(int i, int j) {
  conflicts_.emplace_back(std::min(i, j), std::max(i, j));
  position_.set(i, j, int(conflicts_.size()));
  cost_ += weight(i, j);
}

void JointMotion::drop_conflict(int i, int j) {
  const int hole = position_.at(i, j);
  const Pair last = conflicts_.back();
  conflicts_[std::size_t(hole) - 1] = last;
  position_.set(last.first, last.second, hole);
  conflicts_.pop_back();
  position_.set(i, j, 0);
  cost_ -= weight(i, j);
}

std::vector<int> JointMotion::conflicts_of(int i) const {
  std::vector<int> result;
  for (int j = 0; j < size(); ++j) {
    if (in_conflict(i, j)) result.push_back(j);
  }
  return result;
}

int JointMotion::first_conflict(int i) {
  int first = -1;
  for_each_contact(i, trajectory(i), 0, 0, [&](int j, int k) {
    if (j == i) return true;
    first = k;
    return false;
  });
  return first;
}

void JointMotion::set_weight(int i, int j, float weight) {
  if (in_conflict(i, j)) cost_ += double(weight) - this->weight(i, j);
  weights_.set(i, j, weight);
}

OtherRobots JointMotion::others(int i, double soft_cost) {
  for (int j = 0; j < size(); ++j) {
    soft_costs_[std::size_t(j)] = float(soft_cost) * weight_of(i, j);
  }
  return {&occupancy_, trajectories_, shapes_, soft_costs_, lookahead_};
}

int JointMotion::makespan() const {
  int last = 0;
  for (int i = 0; i < size(); ++i) {
    if (present(i)) last = std::max(last, trajectory(i).arrival());
  }
  return last;
}

std::int64_t JointMotion::flowtime() const {
  std::int64_t sum = 0;
  for (int i = 0; i < size(); ++i) {
    if (present(i)) sum += trajectory(i).arrival();
  }
  return sum;
}

}  // namespace mvtp
