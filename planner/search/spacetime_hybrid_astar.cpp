#include "planner/search/spacetime_hybrid_astar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>

#include "planner/search/cell_set.hpp"
#include "planner/search/focal_queue.hpp"

namespace mvtp {
namespace {

// Cells of the closed list, as parts of a full step and of the turn it makes.
constexpr double kCellPerStep = 0.7;
constexpr double kMaxCell = 1.5;  // [m]
constexpr double kHeadingPerTurn = 0.75;
// Reeds-Shepp shots: from the root, from every sixth node, and from every node close to the goal.
constexpr int kShotEvery = 6;
constexpr double kShotRange = 9.0;  // [m]
// Reversing costs a little more, so that of equally quick ways the plain one is taken.
// Of FOCAL the node that looks quickest to finish is expanded, a conflict being worth so many
// steps. Strictly fewest conflicts first would search all of a dead end before it accepts one.
constexpr double kConflictCost = 10.0;
constexpr double kReversePenalty = 1.02;

struct Node {
  Pose pose;
  double g = 0.0;
  double h = 0.0;
  double f = 0.0;  ///< max(g + h, least cost, f of the parent)
  int t = 0;
  int conflicts = 0;
  int parent = -1;
  Arc arc;                ///< from the parent
  std::vector<Arc> shot;  ///< not empty, or at_goal: the way ends here
  bool at_goal = false;
};

/// The node that looks quickest to finish; among those early enough, the one that has come
/// farthest.
using FocalKey = std::pair<double, double>;

class Search {
 public:
  Search(const SearchProblem& problem, const SearchOptions& options, const ReedsShepp& curves)
      : car_(*problem.car),
        to_go_(*problem.cost_to_go),
        problem_(problem),
        options_(options),
        curves_(curves),
        open_(options.w) {
    for (const Constraint& c : problem.constraints) end_ = std::max(end_, c.last + 1);
    for (const MovingObstacle* other : problem.to_avoid) end_ = std::max(end_, other->makespan());
    timed_ = !problem.constraints.empty() || !problem.to_avoid.empty();
    arcs_ = car_.arcs();
    for (Arc& arc : arcs_) arc.length *= options.arc_scale;
    cell_ = std::min(kMaxCell, kCellPerStep * std::abs(arcs_[0].length));
    const double turn = std::abs(arcs_[0].length) * car_.vehicle().max_curvature();
    headings_ = std::clamp(std::round(2 * std::numbers::pi / (kHeadingPerTurn * turn)), 8.0, 90.0);
  }

  std::optional<TimedPath> run() {
    Node root;
    root.pose = problem_.start;
    root.h = to_go_(root.pose);
    root.f = std::max(root.h, problem_.least_cost);
    add(std::move(root));
    for (int expansions = 0; !open_.empty() && expansions < options_.max_expansions;) {
      const int n = open_.pop();
      if (nodes_[std::size_t(n)].at_goal) return path_to(n);
      if (!closed_.insert(key(nodes_[std::size_t(n)]))) continue;
      if (expansions % kShotEvery == 0 || nodes_[std::size_t(n)].h < kShotRange) shoot(n);
      expand(n);
      ++expansions;
    }
    // Out of expansions: the best way that was found, though one with fewer conflicts may exist.
    if (best_goal_ >= 0) return path_to(best_goal_);
    return std::nullopt;
  }

 private:
  void add(Node node) {
    const double finish = std::max(node.g + options_.w * node.h, problem_.least_cost);
    const double conflicts = kConflictCost * car_.step_length() * double(node.conflicts);
    open_.push(int(nodes_.size()), node.f, node.f, FocalKey(finish + conflicts, -node.g));
    nodes_.push_back(std::move(node));
  }

  /// After end_ nothing moves any more, and time no longer matters.
  [[nodiscard]] std::uint64_t key(const Node& node) const {
    const double heading = std::floor(node.pose.theta / (2 * std::numbers::pi) * headings_ + 0.5);
    const auto h = std::uint64_t(heading + headings_) % std::uint64_t(headings_);
    const auto x = std::uint64_t(std::int64_t(std::floor(node.pose.x / cell_)) + (1 << 19));
    const auto y = std::uint64_t(std::int64_t(std::floor(node.pose.y / cell_)) + (1 << 19));
    const auto t = std::uint64_t(timed_ ? std::min(node.t, end_) : 0);
    return (x & 0xfffffU) | (y & 0xfffffU) << 20U | h << 40U | (t & 0xffffU) << 47U;
  }

  [[nodiscard]] bool constrained(const Sweep& sweep, int t) const {
    return std::ranges::any_of(problem_.constraints, [&](const Constraint& c) {
      return c.first <= t && t <= c.last && collide(sweep, c.sweep);
    });
  }

  [[nodiscard]] int conflicts(const Sweep& sweep, int t) const {
    return int(std::ranges::count_if(problem_.to_avoid, [&](const MovingObstacle* other) {
      return collide(sweep, other->at(t));
    }));
  }

  void expand(int n) {
    for (const Arc& arc : arcs_) extend(n, arc);
    if (timed_ && nodes_[std::size_t(n)].t < end_) extend(n, {});
  }

  void extend(int n, const Arc& arc) {
    const Node& from = nodes_[std::size_t(n)];
    const Sweep sweep = car_.sweep(from.pose, arc);
    if (!car_.is_free(from.pose, arc, sweep) || constrained(sweep, from.t)) return;
    Node node;
    node.pose = drive(from.pose, arc);
    node.g = from.g + car_.step_length() * (arc.length < 0.0 ? kReversePenalty : 1.0);
    node.h = to_go_(node.pose);
    node.f = std::max(from.f, node.g + node.h);  // pathmax
    node.t = from.t + 1;
    node.conflicts = from.conflicts + conflicts(sweep, from.t);
    node.parent = n;
    node.arc = arc;
    add(std::move(node));
  }

  /// Adds the end of the Reeds-Shepp path from n to the goal, if it is free.
  void shoot(int n) {
    const Node& from = nodes_[std::size_t(n)];
    Node node;
    node.shot =
        car_.steps(curves_.path(from.pose, to_go_.goal(), car_.vehicle().min_turning_radius));
    node.pose = from.pose;
    node.g = from.g;
    node.t = from.t;
    node.conflicts = from.conflicts;
    for (const Arc& arc : node.shot) {
      const Sweep sweep = car_.sweep(node.pose, arc);
      if (!car_.is_free(node.pose, arc, sweep) || constrained(sweep, node.t)) return;
      node.conflicts += conflicts(sweep, node.t);
      node.g += car_.step_length();
      node.pose = drive(node.pose, arc);
      ++node.t;
    }
    // It stays at the goal: whoever comes by later counts.
    const Sweep parked = car_.sweep(to_go_.goal(), {});
    for (int t = node.t; t <= end_; ++t) {
      if (constrained(parked, t)) return;
      node.conflicts += conflicts(parked, t);
    }
    node.f = std::max(from.f, node.g);
    node.parent = n;
    node.at_goal = true;
    const int number = int(nodes_.size());
    const auto rank = [this](int k) {
      const Node& goal = nodes_[std::size_t(k)];
      return std::tuple(goal.f > options_.w * open_.lower_bound(), goal.conflicts, goal.f, k);
    };
    add(std::move(node));
    if (best_goal_ < 0 || rank(number) < rank(best_goal_)) best_goal_ = number;
  }

  [[nodiscard]] TimedPath path_to(int n) const {
    const Node& goal = nodes_[std::size_t(n)];
    TimedPath path;
    for (int k = goal.parent; nodes_[std::size_t(k)].parent >= 0;
         k = nodes_[std::size_t(k)].parent) {
      path.steps.push_back(nodes_[std::size_t(k)].arc);
    }
    std::ranges::reverse(path.steps);
    path.steps.insert(path.steps.end(), goal.shot.begin(), goal.shot.end());
    path.cost = goal.f;
    path.lower_bound = std::min(goal.f, open_.lower_bound());
    path.conflicts = goal.conflicts;
    return path;
  }

  const SteppedCar& car_;
  const CostToGo& to_go_;
  const SearchProblem& problem_;
  const SearchOptions& options_;
  const ReedsShepp& curves_;
  int end_ = 0;  ///< from this step on everything rests
  bool timed_;
  std::array<Arc, 6> arcs_;
  double cell_;
  double headings_;
  std::vector<Node> nodes_;
  int best_goal_ = -1;  ///< within the bound if any is; then the fewest conflicts
  FocalQueue<FocalKey> open_;
  CellSet closed_;
};

}  // namespace

std::optional<TimedPath> SpacetimeHybridAstar::search(const SearchProblem& problem,
                                                      const SearchOptions& options) const {
  return Search(problem, options, curves_).run();
}

}  // namespace mvtp
