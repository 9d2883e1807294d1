#include "tools/toio/plan/run_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "planner/problem/document.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"

namespace mvtp {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxBytes = 200'000'000;
constexpr double kLongestRun = 3600.0;  // [s]

/// Millimetres without the noise of the last digits.
double mm(double metres) { return std::round(metres * 1e9) / 1e6; }

/// Where the origin of the plan lies, in dots.
Json origin_dots(const ToioRun& run) {
  const Mat& mat = run.desk.mat;
  return {mat.min_x + run.frame.origin.x / mat.metres_per_dot,
          mat.max_y - run.frame.origin.y / mat.metres_per_dot};
}

Json header(const ToioRun& run) {
  const Mat& mat = run.desk.mat;
  const Cube& cube = run.desk.cube;
  const bool tail_first = run.desk.facing == Facing::kTailFirst;
  return {{"format", "toio-run"},
          {"version", 1},
          {"mat",
           {{"name", mat.name},
            {"range", {mat.min_x, mat.min_y, mat.max_x, mat.max_y}},
            {"mm_per_dot", mm(mat.metres_per_dot)}}},
          {"transform",
           {{"dots_per_m", run.frame.scale / mat.metres_per_dot},
            {"origin_plan", {0, 0}},
            {"origin_dots", origin_dots(run)},
            {"quarter_turns", run.frame.quarter_turns},
            {"heading_offset_deg", tail_first ? 180 : 0}}},
          {"cube",
           {{"front_mm", mm(cube.front)},
            {"rear_mm", mm(cube.rear)},
            {"width_mm", mm(cube.width)},
            {"track_mm", mm(cube.track)},
            {"center_to_axle_mm", mm(cube.center_to_axle)},
            {"mm_s_per_unit", mm(cube.speed_per_unit)},
            {"dead_zone", cube.dead_zone},
            {"max_unit", cube.max_unit}}},
          {"timing",
           {{"speedup", run.timing.speedup},
            {"control_ms", mm(run.timing.control)},
            {"deadman_ms", mm(run.timing.dead_man)},
            {"accel_mm_s2", mm(run.timing.accel)},
            {"segment_s", run.timing.segment}}},
          {"margins",
           {{"lateral_mm", mm(run.margins.lateral)},
            {"along_mm", mm(run.margins.along)},
            {"clearance_least_mm", mm(run.clearance)}}},
          {"mode", to_string(run.mode)}};
}

Json robot_json(const ToioRun& run, const RunRobot& robot) {
  Json waypoints = Json::array();
  std::size_t segment = 0;
  for (const RunWaypoint& w : robot.waypoints) {
    while (segment + 1 < robot.segment_starts.size() &&
           robot.segment_starts[segment + 1] <= w.time) {
      ++segment;
    }
    waypoints.push_back({{"t", w.time},
                         {"x", w.pose.x},
                         {"y", w.pose.y},
                         {"deg", w.pose.degrees},
                         {"dir", w.direction},
                         {"units", {w.units.left, w.units.right}},
                         {"segment", segment}});
  }
  Json requirements = Json::array();
  for (const Requirement& r : robot.requirements) {
    requirements.push_back(
        {{"segment", r.segment}, {"robot", run.robots[r.robot].id}, {"left_segment", r.left}});
  }
  Json frames = Json::array();
  for (const TimedFrame& frame : robot.frames) {
    frames.push_back({{"t", frame.time}, {"hex", to_hex(frame.write.bytes)}});
  }
  return {{"id", robot.id},           {"cube", robot.cube},
          {"color", robot.color},     {"segment_starts", robot.segment_starts},
          {"requires", requirements}, {"waypoints", waypoints},
          {"frames", frames}};
}

/// One element per line: readable, and small.
std::string lines(const std::string& key, const Json& list, const char* indent) {
  std::string text = fmt::format("{}\"{}\": [", indent, key);
  for (std::size_t i = 0; i < list.size(); ++i) {
    text += fmt::format("{}\n{} {}", i == 0 ? "" : ",", indent, list[i].dump());
  }
  return text + "]";
}

double number_between(const Value& value, double low, double high, std::string_view unit) {
  const double number = value.number(unit);
  if (number >= low && number <= high) return number;
  throw InputError(value.where(), fmt::format("is {}{}{}; give a number from {} to {}", number,
                                              unit.empty() ? "" : " ", unit, low, high));
}

int whole_between(const Value& value, int low, int high) {
  const double number = number_between(value, low, high, "");
  if (number == double(int(number))) return int(number);
  throw InputError(value.where(), fmt::format("is {}; give a whole number", number));
}

/// A value in thousandths of our unit.
double from_milli(const Value& map, std::string_view key, double low, double high,
                  std::string_view unit = "mm") {
  return number_between(map.at(key), low, high, unit) / 1000.0;
}

Mat mat_of(const Value& value) {
  value.require_map("{name: simple, range: [98, 142, 402, 358], mm_per_dot: 1.3625}");
  const Value range = value.at("range");
  range.require_list(4, 4, "[98, 142, 402, 358]");
  Mat mat{value.at("name").text(),           whole_between(range[0], 0, 65534),
          whole_between(range[1], 0, 65534), whole_between(range[2], 0, 65534),
          whole_between(range[3], 0, 65534), from_milli(value, "mm_per_dot", 0.5, 5.0)};
  if (mat.max_x > mat.min_x && mat.max_y > mat.min_y) return mat;
  throw InputError(range.where(), "is empty; give [least x, least y, largest x, largest y]");
}

void read_transform(const Value& value, ToioRun& run) {
  value.require_map("{dots_per_m: 16, origin_dots: [50, 440], quarter_turns: 0}");
  const Mat& mat = run.desk.mat;
  run.frame.scale = number_between(value.at("dots_per_m"), 0.1, 1e4, "dots/m") * mat.metres_per_dot;
  run.frame.quarter_turns = whole_between(value.at("quarter_turns"), 0, 3);
  const Value origin = value.at("origin_dots");
  origin.require_list(2, 2, "[50, 440]");
  run.frame.origin = {(origin[0].number("dots") - mat.min_x) * mat.metres_per_dot,
                      (mat.max_y - origin[1].number("dots")) * mat.metres_per_dot};
  const int offset = whole_between(value.at("heading_offset_deg"), 0, 180);
  if (offset != 0 && offset != 180) {
    throw InputError(value.at("heading_offset_deg").where(),
                     fmt::format("is {}; choose 0 (nose first) or 180 (tail first)", offset));
  }
  run.desk.facing = offset == 180 ? Facing::kTailFirst : Facing::kNoseFirst;
}

Cube cube_of(const Value& value) {
  value.require_map("{front_mm: 12.1, rear_mm: 19.7, width_mm: 31.8}");
  Cube cube;
  cube.front = from_milli(value, "front_mm", 1, 100);
  cube.rear = from_milli(value, "rear_mm", 1, 100);
  cube.width = from_milli(value, "width_mm", 1, 100);
  cube.track = from_milli(value, "track_mm", 1, 100);
  cube.center_to_axle = from_milli(value, "center_to_axle_mm", -20, 20);
  cube.speed_per_unit = from_milli(value, "mm_s_per_unit", 0.1, 20, "mm/s");
  cube.dead_zone = whole_between(value.at("dead_zone"), 0, 100);
  cube.max_unit = whole_between(value.at("max_unit"), 1, 255);
  return cube;
}

RunTiming timing_of(const Value& value) {
  value.require_map("{speedup: 2.5, control_ms: 50}");
  RunTiming timing;
  timing.speedup = number_between(value.at("speedup"), 1e-3, 1e4, "times");
  timing.control = from_milli(value, "control_ms", 45, 1000, "ms");
  timing.dead_man = from_milli(value, "deadman_ms", 50, 2550, "ms");
  timing.accel = from_milli(value, "accel_mm_s2", 1, 10000, "mm/s^2");
  timing.segment = number_between(value.at("segment_s"), 1e-4, 1e4, "s");
  return timing;
}

DriveMode mode_of(const Value& value) {
  for (const DriveMode mode : {DriveMode::kTrack, DriveMode::kTarget, DriveMode::kList}) {
    if (value.text() == to_string(mode)) return mode;
  }
  throw InputError(value.where(),
                   fmt::format("is \"{}\"; choose track, target or list", value.text()));
}

std::vector<RunWaypoint> waypoints_of(const Value& list) {
  list.require_list(1, 1'000'000, "[{t: 0, x: 120, y: 200, deg: 90}]");
  std::vector<RunWaypoint> waypoints;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Value entry = list[i];
    entry.require_map("{t: 0, x: 120, y: 200, deg: 90}");
    RunWaypoint w;
    w.time = number_between(entry.at("t"), 0, kLongestRun, "s");
    w.pose = {number_between(entry.at("x"), -65535, 65535, "dots"),
              number_between(entry.at("y"), -65535, 65535, "dots"),
              number_between(entry.at("deg"), 0, 360, "degrees")};
    w.direction = whole_between(entry.at("dir"), -1, 1);
    const Value units = entry.at("units");
    units.require_list(2, 2, "[19, 22]");
    w.units = {whole_between(units[0], -255, 255), whole_between(units[1], -255, 255)};
    if (i > 0 && w.time <= waypoints.back().time) {
      throw InputError(entry.at("t").where(), fmt::format("is {} s after {} s; times must rise",
                                                          w.time, waypoints.back().time));
    }
    waypoints.push_back(w);
  }
  return waypoints;
}

std::vector<double> segment_starts_of(const Value& list, double end) {
  list.require_list(1, 1'000'000, "[0, 0.25, 0.5]");
  std::vector<double> starts;
  for (std::size_t i = 0; i < list.size(); ++i) {
    starts.push_back(number_between(list[i], starts.empty() ? 0.0 : starts.back(), end, "s"));
  }
  return starts;
}

std::vector<TimedFrame> frames_of(const Value& list) {
  list.require_list(0, 1'000'000, "[{t: 0, hex: 01 01 01 00 02 01 00}]");
  std::vector<TimedFrame> frames;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Value hex = list[i].at("hex");
    const std::optional<Bytes> bytes = from_hex(hex.text());
    if (!bytes) {
      throw InputError(hex.where(), "is no list of bytes; give e.g. 01 01 01 00 02 01 00");
    }
    frames.push_back(
        {number_between(list[i].at("t"), 0, kLongestRun, "s"), {Characteristic::kMotor, *bytes}});
  }
  return frames;
}

RunRobot robot_of(const Value& value) {
  value.require_map("{id: agent0, waypoints: [...]}");
  RunRobot robot;
  robot.id = value.at("id").text();
  if (const auto cube = value.find("cube"); cube && cube->kind() == Value::Kind::kScalar) {
    robot.cube = cube->text();
  }
  const Value color = value.at("color");
  color.require_list(3, 3, "[255, 0, 0]");
  for (std::size_t c = 0; c < 3; ++c) {
    robot.color[c] = static_cast<std::uint8_t>(whole_between(color[c], 0, 255));
  }
  robot.waypoints = waypoints_of(value.at("waypoints"));
  robot.segment_starts = segment_starts_of(value.at("segment_starts"), robot.waypoints.back().time);
  robot.frames = frames_of(value.at("frames"));
  return robot;
}

std::size_t robot_named(const ToioRun& run, const Value& name) {
  for (std::size_t i = 0; i < run.robots.size(); ++i) {
    if (run.robots[i].id == name.text()) return i;
  }
  throw InputError(name.where(), fmt::format("is \"{}\"; no robot has this id", name.text()));
}

/// A number of a segment of `robot` that is begun, or left.
std::size_t segment_of(const Value& value, const RunRobot& robot) {
  return std::size_t(whole_between(value, 0, int(robot.segment_starts.size()) - 1));
}

void read_requirements(const Value& list, ToioRun& run, std::size_t robot) {
  list.require_list(0, 1'000'000, "[{segment: 7, robot: agent3, left_segment: 5}]");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Value entry = list[i];
    Requirement r;
    r.robot = robot_named(run, entry.at("robot"));
    r.segment = segment_of(entry.at("segment"), run.robots[robot]);
    r.left = segment_of(entry.at("left_segment"), run.robots[r.robot]);
    if (r.left + 1 >= run.robots[r.robot].segment_starts.size()) {
      throw InputError(entry.at("left_segment").where(),
                       fmt::format("is {}, the rest at the goal, which is never left", r.left));
    }
    const std::vector<Requirement>& before = run.robots[robot].requirements;
    if (!before.empty() && before.back().segment > r.segment) {
      throw InputError(entry.where(), "is out of order; sort them by segment");
    }
    run.robots[robot].requirements.push_back(r);
  }
}

/// Robots go by their ids, and cubes by their names.
void require_distinct(const Value& robots, const ToioRun& run) {
  for (std::size_t i = 0; i < run.robots.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool same_id = run.robots[i].id == run.robots[j].id;
      const std::string& cube = run.robots[i].cube;
      if (!same_id && (cube.empty() || cube != run.robots[j].cube)) continue;
      throw InputError(robots[i].at(same_id ? "id" : "cube").where(),
                       fmt::format("is \"{}\", as robots[{}]'s; give each robot its own",
                                   same_id ? run.robots[i].id : cube, j));
    }
  }
}

}  // namespace

const char* to_string(DriveMode mode) {
  switch (mode) {
    case DriveMode::kTrack:
      return "track";
    case DriveMode::kTarget:
      return "target";
    case DriveMode::kList:
      return "list";
  }
  return "";
}

std::string to_json(const ToioRun& run) {
  std::string text = "{\n";
  const Json head = header(run);
  for (const auto& [key, value] : head.items()) {
    text += fmt::format(" \"{}\": {},\n", key, value.dump());
  }
  text += " \"robots\": [";
  for (std::size_t i = 0; i < run.robots.size(); ++i) {
    const Json robot = robot_json(run, run.robots[i]);
    text += i == 0 ? "\n  {" : ",\n  {";
    for (const char* key : {"id", "cube", "color", "segment_starts"}) {
      text += fmt::format("\"{}\": {},\n   ", key, robot[key].dump());
    }
    text += lines("requires", robot["requires"], "") + ",\n";
    text += lines("waypoints", robot["waypoints"], "   ") + ",\n";
    text += lines("frames", robot["frames"], "   ") + "}";
  }
  return text + "]\n}\n";
}

std::string to_csv(const ToioRun& run) {
  std::string text = "t_ms,robot,characteristic,hex\n";
  for (const RunRobot& robot : run.robots) {
    for (const TimedFrame& frame : robot.frames) {
      text += fmt::format("{:.0f},{},{},{}\n", frame.time * 1000.0, csv_field(robot.id),
                          to_string(frame.write.to), to_hex(frame.write.bytes));
    }
  }
  return text;
}

ToioRun read_run(const std::string& path) {
  const Document document =
      Document::parse(path, read_text_file(path, kMaxBytes), {"toio-run"}, "a run file");
  const Value root = document.root();
  root.require_map("{\"format\": \"toio-run\", ...}");
  if (whole_between(root.at("version"), 0, 1'000'000) != 1) {
    throw InputError(root.at("version").where(), "is not 1; export the plan again");
  }
  ToioRun run;
  run.desk.mat = mat_of(root.at("mat"));
  read_transform(root.at("transform"), run);
  run.desk.cube = cube_of(root.at("cube"));
  run.timing = timing_of(root.at("timing"));
  const Value margins = root.at("margins");
  run.margins = {from_milli(margins, "lateral_mm", 0, 1000),
                 from_milli(margins, "along_mm", 0, 1000)};
  run.clearance = from_milli(margins, "clearance_least_mm", -1e6, 1e6);
  run.mode = mode_of(root.at("mode"));
  const Value robots = root.at("robots");
  robots.require_list(1, 100, "[{id: agent0, waypoints: [...]}]");
  for (std::size_t i = 0; i < robots.size(); ++i) run.robots.push_back(robot_of(robots[i]));
  require_distinct(robots, run);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    read_requirements(robots[i].at("requires"), run, i);
  }
  return run;
}

}  // namespace mvtp
