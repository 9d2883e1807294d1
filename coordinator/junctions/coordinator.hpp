#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "coordinator/controller.hpp"
#include "coordinator/corridor/corridor.hpp"
#include "coordinator/corridor/path_approach.hpp"
#include "coordinator/drivers/controlled_share.hpp"
#include "coordinator/drivers/exit_lanes.hpp"
#include "coordinator/drivers/gate.hpp"
#include "coordinator/drivers/lane_keeping.hpp"
#include "coordinator/drivers/straddling.hpp"
#include "coordinator/drivers/wrong_lanes.hpp"
#include "coordinator/faults/fault_model.hpp"
#include "coordinator/junctions/priority.hpp"
#include "coordinator/junctions/referee.hpp"
#include "coordinator/junctions/stagnation.hpp"
#include "coordinator/people/people.hpp"
#include "coordinator/prediction/known_intent.hpp"
#include "coordinator/prediction/prediction.hpp"
#include "coordinator/signals/green_lanes.hpp"
#include "coordinator/signals/signal_heads.hpp"
#include "planner/road.hpp"

namespace mvtp {

class HumanDrivers;

struct CoordinatorOptions {
  RoadEscotOptions escot;
  CorridorOptions corridors;
  CorridorLimits limits;
  std::vector<std::string> junctions;  ///< ids; none: all with conflicting connections
  double corridors_kept = 60.0;        ///< [s] at least, where nobody drives any more
  double decision = 0.5;  ///< [s] between two plans; rounded to whole steps of the traffic
  /// [ms] of processor time for the plan of one group, from `budget_from` [s] on; see GroupBudget.
  /// 0: no planning at all, as if the planner had died.
  double replan_budget_ms = 1e9;
  double budget_from = 0.0;
  /// Share of the decisions that are dropped as if they were late, at random.
  double late_share = 0.0;
  FaultTolerance tolerance;  ///< of messages and vehicles
  Priority priority;         ///< whose time counts for more
  ControlledShare share;     ///< who is taken over
  /// Signals run their own programs, and this is the ground of drivers with green; none: signals
  /// are the coordinator's, where there are human drivers.
  std::optional<GreenGround> greens = {};
  SignalTiming signals;  ///< where human-driven vehicles get their greens from us
  KnownIntent intent = KnownIntent::kRoute;  ///< of those
};

/// A vehicle under control.
struct Driven {
  std::int64_t key = 0;
  int corridor = 0;
  RoadVehicle road;        ///< `now`: when what is decided next takes effect
  PathApproach approach;   ///< from where it was taken over onto the path
  std::vector<int> route;  ///< edges from the first piece of the corridor on
  std::int64_t since = 0;  ///< step of the takeover
  /// What it is expected to do from its takeover until a plan takes effect.
  std::vector<InertialState> committed = {};
  std::deque<Pose> past = {};  ///< where it was placed, the last step first
};

/// The closed loop at junctions: takes vehicles over before a coordinated stop line, plans for all
/// of them at every decision, places them at every step, and hands them back where no other stop
/// line is near; else they go over into the corridor through the next junctions.
///
/// Safety: at every decision, "everyone brakes now" is free of contact among the vehicles driven.
/// Liveness: the plan that is executed leads every vehicle to the end of its corridor; a new plan
/// replaces it only if it is complete and no worse. Both are properties of decide_on_road and are
/// tested there.
class Coordinator : public Controller {
 public:
  /// @throws InputError if one of the junctions is not in the network.
  Coordinator(Traffic& traffic, const DrivableArea& area, const CoordinatorOptions& options);

  ~Coordinator() override;

  void decide() override;
  void act() override;

  [[nodiscard]] bool drives(const std::string& id) const override { return driven_.contains(id); }
  [[nodiscard]] const std::map<std::string, Driven>& driven() const { return driven_; }
  [[nodiscard]] const std::vector<Replan>& replans() const override { return replans_; }
  [[nodiscard]] std::vector<ZoneFigures> zones() const override;
  [[nodiscard]] std::vector<LeftToTraffic> left_to_sumo() const override;
  /// Ids taken over and handed back at the last decision.
  [[nodiscard]] const std::vector<std::string>& taken_over() const { return taken_over_; }
  [[nodiscard]] const std::vector<std::string>& handed_back() const { return handed_back_; }
  /// Observations of human-driven vehicles near a stop line.
  [[nodiscard]] std::int64_t guest_sightings() const { return guest_sightings_; }
  /// Drivers who stood in a wrong lane for long and took another path.
  [[nodiscard]] int detours() const { return wrong_lanes_.detours(); }
  /// Pairs of such drivers who changed lanes at once.
  [[nodiscard]] int lane_swaps() const { return wrong_lanes_.swaps(); }
  /// Vehicles that were not where their plans had them, and have been given up.
  [[nodiscard]] const std::vector<FaultEvent>& losses() const { return losses_; }
  [[nodiscard]] const CorridorMap& corridors() const { return corridors_; }
  /// Drivers at signals that are ours; none if everybody is automated.
  [[nodiscard]] const HumanDrivers* humans() const { return humans_.get(); }

  /// Steps of the traffic so far.
  [[nodiscard]] std::int64_t steps() const { return step_; }

  /// Who walks over crossings; none if the network has none.
  [[nodiscard]] const People* people() const { return people_ ? &*people_ : nullptr; }

  /// What the planner sees now; public so that the invariants can be tested from outside.
  [[nodiscard]] RoadScene scene() const;
  [[nodiscard]] const JointPlan& plan() const { return plan_; }
  /// What was expected of others at the last decision.
  [[nodiscard]] std::span<const Forecast> forecasts() const { return forecasts_; }
  /// Keys of the vehicles that the last decision planned together.
  [[nodiscard]] const std::vector<std::vector<std::int64_t>>& groups() const { return groups_; }

 private:
  /// A vehicle that is to be driven from this decision on, if a plan for it is accepted.
  struct Newcomer {
    const VehicleState* state = nullptr;
    int corridor = 0;
    double to_line = 0.0;    ///< [m]
    std::vector<int> route;  ///< edges
  };

  /// A plan that may be accepted.
  struct Trial {
    RoadDecision decision;
    std::vector<Forecast> forecasts;
    std::vector<PlannedContact> contacts;
    std::vector<std::size_t> refused;    ///< groups whose vehicles would touch, ascending, and
    std::vector<std::size_t> as_before;  ///< those of them that do better with their old plans
    std::vector<std::string> guests;     ///< human-driven vehicles that go over junctions
    std::set<std::string> excluded;      ///< arrivals that stay as they are
    std::map<std::int64_t, int> paths;   ///< of the vehicles planned, by key
    std::map<std::int64_t, int> zones;   ///< the same: where they are, or come to
  };
  /// Sets of guests that may be let over the junctions of a control zone, in the order of trial.
  struct ZoneOffers {
    std::vector<std::vector<std::string>> sets;
    std::size_t next = 0;  ///< that is tried now; the number of sets: none
    [[nodiscard]] const std::vector<std::string>& present() const { return sets[next]; }
  };
  struct ZoneVerdict {
    int stepped = 0;          ///< vehicles without a complete plan
    double cost = 0.0;        ///< [s]
    bool is_refused = false;  ///< by the referee, for a group
  };

  /// [s] without a complete plan, or turned away, until a vehicle that stands counts as stuck.
  static constexpr double kStuckAfter = 5.0;

  // The loop.
  [[nodiscard]] static InertialState state_at(const SpeedProfile& t, std::int64_t k);
  void replan();
  void follow_plans();
  /// The step from which on what is decided now is executed.
  [[nodiscard]] std::int64_t effective_step() const { return step_ + options_.tolerance.lead; }
  [[nodiscard]] RoadScene empty_scene() const;
  [[nodiscard]] InertialState here(const Driven& driven) const;
  void forget_the_vanished();
  void forget_corridors();
  [[nodiscard]] bool planner_is_dead() const;
  void hold_departures();
  void hold_back(const std::vector<Newcomer>& newcomers);
  [[nodiscard]] const VehicleType& type_of(const std::string& id);
  [[nodiscard]] bool comes_late() const;
  /// As long as somebody is under control, drivers with green go on as planned for.
  [[nodiscard]] bool shows_lights() const {
    return heads_ && !greens_ && !(planner_is_dead() && driven_.empty());
  }
  [[nodiscard]] bool owns_signals() const { return humans_ && shows_lights(); }
  void look_at_signals();
  [[nodiscard]] std::optional<double> over_line(const std::string& id) const;
  void sense_drivers();
  void close_ground(std::map<std::string, Driven>& arrivals);
  [[nodiscard]] RoadEscotOptions escot() const;
  void accept(const Trial& trial, const std::map<std::string, Driven>& arrivals);
  [[nodiscard]] bool is_surprise(const VehicleState& v) const;
  void brake_for_surprises();
  void brake_for(const VehicleState& v);
  [[nodiscard]] std::vector<std::int64_t> stagnating_groups();
  void notice_the_stuck();
  void place_all();
  [[nodiscard]] std::vector<PlannedPose> poses_soon(const std::string& id) const;
  [[nodiscard]] std::optional<ExitLanes::Leaving> leaving(const std::string& id) const;
  [[nodiscard]] PlannedPose planned_pose(const Driven& driven, const InertialState& state) const;

  // Messages that take their time, and vehicles that do not obey: coordinator_tolerance.cpp
  void commit(const std::map<std::string, Driven>& arrivals);
  void announce_plans();
  void give_up_the_lost();
  [[nodiscard]] bool is_lost(const Driven& driven, const VehicleState& state) const;
  void delay(Driven& driven, const VehicleState& state) const;
  [[nodiscard]] const VehicleState& believed(const std::string& id, const Driven& driven);
  void continue_on(Driven& arrival, const Driven& before) const;
  void look_ahead(std::vector<Forecast>& forecasts) const;

  [[nodiscard]] const ReferencePath& path_of(const Driven& driven) const;
  [[nodiscard]] const VehicleState* find_state(const std::string& id) const;

  // Taking over and handing back: coordinator_takeover.cpp
  [[nodiscard]] static bool can_wait(double speed, const Vehicle& body, double to_line);
  [[nodiscard]] std::map<std::string, Driven> leave_corridors(bool may_go_on);
  void stay(const std::string& id);
  [[nodiscard]] bool is_left_at_rest(const Driven& driven) const;
  [[nodiscard]] bool is_wedged(const std::string& id, const Driven& driven);
  [[nodiscard]] bool is_inside(const Driven& driven) const;
  [[nodiscard]] bool leaves_lane(const Driven& driven) const;
  [[nodiscard]] bool ends_soon(const Driven& driven) const;
  [[nodiscard]] bool driver_has_room(const std::string& id, const Driven& driven);
  [[nodiscard]] bool nobody_comes_over(const Driven& driven) const;
  void hand_back(const std::string& id);
  [[nodiscard]] std::optional<Newcomer> next_corridor(const Driven& driven,
                                                      const VehicleState& state);
  [[nodiscard]] std::vector<Newcomer> find_newcomers();
  [[nodiscard]] std::string why_undriven(const Corridor& corridor) const;
  [[nodiscard]] std::optional<Newcomer> newcomer_at(const VehicleState& state, CourseQuery query,
                                                    std::vector<int> route);
  [[nodiscard]] CourseQuery query_for(const VehicleState& state, std::span<const int> route);
  [[nodiscard]] std::vector<int> route_of(const VehicleState& state) const;
  int corridor_beside(int number, const PathApproach& approach, const VehicleState& v);
  [[nodiscard]] PathApproach approach_to(const Corridor& corridor, const VehicleState& state,
                                         double station) const;
  [[nodiscard]] bool is_impatient(const std::string& id) const;
  [[nodiscard]] Driven admit(const Newcomer& newcomer, std::int64_t key);
  void announce(const std::string& id, const Driven& driven);
  [[nodiscard]] bool turns_yet(const Newcomer& newcomer);
  [[nodiscard]] bool stands_for_good(const std::string& id) const;
  [[nodiscard]] bool is_entering(const VehicleState& state);
  [[nodiscard]] bool touches_somebody(const VehicleState& state);
  void remember_lanes();
  [[nodiscard]] int came_from(const std::string& id) const;
  [[nodiscard]] bool is_watched(const VehicleState& v);

  // The plan to be accepted: coordinator_trials.cpp
  [[nodiscard]] static std::vector<std::int64_t> without_plan(
      const RoadScene& now, const JointPlan& incumbent, const std::vector<std::int64_t>& upset);
  [[nodiscard]] Trial best_trial(const std::map<std::string, Driven>& arrivals,
                                 const std::vector<std::int64_t>& upset);
  [[nodiscard]] std::set<std::string> better_later(const Trial& trial,
                                                   const std::map<std::string, Driven>& arrivals,
                                                   bool whole_groups) const;
  [[nodiscard]] std::vector<std::size_t> better_with_old_plans(
      const Trial& trial, const std::map<std::string, Driven>& arrivals) const;
  [[nodiscard]] std::set<std::string> too_late(const std::map<std::string, Driven>& arrivals);
  [[nodiscard]] bool may_come_later(const std::string& id, const Driven& arrival) const;
  [[nodiscard]] Trial plan_trial(const std::map<std::string, Driven>& arrivals,
                                 const std::set<std::string>& excluded,
                                 const std::vector<std::int64_t>& upset,
                                 const std::vector<std::string>& guests);
  [[nodiscard]] Trial without_the_late(Trial trial, const std::map<std::string, Driven>& arrivals,
                                       std::set<std::string> excluded,
                                       const std::vector<std::int64_t>& upset);
  void prepare_tables(const RoadScene& now);

  // What is expected of others: coordinator_forecasts.cpp
  [[nodiscard]] Stand stand_of(const VehicleState& state) const;
  [[nodiscard]] HaltedQueues halted_queues();
  [[nodiscard]] std::vector<Forecast> predict_others(
      const std::map<std::string, const Driven*>& present, const std::vector<std::string>& guests);
  [[nodiscard]] std::vector<Forecast> predict_one(const VehicleState& v,
                                                  const std::vector<std::string>& guests);

  // Who may go over junctions: coordinator_guests.cpp
  void let_pass(const std::string& guest);
  void admit_guests_freely();
  [[nodiscard]] bool see_human(const VehicleState& state, const CourseQuery& query,
                               const std::optional<CourseFinder::LineAhead>& line);
  void see_guest(const VehicleState& state, const CourseQuery& query);
  [[nodiscard]] bool touches_guests(const std::vector<std::string>& guests, const Trial& trial);
  [[nodiscard]] bool waits_inside(const Trial& trial, std::optional<int> zone = {}) const;
  [[nodiscard]] std::vector<Forecast> expect_people(const std::vector<std::string>& crossings);
  [[nodiscard]] bool meets_one(const std::vector<Forecast>& people, int path,
                               const SpeedProfile& plan) const;
  [[nodiscard]] bool is_clear_of(const std::vector<std::string>& guests, const Trial& trial);
  [[nodiscard]] bool is_at_gate(const std::vector<std::string>& guests) const;
  [[nodiscard]] bool exclude_each_other(const std::vector<std::string>& guests,
                                        const std::vector<std::string>& others) const;
  [[nodiscard]] bool may_touch(const Forecast& driver, const Forecast& other) const;
  [[nodiscard]] bool may_meet_people(const std::vector<std::string>& guests);
  [[nodiscard]] double worth(const std::vector<std::string>& guests) const;

  // Guests of each control zone: coordinator_offers.cpp
  void find_zones();
  [[nodiscard]] int zone_of(int corridor) const;
  [[nodiscard]] int zone_of(const std::string& guest) const;
  class GateView;  // coordinator_gate.cpp
  [[nodiscard]] std::vector<std::string> guests_at_gate();
  [[nodiscard]] std::vector<std::vector<std::string>> groups_of_guests();
  [[nodiscard]] std::vector<std::string> crossings_to_offer();
  [[nodiscard]] std::vector<std::vector<std::string>> groups_at_lights();
  [[nodiscard]] std::vector<std::vector<std::string>> in_order(
      std::vector<std::vector<std::string>> groups);
  [[nodiscard]] std::map<int, ZoneOffers> offers_of_zones(
      const std::vector<std::vector<std::string>>& groups, const Trial& without);
  [[nodiscard]] ZoneVerdict verdict(const Trial& trial, int zone) const;
  [[nodiscard]] bool allows(const std::vector<std::string>& guests, int zone, const Trial& with,
                            const Trial& without);
  [[nodiscard]] Trial best_trial_by_zones(const std::map<std::string, Driven>& arrivals,
                                          const std::set<std::string>& excluded,
                                          const std::vector<std::int64_t>& upset,
                                          const std::vector<std::vector<std::string>>& groups,
                                          std::optional<Trial> tried);

  /// The normal lane that a vehicle is on, and the one it was on before; how long it has stood.
  struct Trail {
    int lane = LaneGraph::kNone;
    int before = LaneGraph::kNone;
    std::optional<Pose> watched;  ///< where it was last on a lane that matters; see is_watched()
    int stood = 0;                ///< decisions in a row
  };
  Traffic& traffic_;
  CoordinatorOptions options_;
  LaneGraph graph_;
  std::vector<bool> coordinated_;
  std::vector<int> zone_of_junction_;
  CourseFinder finder_;
  CorridorMap corridors_;
  const DrivableArea& area_;
  Predictor predictor_;
  LaneKeeping keeping_;
  Gate gate_;
  Straddling straddling_;
  ExitLanes exit_lanes_;
  WrongLanes wrong_lanes_;
  std::optional<SignalHeads> heads_;
  std::optional<GreenLanes> greens_;
  std::unique_ptr<HumanDrivers> humans_;
  std::optional<People> people_;
  DecisionGrid grid_;
  std::int64_t step_ = 0;
  std::int64_t next_key_ = 0;
  std::map<std::string, Driven> driven_;
  JointPlan plan_;
  bool plan_touches_ = false;  ///< some of them would touch; else it was judged to be clear
  std::vector<Forecast> forecasts_;
  std::unordered_map<std::string, Trail> trails_;
  std::map<std::string, VehicleType> types_;
  std::map<std::string, std::string> undriven_;    ///< what -> why
  std::vector<std::vector<std::int64_t>> groups_;  ///< keys, of the last decision
  Stagnation stagnation_;
  std::map<std::string, int> turned_away_;  ///< decisions for which newcomers had to wait
  std::map<std::int64_t, int> standing_;    ///< decisions in a row without a complete plan, by key
  std::map<std::int64_t, int> refusals_;    ///< of the referee in a row, by key
  std::set<std::string> lost_;              ///< under control, but they do not obey
  std::vector<FaultEvent> losses_;
  std::map<std::string, VehicleState> believed_;  ///< vehicles that go on into other corridors
  std::map<std::string, std::shared_ptr<const SpeedProfile>> announced_;  ///< to the traffic
  /// By key; kept only where plans take effect later.
  std::map<std::int64_t, std::shared_ptr<const SpeedProfile>> executed_;
  std::set<std::int64_t> blocking_guests_;  ///< keys, at the last decision
  std::vector<Replan> replans_;
  bool left_without_plan_ = false;  ///< somebody, by the last trial
  std::vector<std::string> taken_over_;
  std::vector<std::string> handed_back_;
  std::int64_t guest_sightings_ = 0;
};

}  // namespace mvtp
