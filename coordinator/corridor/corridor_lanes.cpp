// Which lanes a corridor leads over, and where it changes between them.

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/corridor/corridor_course.hpp"

namespace mvtp {
namespace {

constexpr int kNone = LaneGraph::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr std::size_t kLookAhead = 2;  ///< edges behind a corridor that its lanes should lead to

constexpr double kChangeCost = 10.0;       ///< of one lane change,
constexpr double kShortChangeCost = 20.0;  ///< more where it must be short,
constexpr double kLateChangeCost = 100.0;  ///< and where it reaches into the junctions around it
constexpr double kShortChange = 40.0;      ///< [m]
constexpr double kChangeLength = 36.0;     ///< [m] of a change over one lane, where there is room
constexpr double kLeastChange = 16.0;      ///< [m]
constexpr double kChangeRoom = 8.0;        ///< [m] beside that: until it begins, and behind its end
constexpr double kChangeGrid = 4.0;        ///< [m] changes begin at multiples of this

/// Of changing over `lanes` lanes within `room` metres.
double cost_of_change(std::ptrdiff_t lanes, double room) {
  const double n = double(std::abs(lanes));
  if (n == 0.0) return 0.0;
  if (room < kLeastChange * n + kChangeRoom) return kLateChangeCost * n;
  return kChangeCost * n + (room < kShortChange * n ? kShortChangeCost : 0.0);
}

/// Where a change over `lanes` lanes begins and ends on a lane of this length, for a vehicle that
/// is at `position` on it, or before it (< 0). On a short lane it reaches beyond its ends.
CorridorPiece with_change(CorridorPiece piece, int target, double lanes, double position,
                          double length) {
  piece.target = target;
  if (position >= 0.0) {
    piece.begin = std::ceil((position + 2.0) / kChangeGrid) * kChangeGrid;
    piece.end = piece.begin +
                std::clamp(length - 2.0 - piece.begin, kLeastChange * lanes, kChangeLength * lanes);
  } else {
    const double change = std::clamp(length - 5.0, kLeastChange * lanes, kChangeLength * lanes);
    piece.begin = std::min(3.0, 0.5 * (length - change));
    piece.end = piece.begin + change;
  }
  return piece;
}

}  // namespace

/// For each edge from `first` to `last`, for each lane: the cost of the lane changes still to be
/// made by a vehicle that enters the edge on it, up to the next stop if there is one. On the first
/// edge there are `room` metres left.
std::vector<std::vector<double>> CourseFinder::costs_to_go(const CourseQuery& query,
                                                           std::size_t first, std::size_t last,
                                                           double room) const {
  std::vector<std::vector<double>> costs(last - first + 1);
  for (std::size_t i = last + 1; i-- > first;) {
    const std::span<const int> lanes = graph_.lanes_of(query.edges[i]);
    std::vector<double>& here = costs[i - first];
    std::vector<double> leaving(lanes.size(), i == last ? 0.0 : kInfinity);
    const bool stops = query.stop_edge == i && is_open(query.stop_lane, query);
    if (stops) {
      for (std::size_t b = 0; b < lanes.size(); ++b) {
        leaving[b] = lanes[b] == query.stop_lane ? 0.0 : kInfinity;
      }
    } else if (i < last) {
      const std::span<const int> ahead = graph_.lanes_of(query.edges[i + 1]);
      for (const int k : links_between(query.edges[i], query.edges[i + 1])) {
        const LaneGraph::Link& link = graph_.link(k);
        const auto from = std::size_t(std::ranges::find(lanes, link.from) - lanes.begin());
        const auto to = std::size_t(std::ranges::find(ahead, link.to) - ahead.begin());
        leaving[from] = std::min(leaving[from], costs[i + 1 - first][to]);
      }
    }
    here.assign(lanes.size(), kInfinity);
    const double free = i == first ? room : length(query.edges[i]);
    for (std::size_t a = 0; a < lanes.size(); ++a) {
      if (!is_open(lanes[a], query)) continue;
      for (std::size_t b = 0; b < lanes.size(); ++b) {
        if (!is_open(lanes[b], query)) continue;
        // Behind the corridor the driver changes lanes, if he finds room; less so before a stop.
        const double change = cost_of_change(std::ptrdiff_t(a) - std::ptrdiff_t(b), free) +
                              (stops && a != b ? kShortChangeCost : 0.0);
        here[a] = std::min(here[a], change + leaving[b]);
      }
    }
  }
  return costs;
}

std::size_t CourseFinder::last_edge_behind(const CourseQuery& query, std::size_t exit,
                                           double reach) const {
  std::size_t last = exit;
  double covered = length(query.edges[exit]);
  for (; covered < reach && last + 1 < query.edges.size(); ++last) {
    const int junction = graph_.junction_behind(query.edges[last]);
    if (junction == kNone || is_coordinated(junction) || graph_.junction(junction).has_conflicts) {
      break;
    }
    // Its driver turns round, if there is room to hand it back before that.
    if (turns_round(query.edges[last], query.edges[last + 1]) &&
        covered >= straight_room(query.length)) {
      break;
    }
    covered +=
        length_between(query.edges[last], query.edges[last + 1]) + length(query.edges[last + 1]);
  }
  return last;
}

bool CourseFinder::lay_pieces(const CourseQuery& query, const Start& start, std::size_t exit,
                              double reach, CorridorCourse& course) const {
  const std::size_t last = last_edge_behind(query, exit, reach);
  const std::size_t seen = std::min(last + kLookAhead, query.edges.size() - 1);
  const double room = length(query.edges[start.edge]) - std::max(start.position, 0.0);
  const auto costs = costs_to_go(query, start.edge, seen, room);

  for (const int via : start.inside) course.pieces.push_back({.lane = via});
  int lane = start.lane;
  for (std::size_t i = start.edge;; ++i) {
    const std::span<const int> lanes = graph_.lanes_of(query.edges[i]);
    const auto a = std::ranges::find(lanes, lane) - lanes.begin();
    const double begin = i == start.edge ? std::max(start.position, 0.0) : 0.0;
    const double free = length(query.edges[i]) - begin;
    // The lane at the end of this edge, and the link from there.
    double best = kInfinity;
    int chosen = kNone;
    if (i < last) {
      const std::span<const int> ahead = graph_.lanes_of(query.edges[i + 1]);
      for (const int k : links_between(query.edges[i], query.edges[i + 1])) {
        const LaneGraph::Link& link = graph_.link(k);
        const auto b = std::ranges::find(lanes, link.from) - lanes.begin();
        if (!is_open(link.from, query) || (i >= exit && a != b)) continue;
        const auto to = std::size_t(std::ranges::find(ahead, link.to) - ahead.begin());
        const double cost = cost_of_change(a - b, free) + costs[i + 1 - start.edge][to];
        if (cost < best) best = cost, chosen = k;
      }
    }
    if (i < exit && is_coordinated(graph_.junction_behind(query.edges[i]))) {
      course.lines.push_back(int(course.pieces.size()));
    }
    if (i == exit) course.exit_piece = int(course.pieces.size());
    CorridorPiece piece{.lane = lane};
    if (chosen != kNone && graph_.link(chosen).from != lane) {
      const int target = graph_.link(chosen).from;
      const auto b = std::ranges::find(lanes, target) - lanes.begin();
      const bool is_here = i == start.edge && start.position >= 0.0;
      piece = with_change(piece, target, std::abs(double(a - b)), is_here ? begin : -1.0,
                          length(query.edges[i]));
    }
    course.pieces.push_back(piece);
    if (i == last) return true;
    if (chosen == kNone) return i >= exit;  // behind the last junction the course may just end
    for (const int via : graph_.link(chosen).via) course.pieces.push_back({.lane = via});
    lane = graph_.link(chosen).to;
  }
}

/// The lanes behind the first piece, if the body still reaches there.
void CourseFinder::lay_lead_in(const CourseQuery& query, CorridorCourse& course) const {
  course.start = -(query.length + 12.0);
  int lane = course.pieces.front().lane;
  const bool departed = graph_.edge_of(lane) != kNone && query.previous_lane == kNone;
  // Straight on backwards: nobody is there, or as the traffic draws those that begin their route.
  if (departed || query.position > query.length + 3.0) return;
  double covered = 0.0;
  while (covered < -course.start) {
    std::vector<int> behind;
    if (graph_.edge_of(lane) == kNone) {
      const LaneGraph::Link& link = graph_.link(graph_.links_over(lane).front());
      const auto here = std::ranges::find(link.via, lane);
      behind.push_back(link.from);
      behind.insert(behind.end(), link.via.begin(), here);
    } else {
      const std::span<const int> links = graph_.links_to(lane);
      auto chosen = std::ranges::find_if(
          links, [&](int k) { return graph_.link(k).from == query.previous_lane; });
      if (chosen == links.end() && links.size() == 1) chosen = links.begin();
      if (chosen == links.end()) break;
      behind.push_back(graph_.link(*chosen).from);
      behind.insert(behind.end(), graph_.link(*chosen).via.begin(), graph_.link(*chosen).via.end());
    }
    course.lead_in.insert(course.lead_in.begin(), behind.begin(), behind.end());
    for (const int l : behind) covered += graph_.lane(l).length;
    lane = behind.front();
    if (course.lead_in.size() > 12) break;
  }
}

}  // namespace mvtp
