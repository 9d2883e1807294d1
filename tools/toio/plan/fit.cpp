#include "tools/toio/plan/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mvtp {
namespace {

constexpr double kSampling = 0.05;  // between looked-at poses [m of the plan]
constexpr double kMostOverLeast = 1.5;

/// Every pose of every robot, `kSampling` apart.
std::vector<Pose> poses_of(const std::vector<PlannedRobot>& robots) {
  std::vector<Pose> poses;
  for (const PlannedRobot& robot : robots) {
    poses.push_back(robot.start);
    for (const Leg& leg : robot.legs) {
      const int count = std::max(1, int(std::ceil(std::abs(leg.arc.length) / kSampling)));
      for (int k = 1; k <= count; ++k) poses.push_back(leg.at(double(k) / count));
    }
  }
  return poses;
}

struct Box {
  double min_x = std::numeric_limits<double>::infinity();
  double min_y = std::numeric_limits<double>::infinity();
  double max_x = -std::numeric_limits<double>::infinity();
  double max_y = -std::numeric_limits<double>::infinity();

  [[nodiscard]] double width() const { return max_x - min_x; }
  [[nodiscard]] double height() const { return max_y - min_y; }
};

/// What the bodies cover on the desk, with the origin of the plan at (0, 0).
Box extent(const std::vector<Pose>& poses, const Vehicle& body, double scale, int quarter_turns) {
  const PlanFrame frame{scale, quarter_turns, {}};
  Box box;
  for (const Pose& plan : poses) {
    const Pose pose = frame.to_desk(plan);
    for (const double ahead : {body.front, -body.rear}) {
      for (const double left : {body.width / 2, -body.width / 2}) {
        const Pose corner = compose(pose, {ahead, left, 0.0});
        box.min_x = std::min(box.min_x, corner.x);
        box.min_y = std::min(box.min_y, corner.y);
        box.max_x = std::max(box.max_x, corner.x);
        box.max_y = std::max(box.max_y, corner.y);
      }
    }
  }
  return box;
}

bool fits(const Box& box, const Mat& mat) {
  return box.width() <= mat.width() && box.height() <= mat.height();
}

/// The largest scale at which the bodies stay on the mat, up to `highest`; 0 if there is none.
/// What they cover grows with the scale.
double most_scale(const std::vector<Pose>& poses, const Vehicle& body, const Mat& mat,
                  int quarter_turns, double highest) {
  const auto good = [&](double scale) {
    return fits(extent(poses, body, scale, quarter_turns), mat);
  };
  if (!good(0.0)) return 0.0;
  double low = 0.0;
  double high = highest;
  if (good(high)) return high;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (good(middle) ? low : high) = middle;
  }
  return low;
}

/// The scale at which the planned body just covers the cube with its margins.
double least_scale(const std::vector<PlannedRobot>& robots, const Vehicle& body) {
  double scale = 0.0;
  for (const PlannedRobot& robot : robots) {
    const Vehicle& planned = robot.vehicle;
    if (planned.rear <= 0.0) return std::numeric_limits<double>::infinity();
    scale = std::max(
        {scale, body.width / planned.width, body.front / planned.front, body.rear / planned.rear});
  }
  return scale;
}

double fastest(const std::vector<PlannedRobot>& robots, double dt) {
  double speed = 0.0;
  for (const PlannedRobot& robot : robots) {
    for (const Leg& leg : robot.legs) speed = std::max(speed, std::abs(leg.arc.length) / dt);
  }
  return speed;
}

double tightest(const std::vector<PlannedRobot>& robots) {
  double curvature = 0.0;
  for (const PlannedRobot& robot : robots) {
    for (const Leg& leg : robot.legs) {
      curvature = std::max(curvature, std::abs(leg.arc.curvature));
    }
  }
  return curvature;
}

/// What the mats have to hold, without the mat.
struct Need {
  std::vector<Pose> poses;
  Vehicle body;
  double scale = 0.0;  ///< the one asked for, or the least
};

std::string smallest_mat(const Need& need) {
  for (const Mat& mat : known_mats()) {
    for (const int turns : {0, 1}) {
      if (fits(extent(need.poses, need.body, need.scale, turns), mat)) return mat.name;
    }
  }
  return "";
}

std::string too_large(const Fit& fit, const Need& need) {
  return fmt::format(
      "at {:.1f} mm per metre of the plan, the {}, the bodies with their margins cover {:.0f} x "
      "{:.0f} mm; {} has {:.0f} x {:.0f} mm",
      in_mm(need.scale),
      need.scale > fit.least_scale ? "scale asked for" : "least for the true body",
      in_mm(fit.needs_width), in_mm(fit.needs_height), fit.mat.name, in_mm(fit.mat.width()),
      in_mm(fit.mat.height()));
}

/// Puts what the bodies cover into the middle of the mat.
Point centred(const Box& box, const Mat& mat) {
  return {(mat.width() - box.width()) / 2 - box.min_x,
          (mat.height() - box.height()) / 2 - box.min_y};
}

void choose_speed(const std::vector<PlannedRobot>& robots, double dt, const FitOptions& options,
                  Fit& fit) {
  const double planned = fastest(robots, dt) * fit.frame.scale;
  const double curvature = tightest(robots) / fit.frame.scale;
  fit.speedup = planned > 0.0 ? options.speed / planned : 1.0;
  fit.least_speed = least_speed(options.cube, curvature);
  if (fit.problem.empty() && options.speed < fit.least_speed) {
    fit.problem = fmt::format(
        "at {:.0f} mm/s the inner wheel stands in the tightest arc; give "
        "--speed {:.0f} or more",
        in_mm(options.speed), std::ceil(in_mm(fit.least_speed)));
  }
}

}  // namespace

Fit fit_to_mat(const std::vector<PlannedRobot>& robots, double dt, const Mat& mat,
               const FitOptions& options) {
  Fit fit;
  fit.mat = mat;
  const auto least = [&](Facing facing) {
    return least_scale(robots, body_of(options.cube, facing, options.margins));
  };
  const bool tail_first = least(Facing::kTailFirst) < least(Facing::kNoseFirst);
  fit.facing = tail_first ? Facing::kTailFirst : Facing::kNoseFirst;
  fit.least_scale = least(fit.facing);
  if (!std::isfinite(fit.least_scale)) {
    fit.problem =
        "a planned body ends before its rear axle; a cube's body is on both sides of its "
        "wheels at any scale";
    return fit;
  }

  Need need{poses_of(robots), body_of(options.cube, fit.facing, options.margins),
            options.scale.value_or(fit.least_scale)};
  const double highest = options.scale.value_or(kMostOverLeast * fit.least_scale);
  int turns = 0;
  for (const int t : {0, 1}) {
    const double most = most_scale(need.poses, need.body, mat, t, highest);
    if (most > fit.most_scale) {
      fit.most_scale = most;
      turns = t;
    }
  }
  const Box needed = extent(need.poses, need.body, need.scale, turns);
  fit.needs_width = needed.width();
  fit.needs_height = needed.height();
  fit.frame.scale = options.scale.value_or(std::max(fit.most_scale, fit.least_scale));
  fit.frame.quarter_turns = turns;
  fit.frame.origin = centred(extent(need.poses, need.body, fit.frame.scale, turns), mat);
  if (fit.most_scale < need.scale) {
    fit.problem = too_large(fit, need);
    fit.smallest_mat = smallest_mat(need);
  }
  choose_speed(robots, dt, options, fit);
  return fit;
}

}  // namespace mvtp
