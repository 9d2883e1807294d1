#include "tools/view/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

/// For each agent of the instance the index of its trajectory.
std::vector<std::size_t> match(const Instance& instance, const Plan& plan,
                               const std::string& where) {
  std::map<std::string, std::size_t> trajectory_of;
  for (std::size_t i = 0; i < plan.trajectories.size(); ++i) trajectory_of[plan.names.at(i)] = i;

  std::vector<std::size_t> order;
  for (const Agent& agent : instance.agents) {
    const auto found = trajectory_of.find(agent.name);
    if (found == trajectory_of.end()) {
      throw InputError(where + ": schedule", "has no agent '" + agent.name +
                                                 "' of the instance; give the plan's instance");
    }
    order.push_back(found->second);
    trajectory_of.erase(found);
  }
  if (!trajectory_of.empty()) {
    throw InputError(where + ": schedule",
                     "has an agent '" + trajectory_of.begin()->first +
                         "' unknown to the instance; give the plan's instance");
  }
  return order;
}

/// Signed speed of a step as the arc between its two poses [m/s]; plans of other programs lack v.
double speed_of_step(const Pose& from, const Pose& to, double dt) {
  const Pose step = relative(from, to);
  const double half = step.theta / 2.0;
  const double arc_per_chord = std::abs(half) < 1e-6 ? 1.0 : half / std::sin(half);
  return std::copysign(std::hypot(step.x, step.y) * arc_per_chord / dt, step.x);
}

/// The step after which the robot stays where it is.
std::size_t arrival(const Trajectory& trajectory) {
  std::size_t t = trajectory.makespan();
  while (t > 0 && trajectory.at(t - 1).pose == trajectory.at(t).pose) --t;
  return t;
}

ReplayVehicleState state_at(const Trajectory& trajectory, std::size_t t, std::size_t vehicle,
                            double dt) {
  const Pose& pose = trajectory.at(t).pose;
  const bool rests = pose == trajectory.at(t + 1).pose;
  return {.vehicle = vehicle,
          .pose = pose,
          .speed = t == 0 ? 0.0 : speed_of_step(trajectory.at(t - 1).pose, pose, dt),
          .state = t >= arrival(trajectory) ? ReplayState::kArrived
                   : rests                  ? ReplayState::kWaiting
                                            : ReplayState::kCoordinated};
}

void add_figures(const Statistics& statistics, std::size_t agents, ReplayRecorder& recorder) {
  recorder.add_figure({"robots", std::to_string(agents), ""});
  if (!statistics.status.empty()) recorder.add_figure({"status", statistics.status, ""});
  if (!statistics.algorithm.empty()) recorder.add_figure({"algorithm", statistics.algorithm, ""});
  const auto add = [&](const char* label, double value, const char* unit) {
    recorder.add_figure({label, fmt::format("{:.5g}", value), unit});
  };
  add("makespan", statistics.makespan, "s");
  add("flowtime", statistics.flowtime, "s");
  if (statistics.lower_bound > 0.0) add("lower bound", statistics.lower_bound, "s");
  add("runtime", statistics.runtime, "s");
}

}  // namespace

ReplayScene scene_of(const RoadNetwork& network) {
  ReplayScene scene;
  std::set<std::string> incoming;
  for (const auto& [id, junction] : network.junctions) {
    if (junction.shape.size() >= 3) scene.junctions.push_back(junction.shape);
    if (!junction.has_conflicts) continue;
    incoming.insert(junction.incoming_lanes.begin(), junction.incoming_lanes.end());
  }
  for (const auto& [id, lane] : network.lanes) {
    if (!lane.drivable || lane.shape.size() < 2) continue;
    scene.lanes.push_back({.shape = lane.shape,
                           .width = lane.width,
                           .internal = lane.internal,
                           .stop_line = incoming.contains(id)});
  }
  return scene;
}

ReplayScene scene_of(const Map& map) {
  return {.lanes = {},
          .junctions = {},
          .zones = {},
          .circles = map.circles,
          .polygons = map.polygons,
          .border = Point{map.width, map.height}};
}

Replay replay_of(const Instance& instance, const Plan& plan, ReplayInfo info,
                 const std::string& where) {
  info.motion = ReplayMotion::kSteps;
  if (info.seed.empty() && !plan.trajectories.empty()) {
    info.seed = std::to_string(plan.statistics.seed);
  }
  if (info.version.empty()) info.version = plan.statistics.version;
  ReplayRecorder recorder(std::move(info), scene_of(instance.map), 0.0);
  for (const Agent& agent : instance.agents) {
    recorder.add_vehicle({.id = agent.name,
                          .kind = "",
                          .length = agent.vehicle.length(),
                          .width = agent.vehicle.width,
                          .front = agent.vehicle.front,
                          .max_speed = agent.vehicle.max_speed,
                          .start = agent.start,
                          .goal = agent.goal});
  }

  std::vector<ReplayVehicleState> states(instance.agents.size());
  if (plan.trajectories.empty()) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      states[i] = {i, instance.agents[i].start, 0.0, ReplayState::kWaiting};
    }
    recorder.add_frame(0.0, states);
    return recorder.finish();
  }

  const std::vector<std::size_t> order = match(instance, plan, where);
  std::size_t makespan = 0;
  for (const Trajectory& trajectory : plan.trajectories) {
    makespan = std::max(makespan, trajectory.makespan());
  }
  for (std::size_t t = 0; t <= makespan; ++t) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      states[i] = state_at(plan.trajectories[order[i]], t, i, instance.dt);
    }
    recorder.add_frame(static_cast<double>(t) * instance.dt, states);
  }
  add_figures(plan.statistics, instance.agents.size(), recorder);
  return recorder.finish();
}

}  // namespace mvtp
