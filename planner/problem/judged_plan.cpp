#include "planner/problem/judged_plan.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_map>

#include "planner/problem/referee_tolerances.hpp"

namespace mvtp::referee {
namespace {

bool is_finite(const Pose& pose) {
  return std::abs(pose.x) <= kFarthest && std::abs(pose.y) <= kFarthest &&
         std::isfinite(pose.theta);
}

}  // namespace

JudgedPlan::JudgedPlan(const Instance& instance, const Plan& plan, Protocol& protocol)
    : instance_(instance), plan_(plan) {
  std::unordered_map<std::string_view, std::size_t> index;
  for (std::size_t i = 0; i < instance.agents.size(); ++i) index.emplace(agent(i).name, i);
  trajectories_.assign(instance.agents.size(), nullptr);
  for (std::size_t k = 0; k < plan.names.size(); ++k) {
    const auto found = index.find(plan.names[k]);
    if (found == index.end() || trajectories_[found->second] != nullptr) {
      protocol.add(Rule::kAgentUnknown, k, 0, 0, 0.0, 0.0);
    } else {
      trajectories_[found->second] = &plan.trajectories[k];
    }
  }
  for (std::size_t i = 0; i < instance.agents.size(); ++i) {
    if (trajectories_[i] == nullptr) {
      protocol.add(Rule::kAgentMissing, i, 0, 0, 0.0, 0.0);
      continue;
    }
    const std::vector<Waypoint>& waypoints = trajectory(i).waypoints();
    const auto bad = std::find_if(waypoints.begin(), waypoints.end(),
                                  [](const Waypoint& w) { return !is_finite(w.pose); });
    if (bad == waypoints.end()) {
      present_.push_back(i);
    } else {
      const auto step = static_cast<std::size_t>(bad - waypoints.begin());
      protocol.add(Rule::kNotFinite, i, 0, step, double(step), 0.0);
    }
  }
}

}  // namespace mvtp::referee
