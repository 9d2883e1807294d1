#include "tools/toio/plan/frames.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kListSpacing = 0.025;  // of the targets of a list [m]
constexpr double kLookStep = 0.01;      // [s]
constexpr std::uint8_t kTargetTimeout = 5;
constexpr std::uint8_t kListTimeout = 20;

std::uint16_t whole_dots(double dots) {
  return static_cast<std::uint16_t>(std::clamp(std::lround(dots), 0L, 65534L));
}

Target target_at(const DeskFrame& desk, const Pose& pose, bool last) {
  const MatPose mat = rounded(desk.to_mat(pose));
  if (!last) return {whole_dots(mat.x), whole_dots(mat.y), AngleRule::kAny, 0};
  return {whole_dots(mat.x), whole_dots(mat.y), AngleRule::kShorter,
          static_cast<std::uint16_t>(mat.degrees)};
}

/// Cruising speed of the run in units, as the largest speed of a target command.
std::uint8_t cruise_units(const ToioRun& run) {
  int units = 10;
  for (const RunRobot& robot : run.robots) {
    for (const RunWaypoint& waypoint : robot.waypoints) {
      units = std::max({units, std::abs(waypoint.units.left), std::abs(waypoint.units.right)});
    }
  }
  return static_cast<std::uint8_t>(std::min(units, 255));
}

/// The time from `time` on at which the reference has made driven `ahead` more, not past `limit`.
double time_ahead(const Reference& reference, double time, double limit, double ahead) {
  const double arc = reference.at(time).arc;
  double t = time;
  while (t < limit && reference.at(t).arc < arc + ahead) t += kLookStep;
  return std::min(t, limit);
}

std::vector<TimedFrame> track_frames(const ToioRun& run, const RunRobot& robot,
                                     const Reference& reference) {
  std::vector<TimedFrame> frames;
  for (const RunWaypoint& waypoint : robot.waypoints) {
    frames.push_back({waypoint.time, track_frame(run, reference.at(waypoint.time).twist)});
  }
  return frames;
}

std::vector<TimedFrame> target_frames(const ToioRun& run, const Reference& reference) {
  std::vector<TimedFrame> frames;
  for (int k = 0; double(k) * kTargetPeriod < reference.end(); ++k) {
    const double time = k * kTargetPeriod;
    frames.push_back({time, target_frame(run, reference, time, reference.end(), kTargetAhead)});
  }
  return frames;
}

std::vector<TimedFrame> list_frames(const ToioRun& run, const Reference& reference, int mtu) {
  constexpr int kHeader = 3 + 8;  // of the write, and of the command
  const auto most =
      std::clamp<std::size_t>(std::size_t(std::max(0, mtu - kHeader)) / 6, 1, kMaxTargets);
  std::vector<TimedFrame> frames;
  GoThrough list{.mode = {.timeout_s = kListTimeout, .max_speed = cruise_units(run)}};
  double begin = 0.0;           // when the list being filled begins to be driven
  double previous_begin = 0.0;  // and the one before it
  for (double t = 0.0; t < reference.end();) {
    t = time_ahead(reference, t, reference.next_cusp(t + kLookStep), kListSpacing);
    const bool last = t >= reference.end();
    list.targets.push_back(target_at(run.desk, reference.at(t).pose, last));
    if (!last && list.targets.size() < most) continue;
    // A cube keeps one list beside the one that it drives: each is sent as the one before begins.
    frames.push_back({std::round(previous_begin * 1e4) / 1e4, encode(list)});
    previous_begin = begin;
    begin = t;
    list.append = true;
    list.mode.id = static_cast<std::uint8_t>(list.mode.id + 1);
    list.targets.clear();
  }
  return frames;
}

}  // namespace

Write track_frame(const ToioRun& run, const Twist& twist) {
  const auto tens =
      static_cast<std::uint8_t>(std::clamp(std::lround(run.timing.dead_man * 100.0), 1L, 255L));
  return encode(DriveFor{wheel_units(run.desk.cube, run.desk.facing, twist), tens});
}

Write target_frame(const ToioRun& run, const Reference& reference, double time, double limit,
                   double ahead) {
  const double end = std::min(limit, reference.next_cusp(time + kLookStep));
  const double aim = time_ahead(reference, time, end, ahead);
  return encode(GoTo{{.timeout_s = kTargetTimeout, .max_speed = cruise_units(run)},
                     target_at(run.desk, reference.at(aim).pose, aim >= reference.end())});
}

std::vector<TimedFrame> open_loop_frames(const ToioRun& run, const RunRobot& robot, int mtu) {
  const Reference reference(robot, run.desk);
  switch (run.mode) {
    case DriveMode::kTrack:
      return track_frames(run, robot, reference);
    case DriveMode::kTarget:
      return target_frames(run, reference);
    case DriveMode::kList:
      return list_frames(run, reference, mtu);
  }
  return {};
}

}  // namespace mvtp
