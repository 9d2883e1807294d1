#include "tools/toio/plan/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/toio/plan/frames.hpp"
#include "tools/toio/plan/reference.hpp"
#include "tools/toio/plan/release_graph.hpp"

namespace mvtp {
namespace {

constexpr double kFinestSegment = 0.03;  // no finer cut helps cubes that are moved every 50 ms [s]

/// Colours that are told apart on a cube's lamp.
constexpr std::array<std::array<std::uint8_t, 3>, 8> kColours = {{{255, 0, 0},
                                                                  {0, 255, 0},
                                                                  {0, 0, 255},
                                                                  {255, 160, 0},
                                                                  {0, 255, 255},
                                                                  {255, 0, 255},
                                                                  {255, 255, 255},
                                                                  {120, 255, 0}}};

// What is written is rounded before it is used, so that whoever reads the file sees the same.
double to_places(double value, double per_unit) { return std::round(value * per_unit) / per_unit; }

MatPose rounded_for_file(const MatPose& pose) {
  double degrees = to_places(pose.degrees, 1e3);
  if (degrees >= 360.0) degrees -= 360.0;
  return {to_places(pose.x, 1e3), to_places(pose.y, 1e3), degrees};
}

double file_time(double time) { return to_places(time, 1e4); }

std::vector<RunWaypoint> waypoints_of(const std::vector<MotionSample>& samples,
                                      const DeskFrame& desk, double period) {
  std::vector<RunWaypoint> waypoints;
  const double end = samples.back().time;
  for (int k = 0;; ++k) {
    const double time = file_time(std::min(k * period, end));
    const MotionSample sample = at_time(samples, time);
    waypoints.push_back({time, rounded_for_file(desk.to_mat(sample.pose)), sample.direction, {}});
    // A last interval of no length would have no speed.
    if (k * period >= end - 1e-3) break;
  }
  waypoints.back().direction = 0;
  return waypoints;
}

/// When the segments begin; the motion ends with its last whole or partial segment.
std::vector<double> segment_starts(const std::vector<MotionSample>& samples, double segment,
                                   double end) {
  std::vector<double> starts = {0.0};
  const double plan_end = samples.back().plan_time;
  for (int k = 1; double(k) * segment < plan_end - 1e-9; ++k) {
    starts.push_back(std::min(file_time(time_of(samples, k * segment)), end));
  }
  if (plan_end > 0.0) starts.push_back(end);
  return starts;
}

RunRobot robot_of(const ToioRun& run, const PlannedRobot& planned, double dt,
                  std::vector<MotionSample>& samples) {
  const Pace pace{run.timing.speedup, run.timing.accel, run.desk.cube};
  samples = retime(to_desk(run.frame, planned.legs), run.frame.to_desk(planned.start), dt, pace);
  RunRobot robot;
  robot.id = planned.name;
  robot.waypoints = waypoints_of(samples, run.desk, run.timing.control);
  const Reference reference(robot, run.desk);
  for (RunWaypoint& waypoint : robot.waypoints) {
    waypoint.units = wheel_units(run.desk.cube, run.desk.facing, reference.at(waypoint.time).twist);
  }
  return robot;
}

std::vector<Reference> references_of(const ToioRun& run) {
  std::vector<Reference> references;
  for (const RunRobot& robot : run.robots) references.emplace_back(robot, run.desk);
  return references;
}

/// Cuts the motions into segments, finer ones where robots pass close to each other.
std::string release(const std::vector<std::vector<MotionSample>>& motions, double segment,
                    ToioRun& run) {
  const Vehicle body = body_of(run.desk.cube, run.desk.facing, run.margins);
  while (true) {
    std::vector<std::vector<SegmentSweep>> sweeps;
    for (std::size_t i = 0; i < run.robots.size(); ++i) {
      RunRobot& robot = run.robots[i];
      robot.segment_starts = segment_starts(motions[i], segment, robot.waypoints.back().time);
      sweeps.push_back(sweeps_of(Reference(robot, run.desk), body));
    }
    run.timing.segment = segment;
    std::variant<ReleaseGraph, SweepConflict> built = build_release_graph(sweeps);
    if (ReleaseGraph* graph = std::get_if<ReleaseGraph>(&built)) {
      for (std::size_t i = 0; i < run.robots.size(); ++i) {
        run.robots[i].requirements = std::move((*graph)[i]);
      }
      return "";
    }
    segment /= 2;
    if (segment / run.timing.speedup >= kFinestSegment) continue;
    const auto conflict = std::get<SweepConflict>(built);
    return fmt::format(
        "{} and {} come closer than their margins of {:.1f} mm beside and {:.1f} mm ahead and "
        "behind {:.1f} s into the plan; give a larger --scale, smaller margins, or plan with "
        "larger bodies",
        run.robots[conflict.a].id, run.robots[conflict.b].id, run.margins.lateral * 1000,
        run.margins.along * 1000, double(conflict.segment) * segment * 2);
  }
}

}  // namespace

Exported make_run(const std::vector<PlannedRobot>& robots, double dt, const Fit& fit,
                  const FitOptions& fit_options, const ExportOptions& options) {
  Exported exported;
  ToioRun& run = exported.run;
  run.desk = {fit.mat, fit_options.cube, fit.facing};
  run.frame = fit.frame;
  run.timing.speedup = fit.speedup;
  run.timing.accel = fit_options.accel;
  run.margins = fit_options.margins;
  run.mode = options.mode;
  std::vector<std::vector<MotionSample>> motions(robots.size());
  for (std::size_t i = 0; i < robots.size(); ++i) {
    run.robots.push_back(robot_of(run, robots[i], dt, motions[i]));
    run.robots.back().color = kColours[i % kColours.size()];
    if (!options.cubes.empty()) run.robots.back().cube = options.cubes[i];
  }
  run.clearance = to_places(least_clearance(run), 1e5);
  exported.problem = release(motions, options.segment, run);
  for (RunRobot& robot : run.robots) robot.frames = open_loop_frames(run, robot, options.mtu);
  return exported;
}

double least_clearance(const ToioRun& run) {
  constexpr double kStep = 0.01;  // [s]
  const Vehicle body = body_of(run.desk.cube, run.desk.facing, {0.0, 0.0});
  const std::vector<Reference> references = references_of(run);
  double end = 0.0;
  for (const Reference& reference : references) end = std::max(end, reference.end());
  double least = std::numeric_limits<double>::infinity();
  for (double time = 0.0; time < end + kStep; time += kStep) {
    std::vector<OrientedBox> boxes;
    for (const Reference& r : references) boxes.push_back(footprint(body, r.at(time).pose));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = i + 1; j < boxes.size(); ++j) {
        least = std::min(least, separation(boxes[i], boxes[j]));
      }
    }
  }
  return std::isfinite(least) ? least : 0.0;
}

}  // namespace mvtp
