#include "planner/escot/prioritized.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "planner/search/spacetime_hybrid_astar.hpp"

namespace mvtp {
namespace {

/// After so many random orders that were all tried before, there is taken to be no other.
constexpr int kShuffles = 100;

using Order = std::vector<int>;  ///< robots, first planned first

/// Either every robot's motion, in the order of planning, or the robot that found no path.
struct Attempt {
  std::vector<std::vector<Arc>> steps;
  int failed = -1;
};

class Prioritized {
 public:
  Prioritized(const PlanningProblem& problem, const PrioritizedOptions& options,
              const Deadline& deadline)
      : problem_(problem),
        options_(options),
        deadline_(deadline),
        planner_(problem.curves()),
        starts_(problem.starts()) {}

  PlannerResult run() {
    std::mt19937_64 rng(options_.seed);
    Order order = longest_first();
    std::set<Order> tried;
    while (int(tried.size()) < options_.max_orders && tried.insert(order).second) {
      Attempt attempt = plan_in(order);
      if (attempt.failed < 0) return solution(order, attempt);
      if (deadline_.expired()) return {Status::kTimeout, {}};
      order = first(attempt.failed, std::move(order));
      for (int k = 0; k < kShuffles && tried.contains(order); ++k) shuffle(order, rng);
    }
    return {Status::kExhausted, {}};
  }

 private:
  [[nodiscard]] Order longest_first() const {
    Order order(starts_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::ranges::greater{}, [this](int i) {
      return problem_.cost_to_go(i)(starts_[std::size_t(i)]) / problem_.car(i).step_length();
    });
    return order;
  }

  /// `order` with `robot` in front.
  static Order first(int robot, Order order) {
    const auto at = std::ranges::find(order, robot);
    std::rotate(order.begin(), at, at + 1);
    return order;
  }

  /// By hand, for the same permutation with every standard library.
  static void shuffle(Order& order, std::mt19937_64& rng) {
    for (std::size_t n = order.size(); n > 1; --n) std::swap(order[n - 1], order[rng() % n]);
  }

  [[nodiscard]] Attempt plan_in(const Order& order) const {
    Attempt attempt;
    std::vector<SweptTrajectory> planned;
    planned.reserve(order.size());  // it is pointed into
    for (const int i : order) {
      std::optional<SearchResult> path = plan(i, planned, order);
      if (!path) {
        attempt.failed = i;
        return attempt;
      }
      planned.emplace_back(problem_.car(i), starts_[std::size_t(i)], path->steps);
      attempt.steps.push_back(std::move(path->steps));
    }
    return attempt;
  }

  /// The path of robot i, whose turn it is, clear of everybody planned and of the starts of those
  /// after it while they leave.
  [[nodiscard]] std::optional<SearchResult> plan(int i, std::span<const SweptTrajectory> planned,
                                                 const Order& order) const {
    std::vector<const SweptTrajectory*> others;
    for (const SweptTrajectory& other : planned) others.push_back(&other);
    const TimedObstacles traffic(others);
    std::vector<Constraint> constraints;
    for (std::size_t later = planned.size() + 1; later < order.size(); ++later) {
      const int j = order[later];
      const Sweep standing = problem_.car(j).sweep(starts_[std::size_t(j)], {});
      constraints.push_back({0, options_.start_steps - 1, standing});
    }
    return planner_.search({.car = &problem_.car(i),
                            .cost_to_go = &problem_.cost_to_go(i),
                            .start = starts_[std::size_t(i)],
                            .constraints = constraints,
                            .to_keep_clear_of = &traffic},
                           {options_.w, options_.max_expansions}, deadline_);
  }

  [[nodiscard]] PlannerResult solution(const Order& order, const Attempt& attempt) const {
    PlannerResult plan{Status::kSolved, {}};
    for (int i = 0; i < problem_.size(); ++i) {
      const auto rank = std::ranges::find(order, i) - order.begin();
      plan.trajectories.push_back(
          trajectory_of(problem_, i, attempt.steps[std::size_t(rank)], problem_.instance().dt));
    }
    return plan;
  }

  const PlanningProblem& problem_;
  const PrioritizedOptions& options_;
  const Deadline& deadline_;
  SpacetimeHybridAstar planner_;
  Configuration starts_;
};

}  // namespace

PlannerResult plan_prioritized(const PlanningProblem& problem, const PrioritizedOptions& options,
                               const Deadline& deadline) {
  return Prioritized(problem, options, deadline).run();
}

}  // namespace mvtp
