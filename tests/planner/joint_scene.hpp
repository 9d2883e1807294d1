#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "planner/anytime/single_agent_trajectories.hpp"
#include "planner/escot/planner_result.hpp"
#include "planner/escot/planning_problem.hpp"
#include "planner/problem/plan.hpp"
#include "planner/problem/validate.hpp"
#include "planner/search/joint_motion.hpp"

namespace mvtp {

/// An instance, made ready for the parts of ESCoT*.
struct JointScene {
  explicit JointScene(Instance which)
      : instance(std::move(which)),
        planning_problem(instance, CollisionRule::kContinuous),
        obstacles(instance.map, 6.0),
        clearance(instance.map, obstacles) {
    cars.reserve(instance.agents.size());
    for (int i = 0; i < planning_problem.size(); ++i) {
      const Agent& a = instance.agents[std::size_t(i)];
      cars.emplace_back(a.vehicle, time, instance.map, obstacles, clearance);
      robots.push_back({&cars.back(), &planning_problem.cost_to_go(i), a.start});
    }
    alone = find_single_agent_trajectories(planning_problem, robots, never);
    EXPECT_EQ(alone.size(), robots.size());
  }
  JointScene(const JointScene&) = delete;
  JointScene& operator=(const JointScene&) = delete;

  /// The plan of these trajectories.
  Plan plan_of(const JointMotion& motion) const {
    Plan plan;
    plan.statistics.dt = time.dt;
    for (int i = 0; i < motion.size(); ++i) {
      plan.names.push_back(instance.agents[std::size_t(i)].name);
      plan.trajectories.push_back(
          trajectory_of(planning_problem, i, motion.trajectory(i).steps(), time.dt));
    }
    return plan;
  }

  /// The referee finds nothing in the plan of these trajectories.
  void expect_valid(const JointMotion& motion) const {
    for (const Violation& violation :
         find_violations(instance, plan_of(motion), CollisionRule::kContinuous)) {
      ADD_FAILURE() << violation.message;
    }
  }

  TimeGrid time{0.1, 12};
  Instance instance;
  PlanningProblem planning_problem;
  Obstacles obstacles;
  Clearance clearance;
  std::vector<MotionPrimitives> cars;
  std::vector<MacroRobot> robots;
  Deadline never = Deadline::never();
  std::vector<ArcTrajectory> alone;
};

}  // namespace mvtp
