#include "planner/escot/conflict_based_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <iterator>
#include <optional>
#include <utility>

#include "planner/search/conflict.hpp"
#include "planner/search/focal_queue.hpp"

namespace mvtp {
namespace {

/// A node of the constraint tree: what it changes of its parent's paths, and what comes of it.
struct Node {
  int parent = -1;
  int robot = -1;                        ///< whose path it changes
  std::optional<Constraint> constraint;  ///< that the robot keeps beside those of the parent
  SearchResult path;
  double cost = 0.0;
  double lower_bound = 0.0;
  std::optional<Conflict> first;  ///< the first conflict of all paths
  int conflicts = 0;
};

/// The solution of one node, as the literature calls it: what all robots do, with conflicts.
struct NodeSolution {
  std::vector<const SearchResult*> paths;
  std::vector<SweptTrajectory> motions;
  std::vector<Conflict> conflicts;
};

class ConflictTree {
 public:
  ConflictTree(std::span<const CbsRobot> robots, std::span<const SweptTrajectory* const> others,
               const SpacetimeHybridAstar& low_level, const CbsOptions& options,
               const Deadline& deadline)
      : robots_(robots),
        others_(others, options.lookahead, reaches(robots)),
        low_level_(low_level),
        options_(options),
        deadline_(deadline),
        open_(options.w) {
    if (options.cost == CbsCost::kArrival) return;
    for (const CbsRobot& robot : robots) {
      const double steps = (*robot.cost_to_go)(robot.start) / robot.car->step_length();
      least_cost_ = std::max(least_cost_, std::ceil(steps));
    }
  }

  CbsResult run() {
    if (!add_root()) return failed(CbsFailure::kNoPath);
    while (!open_.empty()) {
      const int n = open_.pop();
      const std::optional<Conflict> conflict = nodes_[std::size_t(n)].first;
      if (!conflict) return result_of(n);
      if (int(nodes_.size()) >= options_.max_nodes) return failed(CbsFailure::kTooManyNodes);
      if (deadline_.expired()) break;
      const NodeSolution plan = solution_of(n);
      branch(n, plan, conflict->i, conflict->j, conflict->t);
      branch(n, plan, conflict->j, conflict->i, conflict->t);
    }
    return failed(CbsFailure::kNoPath);
  }

 private:
  [[nodiscard]] static std::vector<Reach> reaches(std::span<const CbsRobot> robots) {
    std::vector<Reach> result;
    for (const CbsRobot& robot : robots) {
      const Vehicle& body = robot.car->vehicle();
      result.push_back({{robot.start.x, robot.start.y},
                        std::hypot(std::max(body.front, body.rear), body.width / 2),
                        robot.car->step_length()});
    }
    return result;
  }

  [[nodiscard]] CbsResult failed(CbsFailure why) const {
    return {deadline_.expired() ? CbsFailure::kTimeout : why, {}};
  }

  /// Everybody's first path, avoiding those planned before where that is cheap.
  bool add_root() {
    std::vector<SweptTrajectory> motions;
    motions.reserve(robots_.size());
    Node root;
    for (int i = 0; i < int(robots_.size()); ++i) {
      std::optional<SearchResult> path = plan(i, {}, motions);
      if (!path) return false;
      motions.push_back(motion(i, *path));
      root.cost += path->cost;
      root.lower_bound += path->lower_bound;
      root_.push_back(*std::move(path));
    }
    add(std::move(root), find_conflicts(motions));
    return true;
  }

  /// Adds the child of node n in which robot i keeps clear of what j does at step t.
  void branch(int n, const NodeSolution& plan, int i, int j, int t) {
    const Constraint constraint{std::max(t - 1, 0), t + 1, plan.motions[std::size_t(j)].at(t)};
    std::vector<Constraint> constraints = constraints_on(i, n);
    constraints.push_back(constraint);
    std::optional<SearchResult> path = this->plan(i, constraints, plan.motions);
    if (!path) return;

    Node child{.parent = n, .robot = i, .constraint = constraint, .path = *std::move(path)};
    const Node& parent = nodes_[std::size_t(n)];
    const SearchResult& before = *plan.paths[std::size_t(i)];
    child.cost = parent.cost + child.path.cost - before.cost;
    // A child is no cheaper than its parent.
    child.lower_bound = std::max(parent.lower_bound,
                                 parent.lower_bound + child.path.lower_bound - before.lower_bound);
    std::vector<Conflict> conflicts = find_conflicts_of(i, motion(i, child.path), plan.motions);
    std::ranges::copy_if(plan.conflicts, std::back_inserter(conflicts),
                         [i](const Conflict& c) { return c.i != i && c.j != i; });
    add(std::move(child), conflicts);
  }

  void add(Node node, const std::vector<Conflict>& conflicts) {
    const auto first = std::ranges::min_element(conflicts);
    if (first != conflicts.end()) node.first = *first;
    node.conflicts = int(conflicts.size());
    open_.push(int(nodes_.size()), node.lower_bound, node.cost,
               std::pair(node.conflicts, node.cost));
    nodes_.push_back(std::move(node));
  }

  /// The path of robot i under `constraints`, with few conflicts with the others' motions.
  [[nodiscard]] std::optional<SearchResult> plan(int i, std::span<const Constraint> constraints,
                                                 std::span<const SweptTrajectory> motions) const {
    std::vector<const SweptTrajectory*> members;
    for (int j = 0; j < int(motions.size()); ++j) {
      if (j != i) members.push_back(&motions[std::size_t(j)]);
    }
    const TimedObstacles group(members);
    const std::array<const TimedObstacles*, 2> to_avoid = {&group, &others_};
    const CbsRobot& robot = robots_[std::size_t(i)];
    return low_level_.search({.car = robot.car,
                              .cost_to_go = robot.cost_to_go,
                              .start = robot.start,
                              .constraints = constraints,
                              .to_avoid = to_avoid,
                              .least_cost = least_cost_},
                             {options_.w, options_.max_expansions}, deadline_);
  }

  [[nodiscard]] SweptTrajectory motion(int i, const SearchResult& path) const {
    const CbsRobot& robot = robots_[std::size_t(i)];
    return {*robot.car, robot.start, path.steps};
  }

  [[nodiscard]] std::vector<Constraint> constraints_on(int i, int n) const {
    std::vector<Constraint> constraints;
    for (; n > 0; n = nodes_[std::size_t(n)].parent) {  // the root has none
      if (nodes_[std::size_t(n)].robot == i) {
        constraints.push_back(*nodes_[std::size_t(n)].constraint);
      }
    }
    return constraints;
  }

  [[nodiscard]] std::vector<const SearchResult*> paths_of(int n) const {
    std::vector<const SearchResult*> paths(robots_.size(), nullptr);
    for (; n > 0; n = nodes_[std::size_t(n)].parent) {
      const Node& node = nodes_[std::size_t(n)];
      const SearchResult*& path = paths[std::size_t(node.robot)];
      if (path == nullptr) path = &node.path;  // the latest change counts
    }
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (paths[i] == nullptr) paths[i] = &root_[i];
    }
    return paths;
  }

  [[nodiscard]] NodeSolution solution_of(int n) const {
    NodeSolution plan{.paths = paths_of(n), .motions = {}, .conflicts = {}};
    for (int i = 0; i < int(robots_.size()); ++i) {
      plan.motions.push_back(motion(i, *plan.paths[std::size_t(i)]));
    }
    plan.conflicts = find_conflicts(plan.motions);
    return plan;
  }

  [[nodiscard]] CbsResult result_of(int n) const {
    CbsResult result;
    for (const SearchResult* path : paths_of(n)) result.steps.push_back(path->steps);
    return result;
  }

  std::span<const CbsRobot> robots_;
  TimedObstacles others_;
  const SpacetimeHybridAstar& low_level_;
  const CbsOptions& options_;
  const Deadline& deadline_;
  double least_cost_ = 0.0;         ///< of every robot [steps]
  std::vector<SearchResult> root_;  ///< everybody's path in node 0
  std::deque<Node> nodes_;          ///< paths in it are pointed at while it grows
  FocalQueue<std::pair<int, double>> open_;
};

}  // namespace

CbsResult conflict_based_search(std::span<const CbsRobot> robots,
                                std::span<const SweptTrajectory* const> others,
                                const SpacetimeHybridAstar& low_level, const CbsOptions& options,
                                const Deadline& deadline) {
  return ConflictTree(robots, others, low_level, options, deadline).run();
}

}  // namespace mvtp
