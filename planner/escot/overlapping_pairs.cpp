#include "planner/escot/overlapping_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/escot/neighbours.hpp"

namespace mvtp {
namespace {

/// No point of the body is farther from the rear axle [m].
double reach(const Vehicle& vehicle) {
  return std::hypot(std::max(vehicle.front, vehicle.rear), vehicle.width / 2);
}

/// The body without a margin of this width.
Vehicle smaller(Vehicle body, double margin) {
  body.front -= margin;
  body.rear -= margin;
  body.width -= 2 * margin;
  return body;
}

}  // namespace

OverlappingPairs::OverlappingPairs(const Instance& instance) : instance_(instance) {
  find(&Agent::start, &Pair::at_start, "starts");
  find(&Agent::goal, &Pair::at_goal, "goals");
}

void OverlappingPairs::find(Pose Agent::*place, std::optional<Cores> Pair::*cores,
                            const char* name) {
  std::vector<Pose> poses;
  double longest = 0.0;
  for (const Agent& agent : instance_.agents) {
    poses.push_back(agent.*place);
    longest = std::max(longest, reach(agent.vehicle));
  }
  const Neighbours neighbours(poses);
  std::vector<int> near;
  for (int j = 0; j < int(poses.size()); ++j) {
    neighbours.within(reach(vehicle(j)) + longest, poses[std::size_t(j)], near);
    std::ranges::sort(near);
    for (const int i : near) {
      if (i >= j || !overlap(i, poses[std::size_t(i)], j, poses[std::size_t(j)])) continue;
      pairs_[{i, j}].*cores = this->cores(i, j, place);
      if (!first_.empty()) continue;
      first_ =
          fmt::format("the {} of {} and {} overlap", name, instance_.agents[std::size_t(i)].name,
                      instance_.agents[std::size_t(j)].name);
    }
  }
}

bool OverlappingPairs::overlap(int i, const Pose& pose_i, int j, const Pose& pose_j) const {
  return collide(Sweep(vehicle(i), pose_i, {}), Sweep(vehicle(j), pose_j, {}));
}

/// The largest bodies, both with the same margin, that do not overlap there.
OverlappingPairs::Cores OverlappingPairs::cores(int i, int j, Pose Agent::*place) const {
  constexpr int kHalvings = 30;
  const Pose& pose_i = instance_.agents[std::size_t(i)].*place;
  const Pose& pose_j = instance_.agents[std::size_t(j)].*place;
  const auto with = [&](double margin) {
    return Cores{smaller(vehicle(i), margin), smaller(vehicle(j), margin)};
  };
  double too_large = 0.0;
  double fits =
      std::min({vehicle(i).length(), vehicle(i).width, vehicle(j).length(), vehicle(j).width}) / 2;
  for (int k = 0; k < kHalvings; ++k) {
    const double margin = (too_large + fits) / 2;
    const Cores now = with(margin);
    const bool meet = collide(Sweep(now.lower, pose_i, {}), Sweep(now.higher, pose_j, {}));
    (meet ? too_large : fits) = margin;
  }
  return with(fits);
}

bool OverlappingPairs::allow(const Step& a, const Step& b) const {
  if (a.robot > b.robot) return allow(b, a);
  const auto pair = pairs_.find({a.robot, b.robot});
  if (pair == pairs_.end()) return false;
  const auto keep_off = [&](const std::optional<Cores>& cores, const Pose& at_a, const Pose& at_b) {
    return cores && overlap(a.robot, at_a, b.robot, at_b) &&
           !collide(Sweep(cores->lower, a.from, a.arc), Sweep(cores->higher, b.from, b.arc));
  };
  return keep_off(pair->second.at_start, a.from, b.from) ||
         keep_off(pair->second.at_goal, drive(a.from, a.arc), drive(b.from, b.arc));
}

bool OverlappingPairs::not_yet_apart(int a, const Pose& pose_a, int b, const Pose& pose_b) const {
  const auto pair = pairs_.find(std::minmax(a, b));
  return pair != pairs_.end() && pair->second.at_start && overlap(a, pose_a, b, pose_b);
}

}  // namespace mvtp
