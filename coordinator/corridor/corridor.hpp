#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/corridor/corridor_course.hpp"
#include "coordinator/corridor/least_curvature.hpp"
#include "coordinator/corridor/path_approach.hpp"
#include "coordinator/network/drivable_area.hpp"
#include "coordinator/traffic.hpp"
#include "planner/road.hpp"

namespace mvtp {

/// Braking towards lower speed limits and before lines that are not passed yet [m/s^2].
[[nodiscard]] inline double comfortable_braking(const Vehicle& body) {
  return std::min(3.5, 0.8 * body.max_decel);
}

/// A course through coordinated junctions for one body: the path of its rear axle, and what lies
/// where along it. Stations are arc lengths of the rear axle [m].
struct Corridor {
  CorridorCourse course;
  int path = 0;                        ///< in the PathLibrary
  std::vector<double> stations;        ///< when the front bumper enters each piece
  std::vector<double> scales;          ///< metres of path per metre of lane, per piece
  std::vector<double> ratios;          ///< metres on the ground per metre of lane, per piece
  std::vector<double> lane_limits;     ///< [m/s] per ReferencePath::kSpacing of the path
  std::vector<double> lateral_limits;  ///< [m/s] likewise, from the curvature and the next line
  int exit_lane = LaneGraph::kNone;    ///< the first behind the last coordinated junction
  std::vector<double> lines;           ///< when the front bumper is at each coordinated stop line
  std::vector<double> stops;  ///< before each of them, the last place where the body is in its lane
  double s_drivable = 0.0;    ///< from here on the body can drive the path
  double s_exit = 0.0;        ///< when the front bumper enters the exit lane
  double s_handback = 0.0;
  double s_latest = 0.0;  ///< until here the body lies along its lane as it does there
  double aside = 0.0;     ///< [m] that it is off the lanes' middle at the hand-back, at least
  double s_end = 0.0;     ///< where a plan is complete
  std::string undriven;   ///< why this body cannot drive here; empty: it can

  /// The station of a front bumper at `position` on `lane`, nearest to `expected`; nullopt if the
  /// lane is not part of the corridor. A lane may be part of it more than once.
  [[nodiscard]] std::optional<double> station(int lane, double position, double expected) const;
  /// The number of the piece on which the front bumper is with the rear axle at `s`.
  [[nodiscard]] std::size_t piece_at(double s) const;
};

struct CorridorLimits {
  double max_lateral_accel = 0.0;  ///< [m/s^2]; 0: only the limits of the lanes
  Margins margins;
  Reservation reservation = Reservation::kNone;  ///< on coordinated junctions
};

/// The corridors in use, each made when it is first asked for. References and numbers are valid
/// until forget_unused(), and then as long as they are used.
class CorridorMap {
 public:
  CorridorMap(const LaneGraph& graph, const DrivableArea& area, const CorridorLimits& limits)
      : graph_(graph), area_(area), limits_(limits), library_(limits.margins, limits.reservation) {}

  /// The corridor along this course for this body.
  int corridor_for(const CorridorCourse& course, const Vehicle& body);

  /// The corridor `c` with the approach to its path as part of that, for one vehicle.
  int joined(int c, const PathApproach& approach);

  /// Metres on the ground per metre that the network gives a lane: its shape may be shorter or
  /// longer than its length.
  [[nodiscard]] double metres_per_metre(int lane) const;

  /// Somebody keeps this corridor without asking for it again.
  void use(int c) { used_[std::size_t(c)] = true; }
  /// Forgets the corridors that nobody has used or asked for since the last call, with their
  /// paths.
  void forget_unused();
  [[nodiscard]] bool holds(int c) const { return corridors_[std::size_t(c)] != nullptr; }

  [[nodiscard]] const Corridor& operator[](int c) const { return *corridors_[std::size_t(c)]; }
  /// Corridors so far, with those forgotten: numbers are never given to another.
  [[nodiscard]] int size() const { return int(corridors_.size()); }
  [[nodiscard]] PathLibrary& library() { return library_; }
  [[nodiscard]] const PathLibrary& library() const { return library_; }

 private:
  /// The lanes' centre line and where each piece begins along it [m].
  struct Line {
    std::vector<Point> points;
    std::vector<double> begins;
  };
  using Shape = std::array<double, 4>;  ///< of a body, and how tightly it turns

  [[nodiscard]] static Shape shape_of(const Vehicle& body);
  [[nodiscard]] double reach_on_ground(const CorridorCourse& course, std::span<const double> begins,
                                       double whole) const;
  [[nodiscard]] Line centre_line(const CorridorCourse& course) const;
  [[nodiscard]] RoadNetwork road_along(const CorridorCourse& course) const;
  [[nodiscard]] static FreeCourse free_course(const Line& line, const CorridorCourse& course,
                                              const Vehicle& body);
  [[nodiscard]] double narrowest_lane(const CorridorCourse& course) const;
  [[nodiscard]] ReferencePath path_along(const Line& line, const CorridorCourse& course,
                                         const Vehicle& body) const;
  [[nodiscard]] Corridor build(const CorridorCourse& course, const Vehicle& body);
  void set_stations(const Line& line, const ReferencePath& path, const Vehicle& body,
                    Corridor& corridor) const;
  [[nodiscard]] std::vector<JunctionStretch> stretches_of(const Corridor& corridor,
                                                          const Vehicle& body) const;
  /// How a body lies at a place.
  struct Lie {
    double s = 0.0;      ///< [m] rear axle
    double aside = 0.0;  ///< [m] see aside()
  };
  [[nodiscard]] static double aside(const Line& line, const ReferencePath& path,
                                    const Vehicle& body, double s);
  [[nodiscard]] static double last_in_lane(const Line& line, const ReferencePath& path,
                                           const Vehicle& body, double from, double to);
  [[nodiscard]] static Lie straight_near(const Line& line, const ReferencePath& path,
                                         const Vehicle& body, double from,
                                         std::pair<double, double> within);
  [[nodiscard]] static double straight_until(const Line& line, const ReferencePath& path,
                                             const Vehicle& body, const Lie& from, double to);
  [[nodiscard]] double lane_limit(const CorridorCourse& course, int lane) const;
  void set_limits(const ReferencePath& path, const Vehicle& body, Corridor& corridor) const;
  [[nodiscard]] double lateral_limit(const ReferencePath& path, double s, bool changes_lane) const;
  [[nodiscard]] static double limit_before_end(const Corridor& corridor, const Vehicle& body,
                                               double s);
  void set_drivable(const ReferencePath& path, const Vehicle& body, Corridor& corridor) const;
  [[nodiscard]] std::string why_not(const ReferencePath& path, const Vehicle& body, double s) const;

  const LaneGraph& graph_;
  const DrivableArea& area_;
  CorridorLimits limits_;
  PathLibrary library_;
  std::vector<std::unique_ptr<const Corridor>> corridors_;  ///< null: forgotten
  std::vector<bool> used_;  ///< of each corridor: since forget_unused()
  std::map<std::pair<CorridorCourse, Shape>, std::vector<int>> known_;
  std::map<std::pair<CorridorCourse, Shape>, int> paths_;  ///< by what they depend on
};

}  // namespace mvtp
