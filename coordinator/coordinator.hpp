#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/controller.hpp"
#include "coordinator/zone.hpp"
#include "planner/algorithms/road_escot.hpp"

namespace mvtp {

struct CoordinatorOptions {
  RoadEscotOptions escot;
  double decision = 0.5;  ///< [s] between two plans; rounded to whole steps of the traffic
  /// [ms] of wall clock for one plan, from `budget_from` [s] on; a plan that takes longer is
  /// dropped. 0: no planning at all, as if the planner had died.
  double replan_budget_ms = 1e9;
  double budget_from = 0.0;
};

/// A vehicle under control.
struct Driven {
  std::int64_t key = 0;
  int movement = 0;
  RoadVehicle road;      ///< `now` as of the last decision
  Pose offset;           ///< from the guide path at takeover, blended out while driving
  double s_taken = 0.0;  ///< where that was [m]
};

/// The closed loop: takes vehicles over at the border of the zone, plans for all of them at every
/// decision, places them at every step, and hands them back behind the junction.
///
/// Safety: at every decision, "everyone brakes now" is free of contact among the vehicles driven.
/// Liveness: the plan that is executed leads every vehicle out of the zone; a new plan replaces it
/// only if it is complete and no worse. Both are properties of decide_on_road and are tested there.
class Coordinator : public Controller {
 public:
  Coordinator(Traffic& traffic, Zone& zone, const CoordinatorOptions& options);

  void decide() override;
  void act() override;

  /// Builds the paths and tables that the vehicles in sight of the network will need.
  void prepare();

  [[nodiscard]] bool drives(const std::string& id) const override {
    return driven_.contains(id);
  }
  [[nodiscard]] const std::map<std::string, Driven>& driven() const { return driven_; }
  [[nodiscard]] const std::vector<Replan>& replans() const override { return replans_; }
  /// Ids taken over and handed back at the last decision.
  [[nodiscard]] const std::vector<std::string>& taken_over() const { return taken_over_; }
  [[nodiscard]] const std::vector<std::string>& handed_back() const { return handed_back_; }
  /// Sightings of vehicles on an approach in a lane that does not lead where they go.
  [[nodiscard]] std::int64_t wrong_lane_sightings() const { return wrong_lane_sightings_; }

  /// What the planner sees now; public so that the invariants can be tested from outside.
  [[nodiscard]] RoadScene scene() const;
  [[nodiscard]] const JointPlan& plan() const { return plan_; }

 private:
  struct Newcomer {
    const VehicleState* state;
    int movement;
  };

  void replan();
  void hand_back_the_finished();
  [[nodiscard]] std::vector<Newcomer> find_newcomers();
  [[nodiscard]] Driven admit(const Newcomer& newcomer);
  [[nodiscard]] bool planner_is_dead() const;
  void hold_back(const std::vector<Newcomer>& newcomers);
  [[nodiscard]] const VehicleType& type_of(const std::string& id);
  [[nodiscard]] std::vector<Forecast> predict_others(const std::vector<Newcomer>& newcomers);
  [[nodiscard]] std::optional<Forecast> predict(const VehicleState& state);
  [[nodiscard]] bool stalled();
  void place_all();

  Traffic& traffic_;
  Zone& zone_;
  CoordinatorOptions options_;
  DecisionGrid grid_;
  std::int64_t step_ = 0;
  std::int64_t next_key_ = 0;
  std::map<std::string, Driven> driven_;
  std::map<std::string, int> last_movement_;  ///< of vehicles handed back and still in sight
  JointPlan plan_;
  std::vector<Forecast> forecasts_;
  std::map<std::string, VehicleType> types_;
  std::set<std::string> held_;
  std::vector<InertialState> last_configuration_;
  std::vector<Replan> replans_;
  std::vector<std::string> taken_over_;
  std::vector<std::string> handed_back_;
  std::int64_t wrong_lane_sightings_ = 0;
};

}  // namespace mvtp
