#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/corridor/corridor.hpp"
#include "coordinator/prediction/halted_queues.hpp"
#include "coordinator/prediction/watched_lanes.hpp"
#include "planner/road.hpp"

namespace mvtp {

/// Where the exit begins that a lane belongs to: the first lane behind a coordinated junction, and
/// how far the lane is from there [m].
struct ExitRoot {
  int lane = LaneGraph::kNone;
  double offset = 0.0;
};

/// What a driver does at a coordinated stop line: waits, as it is held at the end of its lane, or
/// at the line, where his signal is red; goes over it, as it is let through; or nobody knows, of
/// one that does not do what it was told to.
enum class Intent { kWaits, kHasRed, kPasses, kUnknown };

/// Where a driver stands for long.
struct StopLine {
  static constexpr double kBraking = 3.0;  ///< [m/s^2] as drivers like to

  double s = 0.0;             ///< station [m]
  double hardest = kBraking;  ///< [m/s^2] he does not brake harder, but drives over it
  double until = std::numeric_limits<double>::infinity();  ///< [s] from now on
  double braking = kBraking;  ///< [m/s^2] he brakes no earlier than it takes with so much
};

/// How long somebody stands where he is, or soon will.
struct Stand {
  double scheduled = 0.0;  ///< [s] still, at a stop of his
  double so_far = 0.0;     ///< [s]
  /// [m] on its lane, where its front stops behind somebody who stands across it; none: nobody.
  std::optional<double> behind = {};
};

/// What vehicles that nobody controls are expected to do.
class Predictor {
 public:
  Predictor(const LaneGraph& graph, const CourseFinder& finder, CorridorMap& corridors);

  /// The vehicle was handed back on this corridor.
  void handed_back(const std::string& id, int corridor) {
    expected_on_[id] = {corridor, corridors_[corridor].s_handback};
  }
  /// Corridors have been forgotten: nobody can be on them.
  void corridors_forgotten();

  /// Do vehicles on this lane matter to those under control?
  [[nodiscard]] bool watches(int lane) const { return watched_.contains(lane); }
  /// From now on vehicles on a corridor matter, and those who come near to it.
  void watch(const Corridor& corridor) { watched_.add(corridor); }

  /// Who stands now.
  void see(HaltedQueues queues) { queues_ = std::move(queues); }

  /// kNone where no coordinated junction is near behind.
  [[nodiscard]] ExitRoot exit_root(int lane) const { return exit_roots_[std::size_t(lane)]; }

  /// A vehicle on the path that it follows when nobody controls it.
  struct Placed {
    int corridor = 0;
    RoadVehicle road;
  };
  /// Where the rear axle is when it waits at the end of its lane until it can change to one that
  /// leads on; nullopt if its own does.
  [[nodiscard]] std::optional<StopLine> lane_end(const Placed& placed) const;
  /// nullopt if the lanes it is on do not lead along its route.
  [[nodiscard]] std::optional<Placed> place(const VehicleState& vehicle, const CourseQuery& query,
                                            const Vehicle& body);

  /// The motions to be expected of a vehicle along its route; none if it is leaving the range of
  /// all.
  /// @param intent  what it does at the next coordinated stop line.
  [[nodiscard]] std::vector<Forecast> predict(const VehicleState& vehicle, const CourseQuery& query,
                                              const Vehicle& body, Intent intent,
                                              const Stand& stand, const DecisionGrid& grid,
                                              std::int64_t step);

 private:
  void let_pass(Forecast& forecast, const Placed& placed, double speed_factor, const Vehicle& body,
                const std::vector<StopLine>& lines, const DecisionGrid& grid) const;
  void hurry(Forecast& forecast, const Placed& placed, double speed_factor, const Vehicle& body,
             const DecisionGrid& grid) const;
  [[nodiscard]] bool comes_beside(const Placed& placed) const;
  [[nodiscard]] ExitRoot find_exit_root(int lane, double within) const;
  [[nodiscard]] bool leads_where_it_goes(const Corridor& corridor, const CourseQuery& query) const;
  [[nodiscard]] std::optional<StopLine> behind_queue(const Placed& placed,
                                                     const CourseQuery& query) const;
  [[nodiscard]] std::vector<StopLine> lines_ahead(const Placed& placed, const CourseQuery& query,
                                                  const Stand& stand,
                                                  const std::optional<StopLine>& own) const;
  [[nodiscard]] std::shared_ptr<const SpeedEnvelope> envelope_of(const Placed& placed, double share,
                                                                 double braking) const;
  [[nodiscard]] int path_of(const VehicleState& vehicle, const CourseQuery& query,
                            const Vehicle& body, double& station);

  const LaneGraph& graph_;
  const CourseFinder& finder_;
  CorridorMap& corridors_;
  WatchedLanes watched_;
  std::vector<ExitRoot> exit_roots_;
  HaltedQueues queues_;
  /// A place along a corridor.
  struct Station {
    int corridor = 0;
    double s = 0.0;  ///< [m] rear axle
  };
  /// Of vehicles that were handed back, or that pass, while in range: those stay on the path on
  /// which they were last expected. Plans end a hair's breadth before a passage: another path of
  /// the same lanes may be in them.
  std::map<std::string, Station> expected_on_;
};

/// A driver on his way: holds his speed for a while, then speeds up gently. Predicting that a
/// standing leader stands for ever would leave the vehicles behind it without a complete plan; who
/// has stood for a while, and nobody knows why, is expected to stand as long again.
/// @param lines  where he has to wait
/// @param stood  [s]
[[nodiscard]] SpeedProfile predict_leader(const RoadVehicle& vehicle,
                                          const std::vector<StopLine>& lines,
                                          const DecisionGrid& grid, std::int64_t step,
                                          double stood = 0.0);

/// A driver at a scheduled stop: he goes on after `stands` seconds.
[[nodiscard]] SpeedProfile predict_stop(const RoadVehicle& vehicle, double stands,
                                        const DecisionGrid& grid, std::int64_t step);

/// The quickest that a driver may be who is let over a junction: he speeds up at once as his
/// vehicle can, but for its envelope, if it has one.
[[nodiscard]] SpeedProfile predict_passage(const RoadVehicle& vehicle, const Vehicle& body,
                                           const DecisionGrid& grid, std::int64_t step);

/// One that stops as hard as it can, and stands for a while.
[[nodiscard]] SpeedProfile predict_breakdown(const RoadVehicle& vehicle, double decel,
                                             const DecisionGrid& grid, std::int64_t step);

/// The slowest passage to be expected of him: at a crawl in the end, and within his envelope, if he
/// has one.
/// @param lines  where he may have to wait behind the junction
[[nodiscard]] SpeedProfile predict_crawl(const RoadVehicle& vehicle, const Vehicle& body,
                                         const std::vector<StopLine>& lines,
                                         const DecisionGrid& grid, std::int64_t step);

}  // namespace mvtp
