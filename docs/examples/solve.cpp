// Two cars that want to pass each other: an instance, its plan, and the referee's verdict.
#include <cstdio>
#include <mvtp/plan_array.hpp>
#include <mvtp/solve.hpp>
#include <mvtp/validate.hpp>
#include <numbers>

int main() {
  mvtp::Instance instance;
  instance.map.width = 40;  // [m]
  instance.map.height = 20;
  instance.agents = {
      {.name = "left", .vehicle = {}, .start = {5, 10, 0}, .goal = {35, 10, 0}},
      {.name = "right",
       .vehicle = {},
       .start = {35, 10, std::numbers::pi},
       .goal = {5, 10, std::numbers::pi}},
  };

  const mvtp::Plan plan = mvtp::solve(instance, {.algorithm = "escot"}, mvtp::Deadline::in(10));
  const auto violations = find_violations(instance, plan, mvtp::CollisionRule::kContinuous);
  std::printf("%s: %zu steps, %zu violations\n", plan.statistics.status.c_str(),
              plan.statistics.makespan_steps, violations.size());
  for (std::size_t i = 0; i < plan.names.size(); ++i) {
    const auto states = mvtp::states(plan.trajectories[i]);  // rows x, y, heading, v, phi
    const auto end = states.bottomRows<1>();
    std::printf("%s ends at x = %.1f m, y = %.1f m, at most %.1f m beside the line\n",
                plan.names[i].c_str(), end(0), end(1), (states.col(1) - 10.0).abs().maxCoeff());
  }
  return plan.statistics.status == "solved" && violations.empty() ? 0 : 1;
}
