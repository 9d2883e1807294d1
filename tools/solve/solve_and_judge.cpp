#include "tools/solve/solve_and_judge.hpp"

#include <vector>

#include "planner/problem/validate.hpp"
#include "tools/cli/version.hpp"

namespace mvtp {
namespace {

void judge(const Instance& instance, CollisionRule rule, Plan& plan) {
  if (plan.statistics.status != to_string(Status::kSolved)) return;
  const std::vector<Violation> violations = find_violations(instance, plan, rule);
  if (violations.empty()) return;
  plan.statistics.status = "invalid";
  plan.statistics.reason = "the referee rejects the plan: " + violations.front().message;
}

}  // namespace

Plan solve_and_judge(const Instance& instance, const SolveOptions& options,
                     const Deadline& deadline, const std::atomic<bool>& stop) {
  Plan plan = solve(instance, options, deadline.or_when(stop));
  if (stop && plan.statistics.status == to_string(Status::kTimeout)) {
    plan.statistics.reason = "a signal ended the search";
  }
  plan.statistics.version = version();
  judge(instance, options.collision, plan);
  return plan;
}

}  // namespace mvtp
