// Two cars that want to pass each other: an instance, its plan, and the referee's verdict.
#include <cstdio>
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
    const mvtp::Pose end = plan.trajectories[i].at(plan.trajectories[i].makespan()).pose;
    std::printf("%s ends at x = %.1f m, y = %.1f m\n", plan.names[i].c_str(), end.x, end.y);
  }
  return plan.statistics.status == "solved" && violations.empty() ? 0 : 1;
}
