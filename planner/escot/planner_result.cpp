#include "planner/escot/planner_result.hpp"

namespace mvtp {

Trajectory trajectory_of(const PlanningProblem& problem, int i, const std::vector<Arc>& steps,
                         double dt) {
  const Agent& agent = problem.instance().agents[std::size_t(i)];
  Trajectory trajectory(agent.start);
  for (const Arc& arc : steps) {
    const Pose& from = trajectory.waypoints().back().pose;
    trajectory.push_back(waypoint(agent.vehicle, arc, problem.after(i, from, arc), dt));
  }
  return trajectory;
}

}  // namespace mvtp
