// Turns without conflicts behind a corridor or before it: where no vehicle changes hands.

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/corridor/corridor_course.hpp"
#include "coordinator/network/polyline.hpp"

namespace mvtp {
namespace {

constexpr int kNone = LaneGraph::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kSlower = 0.9;  ///< of the speed before a turn, at most, in it
constexpr double kBent = 0.15;   ///< [rad] that count as a bend
constexpr double kNoise = 0.1;   ///< [m]: shorter pieces of a line have no direction

}  // namespace

/// Do the internal `lanes`, driven after lane `before` and up to `after`, bend away from it? The
/// poses of SUMO's drivers jerk there, whose bumpers keep to the lines of the lanes.
bool CourseFinder::bends(int before, std::span<const int> lanes, int after) const {
  const std::vector<Point>& in = graph_.lane(before).shape;
  const double straight = heading(in[in.size() - 2], in.back());
  const auto turned = [&](const Point& a, const Point& b) {
    return distance(a, b) > kNoise && std::abs(wrap_to_pi(heading(a, b) - straight)) > kBent;
  };
  const auto is_bent = [&](int lane) {
    const std::vector<Point>& shape = graph_.lane(lane).shape;
    return std::ranges::adjacent_find(shape, turned) != shape.end();
  };
  if (std::ranges::any_of(lanes, is_bent)) return true;
  if (after == kNone) return false;
  const std::vector<Point>& out = graph_.lane(after).shape;
  return turned(out[0], out[1]);
}

/// The turns without conflicts behind the last coordinated junction, in driving order.
std::vector<CourseFinder::Turn> CourseFinder::turns_behind(const CorridorCourse& course) const {
  std::vector<Turn> turns;
  double here = 0.0;
  const std::size_t n = course.pieces.size();
  for (std::size_t i = std::size_t(course.exit_piece); i < n;) {
    std::vector<int> inside;
    Turn turn{.begin = here, .end = here, .speed = kInfinity};
    const int before = course.pieces[i - 1].last_lane();
    for (; i < n && graph_.edge_of(course.pieces[i].lane) == kNone; ++i) {
      const Lane& lane = graph_.lane(course.pieces[i].lane);
      inside.push_back(course.pieces[i].lane);
      turn.end += lane.length;
      const bool is_slow = lane.speed_limit < kSlower * graph_.lane(before).speed_limit;
      if (is_slow) turn.speed = lane.speed_limit;
    }
    here = turn.end;
    if (!inside.empty()) {
      const int after = i < n ? course.pieces[i].lane : kNone;
      if (turn.speed < kInfinity || bends(before, inside, after)) turns.push_back(turn);
    }
    if (i < n) here += graph_.lane(course.pieces[i++].lane).length;
  }
  return turns;
}

/// The place nearest to `at` behind the exit's start, up to `latest`, that is not right before or
/// inside a turn without conflicts, nor right behind it; `at` itself if there is none [m].
double CourseFinder::clear_of_turns(std::span<const Turn> turns, double body_length, double at,
                                    double latest) {
  std::optional<double> best;
  double from = std::min(at, straight_room(body_length));  // of the lanes since the last turn
  const auto look_at = [&](double to) {
    if (to < from) return;
    const double place = std::clamp(at, from, to);
    if (!best || std::abs(place - at) < std::abs(*best - at)) best = place;
  };
  for (const Turn& turn : turns) {
    look_at(turn.begin - kDriverBrakes);
    from = turn.end + straight_room(body_length);
  }
  look_at(latest);
  return best.value_or(at);
}

/// How far it has to go until it lies straight in its lane, behind a bend without conflicts [m];
/// 0 if it does.
double CourseFinder::to_straight(const CourseQuery& query, const Start& start) const {
  const double left = straight_room(query.length) - start.position;
  if (left <= 0.0) return 0.0;
  const auto is_behind_bend = [&](int k) {
    const LaneGraph::Link& link = graph_.link(k);
    return !is_coordinated(link.junction) && bends(link.from, link.via, link.to);
  };
  return std::ranges::any_of(graph_.links_to(start.lane), is_behind_bend) ? left : 0.0;
}

}  // namespace mvtp
