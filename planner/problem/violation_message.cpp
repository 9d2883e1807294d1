#include "planner/problem/violation_message.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "planner/problem/initial_overlap.hpp"
#include "planner/problem/referee_tolerances.hpp"

namespace mvtp::referee {
namespace {

/// "at step 3.25", or "from step 3.25 to step 7" if it lasts.
std::string span(const Protocol::Entry& entry) {
  if (double(entry.last_step) - entry.when < 1.0) return fmt::format("at step {:.4g}", entry.when);
  return fmt::format("from step {:.4g} to step {}", entry.when, entry.last_step);
}

std::string message(const Protocol::Entry& entry, const Instance& instance, const Plan& plan) {
  const double x = entry.amount;
  const auto car = [&]() -> const Agent& { return instance.agents[entry.subject]; };
  const auto off = [&] { return fmt::format("{:.4f} m and {:.4f} rad", x, entry.turn); };
  switch (entry.rule) {
    case Rule::kAgentMissing:
      return fmt::format("{}: has no trajectory", car().name);
    case Rule::kAgentUnknown:
      return fmt::format("{}: is no agent of the instance, or occurs twice",
                         plan.names[entry.subject]);
    case Rule::kNotFinite:
      return fmt::format("{}: {}: the pose is not finite, or farther than {} m", car().name,
                         span(entry), kFarthest);
    case Rule::kStart:
      return fmt::format("{}: begins {} from its start", car().name, off());
    case Rule::kGoal:
      return fmt::format("{}: ends {} from its goal; {} m and {} rad are allowed", car().name,
                         off(), kGoalTolerance, kGoalTolerance);
    case Rule::kArc:
      return fmt::format("{}: {}: the step ends {} from where its arc leads", car().name,
                         span(entry), off());
    case Rule::kCurvature:
      return fmt::format("{}: {}: turns with a radius of {:.4f} m; at least {:.4f} m is allowed",
                         car().name, span(entry), 1.0 / x, car().vehicle.min_turning_radius);
    case Rule::kSpeed:
      return fmt::format("{}: {}: drives at {:.4f} m/s; at most {:.4f} m/s is allowed", car().name,
                         span(entry), x, car().vehicle.max_speed);
    case Rule::kRobotOverlap:
      return fmt::format("{} and {}: overlap by {:.4f} m {}", car().name,
                         instance.agents[entry.object].name, x, span(entry));
    case Rule::kObstacleOverlap:
      return fmt::format("{}: overlaps {} by {:.4f} m {}", car().name,
                         obstacle_name(instance.map, entry.object), x, span(entry));
    case Rule::kBounds:
      return fmt::format("{}: the {} is {:.4f} m outside the map {}", car().name,
                         instance.map.bounds == Bounds::kAxle ? "rear axle" : "footprint", x,
                         span(entry));
  }
  return "";
}

}  // namespace

Violation to_violation(const Protocol::Entry& entry, const Instance& instance, const Plan& plan) {
  std::vector<std::string> agents = {entry.rule == Rule::kAgentUnknown
                                         ? plan.names[entry.subject]
                                         : instance.agents[entry.subject].name};
  if (entry.rule == Rule::kRobotOverlap) agents.push_back(instance.agents[entry.object].name);
  return {entry.rule, std::move(agents), entry.when, entry.amount, message(entry, instance, plan)};
}

}  // namespace mvtp::referee
