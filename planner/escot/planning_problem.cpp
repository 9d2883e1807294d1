#include "planner/escot/planning_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "planner/motion/passages.hpp"
#include "planner/search/reeds_shepp_planner.hpp"

namespace mvtp {
namespace {

constexpr double kRounding = 1e-6;  // [m], [rad]
/// Part of half the vehicle's width by which obstacles grow on the grid of the cost-to-go: cells
/// are a metre wide, and a grid that closes passable gaps misleads more than one that opens some.
constexpr double kInflation = 0.8;
constexpr double kProofMargin = 0.005;  // [m]; a proof must hold for touches and rounding

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

PlanningProblem::PlanningProblem(const Instance& instance, CollisionRule rule,
                                 const Deadline& deadline)
    : instance_(instance),
      rule_(rule),
      overlapping_pairs_(instance),
      obstacles_(instance.map, longest_reach(instance)) {
  cars_.reserve(instance.agents.size());
  costs_to_go_.reserve(instance.agents.size());
  for (const Agent& agent : instance.agents) {
    exemptions_.push_back(exemptions_of(agent));
    cars_.emplace_back(agent.vehicle, instance.dt, rule, instance.map, obstacles_,
                       exemptions_.back().get());
    std::shared_ptr<const ObstacleGrid> grid;
    if (!obstacles_.empty() && !deadline.expired()) {
      std::shared_ptr<const ObstacleGrid>& shared = grids_[agent.vehicle.width];
      if (!shared) {
        shared = std::make_shared<ObstacleGrid>(instance.map, kInflation * agent.vehicle.width / 2);
      }
      grid = shared;
    }
    costs_to_go_.emplace_back(agent.goal, agent.vehicle.min_turning_radius,
                              ReedsSheppTable::shared(), std::move(grid));
  }
}

std::unique_ptr<const Exemptions> PlanningProblem::exemptions_of(const Agent& agent) const {
  if (instance_.initial_overlap == InitialOverlap::kRefuse) return nullptr;
  auto exemptions = std::make_unique<Exemptions>(agent.vehicle, instance_.map, obstacles_,
                                                 agent.start, agent.goal);
  return exemptions->empty() ? nullptr : std::move(exemptions);
}

Configuration PlanningProblem::starts() const {
  Configuration q;
  for (const Agent& agent : instance_.agents) q.push_back(agent.start);
  return q;
}

Pose PlanningProblem::at_goal_or(int i, const Pose& pose) const {
  const bool at_goal = std::abs(pose.x - goal(i).x) < kRounding &&
                       std::abs(pose.y - goal(i).y) < kRounding &&
                       std::abs(wrap_to_pi(pose.theta - goal(i).theta)) < kRounding;
  return at_goal ? goal(i) : pose;
}

double PlanningProblem::lower_bound() const {
  double bound = 0.0;
  for (const Agent& agent : instance_.agents) {
    const double length =
        shortest_length(agent.start, agent.goal, agent.vehicle.min_turning_radius);
    bound = std::max(bound, length / agent.vehicle.max_speed);
  }
  return bound;
}

std::string PlanningProblem::proof_of_infeasibility(const Deadline& deadline) const {
  const std::string proof = proof_by_places();
  return proof.empty() ? proof_by_passages(deadline) : proof;
}

std::string PlanningProblem::proof_by_passages(const Deadline& deadline) const {
  if (obstacles_.empty()) return {};
  std::map<std::pair<double, double>, Passages> all;  // by radius and freedom to be outside
  for (int i = 0; i < size() && !deadline.expired(); ++i) {
    // The largest disc in the body, around its middle, moves with it, and a little smaller for
    // touches that are allowed. Checked at steps only, it gets through what is not deeper than
    // half its longest jump: no point between two places is farther from both.
    if (exemptions(i) != nullptr) continue;  // the proof takes both places to be free
    const Vehicle& vehicle = car(i).vehicle();
    const double ahead = (vehicle.front - vehicle.rear) / 2;
    double radius = std::min(vehicle.width, vehicle.length()) / 2 - kProofMargin;
    const double outside =
        instance_.map.bounds == Bounds::kFootprint ? -radius : std::abs(ahead) + kProofMargin;
    if (rule_ == CollisionRule::kSteps) {
      radius -= car(i).step_length() * std::hypot(1.0, ahead * vehicle.max_curvature()) / 2;
    }
    if (radius <= 0.0) continue;
    const Passages& passages =
        all.try_emplace({radius, outside}, instance_.map, radius, outside, deadline).first->second;
    const Agent& agent = instance_.agents[std::size_t(i)];
    if (passages.separated(Frame(agent.start).world(ahead, 0.0),
                           Frame(agent.goal).world(ahead, 0.0))) {
      return fmt::format("no path for {} to its goal, even alone: every gap is narrower than it",
                         agent.name);
    }
  }
  return {};
}

std::string PlanningProblem::proof_by_places() const {
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
      const int obstacle = exemptions(i) == nullptr ? obstacles_.first_hit(sweep) : -1;
      if (obstacle >= 0) {
        return fmt::format("the {} of {} overlaps obstacle {}", what, name(i), obstacle);
      }
    }
  }
  return instance_.initial_overlap == InitialOverlap::kRefuse ? overlapping_pairs_.first()
                                                              : std::string();
}

}  // namespace mvtp
