#include "tools/view/plan_replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/metrics.hpp"
#include "tools/view/scene.hpp"

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
      throw InputError(where + ": schedule",
                       "lacks agent \"" + agent.name + "\"; name the instance of this plan");
    }
    order.push_back(found->second);
    trajectory_of.erase(found);
  }
  if (!trajectory_of.empty()) {
    throw InputError(where + ": schedule." + trajectory_of.begin()->first,
                     "is no agent of the instance; name the instance of this plan");
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

ReplayVehicleState state_at(const Trajectory& trajectory, std::size_t t, std::size_t vehicle,
                            double dt) {
  const Pose& pose = trajectory.at(t).pose;
  const bool rests = pose == trajectory.at(t + 1).pose;
  return {.vehicle = vehicle,
          .pose = pose,
          .speed = t == 0 ? 0.0 : speed_of_step(trajectory.at(t - 1).pose, pose, dt),
          .state = t >= arrival_step(trajectory) ? ReplayState::kArrived
                   : rests                       ? ReplayState::kWaiting
                                                 : ReplayState::kCoordinated};
}

ReplayRecorder recorder_of(const Instance& instance, ReplayInfo info) {
  info.motion = ReplayMotion::kSteps;
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
  return recorder;
}

void add_figures(Plan plan, std::size_t violations, ReplayRecorder& recorder) {
  fill_in_durations(plan);
  const Statistics& statistics = plan.statistics;
  const auto add_text = [&](const char* label, const std::string& value) {
    if (!value.empty()) recorder.add_figure({label, value, ""});
  };
  const auto add = [&](const char* label, double value, const char* unit) {
    if (value > 0.0) recorder.add_figure({label, fmt::format("{:.5g}", value), unit});
  };
  add_text("robots", std::to_string(plan.trajectories.size()));
  add_text("status", statistics.status);
  add_text("algorithm", statistics.algorithm);
  add("makespan", statistics.makespan, "s");
  add("flowtime", statistics.flowtime, "s");
  add("lower bound", statistics.lower_bound, "s");
  add("runtime", statistics.runtime, "s");
  add_text("violations", std::to_string(violations));
}

void add_event(const Violation& violation, const Instance& instance, const Plan& plan,
               const std::vector<std::size_t>& order, ReplayRecorder& recorder) {
  const bool is_overlap =
      violation.rule == Rule::kRobotOverlap || violation.rule == Rule::kObstacleOverlap;
  ReplayEvent event{.kind = is_overlap ? ReplayEventKind::kOverlap : ReplayEventKind::kNote,
                    .time = violation.step * plan.statistics.dt,
                    .value = -violation.amount,
                    .text = violation.message};
  const auto step = static_cast<std::size_t>(std::max(violation.step, 0.0));
  for (std::size_t i = 0; i < instance.agents.size(); ++i) {
    if (std::ranges::find(violation.agents, instance.agents[i].name) == violation.agents.end()) {
      continue;
    }
    const Pose& pose = plan.trajectories[order[i]].at(step).pose;
    if (event.vehicles.empty()) event.place = {pose.x, pose.y};
    event.vehicles.push_back(i);
  }
  recorder.add_event(event);
}

}  // namespace

Replay replay_of(const Instance& instance, const Plan& plan, std::span<const Violation> violations,
                 ReplayInfo info, const std::string& where) {
  const std::vector<std::size_t> order = match(instance, plan, where);
  if (info.seed.empty()) info.seed = std::to_string(plan.statistics.seed);
  if (info.version.empty()) info.version = plan.statistics.version;
  ReplayRecorder recorder = recorder_of(instance, std::move(info));

  const std::size_t makespan = makespan_steps(plan);
  std::vector<ReplayVehicleState> states(order.size());
  for (std::size_t t = 0; t <= makespan; ++t) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      states[i] = state_at(plan.trajectories[order[i]], t, i, plan.statistics.dt);
    }
    recorder.add_frame(static_cast<double>(t) * plan.statistics.dt, states);
  }
  add_figures(plan, violations.size(), recorder);
  for (const Violation& violation : violations) {
    add_event(violation, instance, plan, order, recorder);
  }
  return recorder.finish();
}

Replay replay_of(const Instance& instance, ReplayInfo info) {
  ReplayRecorder recorder = recorder_of(instance, std::move(info));
  std::vector<ReplayVehicleState> states;
  for (const Agent& agent : instance.agents) {
    states.push_back({states.size(), agent.start, 0.0, ReplayState::kWaiting});
  }
  recorder.add_frame(0.0, states);
  recorder.add_figure({"robots", std::to_string(instance.agents.size()), ""});
  return recorder.finish();
}

}  // namespace mvtp
