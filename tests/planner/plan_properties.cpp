#include "tests/planner/plan_properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "planner/problem/metrics.hpp"
#include "planner/problem/validate.hpp"

namespace mvtp {
namespace {

/// Collects what is broken.
class Findings {
 public:
  template <class... Values>
  void require(bool holds, std::string_view property, const Values&... values) {
    if (holds) return;
    std::string line(property);
    (line.append(fmt::format(" {}", values)), ...);
    lines_.push_back(line);
  }

  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
};

bool about(double a, double b) { return std::abs(a - b) <= 1e-6 * (1.0 + std::abs(b)); }

void check_any_answer(Findings& findings, const SolveOptions& options, const Statistics& s) {
  constexpr std::array kStatuses = {"solved", "timeout", "exhausted", "infeasible"};
  findings.require(std::ranges::find(kStatuses, s.status) != kStatuses.end(), "status", s.status);
  findings.require(s.algorithm == options.algorithm, "algorithm", s.algorithm);
  findings.require(s.reason.empty() == (s.status == "solved"), "reason", s.reason);
  findings.require(std::isfinite(s.runtime) && s.runtime >= 0, "runtime", s.runtime);
  findings.require(std::isfinite(s.lower_bound) && s.lower_bound >= 0, "bound", s.lower_bound);
  findings.require(std::isfinite(s.dt) && s.dt > 0, "dt", s.dt);
}

void check_times(Findings& findings, const Plan& plan) {
  const Statistics& s = plan.statistics;
  const double makespan = double(makespan_steps(plan)) * s.dt;
  findings.require(s.makespan_steps == makespan_steps(plan), "steps", s.makespan_steps);
  findings.require(about(s.makespan, makespan), "makespan against steps", s.makespan, makespan);
  findings.require(about(s.flowtime, double(flowtime_steps(plan)) * s.dt), "flowtime", s.flowtime);
  findings.require(s.cost == s.flowtime, "cost against flowtime", s.cost, s.flowtime);
  findings.require(s.makespan >= s.lower_bound - 1e-6, "makespan below lower bound", s.makespan,
                   s.lower_bound);
  findings.require(s.makespan <= s.flowtime + 1e-6, "makespan above flowtime", s.makespan);
  findings.require(s.flowtime <= double(plan.names.size()) * s.makespan + 1e-6, "flowtime is long",
                   s.flowtime, s.makespan);
  if (s.solo_makespan) {
    findings.require(*s.solo_makespan <= s.makespan + 1e-6, "solo makespan above makespan",
                     *s.solo_makespan, s.makespan);
    findings.require(*s.solo_makespan >= s.lower_bound - 1e-6, "solo makespan below bound",
                     *s.solo_makespan, s.lower_bound);
  }
  if (s.first_solution) {
    findings.require(*s.first_solution >= 0 && *s.first_solution <= s.runtime,
                     "first solution after the end", *s.first_solution, s.runtime);
  }
}

void check_motion(Findings& findings, const Instance& instance, const SolveOptions& options,
                  const Plan& plan) {
  for (std::size_t i = 0; i < instance.agents.size(); ++i) {
    const Agent& agent = instance.agents[i];
    findings.require(plan.names[i] == agent.name, "name", plan.names[i]);
    findings.require(plan.trajectories[i].at(0).pose == agent.start, "not from start", agent.name);
    findings.require(plan.trajectories[i].waypoints().back().pose == agent.goal,
                     "not exactly at the goal:", agent.name);
  }
  for (const Violation& violation : find_violations(instance, plan, options.collision)) {
    findings.require(false, "referee:", violation.message);
  }
}

}  // namespace

std::vector<std::string> broken_properties(const Instance& instance, const SolveOptions& options,
                                           const Plan& plan) {
  Findings findings;
  check_any_answer(findings, options, plan.statistics);
  if (plan.statistics.status != "solved") return findings.lines();
  if (plan.names.size() != instance.agents.size() ||
      plan.trajectories.size() != instance.agents.size()) {
    findings.require(false, "numbers of names, trajectories, agents:", plan.names.size(),
                     plan.trajectories.size(), instance.agents.size());
    return findings.lines();
  }
  check_times(findings, plan);
  check_motion(findings, instance, options, plan);
  return findings.lines();
}

}  // namespace mvtp
