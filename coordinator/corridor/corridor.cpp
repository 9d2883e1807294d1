#include "coordinator/corridor/corridor.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

/// Of a course what its path depends on.
CorridorCourse ground_of(CorridorCourse course) {
  course.reach = std::max(course.reach, course.end);
  course.handback = course.end = 0.0;
  course.slow_places.clear();
  course.dead_end = course.cramped = false;
  return course;
}

}  // namespace

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
  constexpr double kArc = 2.0;  // [m] behind its beginning it bends as it does before it
  const double begin = approach.begin();
  const Pose first = approach.pose(path, begin);
  const Pose second = approach.pose(path, begin + ReferencePath::kSpacing);
  const double curvature = wrap_to_pi(second.theta - first.theta) / distance(first, second);
  std::vector<Point> points;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const double s = double(i) * ReferencePath::kSpacing;
    const double arc = std::clamp(begin - s, 0.0, kArc);
    const Pose behind = drive(drive(first, -arc, curvature), s + arc - begin, 0.0);
    const Pose pose = s < begin ? behind : approach.pose(path, s);
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

}  // namespace mvtp
