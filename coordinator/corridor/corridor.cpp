#include "coordinator/corridor/corridor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/audit/audit.hpp"
#include "coordinator/corridor/drivers_path.hpp"
#include "coordinator/corridor/least_curvature.hpp"
#include "coordinator/corridor/reference_path.hpp"
#include "coordinator/network/kerbs.hpp"
#include "coordinator/network/polyline.hpp"

namespace mvtp {
namespace {

constexpr double kAside = 0.05;  ///< [m] of either end of a body that lies along its lane
constexpr double kChangeLateralAccel = 3.0;  ///< [m/s^2] while changing lanes, whatever the limit

/// Of a course what its path depends on.
CorridorCourse ground_of(CorridorCourse course) {
  course.reach = std::max(course.reach, course.end);
  course.handback = course.end = 0.0;
  course.slow_places.clear();
  course.dead_end = course.cramped = false;
  return course;
}

/// Does the body touch ground to keep off?
bool touches(const ReferencePath& path, const Vehicle& body, const DrivableArea& area) {
  for (double s = 0.0; s < path.length(); s += kJudgedEvery) {
    if (area.touches_solid(path.at(s), body)) return true;
  }
  return false;
}

}  // namespace

/// The lanes' centre line and where each piece begins along it [m].
struct CorridorMap::Line {
  std::vector<Point> points;
  std::vector<double> begins;
};

std::optional<double> Corridor::station(int lane, double position, double expected) const {
  std::optional<double> best;
  for (std::size_t i = 0; i < course.pieces.size(); ++i) {
    const CorridorPiece& piece = course.pieces[i];
    if (piece.lane != lane && piece.target != lane) continue;
    const double s = stations[i] + position * scales[i];
    if (!best || std::abs(s - expected) < std::abs(*best - expected)) best = s;
  }
  return best;
}

std::size_t Corridor::piece_at(double s) const {
  const auto next = std::ranges::upper_bound(stations, s);
  return next == stations.begin() ? 0 : std::size_t(next - stations.begin()) - 1;
}

CorridorMap::Shape CorridorMap::shape_of(const Vehicle& body) {
  return {body.front, body.rear, body.width, body.min_turning_radius};
}

int CorridorMap::corridor_for(const CorridorCourse& course, const Vehicle& body) {
  // Bodies of one shape and strength share corridors, whatever their types are called; those that
  // differ in strength alone share the path.
  std::vector<int>& alike = known_[{course, shape_of(body)}];
  for (const int c : alike) {
    const Vehicle& other = library_.body((*this)[c].path);
    if (other.max_accel != body.max_accel || other.max_decel != body.max_decel) continue;
    use(c);
    return c;
  }
  if (alike.empty()) {
    corridors_.push_back(std::make_unique<Corridor>(build(course, body)));
  } else {
    auto corridor = std::make_unique<Corridor>((*this)[alike.front()]);
    corridor->path = library_.add_like(corridor->path, body);
    corridors_.push_back(std::move(corridor));
  }
  used_.push_back(true);
  alike.push_back(size() - 1);
  return alike.back();
}

int CorridorMap::joined(int c, const PathApproach& approach) {
  const ReferencePath& path = library_.path((*this)[c].path);
  const Vehicle body = library_.body((*this)[c].path);
  const Pose first = approach.pose(path, approach.begin());
  std::vector<Point> points;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const double s = double(i) * ReferencePath::kSpacing;
    const double behind = approach.begin() - s;
    const Pose pose = behind > 0.0 ? compose(first, {-behind, 0.0, 0.0}) : approach.pose(path, s);
    points.push_back({pose.x, pose.y});
  }
  auto corridor = std::make_unique<Corridor>((*this)[c]);
  const ReferencePath whole(points);
  corridor->lane_limits.clear();
  corridor->lateral_limits.clear();
  set_limits(whole, body, *corridor);
  corridor->path = library_.add(whole, body, stretches_of(*corridor, body));
  corridors_.push_back(std::move(corridor));
  used_.push_back(true);
  return size() - 1;
}

void CorridorMap::forget_unused() {
  std::vector<int> paths;
  for (int c = 0; c < size(); ++c) {
    if (!used_[std::size_t(c)] && holds(c)) {
      paths.push_back((*this)[c].path);
      corridors_[std::size_t(c)].reset();
    }
  }
  used_.assign(used_.size(), false);
  library_.remove(paths);
  for (auto& [course, alike] : known_) std::erase_if(alike, [&](int c) { return !holds(c); });
  std::erase_if(known_, [](const auto& entry) { return entry.second.empty(); });
  std::erase_if(paths_, [&](const auto& entry) { return !library_.holds(entry.second); });
}

/// Appends a lane of which the other half is another lane.
void append_change(BrokenLine& line, const CorridorPiece& piece, const Lane& from, const Lane& to) {
  const double from_length = length_of(from.shape);
  const double to_length = length_of(to.shape);
  const double scale = from_length / from.length;
  const double middle = std::clamp(0.5 * (piece.begin + piece.end) / from.length, 0.1, 0.9);
  const std::vector<Point> first = stretch_of(from.shape, 0.0, middle * from_length);
  const std::vector<Point> second = stretch_of(to.shape, middle * to_length, to_length);
  const double begin = line.length;
  line.append(first);
  const Point& a = first[first.size() - 2];
  const Point& b = first.back();
  const Point& c = second.front();
  const double left = ((b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x)) / distance(a, b);
  line.jumps.push_back(
      {line.points.size(), left, begin + piece.begin * scale, begin + piece.end * scale});
  line.append(second);
}

CorridorMap::Line CorridorMap::centre_line(const CorridorCourse& course) const {
  BrokenLine whole;
  Line line;
  for (const int l : course.lead_in) whole.append(graph_.lane(l).shape);
  for (const CorridorPiece& piece : course.pieces) {
    line.begins.push_back(whole.length);
    const Lane& lane = graph_.lane(piece.lane);
    if (piece.target == LaneGraph::kNone) {
      whole.append(lane.shape);
    } else {
      append_change(whole, piece, lane, graph_.lane(piece.target));
    }
  }
  const double kept =
      line.begins[std::size_t(course.exit_piece)] + std::max(course.reach, course.end) + 1.0;
  line.points = shortened(without_jumps(whole), whole.length - kept);
  const Lane& first = graph_.lane(course.pieces.front().lane);
  const double scale = course.start > 0.0 ? length_of(first.shape) / first.length : 1.0;
  const double skipped = line.begins.front() + course.start * scale;
  line.points = trimmed(std::move(line.points), skipped);
  for (double& begin : line.begins) begin -= skipped;
  return line;
}

/// The lanes of a course with those beside them in the same direction, and the junctions between.
RoadNetwork CorridorMap::road_along(const CorridorCourse& course) const {
  RoadNetwork road;
  const auto add = [&](int lane) {
    const Lane& l = graph_.lane(lane);
    road.lanes.emplace(l.id, l);
    for (const int k : graph_.links_from(lane)) {
      const Junction& junction = graph_.junction(graph_.link(k).junction);
      road.junctions.emplace(junction.id, junction);
    }
  };
  const auto add_edge = [&](int lane) {
    const int edge = graph_.edge_of(lane);
    if (edge == LaneGraph::kNone) return add(lane);
    for (const int beside : graph_.lanes_of(edge)) add(beside);
  };
  for (const int lane : course.lead_in) add_edge(lane);
  for (const CorridorPiece& piece : course.pieces) add_edge(piece.lane);
  return road;
}

/// Not free is where vehicles change hands.
FreeCourse CorridorMap::free_course(const Line& line, const CorridorCourse& course,
                                    const Vehicle& body) {
  constexpr double kBefore = 7.5;  // [m] the first line
  FreeCourse free;
  for (const int piece : course.lines) free.lines.push_back(line.begins[std::size_t(piece) + 1]);
  const double exit = line.begins[std::size_t(course.exit_piece)];
  free.within = {free.lines.front() - kBefore, exit + body.length() + 1.0 - body.front};
  return free;
}

double CorridorMap::narrowest_lane(const CorridorCourse& course) const {
  double width = std::numeric_limits<double>::infinity();
  for (const CorridorPiece& piece : course.pieces) {
    width = std::min({width, graph_.lane(piece.lane).width, graph_.lane(piece.last_lane()).width});
  }
  return width;
}

ReferencePath CorridorMap::path_along(const Line& line, const CorridorCourse& course,
                                      const Vehicle& body) const {
  if (course.human_driven) return drivers_path(line.points, body);
  // Behind the begin of the first lane there is nobody, where the roads begin, nor beyond their
  // end.
  const bool begins = course.start <= 0.0 && course.lead_in.empty();
  const double from = body.rear + (begins ? line.begins.front() : 0.0);
  const double to = length_of(line.points) - body.front - 1.0;
  const RoadNetwork road = road_along(course);
  const DrivableArea own(road);
  DrivableArea clear_of_kerbs = own;
  std::vector<Polygon> kerbs = kerbs_where_people_wait(road);
  const bool people_walk = !kerbs.empty();
  for (Polygon& kerb : kerbs) clear_of_kerbs.keep_off(std::move(kerb));
  // Round a corner where people walk, nobody comes nearer to it than the lanes do.
  const auto straightest = [&](ReferencePath path, const DrivableArea& kept_to) {
    if (people_walk) return path;
    return straightened(path, {from, to}, free_course(line, course, body), narrowest_lane(course),
                        body, kept_to, area_);
  };
  ReferencePath path = make_reference_path(line.points, from, to, body, clear_of_kerbs, area_);
  // One that keeps off less than all of it is neither the best for people nor for vehicles.
  if (!touches(path, body, clear_of_kerbs)) return straightest(path, clear_of_kerbs);
  path = make_reference_path(line.points, from, to, body, own, area_);
  return straightest(path, own);
}

/// Courses that differ only in where a vehicle is handed back share a path.
Corridor CorridorMap::build(const CorridorCourse& course, const Vehicle& body) {
  const Line line = centre_line(course);
  const auto [known, is_new] = paths_.try_emplace({ground_of(course), shape_of(body)}, 0);
  std::optional<ReferencePath> made;
  if (is_new) made = path_along(line, course, body);
  const ReferencePath& path = is_new ? *made : library_.path(known->second);
  Corridor corridor{.course = course};
  set_stations(line, path, body, corridor);
  set_limits(path, body, corridor);
  if (!course.human_driven) set_drivable(path, body, corridor);
  corridor.path = is_new ? library_.add(*std::move(made), body, stretches_of(corridor, body))
                         : library_.add_like(known->second, body);
  if (is_new) known->second = corridor.path;
  return corridor;
}

/// From each coordinated line until the tail is on the next normal lane.
std::vector<JunctionStretch> CorridorMap::stretches_of(const Corridor& corridor,
                                                       const Vehicle& body) const {
  std::vector<JunctionStretch> stretches;
  const std::vector<CorridorPiece>& pieces = corridor.course.pieces;
  for (const int line : corridor.course.lines) {
    const int approach = pieces[std::size_t(line)].last_lane();
    std::size_t out = std::size_t(line) + 1;
    while (out < pieces.size() && graph_.edge_of(pieces[out].lane) == LaneGraph::kNone) ++out;
    if (out == pieces.size()) continue;
    stretches.push_back({.junction = graph_.junction_behind(graph_.edge_of(approach)),
                         .approach = approach,
                         .from = corridor.stations[std::size_t(line) + 1],
                         .to = corridor.stations[out] + body.length()});
  }
  return stretches;
}

void CorridorMap::set_stations(const Line& line, const ReferencePath& path, const Vehicle& body,
                               Corridor& corridor) const {
  constexpr double kDrift = 8.0;  // [m] that smoothing shifts a place along the path at most
  const CorridorCourse& course = corridor.course;
  const double stretch = path.length() / length_of(line.points);
  double last = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < course.pieces.size(); ++i) {
    const double expected = line.begins[i] * stretch;
    double s = line.begins[i];
    if (line.begins[i] > 0.0) {
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
