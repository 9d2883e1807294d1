#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "coordinator/network/lane_graph.hpp"

namespace mvtp {

/// One lane of a corridor; with a lane change where `target` is another lane of its edge.
struct CorridorPiece {
  int lane = LaneGraph::kNone;
  int target = LaneGraph::kNone;  ///< lane at the end of the piece, if another one
  double begin = 0.0;             ///< [m] along `lane` where the change begins and
  double end = 0.0;               ///< where it ends; on a short lane, before and behind it

  [[nodiscard]] int last_lane() const { return target == LaneGraph::kNone ? lane : target; }
  friend auto operator<=>(const CorridorPiece&, const CorridorPiece&) = default;
};

/// Where a driver may be no faster.
struct SlowPlace {
  double at = 0.0;     ///< [m] behind the start of the exit piece, of the front bumper
  double speed = 0.0;  ///< [m/s]
  friend auto operator<=>(const SlowPlace&, const SlowPlace&) = default;
};

/// The course of a vehicle through one or more coordinated junctions, as lanes.
struct CorridorCourse {
  std::vector<int> lead_in;  ///< lanes behind the first piece on which its tail may still be
  std::vector<CorridorPiece> pieces;
  std::vector<int> lines;  ///< pieces at whose ends there are coordinated stop lines
  int exit_piece = 0;      ///< the first behind the last coordinated junction
  double start = 0.0;      ///< [m] on the first lane where the course begins; < 0: behind it
  double handback = 0.0;   ///< [m] behind the start of the exit piece, of the front bumper
  double end = 0.0;        ///< [m] likewise: where a plan is complete; >= handback
  double reach = 0.0;      ///< [m] likewise: what lies further ahead does not matter
  std::vector<SlowPlace> slow_places;  ///< behind the hand-back
  bool human_driven = false;           ///< who keeps to the lanes, however wide the body swings
  bool dead_end = false;               ///< the last lane does not lead on along the route
  bool cramped = false;  ///< too short behind the last junction for the body to lie straight

  friend auto operator<=>(const CorridorCourse&, const CorridorCourse&) = default;
};

struct CorridorOptions {
  double takeover = 80.0;  ///< [m] before a stop line, or more: CourseFinder::takeover_before()
  double latency = 0.0;    ///< [s] more than a decision until a vehicle answers
  double exit = 60.0;      ///< [m] behind a junction where a vehicle is handed back at the latest
  double chain = 50.0;     ///< [m] junctions nearer to each other share a corridor
  double longest = 350.0;  ///< [m] of a corridor from its first stop line on
};

/// A vehicle as the course finder sees it.
struct CourseQuery {
  int lane = LaneGraph::kNone;
  double position = 0.0;  ///< [m] of the front bumper on it
  std::span<const int>
      edges;            ///< its route: the edge it is on (inside a junction: before it) first
  double length = 4.5;  ///< [m] of the body
  const std::string* vehicle_class = nullptr;
  int previous_lane = LaneGraph::kNone;  ///< normal lane before the present one, if known
  int next_lane = LaneGraph::kNone;      ///< onto which its driver means to go, if known
  /// It stops here, on edges[stop_edge], before it goes on.
  std::optional<std::size_t> stop_edge;
  int stop_lane = LaneGraph::kNone;  ///< of that edge
  double stop_position = 0.0;        ///< [m]
};

/// Walks along routes: which lanes lead where a vehicle wants to go, from where on it is taken
/// over, and where it is handed back.
class CourseFinder {
 public:
  CourseFinder(const LaneGraph& graph, std::vector<bool> coordinated,
               const CorridorOptions& options);

  [[nodiscard]] bool is_coordinated(int junction) const {
    return junction != LaneGraph::kNone && coordinated_[std::size_t(junction)];
  }
  /// Is this lane inside a coordinated junction?
  [[nodiscard]] bool is_inside(int lane) const { return graph_.is_inside(lane, coordinated_); }
  /// Can a vehicle at this place be within the takeover distance of a coordinated stop line,
  /// wherever it goes? Quick: most vehicles are not.
  [[nodiscard]] bool may_approach(int lane, double position) const;

  /// The course of a vehicle that is within the takeover distance; nullopt if it is not, or if no
  /// lane leads where it wants to go.
  [[nodiscard]] std::optional<CorridorCourse> find(const CourseQuery& query) const;

  /// The course of a vehicle that nobody controls, for `reach` metres along its route.
  [[nodiscard]] CorridorCourse follow(const CourseQuery& query, double reach) const;

  /// Where vehicles are taken over before the line at the end of an edge [m]: as far as the
  /// options say, or as who keeps to the fastest limit there needs to stop.
  [[nodiscard]] double takeover_before(int edge) const { return takeover_[std::size_t(edge)]; }

  /// The largest of these [m].
  [[nodiscard]] double furthest_takeover() const { return furthest_; }

  /// A coordinated stop line ahead on a route.
  struct LineAhead {
    int edge = LaneGraph::kNone;  ///< that ends there
    double distance = 0.0;        ///< [m] from the vehicle
    double takeover = 0.0;        ///< [m] before it
    [[nodiscard]] bool is_near() const { return distance <= takeover; }
  };
  /// The next one, if there is one before the route of the vehicle ends.
  [[nodiscard]] std::optional<LineAhead> line_ahead(const CourseQuery& query) const;
  /// Distance to it [m].
  [[nodiscard]] std::optional<double> distance_to_line(const CourseQuery& query) const;

 private:
  static constexpr double kEarly = 60.0;  ///< [m] that a takeover may be earlier, before a junction
  static constexpr double kDriverBrakes = 45.0;  ///< [m] that a driver needs to stop comfortably

  /// Where a vehicle joins its route.
  struct Start {
    std::vector<int> inside;      ///< the rest of the internal lanes, if it is inside a junction
    std::size_t edge = 0;         ///< in the query's edges: that of
    int lane = LaneGraph::kNone;  ///< its first normal lane
    double position = 0.0;        ///< [m] on that; < 0: before it
  };

  /// Of a junction without conflicts.
  struct Turn {
    double begin = 0.0;  ///< [m] behind the start of the exit piece
    double end = 0.0;    ///< [m] likewise
    double speed = 0.0;  ///< [m/s] that its driver may have; infinite: as before it
  };

  /// What lies behind the last junction of a corridor.
  struct Exit {
    enum class Kind { kOpen, kLine, kForeign, kStop, kRouteEnd };
    Kind kind = Kind::kOpen;
    double room = 0.0;      ///< [m] from the start of the exit edge to what ends it
    std::size_t edge = 0;   ///< at the end of this one
    double takeover = 0.0;  ///< [m] before a line there
  };

  [[nodiscard]] double stopping_room(double limit) const;
  [[nodiscard]] double find_takeover(int edge, double furthest) const;
  void find_takeovers();
  void measure_to_lines();
  [[nodiscard]] std::span<const int> links_between(int from_edge, int to_edge) const;
  [[nodiscard]] double length(int edge) const;
  [[nodiscard]] double length_between(int from_edge, int to_edge) const;
  [[nodiscard]] bool is_open(int lane, const CourseQuery& query) const;
  [[nodiscard]] std::optional<Start> start_of(const CourseQuery& query) const;
  [[nodiscard]] std::optional<std::size_t> first_line(const CourseQuery& query, const Start& start,
                                                      double within, double& distance) const;
  [[nodiscard]] bool bends(int before, std::span<const int> lanes, int after) const;
  [[nodiscard]] std::vector<Turn> turns_behind(const CorridorCourse& course) const;
  [[nodiscard]] double to_straight(const CourseQuery& query, const Start& start) const;
  [[nodiscard]] bool is_due(const CourseQuery& query, const Start& start, std::size_t line,
                            double distance) const;
  [[nodiscard]] Exit exit_behind(const CourseQuery& query, std::size_t edge, double driven) const;
  [[nodiscard]] double handback_at(const Exit& exit, double body_length) const;
  [[nodiscard]] std::vector<std::vector<double>> costs_to_go(const CourseQuery& query,
                                                             std::size_t first, std::size_t last,
                                                             double room) const;
  /// The last edge behind the exit that a course leads along, `reach` metres or to where it has to
  /// end before.
  [[nodiscard]] std::size_t last_edge_behind(const CourseQuery& query, std::size_t exit,
                                             double reach) const;
  [[nodiscard]] bool lay_pieces(const CourseQuery& query, const Start& start, std::size_t exit,
                                double reach, CorridorCourse& course) const;
  [[nodiscard]] static double straight_room(double body_length);
  [[nodiscard]] static double clear_of_turns(std::span<const Turn> turns, double body_length,
                                             double at, double latest);
  [[nodiscard]] bool turns_round(int from_edge, int to_edge) const;
  [[nodiscard]] bool leads_on(const CourseQuery& query, const Start& start,
                              const CorridorCourse& course) const;
  [[nodiscard]] std::size_t last_edge(const Start& start, const CorridorCourse& course) const;
  [[nodiscard]] double speed_behind(const CourseQuery& query, const Start& start,
                                    const CorridorCourse& course) const;
  void lay_lead_in(const CourseQuery& query, CorridorCourse& course) const;

  const LaneGraph& graph_;
  std::vector<bool> coordinated_;
  CorridorOptions options_;
  std::unordered_map<std::uint64_t, std::vector<int>> links_;
  std::vector<double> takeover_;  ///< [m] by edge; see takeover_before()
  double furthest_ = 0.0;         ///< of these
  std::vector<double> to_line_;   ///< [m] from the end of each lane to the nearest stop line
};

}  // namespace mvtp
