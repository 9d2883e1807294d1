#include "planner/escot/planner_result.hpp"

namespace mvtp {

Trajectory trajectory_of(const PlanningProblem& problem, int i, const std::vector<Arc>& steps) {
  Trajectory trajectory(problem.instance().agents[std::size_t(i)].start);
  for (const Arc& arc : steps) {
    const Pose& from = trajectory.waypoints().back().pose;
    trajectory.push_back(problem.car(i).waypoint(arc, problem.after(i, from, arc)));
  }
  return trajectory;
}

}  // namespace mvtp
