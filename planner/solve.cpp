#include "planner/solve.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>

#include "planner/anytime/escot_star.hpp"
#include "planner/escot/conflict_based_search.hpp"
#include "planner/escot/escot.hpp"
#include "planner/escot/planning_problem.hpp"
#include "planner/escot/prioritized.hpp"
#include "planner/escot/single_agent_path.hpp"
#include "planner/problem/initial_overlap.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/metrics.hpp"

namespace mvtp {
namespace {

PlannerResult run_escot(const PlanningProblem& problem, const SolveOptions& options,
                        const Deadline& deadline) {
  EscotOptions escot;
  escot.seed = options.seed;
  escot.world.seed = options.seed;
  escot.world.score = options.pbcr;
  return solve_escot(problem, escot, deadline);
}

PlannerResult run_pbcr(const PlanningProblem& problem, const SolveOptions& options,
                       const Deadline& deadline) {
  EscotOptions escot;
  escot.seed = options.seed;
  escot.world.seed = options.seed;
  escot.world.score = options.pbcr;
  escot.world.grouping = false;
  escot.replan_duplicates = false;
  return solve_escot(problem, escot, deadline);
}

/// Conflict-based search over all robots at once.
PlannerResult run_cbs(const PlanningProblem& problem, const CbsOptions& options,
                      const Deadline& deadline) {
  std::vector<CbsRobot> robots;
  const Configuration starts = problem.starts();
  for (int i = 0; i < problem.size(); ++i) {
    robots.push_back({&problem.car(i), &problem.cost_to_go(i), starts[std::size_t(i)]});
  }
  const CbsResult result =
      conflict_based_search(robots, {}, SpacetimeHybridAstar(problem.curves()), options, deadline);
  if (result.failure == CbsFailure::kTimeout) return {Status::kTimeout, {}};
  if (result.failure != CbsFailure::kNone) return {Status::kExhausted, {}};
  PlannerResult plan{Status::kSolved, {}};
  for (int i = 0; i < problem.size(); ++i) {
    plan.trajectories.push_back(
        trajectory_of(problem, i, result.steps[std::size_t(i)], problem.instance().dt));
  }
  return plan;
}

PlannerResult run_eccr(const PlanningProblem& problem, const SolveOptions&,
                       const Deadline& deadline) {
  return run_cbs(problem, eccr_options(), deadline);
}

PlannerResult run_cl_cbs(const PlanningProblem& problem, const SolveOptions&,
                         const Deadline& deadline) {
  return run_cbs(problem, cl_cbs_options(), deadline);
}

PlannerResult run_sha(const PlanningProblem& problem, const SolveOptions& options,
                      const Deadline& deadline) {
  PrioritizedOptions sha;
  sha.seed = options.seed;
  return plan_prioritized(problem, sha, deadline);
}

PlannerResult run_escot_star(const PlanningProblem& problem, const SolveOptions& options,
                             const Deadline& deadline) {
  return solve_escot_star(
      problem, {.seed = options.seed, .gap = options.gap, .threads = options.threads}, deadline);
}

struct Algorithm {
  std::string name;
  PlannerResult (*run)(const PlanningProblem&, const SolveOptions&, const Deadline&);
  /// Do its robots move by PBCR, which plans also for those that overlap each other at their
  /// starts or goals?
  bool runs_pbcr = false;
};

const std::vector<Algorithm>& algorithms() {
  static const std::vector<Algorithm> kAll = {
      {"escot", run_escot, true}, {"pbcr", run_pbcr, true}, {"eccr", run_eccr},
      {"cl-cbs", run_cl_cbs},     {"sha", run_sha},         {"escot-star", run_escot_star}};
  return kAll;
}

/// @param options  its seed becomes that of the last run: the one that solved, if any did
PlannerResult run_repeatedly(const Algorithm& algorithm, const PlanningProblem& problem,
                             SolveOptions& options, const Deadline& deadline) {
  PlannerResult plan;
  const std::uint64_t first_seed = options.seed;
  for (int run = 0; run < std::max(options.runs, 1); ++run) {
    options.seed = first_seed + std::uint64_t(run);
    plan = algorithm.run(problem, options, deadline.within(options.run_time_limit));
    if (plan.status == Status::kSolved || deadline.expired()) break;
  }
  return plan;
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::string reason(const PlannerResult& plan) {
  switch (plan.status) {
    case Status::kTimeout:
      return "the time limit ended the search";
    case Status::kExhausted:
      return "the search gave up: no move or no path left to try";
    default:
      return {};
  }
}

}  // namespace

const std::vector<std::string>& algorithm_names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const Algorithm& algorithm : algorithms()) names.push_back(algorithm.name);
    return names;
  }();
  return kNames;
}

Plan solve(const Instance& instance, const SolveOptions& options, const Deadline& deadline) {
  const auto algorithm = std::ranges::find(algorithms(), options.algorithm, &Algorithm::name);
  if (algorithm == algorithms().end()) {
    throw InputError("--algorithm",
                     fmt::format("unknown algorithm '{}'; choose one of {}", options.algorithm,
                                 fmt::join(algorithm_names(), ", ")));
  }
  const auto begin = std::chrono::steady_clock::now();
  const PlanningProblem problem(instance, options.collision, deadline);

  Plan plan;
  PlannerResult solution;
  SolveOptions last = options;
  double prepared = 0.0;  // [s]
  plan.statistics.reason = problem.proof_of_infeasibility(deadline);
  if (plan.statistics.reason.empty() && !algorithm->runs_pbcr &&
      !problem.overlapping_pairs().empty()) {
    plan.statistics.reason =
        fmt::format("{}; only escot and pbcr let them", problem.overlapping_pairs().first());
  } else if (plan.statistics.reason.empty()) {
    prepared = seconds_since(begin);
    solution = run_repeatedly(*algorithm, problem, last, deadline);
    plan.statistics.reason = reason(solution);
  } else {
    solution.status = Status::kInfeasible;
  }

  for (const Agent& agent : instance.agents) {
    plan.names.push_back(agent.name);
    plan.vehicles.push_back(agent.vehicle);
  }
  plan.trajectories = std::move(solution.trajectories);
  plan.statistics.status = to_string(solution.status);
  plan.statistics.algorithm = options.algorithm;
  if (algorithm->runs_pbcr && options.pbcr == PbcrScore::kPaper) plan.statistics.pbcr = "paper";
  plan.statistics.seed = last.seed;
  plan.statistics.dt = solution.dt.value_or(instance.dt);
  plan.statistics.solo_makespan = solution.solo_makespan;
  if (solution.first_solution) {
    plan.statistics.first_solution = *solution.first_solution + prepared;
  }
  plan.statistics.lower_bound = problem.lower_bound();
  plan.statistics.initial_overlaps = exemptions_of(instance);
  fill_in_durations(plan);
  plan.statistics.runtime = seconds_since(begin);
  return plan;
}

std::vector<std::size_t> robots_without_single_agent_path(const Instance& instance) {
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  std::vector<std::size_t> robots;
  for (int i = 0; i < problem.size(); ++i) {
    if (!find_single_agent_path(problem, i, Deadline::never())) robots.push_back(std::size_t(i));
  }
  return robots;
}

}  // namespace mvtp
