#include "planner/algorithms/eccr.hpp"

#include <algorithm>
#include <memory>
#include <tuple>

#include "planner/search/conflict.hpp"
#include "planner/search/focal_queue.hpp"

namespace mvtp {
namespace {

/// One robot's path with its sweeps; shared by all nodes that did not change it.
struct Path {
  TimedPath path;
  MovingObstacle motion;
};

struct Node {
  std::vector<std::shared_ptr<const Path>> paths;
  std::vector<std::vector<Constraint>> constraints;  ///< per robot
  Conflicts conflicts;
  double cost = 0.0;
  double lower_bound = 0.0;
};

class Eccr {
 public:
  Eccr(std::span<const EccrRobot> robots, std::span<const MovingObstacle* const> others,
       const SpacetimeHybridAstar& low_level, const EccrOptions& options, const Deadline& deadline)
      : robots_(robots),
        others_(others),
        low_level_(low_level),
        options_(options),
        deadline_(deadline),
        open_(options.w) {
    for (const EccrRobot& robot : robots) {
      least_cost_ = std::max(least_cost_, (*robot.cost_to_go)(robot.start));
    }
  }

  EccrResult run() {
    if (!add_root()) return {EccrFailure::kNoPath, {}};
    while (!open_.empty()) {
      const std::shared_ptr<const Node> node = nodes_[std::size_t(open_.pop())];
      if (!node->conflicts.first) return solution(*node);
      if (int(nodes_.size()) >= options_.max_nodes) return {EccrFailure::kTooManyNodes, {}};
      if (deadline_.expired()) return {EccrFailure::kTimeout, {}};
      const Conflict& c = *node->conflicts.first;
      branch(*node, c.i, c.j, c.t);
      branch(*node, c.j, c.i, c.t);
    }
    return {EccrFailure::kNoPath, {}};
  }

 private:
  /// Everybody's first path, avoiding those planned before where that is cheap.
  bool add_root() {
    Node root;
    root.constraints.resize(robots_.size());
    for (int i = 0; i < int(robots_.size()); ++i) {
      std::shared_ptr<const Path> path = plan(root, i);
      if (!path) return false;
      root.paths.push_back(std::move(path));
    }
    add(std::move(root));
    return true;
  }

  /// Adds the child of `node` in which robot i keeps clear of what j does at step t.
  void branch(const Node& node, int i, int j, int t) {
    Node child = node;
    child.constraints[std::size_t(i)].push_back(
        {std::max(t - 1, 0), t + 1, node.paths[std::size_t(j)]->motion.at(t)});
    std::shared_ptr<const Path> path = plan(child, i);
    if (!path) return;
    child.paths[std::size_t(i)] = std::move(path);
    add(std::move(child));
  }

  void add(Node node) {
    std::vector<const MovingObstacle*> motions;
    node.cost = 0.0;
    double bound = 0.0;
    for (const auto& path : node.paths) {
      motions.push_back(&path->motion);
      node.cost += path->path.cost;
      bound += path->path.lower_bound;
    }
    node.lower_bound = std::max(node.lower_bound, bound);  // a child is no cheaper than its parent
    node.conflicts = find_conflicts(motions);
    const int n = int(nodes_.size());
    open_.push(n, node.lower_bound, node.cost, std::tuple(node.conflicts.count, node.cost));
    nodes_.push_back(std::make_shared<const Node>(std::move(node)));
  }

  /// The path of robot i under its constraints, with few conflicts with the other paths of `node`.
  std::shared_ptr<const Path> plan(const Node& node, int i) const {
    std::vector<const MovingObstacle*> to_avoid(others_.begin(), others_.end());
    for (std::size_t j = 0; j < node.paths.size(); ++j) {
      if (int(j) != i) to_avoid.push_back(&node.paths[j]->motion);
    }
    const EccrRobot& robot = robots_[std::size_t(i)];
    const SearchProblem problem{robot.car,   robot.cost_to_go,
                                robot.start, node.constraints[std::size_t(i)],
                                to_avoid,    least_cost_};
    std::optional<TimedPath> path =
        low_level_.search(problem, {options_.w, options_.max_expansions});
    if (!path) return nullptr;
    MovingObstacle motion(*robot.car, robot.start, path->steps);
    return std::make_shared<const Path>(Path{*std::move(path), std::move(motion)});
  }

  static EccrResult solution(const Node& node) {
    EccrResult result;
    for (const auto& path : node.paths) result.steps.push_back(path->path.steps);
    return result;
  }

  std::span<const EccrRobot> robots_;
  std::span<const MovingObstacle* const> others_;
  const SpacetimeHybridAstar& low_level_;
  const EccrOptions& options_;
  const Deadline& deadline_;
  double least_cost_ = 0.0;  ///< of every robot: no plan ends before the slowest arrives
  std::vector<std::shared_ptr<const Node>> nodes_;
  FocalQueue<std::tuple<int, double>> open_;
};

}  // namespace

EccrResult solve_eccr(std::span<const EccrRobot> robots,
                      std::span<const MovingObstacle* const> others,
                      const SpacetimeHybridAstar& low_level, const EccrOptions& options,
                      const Deadline& deadline) {
  return Eccr(robots, others, low_level, options, deadline).run();
}

}  // namespace mvtp
