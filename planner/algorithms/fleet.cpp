#include "planner/algorithms/fleet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kRounding = 1e-6;  // [m], [rad]
/// Part of half the vehicle's width by which obstacles grow on the grid of the cost-to-go: cells
/// are a metre wide, and a grid that closes passable gaps misleads more than one that opens some.
constexpr double kInflation = 0.8;

/// Radius of the circle around the longest sweep of one step.
double longest_reach(const Instance& instance) {
  double reach = 1.0;
  for (const Agent& agent : instance.agents) {
    const Arc arc{agent.vehicle.max_speed * instance.dt, agent.vehicle.max_curvature()};
    reach = std::max(reach, Sweep(agent.vehicle, agent.start, arc).radius());
  }
  return reach;
}

}  // namespace

Fleet::Fleet(const Instance& instance, CollisionRule rule)
    : instance_(instance), obstacles_(instance.map, longest_reach(instance)) {
  cars_.reserve(instance.agents.size());
  costs_to_go_.reserve(instance.agents.size());
  for (const Agent& agent : instance.agents) {
    cars_.emplace_back(agent.vehicle, instance.dt, rule, instance.map, obstacles_);
    std::shared_ptr<const ObstacleGrid> grid;
    if (!obstacles_.empty()) {
      std::shared_ptr<const ObstacleGrid>& shared = grids_[agent.vehicle.width];
      if (!shared) {
        shared = std::make_shared<ObstacleGrid>(instance.map, kInflation * agent.vehicle.width / 2);
      }
      grid = shared;
    }
    costs_to_go_.emplace_back(agent.goal, agent.vehicle.min_turning_radius, table_,
                              std::move(grid));
  }
}

Configuration Fleet::starts() const {
  Configuration q;
  for (const Agent& agent : instance_.agents) q.push_back(agent.start);
  return q;
}

Pose Fleet::after(int i, const Pose& from, const Arc& arc) const {
  const Pose end = drive(from, arc);
  const bool at_goal = distance(end, goal(i)) < kRounding &&
                       std::abs(wrap_to_pi(end.theta - goal(i).theta)) < kRounding;
  return at_goal ? goal(i) : end;
}

double Fleet::lower_bound() const {
  double bound = 0.0;
  for (const Agent& agent : instance_.agents) {
    const double length = curves_.length(agent.start, agent.goal, agent.vehicle.min_turning_radius);
    bound = std::max(bound, length / agent.vehicle.max_speed);
  }
  return bound;
}

std::string Fleet::proof_of_infeasibility() const {
  for (const bool goals : {false, true}) {
    const char* what = goals ? "goal" : "start";
    const auto pose = [&](int i) {
      const Agent& agent = instance_.agents[std::size_t(i)];
      return goals ? agent.goal : agent.start;
    };
    const auto name = [&](int i) { return instance_.agents[std::size_t(i)].name; };
    for (int i = 0; i < size(); ++i) {
      if (!car(i).in_bounds(pose(i), {})) {
        return fmt::format("the {} of {} is outside the map", what, name(i));
      }
      const Sweep sweep = car(i).sweep(pose(i), {});
      if (const int obstacle = obstacles_.first_hit(sweep); obstacle >= 0) {
        return fmt::format("the {} of {} overlaps obstacle {}", what, name(i), obstacle);
      }
      for (int j = 0; j < i; ++j) {
        if (!collide(sweep, car(j).sweep(pose(j), {}))) continue;
        return fmt::format("the {}s of {} and {} overlap", what, name(j), name(i));
      }
    }
  }
  return {};
}

}  // namespace mvtp
