#include "tools/toio/plan/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "planner/problem/input_error.hpp"
#include "planner/problem/referee_geometry.hpp"
#include "tools/toio/plan/player.hpp"
#include "tools/toio/plan/reference.hpp"

namespace mvtp {
namespace {

constexpr double kStep = 0.01;       // between two looked-at places [s]
constexpr double kSensorRoom = 2.0;  // of the sensor from the edge of the print [dots]
constexpr double kTouch = 0.0002;    // deeper overlaps count [m]
constexpr double kOnPath = 1.0;      // how far a target may be from the path [dots]

/// One robot of the run, its motion, and the room that it takes.
struct Judged {
  const RunRobot* robot;
  Reference reference;
  std::vector<std::vector<referee::Box>> sweeps;  ///< by segment; the last at the goal
};

std::vector<double> times_of(const Reference& reference, double begin, double end) {
  std::vector<double> times;
  const int count = int(std::ceil((end - begin) / kStep));
  for (int n = 0; n < count; ++n) times.push_back(begin + n * kStep);
  times.push_back(std::min(end, reference.end()));
  return times;
}

Judged judged(const ToioRun& run, const RunRobot& robot) {
  Judged result{&robot, Reference(robot, run.desk), {}};
  const Vehicle body = body_of(run.desk.cube, run.desk.facing, run.margins);
  const std::vector<double>& starts = robot.segment_starts;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const double end = k + 1 < starts.size() ? starts[k + 1] : starts[k];
    std::vector<referee::Box> sweep;
    for (const double time : times_of(result.reference, starts[k], end)) {
      const referee::Box box = referee::footprint(body, result.reference.at(time).pose);
      if (!sweep.empty() && sweep.back().center == box.center) continue;  // it waits
      sweep.push_back(box);
    }
    result.sweeps.push_back(std::move(sweep));
  }
  return result;
}

std::optional<std::string> off_mat(const ToioRun& run, const Judged& judged) {
  const Mat& mat = run.desk.mat;
  const Map bounds{.width = mat.width(), .height = mat.height()};
  for (const RunWaypoint& waypoint : judged.robot->waypoints) {
    const Pose pose = judged.reference.at(waypoint.time).pose;
    const Vehicle body = body_of(run.desk.cube, run.desk.facing, run.margins);
    const double inside = referee::margin_inside(bounds, referee::footprint(body, pose));
    if (inside < -kTouch) {
      return fmt::format("{}: its body with margins is {:.1f} mm off the mat at {:.2f} s",
                         judged.robot->id, -inside * 1000, waypoint.time);
    }
    const MatPose sensor = run.desk.sensor(pose);
    const double room = std::min(
        {sensor.x - mat.min_x, mat.max_x - sensor.x, sensor.y - mat.min_y, mat.max_y - sensor.y});
    if (room < kSensorRoom) {
      return fmt::format("{}: its sensor leaves the print of the mat at {:.2f} s", judged.robot->id,
                         waypoint.time);
    }
  }
  return std::nullopt;
}

std::optional<std::string> too_fast(const ToioRun& run, const Judged& judged) {
  const Cube& cube = run.desk.cube;
  const std::vector<RunWaypoint>& waypoints = judged.robot->waypoints;
  double before = 0.0;
  for (std::size_t k = 0; k < waypoints.size(); ++k) {
    const double time = waypoints[k].time;
    const Twist twist = judged.reference.at(time).twist;
    const ExactUnits units = exact_units(cube, run.desk.facing, twist);
    const double fastest = std::max(std::abs(units.left), std::abs(units.right));
    if (fastest > cube.max_unit + 0.5) {
      return fmt::format("{}: a wheel would turn at {:.0f} units at {:.2f} s; the most is {}",
                         judged.robot->id, fastest, time, cube.max_unit);
    }
    // Speeds are means over an interval: short last ones differ by more than the limit allows.
    const double change = std::abs(twist.v - before);
    const double least_time = run.timing.control;
    if (change > 1.25 * run.timing.accel * least_time + 0.002) {
      return fmt::format(
          "{}: its speed changes by {:.0f} mm/s within {:.0f} ms at {:.2f} s; its "
          "acceleration limit is {:.0f} mm/s^2",
          judged.robot->id, change * 1000, least_time * 1000, time, run.timing.accel * 1000);
    }
    before = twist.v;
  }
  return std::nullopt;
}

bool meet(const std::vector<referee::Box>& a, const std::vector<referee::Box>& b) {
  const auto reach = [](const referee::Box& box) {
    return std::hypot(box.half_length, box.half_width);
  };
  for (const referee::Box& p : a) {
    for (const referee::Box& q : b) {
      const double apart = std::hypot(p.center.x - q.center.x, p.center.y - q.center.y);
      if (apart > reach(p) + reach(q)) continue;
      if (referee::separation(p, q) < -kTouch) return true;
    }
  }
  return false;
}

std::optional<std::string> circular(const ToioRun& run, const RunRobot& robot) {
  for (const Requirement& r : robot.requirements) {
    if (r.left < r.segment) continue;
    return fmt::format(
        "{}: segment {} waits for segment {} of {}, which is no earlier: robots "
        "could wait for each other",
        robot.id, r.segment, r.left, run.robots[r.robot].id);
  }
  return std::nullopt;
}

/// Robot j's segments that could meet robot i's although none says so.
std::optional<std::string> forgotten(const Judged& of_i, std::size_t i, const Judged& of_j) {
  const std::size_t last_i = of_i.sweeps.size() - 1;
  std::size_t left = 0;  // segments of i below this one have been left when j begins b
  std::size_t next = 0;
  const std::vector<Requirement>& requirements = of_j.robot->requirements;
  for (std::size_t b = 0; b < std::max(of_i.sweeps.size(), of_j.sweeps.size()); ++b) {
    for (; next < requirements.size() && requirements[next].segment <= b; ++next) {
      if (requirements[next].robot == i) left = std::max(left, requirements[next].left + 1);
    }
    const std::size_t at_j = std::min(b, of_j.sweeps.size() - 1);
    for (std::size_t a = std::min(left, last_i); a <= std::min(b, last_i); ++a) {
      if (at_j < b && a < std::min(b, last_i)) continue;  // j has rested there before
      if (!meet(of_i.sweeps[a], of_j.sweeps[at_j])) continue;
      return fmt::format("{} could meet {}: its segment {} does not wait until segment {} is left",
                         of_j.robot->id, of_i.robot->id, at_j, a);
    }
  }
  return std::nullopt;
}

std::string frame_problem(const RunRobot& robot, const TimedFrame& frame, const std::string& what) {
  return fmt::format("{}: the frame at {:.2f} s ({}) {}", robot.id, frame.time,
                     to_hex(frame.write.bytes), what);
}

/// The speeds of the waypoint from which on the frame is to be sent.
WheelUnits units_at(const RunRobot& robot, double time) {
  const auto after = std::ranges::upper_bound(robot.waypoints, time, {}, &RunWaypoint::time);
  return after == robot.waypoints.begin() ? WheelUnits{} : (after - 1)->units;
}

bool on_path(const ToioRun& run, const Judged& judged, const Target& target) {
  for (const double time : times_of(judged.reference, 0.0, judged.reference.end())) {
    const MatPose mat = run.desk.to_mat(judged.reference.at(time).pose);
    if (std::hypot(mat.x - target.x, mat.y - target.y) <= kOnPath) return true;
  }
  return false;
}

std::optional<std::string> wrong_frame(const ToioRun& run, const Judged& judged) {
  const RunRobot& robot = *judged.robot;
  for (const TimedFrame& frame : robot.frames) {
    const auto command = decode_command(frame.write.to, frame.write.bytes);
    if (!command) return frame_problem(robot, frame, "is no command of a cube");
    std::vector<Target> targets;
    if (const auto* drive_for = std::get_if<DriveFor>(&*command)) {
      if (!(drive_for->speed == units_at(robot, frame.time))) {
        return frame_problem(robot, frame, "turns the wheels otherwise than its waypoint says");
      }
      if (drive_for->tens_of_ms == 0) return frame_problem(robot, frame, "never ends by itself");
    } else if (const auto* one = std::get_if<GoTo>(&*command)) {
      targets = {one->target};
    } else if (const auto* many = std::get_if<GoThrough>(&*command)) {
      targets = many->targets;
    } else {
      return frame_problem(robot, frame, "is none of those that move cubes along a plan");
    }
    for (const Target& target : targets) {
      if (!on_path(run, judged, target)) {
        return frame_problem(robot, frame, "has a target beside the path");
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> find_problems(const ToioRun& run) {
  std::vector<std::string> problems;
  const auto add = [&](const std::optional<std::string>& problem) {
    if (problem) problems.push_back(*problem);
  };
  std::vector<Judged> robots;
  for (const RunRobot& robot : run.robots) robots.push_back(judged(run, robot));
  for (const Judged& robot : robots) {
    add(off_mat(run, robot));
    add(too_fast(run, robot));
    add(circular(run, *robot.robot));
    add(wrong_frame(run, robot));
  }
  for (std::size_t i = 0; i < robots.size(); ++i) {
    for (std::size_t j = 0; j < robots.size(); ++j) {
      if (i != j) add(forgotten(robots[i], i, robots[j]));
    }
  }
  return problems;
}

ToioRun read_drivable_run(const std::string& path, DriveMode mode) {
  ToioRun run = read_run(path);
  require_mode(run, mode, path);
  const std::vector<std::string> problems = find_problems(run);
  if (!problems.empty()) throw InputError(path, problems.front() + "; see mvtp toio check");
  return run;
}

}  // namespace mvtp
