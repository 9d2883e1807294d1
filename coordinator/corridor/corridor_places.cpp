#include <algorithm>
#include <limits>

#include "coordinator/corridor/corridor.hpp"
#include "coordinator/network/polyline.hpp"

namespace mvtp {
namespace {

constexpr double kAside = 0.05;  ///< [m] of either end of a body that lies along its lane

}  // namespace

void CorridorMap::set_stations(const Line& line, const ReferencePath& path, const Vehicle& body,
                               Corridor& corridor) const {
  constexpr double kDrift = 8.0;  // [m] that smoothing shifts a place along the path at most
  const CorridorCourse& course = corridor.course;
  const double stretch = path.length() / length_of(line.points);
  double last = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < course.pieces.size(); ++i) {
    const double expected = line.begins[i] * stretch;
    double s = line.begins[i];
    if (course.human_driven) {
      s -= body.rear;  // see drivers_path()
    } else if (line.begins[i] > 0.0) {
      s = path.project(graph_.lane(course.pieces[i].lane).shape.front(), expected - kDrift,
                       expected + kDrift);
    }
    last = std::max(last + 0.01, s - body.front);
    corridor.stations.push_back(last);
  }
  for (std::size_t i = 0; i < course.pieces.size(); ++i) {
    const bool is_last = i + 1 == course.pieces.size();
    corridor.scales.push_back(is_last ? 1.0
                                      : (corridor.stations[i + 1] - corridor.stations[i]) /
                                            graph_.lane(course.pieces[i].lane).length);
  }
  for (const int piece : course.lines) {
    constexpr double kSwing = 40.0;  // [m] before a line at most
    const double at = corridor.stations[std::size_t(piece) + 1];
    const double first = corridor.lines.empty() ? 0.0 : corridor.lines.back();
    corridor.lines.push_back(at);
    corridor.stops.push_back(last_in_lane(line, path, body, std::max(first, at - kSwing), at));
  }
  for (const CorridorPiece& piece : course.pieces) {
    corridor.ratios.push_back(metres_per_metre(piece.lane));
  }
  const auto exit = std::size_t(course.exit_piece);
  corridor.exit_lane = course.pieces[exit].lane;
  corridor.s_exit = corridor.stations[exit];
  corridor.s_end = corridor.s_exit + course.end;
  const double wanted = corridor.s_exit + course.handback;
  const double earliest = corridor.s_exit + std::min(course.handback, body.length() + 1.0);
  const Lie lie = straight_near(line, path, body, wanted, {earliest, corridor.s_end});
  corridor.s_handback = lie.s;
  corridor.aside = lie.aside;
  corridor.s_latest = straight_until(line, path, body, lie, corridor.s_end);
  // Vehicles come by in steps: there is room to find one of those where the body lies so.
  constexpr double kRoom = 3.0;  // [m]
  while (corridor.s_latest - corridor.s_handback < kRoom && corridor.s_handback - 0.5 > earliest &&
         aside(line, path, body, corridor.s_handback - 0.5) <= kAside) {
    corridor.s_handback -= 0.5;
  }
}

/// How far the ends of the body are off the lanes' centre line [m].
double CorridorMap::aside(const Line& line, const ReferencePath& path, const Vehicle& body,
                          double s) {
  const Pose pose = path.at(s);
  return std::max(distance_to(line.points, compose(pose, {body.front, 0.0, 0.0})),
                  distance_to(line.points, compose(pose, {-body.rear, 0.0, 0.0})));
}

/// The first place from `from` on, or else the last before it, where the body lies along its lane;
/// else the one where it does so best.
CorridorMap::Lie CorridorMap::straight_near(const Line& line, const ReferencePath& path,
                                            const Vehicle& body, double from,
                                            std::pair<double, double> within) {
  Lie best{from, aside(line, path, body, from)};
  const auto look_at = [&](double s) {
    const double here = aside(line, path, body, s);
    if (here < best.aside) best = {s, here};
  };
  for (double s = from; s < within.second && best.aside > kAside; s += 1.0) look_at(s);
  for (double s = from; s > within.first && best.aside > kAside; s -= 1.0) look_at(s);
  return best;
}

/// How far on from `from` the body goes on lying along its lane, or no worse than there.
double CorridorMap::straight_until(const Line& line, const ReferencePath& path, const Vehicle& body,
                                   const Lie& from, double to) {
  constexpr double kStep = 0.5;  // [m]
  const double most = std::max(kAside, from.aside);
  double s = from.s;
  while (s + kStep <= to && aside(line, path, body, s + kStep) <= most) s += kStep;
  return s;
}

/// Where a body that swings aside before a turn, ahead of `to`, is still in its lane.
double CorridorMap::last_in_lane(const Line& line, const ReferencePath& path, const Vehicle& body,
                                 double from, double to) {
  constexpr double kInLane = 0.3;  // [m] of either end: a lorry in a lane of 3.2 m is within it
  double s = to;
  while (s > from && aside(line, path, body, s) > kInLane) s -= 0.5;
  return std::max(s, from);
}

}  // namespace mvtp
