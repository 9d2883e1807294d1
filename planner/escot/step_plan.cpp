#include "planner/escot/step_plan.hpp"

namespace mvtp {

Trajectory trajectory_of(const PlanningProblem& fleet, int i, const std::vector<Arc>& steps) {
  Trajectory trajectory(fleet.instance().agents[std::size_t(i)].start);
  for (const Arc& arc : steps) {
    const Pose& from = trajectory.waypoints().back().pose;
    trajectory.push_back(fleet.car(i).waypoint(arc, fleet.after(i, from, arc)));
  }
  return trajectory;
}

}  // namespace mvtp
