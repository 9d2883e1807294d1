#include "coordinator/corridor/corridor_course.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mvtp {
namespace {

constexpr int kNone = LaneGraph::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kLeadIn = 30.0;          ///< [m] of path before the takeover, for long bodies
constexpr double kRunOut = 25.0;          ///< [m] behind the hand-back until a plan is complete
constexpr double kObservedBehind = 20.0;  ///< [m] behind that in which others still matter
constexpr double kBeforeEnd = 9.0;        ///< [m] that a hand-back keeps from the end of its lane
constexpr double kArrives = 0.5;          ///< [m] before the end of its route, if that is near
constexpr double kDriverChanges = 80.0;   ///< [m] that a driver needs to change lanes and to stop
constexpr double kBeforeJunction = 10.0;  ///< [m] before it, then
constexpr double kBridge = 100.0;         ///< [m] more behind a junction, up to the next takeover

std::uint64_t pair_key(int a, int b) {
  return (std::uint64_t(std::uint32_t(a)) << 32U) | std::uint32_t(b);
}

}  // namespace

CourseFinder::CourseFinder(const LaneGraph& graph, std::vector<bool> coordinated,
                           const CorridorOptions& options)
    : graph_(graph), coordinated_(std::move(coordinated)), options_(options) {
  for (int k = 0; k < graph.links(); ++k) {
    const LaneGraph::Link& link = graph.link(k);
    links_[pair_key(graph.edge_of(link.from), graph.edge_of(link.to))].push_back(k);
  }
  find_takeovers();
  measure_to_lines();
}

std::span<const int> CourseFinder::links_between(int from_edge, int to_edge) const {
  const auto found = links_.find(pair_key(from_edge, to_edge));
  return found == links_.end() ? std::span<const int>() : std::span<const int>(found->second);
}

double CourseFinder::length(int edge) const {
  return graph_.lane(graph_.lanes_of(edge).front()).length;
}

double CourseFinder::length_between(int from_edge, int to_edge) const {
  const std::span<const int> links = links_between(from_edge, to_edge);
  return links.empty() ? 0.0 : graph_.link(links.front()).length;
}

bool CourseFinder::is_open(int lane, const CourseQuery& query) const {
  if (lane == kNone) return false;
  return query.vehicle_class == nullptr || graph_.lane(lane).allows(*query.vehicle_class);
}

std::optional<CourseFinder::Start> CourseFinder::start_of(const CourseQuery& query) const {
  const int edge = graph_.edge_of(query.lane);
  if (query.edges.empty()) return std::nullopt;
  if (edge != kNone) {
    if (query.edges[0] != edge) return std::nullopt;
    return Start{.inside = {}, .edge = 0, .lane = query.lane, .position = query.position};
  }
  for (const int k : graph_.links_over(query.lane)) {
    const LaneGraph::Link& link = graph_.link(k);
    const int to = graph_.edge_of(link.to);
    if (query.edges.size() < 2 || query.edges[0] != graph_.edge_of(link.from) ||
        query.edges[1] != to) {
      continue;
    }
    Start start{.inside = {}, .edge = 1, .lane = link.to, .position = query.position};
    const auto here = std::ranges::find(link.via, query.lane);
    start.inside.assign(here, link.via.end());
    for (const int via : start.inside) start.position -= graph_.lane(via).length;
    return start;
  }
  return std::nullopt;
}

/// The edge at whose end the first coordinated stop line on the route is, at most `within` metres
/// ahead, and how far ahead; nullopt if there is none, or a junction of others before it.
std::optional<std::size_t> CourseFinder::first_line(const CourseQuery& query, const Start& start,
                                                    double within, double& distance) const {
  distance = length(query.edges[start.edge]) - start.position;
  for (std::size_t i = start.edge; i + 1 < query.edges.size(); ++i) {
    if (distance > within || (query.stop_edge && *query.stop_edge <= i)) return std::nullopt;
    const int junction = graph_.junction_behind(query.edges[i]);
    if (junction == kNone) return std::nullopt;
    if (is_coordinated(junction)) return i;
    if (graph_.junction(junction).has_conflicts) return std::nullopt;
    distance += length_between(query.edges[i], query.edges[i + 1]) + length(query.edges[i + 1]);
  }
  return std::nullopt;
}

CourseFinder::Exit CourseFinder::exit_behind(const CourseQuery& query, std::size_t edge,
                                             double driven) const {
  using Kind = Exit::Kind;
  // Up to where a next takeover still puts off the hand-back.
  const double far = options_.exit + kBridge + furthest_;
  Exit exit{.kind = Kind::kOpen, .room = 0.0, .edge = edge};
  for (std::size_t i = edge;; ++i) {
    exit.edge = i;
    if (query.stop_edge && *query.stop_edge == i) {
      exit.kind = Kind::kStop;
      exit.room += query.stop_position;
      return exit;
    }
    exit.room += length(query.edges[i]);
    exit.kind = Kind::kRouteEnd;
    if (i + 1 == query.edges.size()) return exit;
    const int junction = graph_.junction_behind(query.edges[i]);
    if (junction == kNone) return exit;
    exit.kind = is_coordinated(junction) ? Kind::kLine : Kind::kForeign;
    exit.takeover = takeover_before(query.edges[i]);
    if (is_coordinated(junction) || graph_.junction(junction).has_conflicts) break;
    exit.kind = Kind::kOpen;
    if (exit.room > far) return exit;
    exit.room += length_between(query.edges[i], query.edges[i + 1]);
  }
  const bool chained = exit.kind == Exit::Kind::kLine && exit.room < options_.chain;
  if (!chained || driven + exit.room > options_.longest) return exit;
  return exit_behind(query, exit.edge + 1, driven + exit.room);
}

/// What it takes behind a junction until a body lies straight in its lane again [m].
double CourseFinder::straight_room(double body_length) { return body_length + 1.0; }

/// Where behind the start of the exit edge the front bumper is at the hand-back [m].
double CourseFinder::handback_at(const Exit& exit, double body_length) const {
  double at = options_.exit;
  if (exit.kind == Exit::Kind::kLine) {
    // Where the next takeover is near, nobody drives on its own in between.
    at = std::clamp(exit.room - exit.takeover, 15.0, options_.exit + kBridge);
  } else if (exit.kind == Exit::Kind::kForeign || exit.kind == Exit::Kind::kStop) {
    at = std::min(exit.room - kDriverBrakes, options_.exit);
  } else if (exit.kind == Exit::Kind::kRouteEnd && exit.room < options_.exit) {
    at = exit.room - kArrives;
  }
  return std::max(at, straight_room(body_length));
}

/// Does the route turn round between two edges, as at the end of a road? No driver takes a vehicle
/// back well there.
bool CourseFinder::turns_round(int from_edge, int to_edge) const {
  constexpr double kRound = 2.0;  // [rad]
  const std::vector<Point>& a = graph_.lane(graph_.lanes_of(from_edge).front()).shape;
  const std::vector<Point>& b = graph_.lane(graph_.lanes_of(to_edge).front()).shape;
  const Point u{a.back().x - a[a.size() - 2].x, a.back().y - a[a.size() - 2].y};
  const Point v{b[1].x - b[0].x, b[1].y - b[0].y};
  return std::abs(std::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y)) > kRound;
}

/// In the query's edges: the one on which the course ends.
std::size_t CourseFinder::last_edge(const Start& start, const CorridorCourse& course) const {
  const auto edges = std::ranges::count_if(
      course.pieces, [&](const CorridorPiece& p) { return graph_.edge_of(p.lane) != kNone; });
  return start.edge + std::size_t(edges) - 1;
}

/// Does the last lane lead on along the route, or to a line before which it is taken over again?
/// Else its driver has to change lanes, or to turn round, behind the hand-back.
bool CourseFinder::leads_on(const CourseQuery& query, const Start& start,
                            const CorridorCourse& course) const {
  const std::size_t last = last_edge(start, course);
  if (last + 1 >= query.edges.size()) return true;
  const int junction = graph_.junction_behind(query.edges[last]);
  if (is_coordinated(junction)) return true;
  if (turns_round(query.edges[last], query.edges[last + 1])) return false;
  return std::ranges::any_of(links_between(query.edges[last], query.edges[last + 1]), [&](int k) {
    return graph_.link(k).from == course.pieces.back().last_lane();
  });
}

/// How slowly its driver has to drive at the end of the last lane: as the turn there wants it, or
/// so that he can stop, where he may have to wait for others or for a gap in another lane [m/s];
/// infinite where the route ends.
double CourseFinder::speed_behind(const CourseQuery& query, const Start& start,
                                  const CorridorCourse& course) const {
  const std::size_t last = last_edge(start, course);
  if (last + 1 >= query.edges.size()) return kInfinity;
  double speed = 0.0;
  for (const int k : links_between(query.edges[last], query.edges[last + 1])) {
    const LaneGraph::Link& link = graph_.link(k);
    const bool is_foreign =
        !is_coordinated(link.junction) && graph_.junction(link.junction).has_conflicts;
    if (link.from != course.pieces.back().last_lane() || link.via.empty() || is_foreign) continue;
    speed = graph_.lane(link.via.front()).speed_limit;
  }
  return speed;
}

/// Is it time to take the vehicle over? Inside a junction without conflicts and just behind it its
/// pose is that of a turn, so it is taken over before such a junction instead, or behind it if it
/// can still stop before the line then.
bool CourseFinder::is_due(const CourseQuery& query, const Start& start, std::size_t line,
                          double distance) const {
  const double bent = to_straight(query, start);
  if (bent > 0.0 && distance - bent > kDriverBrakes) return false;
  const double takeover = takeover_before(query.edges[line]);
  if (distance <= takeover) return true;
  if (start.edge == line || start.position < 0.0) return false;
  const double to_end = length(query.edges[start.edge]) - start.position;
  const double inside = length_between(query.edges[start.edge], query.edges[start.edge + 1]);
  const double behind = distance - to_end - inside - query.length - 3.0;
  return to_end <= kBeforeJunction && behind <= takeover;
}

std::optional<CorridorCourse> CourseFinder::find(const CourseQuery& query) const {
  const std::optional<Start> start = start_of(query);
  double distance = 0.0;
  if (!start) return std::nullopt;
  const std::optional<std::size_t> line = first_line(query, *start, furthest_ + kEarly, distance);
  if (!line || !is_due(query, *start, *line, distance)) return std::nullopt;

  const Exit exit = exit_behind(query, *line + 1, 0.0);
  std::size_t first_exit = exit.edge;
  // The exit edge is the first one behind the last coordinated junction.
  while (first_exit > *line + 1 &&
         !is_coordinated(graph_.junction_behind(query.edges[first_exit - 1]))) {
    --first_exit;
  }
  CorridorCourse course;
  double wanted = handback_at(exit, query.length);
  if (!lay_pieces(query, *start, first_exit, wanted + kRunOut + kObservedBehind, course)) {
    return std::nullopt;
  }
  double laid = 0.0;
  for (std::size_t i = std::size_t(course.exit_piece); i < course.pieces.size(); ++i) {
    laid += graph_.lane(course.pieces[i].lane).length;
  }
  const double room = std::min(laid, exit.room);
  const bool is_early = !leads_on(query, *start, course);
  if (is_early) {
    wanted = std::max(straight_room(query.length), std::min(wanted, room - kDriverChanges));
  }
  const bool arrives = exit.kind == Exit::Kind::kRouteEnd && exit.room < options_.exit;
  const double latest =
      arrives ? room - kArrives
              : std::max(std::min(straight_room(query.length), room - 1.6), room - kBeforeEnd);
  const std::vector<Turn> turns = turns_behind(course);
  course.cramped = room < straight_room(query.length);
  course.handback =
      std::max(0.1, clear_of_turns(turns, query.length, std::min(wanted, latest), latest));
  course.end = std::max(course.handback, std::min(course.handback + kRunOut, room - 1.0));
  // Where it bends at first there is room for a hand-back further on.
  if (is_early) course.end = std::max(course.end, room - kDriverBrakes);
  course.reach = std::min(room, course.end + kObservedBehind);
  // It stops there, or at the next coordinated line if it is not admitted to the next corridor.
  if (exit.kind == Exit::Kind::kLine || exit.kind == Exit::Kind::kStop) {
    course.slow_places.push_back({exit.room, 0.0});
  }
  course.slow_places.push_back({laid, speed_behind(query, *start, course)});
  for (const Turn& turn : turns) {
    if (turn.begin > course.handback) course.slow_places.push_back({turn.begin, turn.speed});
  }
  course.start = query.position + distance - takeover_before(query.edges[*line]) - kLeadIn;
  if (course.start <= 0.0) lay_lead_in(query, course);
  return course;
}

CorridorCourse CourseFinder::follow(const CourseQuery& query, double reach) const {
  CorridorCourse course;
  const std::optional<Start> start = start_of(query);
  if (!start) {
    course.pieces.push_back({.lane = query.lane});
  } else {
    for (const int via : start->inside) course.pieces.push_back({.lane = via});
    int lane = start->lane;
    double covered = graph_.lane(lane).length - start->position;
    course.pieces.push_back({.lane = lane});
    for (std::size_t i = start->edge; covered < reach && i + 1 < query.edges.size(); ++i) {
      const std::span<const int> links = links_between(query.edges[i], query.edges[i + 1]);
      const auto leads_on = [&](int n) { return graph_.link(n).from == lane; };
      auto k = std::ranges::find_if(links, [&](int n) {
        return leads_on(n) && lane == query.lane && graph_.link(n).to == query.next_lane;
      });
      if (k == links.end()) k = std::ranges::find_if(links, leads_on);
      course.dead_end = k == links.end();
      if (course.dead_end) break;
      for (const int via : graph_.link(*k).via) course.pieces.push_back({.lane = via});
      lane = graph_.link(*k).to;
      course.pieces.push_back({.lane = lane});
      covered += graph_.link(*k).length + graph_.lane(lane).length;
    }
  }
  for (const CorridorPiece& piece : course.pieces) course.reach += graph_.lane(piece.lane).length;
  course.handback = course.end = course.reach;
  course.human_driven = true;
  constexpr double kGrid = 50.0;  // [m]: few paths serve all vehicles of a long lane
  course.start = std::floor((query.position - query.length - kLeadIn) / kGrid) * kGrid;
  if (course.start <= 0.0) lay_lead_in(query, course);
  return course;
}

std::optional<CourseFinder::LineAhead> CourseFinder::line_ahead(const CourseQuery& query) const {
  const std::optional<Start> start = start_of(query);
  if (!start) return std::nullopt;
  double distance = 0.0;
  const std::optional<std::size_t> line = first_line(query, *start, kInfinity, distance);
  if (!line) return std::nullopt;
  const int edge = query.edges[*line];
  return LineAhead{edge, distance, takeover_before(edge)};
}

std::optional<double> CourseFinder::distance_to_line(const CourseQuery& query) const {
  const std::optional<LineAhead> line = line_ahead(query);
  return line ? std::optional(line->distance) : std::nullopt;
}

}  // namespace mvtp
