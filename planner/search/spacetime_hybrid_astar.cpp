#include "planner/search/spacetime_hybrid_astar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <tuple>
#include <unordered_set>

#include "planner/search/focal_queue.hpp"

namespace mvtp {
namespace {

// Cells of the closed list, as parts of a full step and of the turn it makes.
constexpr double kCellPerStep = 0.7;
constexpr double kMaxCell = 1.5;  // [m]
constexpr double kHeadingPerTurn = 0.75;
// Reeds-Shepp analytic expansions: from the root, from every sixth node, and from every node close
// to the goal.
constexpr int kExpansionEvery = 6;
constexpr double kExpansionRange = 9.0;  // [m]
// Of FOCAL the node that looks quickest to finish is expanded, a conflict being worth so many
// steps. Strictly fewest conflicts first would search all of a dead end before it accepts one.
constexpr double kConflictCost = 10.0;
// Reversing costs a little more there, so that of equally quick paths the plain one is taken.
constexpr double kReversePenalty = 0.02;
/// The cost-to-go is known to about this part of a step: no more is rounded up to a whole one.
constexpr double kRounding = 0.1;
constexpr int kMaxPieces = 5;    // of a Reeds-Shepp path; each ends with a shorter step
constexpr int kClockEvery = 32;  // expansions

struct Node {
  Pose pose;
  double h = 0.0;  ///< [m]
  double f = 0.0;  ///< steps until arrival, or least cost, or f of the parent if that is more
  int t = 0;
  int reversed = 0;  ///< steps in reverse
  int conflicts = 0;
  int parent = -1;
  Arc arc;                              ///< from the parent
  std::vector<Arc> analytic_expansion;  ///< not empty, or at_goal: the path ends here
  bool at_goal = false;
};

/// The node that looks quickest to finish; among those early enough, the one that has come
/// farthest.
using FocalKey = std::pair<double, int>;

/// Where a path to the goal was found: what costs no less and comes later in FOCAL is pointless.
struct Reached {
  double f = 0.0;
  FocalKey key;
};

class Search {
 public:
  Search(const SearchProblem& problem, const SearchOptions& options, const ReedsShepp& curves,
         const Deadline& deadline)
      : car_(*problem.car),
        to_go_(*problem.cost_to_go),
        problem_(problem),
        options_(options),
        curves_(curves),
        deadline_(deadline),
        scaled_(options.arc_scale == 1.0 ? std::vector<Primitive>{}
                                         : car_.primitives(options.arc_scale)),
        primitives_(options.arc_scale == 1.0 ? car_.primitives() : scaled_),
        parked_(car_.sweep(to_go_.goal(), {})),
        open_(options.w) {
    for (const Constraint& c : problem.constraints) end_ = std::max(end_, c.last + 1);
    timed_ = !problem.constraints.empty();
    const auto consider = [this](const TimedObstacles* traffic) {
      if (traffic == nullptr || traffic->empty()) return;
      end_ = std::max(end_, traffic->end());
      timed_ = true;
    };
    consider(problem.to_keep_clear_of);
    for (const TimedObstacles* traffic : problem.to_avoid) consider(traffic);
    const double step = options.arc_scale * car_.step_length();
    cell_ = std::min(kMaxCell, kCellPerStep * step);
    const double turn = step * car_.vehicle().max_curvature();
    headings_ = std::clamp(std::round(2 * std::numbers::pi / (kHeadingPerTurn * turn)), 8.0, 90.0);
  }

  std::optional<SearchResult> run() {
    if (forbidden(parked_, end_)) return std::nullopt;
    goal_free_from_ = goal_free_from();
    least_cost_ = std::max(problem_.least_cost, double(goal_free_from_));
    Node root;
    root.pose = problem_.start;
    root.h = to_go_(root.pose);
    root.f = std::max(steps_to_arrival(root), least_cost_);
    add(std::move(root));
    for (int expansions = 0; !open_.empty() && expansions < options_.max_expansions;) {
      if (expansions % kClockEvery == 0 && deadline_.expired()) return std::nullopt;
      const int n = open_.pop();
      if (nodes_[std::size_t(n)].at_goal) return path_to(n);
      if (nodes_[std::size_t(n)].f >= clear_goal_ ||
          !closed_.insert(key(nodes_[std::size_t(n)])).second) {
        continue;
      }
      if (expansions % kExpansionEvery == 0 || nodes_[std::size_t(n)].h < kExpansionRange)
        try_analytic_expansion(n);
      expand(n);
      ++expansions;
    }
    // Out of expansions: the best path that was found, though one with fewer conflicts may exist.
    if (best_goal_ >= 0) return path_to(best_goal_);
    return std::nullopt;
  }

 private:
  /// The step from which on the robot may stand at its goal for ever, if it may in the end.
  [[nodiscard]] int goal_free_from() const {
    int t = end_;
    while (t > 0 && !forbidden(parked_, t - 1)) --t;
    return t;
  }

  [[nodiscard]] double steps_to_arrival(const Node& node) const {
    return double(node.t) + std::ceil(node.h / car_.step_length() - kRounding);
  }

  [[nodiscard]] FocalKey focal_key(const Node& node) const {
    // Time that there is to spare is not spent on coming close to the goal: the weight counts
    // alone.
    const double to_go = node.h / car_.step_length();
    const double arrival = double(node.t) + kReversePenalty * node.reversed + to_go;
    const double finish = std::max(arrival, least_cost_) + (options_.w - 1.0) * to_go;
    const double conflicts = kConflictCost * double(node.conflicts);
    return {finish + conflicts, -node.t};
  }

  void add(Node node) {
    open_.push(int(nodes_.size()), node.f, node.f, focal_key(node));
    nodes_.push_back(std::move(node));
  }

  /// Would a goal that was reached leave the queue before `node`, which is not in it yet?
  ///
  /// Such a goal is in FOCAL no later and comes earlier there, so that leaving the node out changes
  /// nothing: the search ends before its turn.
  [[nodiscard]] bool comes_after_a_goal(const Node& node) const {
    if (reached_.empty()) return false;
    const FocalKey key = focal_key(node);
    return std::ranges::any_of(
        reached_, [&](const Reached& goal) { return goal.f <= node.f && goal.key <= key; });
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

  /// May nobody drive `sweep` during step t, whatever the cost?
  [[nodiscard]] bool forbidden(const Sweep& sweep, int t) const {
    const TimedObstacles* hard = problem_.to_keep_clear_of;
    if (hard != nullptr && hard->hit(sweep, t)) return true;
    return std::ranges::any_of(problem_.constraints, [&](const Constraint& c) {
      return c.first <= t && t <= c.last && collide(sweep, c.sweep);
    });
  }

  [[nodiscard]] int conflicts(const Sweep& sweep, int t) const {
    int found = 0;
    for (const TimedObstacles* traffic : problem_.to_avoid) {
      if (!traffic->empty()) found += traffic->count(sweep, t);
    }
    return found;
  }

  void expand(int n) {
    const Frame frame(nodes_[std::size_t(n)].pose);
    const bool may_wait = timed_ && nodes_[std::size_t(n)].t < end_;
    const std::size_t count = primitives_.size() - (may_wait ? 0 : 1);  // the wait is the last
    for (std::size_t k = 0; k < count; ++k) extend(n, frame, primitives_[k]);
  }

  void extend(int n, const Frame& frame, const Primitive& step) {
    const Node& from = nodes_[std::size_t(n)];
    Node node;
    node.pose = step.end_from(from.pose, frame);
    node.t = from.t + 1;
    if (closed_.contains(key(node))) return;
    node.h = to_go_(node.pose);
    node.f = std::max(from.f, steps_to_arrival(node));  // pathmax
    if (node.f >= clear_goal_) return;
    node.reversed = from.reversed + (step.arc.length < 0.0 ? 1 : 0);
    node.conflicts = from.conflicts;
    if (comes_after_a_goal(node)) return;
    const Sweep sweep = step.sweep.moved_to(frame);
    if (!car_.is_free(from.pose, step.arc, sweep) || forbidden(sweep, from.t)) return;
    node.conflicts += conflicts(sweep, from.t);
    if (comes_after_a_goal(node)) return;
    node.parent = n;
    node.arc = step.arc;
    add(std::move(node));
  }

  /// Adds the end of the Reeds-Shepp path from n to the goal, if it is free.
  void try_analytic_expansion(int n) {
    const Node& from = nodes_[std::size_t(n)];
    const double earliest = from.t + from.h / car_.step_length();
    if (earliest + kMaxPieces < goal_free_from_ || from.f >= clear_goal_) return;
    Node node;
    node.analytic_expansion =
        car_.steps(curves_.path(from.pose, to_go_.goal(), car_.vehicle().min_turning_radius));
    node.t = from.t + int(node.analytic_expansion.size());
    if (node.t < goal_free_from_) return;
    node.f = std::max(from.f, double(node.t));
    node.reversed =
        from.reversed + int(std::ranges::count_if(node.analytic_expansion,
                                                  [](const Arc& arc) { return arc.length < 0.0; }));
    node.conflicts = from.conflicts + parked_conflicts_from(node.t);
    node.parent = n;
    node.at_goal = true;
    if (!drive_analytic_expansion(from, node)) return;
    if (node.conflicts == 0) clear_goal_ = std::min(clear_goal_, node.f);
    reached_.push_back({node.f, focal_key(node)});
    const int number = int(nodes_.size());
    const bool best = best_goal_ < 0 || rank(node) < rank(nodes_[std::size_t(best_goal_)]);
    add(std::move(node));
    if (best) best_goal_ = number;
  }

  /// Counts the conflicts on the path of the analytic expansion. False if it is not free, or has
  /// too many of them to be of use.
  [[nodiscard]] bool drive_analytic_expansion(const Node& from, Node& goal) const {
    if (pointless(goal)) return false;
    Pose pose = from.pose;
    int t = from.t;
    for (const Arc& arc : goal.analytic_expansion) {
      const Sweep sweep = car_.sweep(pose, arc);
      if (!car_.is_free(pose, arc, sweep) || forbidden(sweep, t)) return false;
      if (const int met = conflicts(sweep, t); met > 0) {
        goal.conflicts += met;
        if (pointless(goal)) return false;
      }
      pose = drive(pose, arc);
      ++t;
    }
    goal.pose = pose;
    return true;
  }

  /// The least is the best to fall back on when the search is out of expansions.
  [[nodiscard]] std::tuple<bool, int, double> rank(const Node& goal) const {
    return {goal.f > options_.w * open_.lower_bound(), goal.conflicts, goal.f};
  }

  /// Would nothing change if this goal was never reached, however few conflicts are to come?
  [[nodiscard]] bool pointless(const Node& goal) const {
    if (goal.conflicts == 0 && goal.f < clear_goal_) return false;
    return comes_after_a_goal(goal) && rank(goal) >= rank(nodes_[std::size_t(best_goal_)]);
  }

  /// Conflicts of a robot that stays at its goal from step t on: whoever comes by later counts.
  [[nodiscard]] int parked_conflicts_from(int t) {
    // parked_conflicts_[k] is the sum over the last k steps until end_.
    while (end_ - t + 1 >= int(parked_conflicts_.size())) {
      const int step = end_ - int(parked_conflicts_.size()) + 1;
      parked_conflicts_.push_back(parked_conflicts_.back() + conflicts(parked_, step));
    }
    return parked_conflicts_[std::size_t(std::max(0, end_ - t + 1))];
  }

  [[nodiscard]] SearchResult path_to(int n) const {
    const Node& goal = nodes_[std::size_t(n)];
    SearchResult path;
    for (int k = goal.parent; nodes_[std::size_t(k)].parent >= 0;
         k = nodes_[std::size_t(k)].parent) {
      path.steps.push_back(nodes_[std::size_t(k)].arc);
    }
    std::ranges::reverse(path.steps);
    path.steps.insert(path.steps.end(), goal.analytic_expansion.begin(),
                      goal.analytic_expansion.end());
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
  const Deadline& deadline_;
  int goal_free_from_ = 0;
  double least_cost_ = 0.0;  ///< [steps]
  int end_ = 0;              ///< from this step on everything rests
  bool timed_;
  std::vector<Primitive> scaled_;  ///< steps that are not full ones
  const std::vector<Primitive>& primitives_;
  Sweep parked_;
  double cell_;
  double headings_;
  std::vector<Node> nodes_;
  std::vector<Reached> reached_;             ///< for each goal in nodes_
  std::vector<int> parked_conflicts_ = {0};  ///< see parked_conflicts_from()
  int best_goal_ = -1;  ///< within the bound if any is; then the fewest conflicts
  double clear_goal_ =
      std::numeric_limits<double>::infinity();  ///< least f of one without conflicts
  FocalQueue<FocalKey> open_;
  std::unordered_set<std::uint64_t> closed_;
};

}  // namespace

std::optional<SearchResult> SpacetimeHybridAstar::search(const SearchProblem& problem,
                                                         const SearchOptions& options,
                                                         const Deadline& deadline) const {
  return Search(problem, options, curves_, deadline).run();
}

std::optional<SearchResult> SpacetimeHybridAstar::search_with_shorter_steps(
    const SearchProblem& problem, SearchOptions options, const Deadline& deadline) const {
  for (const double scale : {1.0, 0.5, 0.25}) {
    options.arc_scale = scale;
    if (auto path = search(problem, options, deadline)) return path;
  }
  return std::nullopt;
}

}  // namespace mvtp
