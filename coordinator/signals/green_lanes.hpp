#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "coordinator/corridor/corridor.hpp"
#include "coordinator/prediction/prediction.hpp"
#include "coordinator/signals/signal_program.hpp"

namespace mvtp {

/// Which ground signals that run their own programs leave to vehicles under control at red.
enum class GreenGround {
  kAll,  ///< none of the tiles on the paths of lanes with green [FCFS-Light, Dresner, Stone 2008]
  kSensed,  ///< none of those tiles if a human driver is seen on the lane [H-AIM, Sharon, Stone
            ///< 2017]
};

/// Signals that run their own programs, for human drivers: vehicles under control pass whatever
/// they show, but keep off the ground of lanes with green.
///
/// Who comes from a lane with green goes before all others but those of other lanes with protected
/// green. A permissive green ('g') lets a vehicle under control do what it lets a human driver do:
/// pass where nobody is seen coming.
///
/// Safety: nobody under control is at any time on ground where a driver may be by then who heeds
/// his light, as far as the program says. Liveness: at its own green every lane gets its turn.
class GreenLanes {
 public:
  /// In how many seconds a vehicle under control is over its next line; infinity: it has no
  /// complete plan; nullopt: it is not under control, or over the last.
  using OverLine = std::function<std::optional<double>(const std::string&)>;

  static constexpr double kSensors = 200.0;  ///< [m] before a line that drivers are seen

  GreenLanes(Traffic& traffic, const LaneGraph& graph, const CourseFinder& finder,
             CorridorMap& corridors, Predictor& predictor, const DecisionGrid& grid,
             GreenGround ground, OverLine over_line);

  /// Looks at the signals, at every step.
  void observe();

  /// Is the next coordinated line on its route one with a light, or is it on the junction behind?
  [[nodiscard]] bool governs(const CourseQuery& query) const;
  /// Where its connection is known, what a human driver there does.
  [[nodiscard]] std::vector<Forecast> expect(const VehicleState& vehicle, const CourseQuery& query,
                                             const VehicleType& type, std::int64_t step);

  /// A decision begins.
  void begin(std::int64_t step);
  /// A human driver who comes to a line with a light, from `edge`, on this lane or on any of it.
  void sense(const VehicleState& vehicle, int edge, int lane, double to_line,
             const VehicleType& type);
  /// One who is on a junction: as long as he waits there for others, he may go on at any time.
  void sense_inside(const VehicleState& vehicle, const CourseQuery& query, const VehicleType& type);
  /// The ground that is closed to a vehicle from now on, and whether it may ask for a better plan.
  void close(RoadVehicle& vehicle, int corridor, const VehicleType& type);
  /// Drivers with green do not wait for vehicles under control that stand before their lines.
  void settle();

 private:
  /// A human driver before a line.
  struct Sensed {
    std::string id;
    double to_line = 0.0;   ///< [m]
    double earliest = 0.0;  ///< [s] until he is there, if nobody is ahead of him
  };
  /// A connection on a corridor, and where its stop line is.
  struct Crossing {
    int link = LaneGraph::kNone;
    double stop = 0.0;  ///< [m] the last place of the rear axle before it
  };

  [[nodiscard]] const SignalProgram* program_of(int link) const;
  [[nodiscard]] int link_of(const CourseQuery& query) const;
  [[nodiscard]] bool can_stop(const VehicleState& vehicle, const CourseQuery& query,
                              const VehicleType& type) const;
  [[nodiscard]] bool may_wait_inside(const VehicleState& vehicle, const CourseQuery& query,
                                     const VehicleType& type) const;
  [[nodiscard]] std::vector<Crossing> crossings_on(const Corridor& corridor) const;
  [[nodiscard]] std::optional<double> find_earliest(int lane) const;
  [[nodiscard]] std::optional<double> earliest_on(int lane);
  [[nodiscard]] bool follows_somebody(int lane, double to_line) const;
  void close_for(const Crossing& crossing, int other, RoadVehicle& vehicle);
  [[nodiscard]] std::pair<double, double> common_ground(int path, int link);
  [[nodiscard]] int path_over(int link, const VehicleType& type);
  [[nodiscard]] Forecast waits_at(const RoadVehicle& road, double stop, std::int64_t step) const;
  [[nodiscard]] std::vector<std::string> who_waits_for(const VehicleState& vehicle) const;

  Traffic& traffic_;
  const LaneGraph& graph_;
  const CourseFinder& finder_;
  CorridorMap& corridors_;
  Predictor& predictor_;
  DecisionGrid grid_;
  GreenGround ground_;
  OverLine over_line_;
  std::map<std::string, SignalProgram> programs_;
  std::map<int, std::vector<int>> at_junction_;  ///< links with a light
  std::int64_t step_ = 0;
  std::map<int, std::vector<Sensed>> sensed_;      ///< human drivers, by lane
  std::set<int> waiting_inside_;                   ///< links on which somebody does
  std::map<int, std::optional<double>> earliest_;  ///< find_earliest(), by lane
  std::map<std::string, VehicleType> types_;       ///< of all who have come so far
  /// Of a path, where bodies of a type over a link share tiles with it: by path, link and type.
  std::map<std::tuple<int, int, std::string>, std::pair<double, double>> grounds_;
  std::map<std::string, std::vector<std::string>> relying_;  ///< drivers, and whom they ignore
};

}  // namespace mvtp
