#include "tools/export/recording.hpp"

#include <fmt/chrono.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "planner/geometry.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/metrics.hpp"
#include "planner/problem/plan_file.hpp"
#include "tools/view/scene.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

constexpr double kStanding = 0.01;  // [m] driven in a step, below which no steering is seen
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kTimeTolerance = 1e-6;  // [s]

/// The arc that leads from one pose to the other, or nearly so.
Arc arc_between(const Pose& from, const Pose& to) {
  const Pose step = relative(from, to);
  const double half = step.theta / 2.0;
  const double arc_per_chord = std::abs(half) < 1e-6 ? 1.0 : half / std::sin(half);
  const double length = std::copysign(std::hypot(step.x, step.y) * arc_per_chord, step.x);
  const bool is_straight = std::abs(length) < 1e-9 || step.theta == 0.0;  // no curvature of -0
  return {length, is_straight ? 0.0 : step.theta / length};
}

/// A plan's waypoint as a state; plans of other programs lack v and phi.
RecordedState state_at(const Trajectory& trajectory, std::size_t t, double dt) {
  const Waypoint& waypoint = trajectory.at(t);
  const bool moves = t <= trajectory.makespan();
  return {static_cast<double>(t) * dt, waypoint.pose, moves ? waypoint.v : 0.0,
          moves ? waypoint.phi : 0.0};
}

bool lacks_motion(const RecordedVehicle& vehicle) {
  return std::ranges::any_of(vehicle.states, [](const RecordedState& state) {
    return std::isnan(state.v) || std::isnan(state.steer);
  });
}

/// The vehicles of the plan, in its order: those that it records, else those of its instance.
std::vector<Vehicle> vehicles_of(const Plan& plan, const std::optional<Instance>& instance,
                                 const RecordingRequest& request) {
  const std::optional<std::string>& preset = request.reading.vehicle_preset;
  if (!preset && !plan.vehicles.empty()) return plan.vehicles;
  if (instance) {
    std::map<std::string, Vehicle> by_name;
    for (const Agent& agent : instance->agents) by_name[agent.name] = agent.vehicle;
    std::vector<Vehicle> vehicles;
    for (const std::string& name : plan.names) {
      if (!by_name.contains(name)) {
        throw InputError(request.input + ": schedule." + name,
                         "is no agent of the instance; name the instance of this plan");
      }
      vehicles.push_back(by_name[name]);
    }
    return vehicles;
  }
  const auto known = vehicle_preset(preset.value_or(""));
  if (!known) {
    throw InputError(request.input,
                     "does not say what its vehicles are; name its instance with --instance, or "
                     "give --vehicle escot|cl-cbs");
  }
  return std::vector<Vehicle>(plan.names.size(), known->vehicle);
}

Recording read_plan_recording(const RecordingRequest& request) {
  std::optional<Instance> instance;
  if (!request.instance.empty()) instance = read_instance(request.instance, request.reading);
  const double dt = instance ? instance->dt : request.reading.dt.value_or(1.0);
  Plan plan = read_plan(request.input, {.yaw = request.reading.yaw, .dt = dt});
  if (request.reading.dt) plan.statistics.dt = *request.reading.dt;
  Recording recording = recording_of(plan, vehicles_of(plan, instance, request));
  if (instance) recording.scene = scene_of(instance->map);
  recording.name = fs::path(request.input).filename().string();
  return recording;
}

/// The day on which a file was last written, so that the same file gives the same bytes.
std::string date_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) status = {};
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(status.st_mtime));
}

}  // namespace

void fill_in_motion(RecordedVehicle& vehicle) {
  for (std::size_t i = 0; i < vehicle.states.size(); ++i) {
    RecordedState& now = vehicle.states[i];
    if (i == 0) {
      now.v = std::isnan(now.v) ? 0.0 : now.v;
      continue;
    }
    const RecordedState& before = vehicle.states[i - 1];
    const Arc arc = arc_between(before.pose, now.pose);
    const bool stands = std::abs(arc.length) < kStanding;
    if (std::isnan(now.v)) {
      now.v = arc.length / (now.time - before.time);
    } else {
      now.v = std::copysign(now.v, stands ? before.v : arc.length);
    }
    now.steer = stands ? before.steer : std::atan(vehicle.body.wheelbase * arc.curvature);
  }
}

Recording recording_of(const Plan& plan, const std::vector<Vehicle>& vehicles) {
  Recording recording;
  recording.dt = plan.statistics.dt;
  const std::size_t makespan = makespan_steps(plan);
  for (std::size_t i = 0; i < plan.names.size(); ++i) {
    RecordedVehicle vehicle{plan.names[i], "", vehicles[i], {}};
    for (std::size_t t = 0; t <= makespan; ++t) {
      vehicle.states.push_back(state_at(plan.trajectories[i], t, recording.dt));
    }
    if (lacks_motion(vehicle)) {
      for (RecordedState& state : vehicle.states) state = {state.time, state.pose, kUnknown, 0.0};
      fill_in_motion(vehicle);
    }
    recording.vehicles.push_back(std::move(vehicle));
  }
  return recording;
}

Recording read_recording(const RecordingRequest& request) {
  const bool is_run = fs::is_directory(request.input);
  if (is_run && !request.instance.empty()) {
    throw InputError("--instance", "belongs to a plan; " + request.input + " is a folder");
  }
  Recording recording = is_run ? read_run_recording(request.input) : read_plan_recording(request);
  recording.date = date_of(request.input);
  return recording;
}

void cut(Recording& recording, double begin, double end) {
  for (RecordedVehicle& vehicle : recording.vehicles) {
    std::erase_if(vehicle.states, [&](const RecordedState& state) {
      return state.time < begin - kTimeTolerance || state.time > end + kTimeTolerance;
    });
  }
  std::erase_if(recording.vehicles, [](const auto& vehicle) { return vehicle.states.empty(); });
}

void split_stays(Recording& recording) {
  std::vector<RecordedVehicle> stays;
  std::set<std::string> ids;
  for (const RecordedVehicle& vehicle : recording.vehicles) ids.insert(vehicle.id);
  const auto new_id = [&](const std::string& id, int& count) {
    if (++count == 1) return id;
    while (!ids.insert(id + "+" + std::to_string(count)).second) ++count;
    return id + "+" + std::to_string(count);
  };
  for (const RecordedVehicle& vehicle : recording.vehicles) {
    int count = 0;
    for (const RecordedState& state : vehicle.states) {
      const bool goes_on =
          count > 0 && state.time - stays.back().states.back().time < 1.5 * recording.dt;
      if (!goes_on) {
        stays.push_back({new_id(vehicle.id, count), vehicle.kind, vehicle.body, {}});
      }
      stays.back().states.push_back(state);
    }
  }
  recording.vehicles = std::move(stays);
}

}  // namespace mvtp
