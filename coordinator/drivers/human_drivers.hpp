#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "coordinator/corridor/corridor.hpp"
#include "coordinator/prediction/known_intent.hpp"
#include "coordinator/prediction/prediction.hpp"
#include "coordinator/prediction/tube.hpp"
#include "coordinator/signals/signal_heads.hpp"

namespace mvtp {

class LaneKeeping;
class PhaseChoice;

/// The ground ahead of a driver on which he may be at some moments.
struct ExpectedGround {
  /// Metres along his path from where he is to where his rear axle may be.
  struct Reach {
    double least = 0.0;
    double most = 0.0;
  };
  bool passes = false;         ///< he has green, or is behind his line; else he stays before it
  std::vector<int> paths;      ///< in the PathLibrary: one if it is known where he turns
  std::vector<Reach> reaches;  ///< one for each moment, over all these paths
};

/// Human-driven vehicles at signals that the coordinator owns. Each is an agent of the planner
/// whose only decision is when it gets green: its passage is planned first, then the signal is
/// shown, as late as it does not brake for red. Where changes cost time, greens are those of one
/// phase of the signal at a time (PhaseChoice), and last until it ends. A green that is shown is
/// taken back only from one who leaves the lane, or who can still stop when his light turns yellow.
///
/// Safety: as long as a driver is inside his tube, those under control keep clear of him, and so do
/// other drivers. Liveness: one at red waits before the line, where it blocks nobody across.
class HumanDrivers {
 public:
  /// The plan that a vehicle under control follows; nullptr if it is not under control.
  using PlanOf = std::function<const SpeedProfile*(const std::string&)>;

  HumanDrivers(Traffic& traffic, LaneKeeping& keeping, const LaneGraph& graph,
               CorridorMap& corridors, Predictor& predictor, const std::vector<bool>& coordinated,
               SignalHeads& heads, const DecisionGrid& grid, KnownIntent intent, PlanOf plan_of);
  HumanDrivers(HumanDrivers&&) = delete;
  ~HumanDrivers();

  /// Is the next coordinated line on its route one with an owned light?
  [[nodiscard]] bool decides_for(const CourseQuery& query) const;
  /// Is a vehicle on this lane inside a coordinated junction?
  [[nodiscard]] bool is_inside(int lane) const;

  /// A decision begins: who is not seen until the end of it has left.
  void begin(std::int64_t step);
  /// Somebody `to_line` [m] before his line, or inside. The last edge before it may be short.
  void see(const VehicleState& vehicle, const CourseQuery& query, double to_line,
           const VehicleType& type);
  void end();

  [[nodiscard]] bool knows(const std::string& id) const { return agents_.contains(id); }
  /// Has it green, or is it behind its line?
  [[nodiscard]] bool passes(const std::string& id) const;
  /// Does it stop before its line, whatever it is shown? A green ends while who has no planned
  /// passage can still stop.
  [[nodiscard]] bool has_to_wait(const std::string& id) const;
  /// What it may do if it passes, one forecast for each movement; none if it is not known.
  [[nodiscard]] std::vector<Forecast> passages(const std::string& id) const;

  /// Where it may be some steps after `step`, as the last decision expects it; nullopt if it is not
  /// known, or what was expected is older than that.
  /// @param where  its rear axle at `step`
  [[nodiscard]] std::optional<ExpectedGround> ground_of(const std::string& id, const Pose& where,
                                                        std::int64_t step,
                                                        std::span<const int> later) const;

  /// Groups of drivers that may get green now, the longest waiting first: each group wholly or not
  /// at all, and any of them beside each other. Nobody of a group meets a driver who has green.
  [[nodiscard]] std::vector<std::vector<std::string>> propose();
  /// How long he has waited [s]; infinite if his light is green.
  [[nodiscard]] double waited(const std::string& id) const;
  /// Who stands first at his line, in the phase that is on, with nobody on foot before him.
  [[nodiscard]] std::vector<std::string> first_at_lines() const;
  /// The passage of this one is planned: shows it green.
  void grant(const std::string& id);
  /// What it is worth that these pass now [s]: what they have waited, and what a stop costs those
  /// who still move. Others should not lose more by it: who waits until his own loss is as great
  /// loses at most twice what is inevitable (the rent-or-buy rule).
  [[nodiscard]] double worth(const std::vector<std::string>& ids) const;
  /// Do those who have this light cross his path?
  [[nodiscard]] bool is_crossed_by(const std::string& id, int light) const;
  /// Would one of them meet a vehicle under control that follows this plan on its path?
  [[nodiscard]] bool may_meet(const std::vector<std::string>& ids, int path,
                              const SpeedProfile& plan) const;

  /// Everything is decided: ends greens that nobody needs any more.
  void settle();
  /// Nobody plans: the signals run their own programs, and drivers do as SUMO's do.
  void release_all();

  [[nodiscard]] std::int64_t greens() const { return heads_.greens(); }
  /// Drivers who left their tubes within a decision, summed over the decisions.
  [[nodiscard]] std::int64_t tube_misses() const { return tube_misses_; }
  /// Drivers who could not stop any more before a red light, or got green without a plan.
  [[nodiscard]] std::int64_t unplanned_passages() const { return unplanned_; }

 private:
  /// One movement that it may drive.
  struct Movement {
    std::vector<int> links;
    int corridor = 0;
    TubeDriver driver;
    double s_clear = 0.0;  ///< station behind the junction where its tail is clear of it [m]
    Forecast forecast;     ///< its tube from this decision on, with green
  };
  struct Agent {
    std::string id;
    std::string lane;
    std::vector<int> links;  ///< connections by which it may go on; one light each
    std::vector<Movement>
        movements;          ///< one if it is known where it goes, else one for each movement
    double to_line = 0.0;   ///< [m]
    double position = 0.0;  ///< on its lane [m]
    double speed = 0.0;
    Pose pose;
    Pose front;  ///< of the middle of its front bumper
    double length = 0.0;
    bool granted = false;
    bool inside = false;
    bool seen = false;
    std::int64_t came = 0;  ///< step
    double waited = 0.0;    ///< [s] lost before the line so far
    /// Drivers for whom it does not wait inside the junction, though it yields to their movements.
    std::set<std::string> goes_before;
    /// Behind the movements, what does not depend on them: its line, how it brakes and speeds up.
    [[nodiscard]] const TubeDriver& driver() const { return movements.front().driver; }
    /// How far it may have come at the next decision, at least and at most [m].
    std::optional<std::pair<double, double>> expected;
  };

  [[nodiscard]] static TubeView tube_of(const Movement& movement) {
    return {movement.forecast.earliest, *movement.forecast.latest};
  }
  [[nodiscard]] int link_ahead(const CourseQuery& query) const;
  [[nodiscard]] CourseQuery before_line(const CourseQuery& query) const;
  [[nodiscard]] std::vector<int> links_of(const CourseQuery& query) const;
  [[nodiscard]] std::vector<int> links_in_question(const CourseQuery& query, double to_line) const;
  [[nodiscard]] std::vector<Movement> movements_of(const VehicleState& v, const CourseQuery& query,
                                                   double to_line, const VehicleType& type) const;
  void check_tube(Agent& agent, const Pose& front);
  void set_driver(Movement& movement, const RoadVehicle& road, double to_line,
                  const VehicleState& v, const VehicleType& type) const;
  void remember_lanes();
  [[nodiscard]] std::vector<std::string> who_waits_for(const Agent& agent) const;
  void predict_all();
  void predict(Agent& agent);
  [[nodiscard]] const SpeedProfile& fastest(const Agent& agent) const;
  [[nodiscard]] const SpeedProfile& slowest(const Agent& agent) const;
  [[nodiscard]] bool yields_to(const std::vector<int>& links, const std::vector<int>& others) const;
  [[nodiscard]] bool let_each_other_pass(const Agent& a, const Agent& b) const;
  [[nodiscard]] bool may_come(const Agent& agent) const;
  [[nodiscard]] bool awaits(const Agent& agent, const Agent& other) const;
  void pass_before_who_waits(Agent& agent) const;
  [[nodiscard]] std::int64_t yields_until(const Agent& agent, const Movement& movement) const;
  [[nodiscard]] bool turns_elsewhere(const Agent& agent, const VehicleState& leader) const;
  [[nodiscard]] std::optional<double> lead_of(const Agent& agent, const Movement& movement,
                                              const VehicleState& v) const;
  [[nodiscard]] std::vector<TubeLeader> leaders_of(const Agent& agent,
                                                   const Movement& movement) const;
  [[nodiscard]] bool is_due(const Agent& agent) const;
  [[nodiscard]] bool is_first(const Agent& agent) const;
  [[nodiscard]] bool may_have_green(const Agent& agent) const;
  [[nodiscard]] bool has_room_behind(const Agent& agent, const Movement& movement) const;
  [[nodiscard]] std::vector<const Agent*> with_followers(const Agent& first) const;
  [[nodiscard]] bool must_end(int link) const;
  [[nodiscard]] double latest_at_line(const Agent& agent) const;
  [[nodiscard]] double green_left(const Agent& first) const;
  /// Those who may have green beside a light that they cross.
  enum class Beside { kDrivers, kPeople };
  [[nodiscard]] bool may_turn_green(int link, Beside beside) const;
  [[nodiscard]] bool is_shown_green(const Agent& agent) const;
  [[nodiscard]] bool is_in_phase(const Agent& agent) const;
  [[nodiscard]] bool goes_on_ahead(const VehicleState& v) const;
  [[nodiscard]] bool is_behind_one_who_waits(const Agent& agent) const;
  [[nodiscard]] bool may_end(int link) const;
  [[nodiscard]] bool will_stop_at_yellow(const Agent& agent) const;
  [[nodiscard]] bool will_pass_at_yellow(const Agent& agent) const;
  [[nodiscard]] bool has_stopped_after_all(const Agent& agent) const;
  void take_back_greens();
  void complete_phases();
  [[nodiscard]] bool go_together(const Agent& a, const Agent& b) const;
  [[nodiscard]] bool cross(const Agent& a, const Agent& b) const;
  [[nodiscard]] bool can_stop_after(const Agent& agent, double seconds) const;
  [[nodiscard]] bool may_meet(const Agent& a, const Agent& b) const;
  [[nodiscard]] bool come_from_one_lane(const Agent& a, const Agent& b) const;
  void drop(const Agent& agent);
  [[nodiscard]] int slack_before() const;
  [[nodiscard]] int slack_behind() const;
  [[nodiscard]] double length_of(const std::string& type) const;
  [[nodiscard]] ExpectedGround::Reach reach_of(const Agent& agent, const Movement& movement,
                                               const Pose& where, std::int64_t then) const;

  Traffic& traffic_;
  LaneKeeping& keeping_;
  const LaneGraph& graph_;
  CorridorMap& corridors_;
  Predictor& predictor_;
  const std::vector<bool>& coordinated_;
  DecisionGrid grid_;
  SignalHeads& heads_;
  KnownIntent intent_;
  PlanOf plan_of_;
  std::unique_ptr<PhaseChoice> phases_;  ///< none: each light goes alone
  std::int64_t step_ = 0;
  std::map<std::string, Agent> agents_;
  std::map<std::string, std::string> origins_;     ///< the last lane before a junction, by vehicle
  mutable std::map<std::string, double> lengths_;  ///< [m] by type
  std::int64_t tube_misses_ = 0;
  std::int64_t unplanned_ = 0;
};

}  // namespace mvtp
