#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/audit/audit.hpp"
#include "coordinator/corridor/corridor.hpp"
#include "coordinator/corridor/reference_path.hpp"
#include "coordinator/network/polyline.hpp"

namespace mvtp {
namespace {

constexpr double kChangeLateralAccel = 3.0;  ///< [m/s^2] while changing lanes, whatever the limit

}  // namespace

double CorridorMap::metres_per_metre(int lane) const {
  constexpr double kShort = 1.0;  // [m]: a lane that is only a seam says nothing about its ground
  const double shape = length_of(graph_.lane(lane).shape);
  return shape > kShort ? shape / graph_.lane(lane).length : 1.0;
}

/// The speed at s that keeps to the limit [m/s]. Speeds are looked up at a few places of each
/// decision only: the sharpest bend nearby counts, with a little to spare.
double CorridorMap::lateral_limit(const ReferencePath& path, double s, bool changes_lane) const {
  constexpr double kNearby = 0.75;  // [m]
  constexpr double kSpare = 0.97;
  double most = limits_.max_lateral_accel > 0.0 ? limits_.max_lateral_accel
                                                : std::numeric_limits<double>::infinity();
  if (changes_lane) most = std::min(most, kChangeLateralAccel);
  double sharpest = 1e-9;
  for (double d = -kNearby; d <= kNearby; d += ReferencePath::kSpacing) {
    sharpest = std::max(sharpest, std::abs(path.curvature(s + d)));
  }
  return std::sqrt(kSpare * most / sharpest);
}

/// The speed at s from which the body still comes to the slow places behind its corridor as its
/// driver has to [m/s].
double CorridorMap::limit_before_end(const Corridor& corridor, const Vehicle& body, double s) {
  constexpr double kSpare = 1.0;     // [m]
  constexpr double kReaction = 1.0;  // [s] until the next decision, and of its driver
  constexpr double kLeast = 2.0;     // [m/s]: it has to come to the end of its plan
  const double b = comfortable_braking(body);
  const double lost = b * kReaction;
  double limit = std::numeric_limits<double>::infinity();
  for (const SlowPlace& place : corridor.course.slow_places) {
    const double room = std::max(corridor.s_exit + place.at - kSpare - s, 0.0);
    const double then = place.speed;
    limit = std::min(limit,
                     std::max(then, std::sqrt(lost * lost + then * then + 2.0 * b * room) - lost));
  }
  return std::max(kLeast, limit);
}

/// Drivers take a bend at one speed, which its limit is lowered to; vehicles under control keep to
/// the lateral acceleration that their paths have at each place.
double CorridorMap::lane_limit(const CorridorCourse& course, int lane) const {
  const Lane& there = graph_.lane(lane);
  const bool heeds_bends = limits_.max_lateral_accel > 0.0 && !course.human_driven;
  return heeds_bends ? there.posted_limit.value_or(there.speed_limit) : there.speed_limit;
}

void CorridorMap::set_limits(const ReferencePath& path, const Vehicle& body,
                             Corridor& corridor) const {
  const std::vector<CorridorPiece>& pieces = corridor.course.pieces;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const double s = double(i) * ReferencePath::kSpacing;
    const std::size_t p = corridor.piece_at(s);
    const CorridorPiece& piece = pieces[p];
    const double limit =
        corridor.ratios[p] * std::min(lane_limit(corridor.course, piece.lane),
                                      lane_limit(corridor.course, piece.last_lane()));
    bool changes = false;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (pieces[k].target == LaneGraph::kNone) continue;
      const double front = (s - corridor.stations[k]) / corridor.scales[k];
      changes = changes || (front > pieces[k].begin - 2.0 && front < pieces[k].end + body.length());
    }
    corridor.lane_limits.push_back(limit);
    corridor.lateral_limits.push_back(
        std::min(lateral_limit(path, s, changes), limit_before_end(corridor, body, s)));
  }
}

/// A turn that lies well before the first stop line is left to its driver: it is
/// taken over behind it. Anything later makes the corridor undriven.
void CorridorMap::set_drivable(const ReferencePath& path, const Vehicle& body,
                               Corridor& corridor) const {
  constexpr double kRoom = 20.0;   // [m] that are left before the first line
  constexpr double kAslant = 0.1;  // [m] off its lane: its driver would take it back with a jerk
  if (corridor.course.cramped || corridor.aside > kAslant) {
    corridor.undriven = "there is no room behind the junction to hand it back";
    return;
  }
  double first = body.rear;  // no vehicle is further back at its takeover
  if (corridor.course.start <= 0.0) first = std::max(first, corridor.stations.front());
  if (corridor.course.start <= 0.0 && corridor.course.lead_in.empty()) first += body.length();
  first = std::max(0.0, first);
  for (double s = std::min(corridor.s_handback, path.length()); s >= first; s -= kJudgedEvery) {
    std::string reason = why_not(path, body, s);
    if (reason.empty()) continue;
    corridor.s_drivable = s + kJudgedEvery;
    if (corridor.s_drivable + kRoom > corridor.lines.front()) corridor.undriven = std::move(reason);
    return;
  }
}

std::string CorridorMap::why_not(const ReferencePath& path, const Vehicle& body, double s) const {
  if (std::abs(path.curvature(s)) > body.max_curvature()) {
    return fmt::format("it turns on {:.1f} m, the body needs {:.1f} m",
                       1.0 / std::abs(path.curvature(s)), body.min_turning_radius);
  }
  if (leaves_road(path, s, body, area_)) return "the body would leave the road";
  return {};
}

}  // namespace mvtp
