#include "tools/report/time_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>

#include "planner/geometry.hpp"
#include "planner/problem/input_error.hpp"
#include "tools/report/marks_on_path.hpp"
#include "tools/view/read_replay.hpp"

namespace mvtp {
namespace {

constexpr double kWindow = 300.0;  // [s]
constexpr double kAside = 8.0;     // [m]: two lanes and a half; farther off it is another road

/// A front bumper at one moment.
struct Front {
  std::size_t frame = 0;
  Pose pose;
  ReplayState state = ReplayState::kCarFollowing;
};

/// One run, unpacked.
struct Run {
  std::string label;
  std::string where;
  std::vector<ReplayVehicle> vehicles;
  ReplayScene scene;
  std::vector<ReplaySignal> signals;
  std::vector<double> times;
  std::vector<std::vector<Front>> fronts;  ///< of each vehicle, in order of time
};

Run unpack(const LabelledReplay& labelled) {
  const Replay& replay = *labelled.replay;
  Run run{labelled.label,
          labelled.where,
          vehicles_of(replay, labelled.where),
          scene_of(replay, labelled.where),
          signals_of(replay, labelled.where),
          {},
          {}};
  const ReplayFrames frames = frames_of(replay, labelled.where);
  run.times = frames.times;
  run.fronts.resize(run.vehicles.size());
  for (std::size_t k = 0; k < frames.states.size(); ++k) {
    for (const ReplayVehicleState& state : frames.states[k]) {
      const Pose front = compose(state.pose, {run.vehicles.at(state.vehicle).front, 0.0, 0.0});
      run.fronts[state.vehicle].push_back({k, front, state.state});
    }
  }
  return run;
}

bool is_of(const ReplayVehicle& vehicle, const std::string& movement) {
  return !vehicle.person && vehicle.movement == movement;
}

/// The movements of a run by how many vehicles they have, most first.
std::vector<std::string> movements_of(const Run& run) {
  std::map<std::string, int> counts;
  for (std::size_t v = 0; v < run.vehicles.size(); ++v) {
    const ReplayVehicle& vehicle = run.vehicles[v];
    if (vehicle.person || vehicle.movement.empty() || run.fronts[v].empty()) continue;
    ++counts[vehicle.movement];
  }
  std::vector<std::string> names;
  for (const auto& [name, count] : counts) names.push_back(name);
  std::ranges::stable_sort(names, std::greater(),
                           [&](const std::string& name) { return counts.at(name); });
  return names;
}

/// @throws InputError if a run has nobody of it.
std::string movement_of(const std::vector<Run>& runs, const std::string& asked) {
  std::string movement = asked;
  for (const Run& run : runs) {
    const std::vector<std::string> names = movements_of(run);
    if (names.empty()) throw InputError(run.where, "has no vehicle; give a longer run");
    if (movement.empty()) movement = names.front();
    if (std::ranges::find(names, movement) != names.end()) continue;
    const auto some = std::span(names).first(std::min<std::size_t>(names.size(), 5));
    throw InputError(run.where, fmt::format("has no vehicle of the movement \"{}\"; those of most "
                                            "vehicles are {}",
                                            movement, fmt::join(some, ", ")));
  }
  return movement;
}

/// The path of the longest trip.
ReferencePath path_of(const std::vector<Run>& runs, const std::string& movement) {
  std::vector<Point> longest;
  double length = 0.0;
  for (const Run& run : runs) {
    for (std::size_t v = 0; v < run.vehicles.size(); ++v) {
      if (!is_of(run.vehicles[v], movement)) continue;
      std::vector<Point> points;
      double own = 0.0;
      for (const Front& front : run.fronts[v]) {
        const Point place{front.pose.x, front.pose.y};
        const double step =
            points.empty() ? 1.0 : std::hypot(place.x - points.back().x, place.y - points.back().y);
        if (step < 0.5) continue;  // stands, or creeps
        own += points.empty() ? 0.0 : step;
        points.push_back(place);
      }
      if (points.size() > 1 && own > length) longest = std::move(points), length = own;
    }
  }
  if (longest.size() < 2) {
    throw InputError(runs.front().where, fmt::format("no vehicle of the movement \"{}\" moves in "
                                                     "it; give a longer run",
                                                     movement));
  }
  return ReferencePath(longest);
}

std::string driver_of(ReplayState state, const ReplayVehicle& vehicle) {
  if (state == ReplayState::kCoordinated || state == ReplayState::kWaiting) return "controlled";
  return vehicle.automated ? "sumo" : "human";
}

/// Makes the lines of a run's vehicles.
class LineMaker {
 public:
  LineMaker(const Run& run, const ReferencePath& path, Stretch time)
      : run_(run), path_(path), time_(time) {
    for (std::size_t i = 0; i < path.samples(); ++i) {
      const Pose& pose = path.sample(i);
      low_ = {std::min(low_.x, pose.x), std::min(low_.y, pose.y)};
      high_ = {std::max(high_.x, pose.x), std::max(high_.y, pose.y)};
    }
  }

  void add(std::size_t vehicle, bool own, std::vector<TimeSpaceLine>& lines) const {
    const Front* last = nullptr;  // the one that the line has reached
    double station = 0.0;
    for (const Front& front : run_.fronts[vehicle]) {
      const double time = run_.times[front.frame];
      if (time < time_.from - 1e-9 || time > time_.to + 1e-9) continue;
      const bool goes_on = last != nullptr && last->frame + 1 == front.frame;
      const auto at = station_of(front.pose, own, goes_on ? std::optional(station) : std::nullopt);
      if (!at) {
        last = nullptr;
        continue;
      }
      station = *at;
      const std::string driver = driver_of(front.state, run_.vehicles[vehicle]);
      if (!goes_on) {
        lines.push_back({driver, {}, {}});
      } else if (lines.back().driver != driver) {
        const TimeSpaceLine& before = lines.back();
        lines.push_back({driver, {before.times.back()}, {before.stations.back()}});
      }
      lines.back().times.push_back(time);
      lines.back().stations.push_back(station);
      last = &front;
    }
  }

 private:
  /// nullopt: it is not on the path.
  [[nodiscard]] std::optional<double> station_of(const Pose& front, bool own,
                                                 std::optional<double> before) const {
    const Point place{front.x, front.y};
    if (place.x < low_.x - kAside || place.x > high_.x + kAside || place.y < low_.y - kAside ||
        place.y > high_.y + kAside) {
      return std::nullopt;
    }
    constexpr double kBack = 5.0;    // [m] from one frame to the next
    constexpr double kAhead = 60.0;  // [m]
    const double s = before ? path_.project(place, *before - kBack, *before + kAhead)
                            : path_.project(place, 0.0, path_.length());
    if (s < -0.5 || s > path_.length() + 0.5) return std::nullopt;
    const Pose seen = relative(path_.at(s), front);
    // Others count while they are in the same lane.
    const double aside = own ? kAside : 1.2;
    const double turned = own ? std::numbers::pi : std::numbers::pi / 8.0;
    if (std::abs(seen.y) > aside || std::abs(seen.theta) > turned) return std::nullopt;
    return s;
  }

  const Run& run_;
  const ReferencePath& path_;
  Stretch time_;
  Point low_{1e12, 1e12};
  Point high_{-1e12, -1e12};
};

TimeSpacePanel panel_of(const Run& run, const ReferencePath& path,
                        const TimeSpaceDiagram& diagram) {
  TimeSpacePanel panel;
  panel.label = run.label;
  panel.signals = signals_on(path, run.scene, run.signals, diagram.time);
  panel.zones = zones_on(path, run.scene.corridors);
  const LineMaker maker(run, path, diagram.time);
  for (std::size_t v = 0; v < run.vehicles.size(); ++v) {
    if (run.vehicles[v].person) continue;
    const bool own = is_of(run.vehicles[v], diagram.movement);
    maker.add(v, own, own ? panel.lines : panel.others);
  }
  const auto is_point = [](const TimeSpaceLine& line) { return line.times.size() < 2; };
  std::erase_if(panel.lines, is_point);
  std::erase_if(panel.others, is_point);
  return panel;
}

Stretch window_of(const std::vector<Run>& runs, const TimeSpaceRequest& request) {
  double first = runs.front().times.front();
  double last = runs.front().times.back();
  for (const Run& run : runs) {
    first = std::min(first, run.times.front());
    last = std::max(last, run.times.back());
  }
  const double begin = request.begin.value_or(first);
  const double end = request.end.value_or(std::min(begin + kWindow, last));
  if (begin >= std::min(end, last)) {
    throw InputError("--begin",
                     fmt::format("is {:g}; give a time before {:g} s, where {} ends", begin,
                                 std::min(end, last), end < last ? "the diagram" : "the last run"));
  }
  return {begin, std::min(end, last)};
}

}  // namespace

TimeSpaceDiagram time_space_of(std::span<const LabelledReplay> replays,
                               const TimeSpaceRequest& request) {
  std::vector<Run> runs;
  for (const LabelledReplay& replay : replays) {
    runs.push_back(unpack(replay));
    if (runs.back().times.size() < 2) throw InputError(replay.where, "has less than two frames");
  }
  TimeSpaceDiagram diagram;
  diagram.movement = movement_of(runs, request.movement);
  diagram.time = window_of(runs, request);
  const ReferencePath path = path_of(runs, diagram.movement);
  diagram.length = path.length();
  for (const Run& run : runs) diagram.panels.push_back(panel_of(run, path, diagram));
  diagram.stop_lines = stop_lines_on(path, runs.front().scene);
  diagram.junctions = junctions_on(path, runs.front().scene);
  return diagram;
}

}  // namespace mvtp
