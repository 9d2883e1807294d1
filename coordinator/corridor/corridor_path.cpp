#include <algorithm>
#include <limits>

#include "coordinator/audit/audit.hpp"
#include "coordinator/corridor/corridor.hpp"
#include "coordinator/corridor/drivers_path.hpp"
#include "coordinator/corridor/least_curvature.hpp"
#include "coordinator/corridor/reference_path.hpp"
#include "coordinator/network/kerbs.hpp"
#include "coordinator/network/polyline.hpp"

namespace mvtp {
namespace {

/// Does the body touch ground to keep off?
bool touches(const ReferencePath& path, const Vehicle& body, const DrivableArea& area) {
  for (double s = 0.0; s < path.length(); s += kJudgedEvery) {
    if (area.touches_solid(path.at(s), body)) return true;
  }
  return false;
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

}  // namespace

/// How far along the line of a course what lies ahead matters [m]: lanes may be shorter or longer
/// than the ground that they cover.
double CorridorMap::reach_on_ground(const CorridorCourse& course, std::span<const double> begins,
                                    double whole) const {
  double left = course.reach;
  for (auto i = std::size_t(course.exit_piece); i < course.pieces.size(); ++i) {
    const double ground = (i + 1 < begins.size() ? begins[i + 1] : whole) - begins[i];
    const double length = graph_.lane(course.pieces[i].lane).length;
    if (left <= length) return begins[i] + left * ground / length;
    left -= length;
  }
  return whole + left;
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
  const double kept = std::max(line.begins[std::size_t(course.exit_piece)] + course.end,
                               reach_on_ground(course, line.begins, whole.length)) +
                      1.0;
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

}  // namespace mvtp
