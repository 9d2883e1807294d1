#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "planner/lot/lot_motion.hpp"
#include "planner/motion/motion_primitives.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/problem/parking_lot.hpp"
#include "planner/search/joint_motion.hpp"
#include "planner/search/soft_hybrid_astar.hpp"

namespace mvtp {

/// A body that stands on the lot and does not move.
struct StandingCar {
  Pose pose;
  Vehicle body;
};

/// A car that asks for a path.
struct LotRequest {
  std::int64_t key = 0;
  Vehicle body;
  Pose pose;
  double speed = 0.0;       ///< [m/s] >= 0; a moving car is in an entry lane
  std::vector<Pose> goals;  ///< any of them will do
  bool leaves = false;      ///< the goals are in exit lanes, where it drives on
  int entry = -1;           ///< the entry lane in which it is; -1: elsewhere, at rest
};

struct LotPlannerOptions {
  LotLimits limits;
  double margin = 0.12;   ///< [m] around each body, of planned paths
  double gap = 0.04;      ///< [m] around each body, of the order of passage; <= margin - 0.08
  double ahead = 2.5;     ///< [s] for which no path is changed; long enough to brake to rest
  int expansions = 2000;  ///< of one search
  double weight = 1.5;    ///< of the cost-to-go
  double decision = 0.5;  ///< [s] from one to the next
  /// GroupRobots; false: PBCR decides every motion, and nobody has a complete plan.
  bool plans_groups = true;
  int max_group = 5;    ///< PreCheck: cars that are planned anew together, at most
  bool regroup = true;  ///< plan groups anew; false: each car once, against all earlier ones
  double worth = 2.0;   ///< [s] of waiting ahead, from which on a group is planned anew
};

struct LotAdmission {
  std::size_t goal = 0;  ///< index of the request's
  double alone = 0.0;    ///< [s] that the path would take with nobody else moving
  int replanned = 0;     ///< cars under way whose paths changed
};

/// Plans on an open lot for cars that come and go while others are under way: ESCoT, lifelong.
///
/// Each call is one generate_config() over a World. Every car under way has a complete path (soft
/// space-time hybrid A* over MotionPrimitives), and all of them an order that lets everyone arrive;
/// a new plan replaces it only if that holds for it too, as told by a forecast of the motion
/// itself. All poses in the lot's own frame: ground in x, y > 0.
class LotPlanner {
 public:
  /// So far a car drives on beyond a goal in an exit lane [m].
  static constexpr double kRunOut = 1.5;

  /// @param lot  its ground lies in x, y > 0
  LotPlanner(const ParkingLot& lot, const LotPlannerOptions& options);
  LotPlanner(const LotPlanner&) = delete;
  LotPlanner& operator=(const LotPlanner&) = delete;

  /// Who stands on the lot from now on, cars that ask for a path left out.
  void set_standing(std::vector<StandingCar> standing);

  /// Finds a path for one more car, and puts it on it.
  /// @param waiting  others that ask for a path, and stand where they are until they have one
  /// @return nullopt if there is none now; nothing has changed then
  [[nodiscard]] std::optional<LotAdmission> admit(LotMotion& motion, const LotRequest& request,
                                                  std::span<const StandingCar> waiting);

  /// One decision for those under way: looks for an order in which the car that loses most gets on
  /// earlier; PBCR moves those without a plan. @return cars replanned
  int decide(LotMotion& motion, std::span<const StandingCar> waiting);

  /// How far it is to a goal, about [m].
  [[nodiscard]] double distance(const Vehicle& body, const Pose& from, const Pose& goal);

  /// How far a car that comes in at this speed drives on before its path can turn [m].
  [[nodiscard]] double prefix_length(double speed) const;

  /// Tables of costs-to-go kept and cars that wait for a further attempt, for one who looks after
  /// the memory.
  [[nodiscard]] std::size_t costs_kept() const { return costs_to_go_.size(); }
  [[nodiscard]] std::size_t failures_kept() const { return failed_.size(); }
  static constexpr std::size_t kMostCosts = 500;  ///< kept from one decision to the next

 private:
  class ReplanningSession;
  class World;
  using GoalKey = std::tuple<double, double, double, double, double>;

  static constexpr double kTimeStep = 0.05;  ///< [s]
  static constexpr double kPrimitive = 1.0;  ///< [m] driven in one macro step
  static constexpr int kMostRobots = 1000;   ///< in one search: cars, goals and those who wait

  struct KnownCost {
    CostToGo cost;
    std::int64_t used = 0;  ///< in this decision, for the last time
  };

  /// The obstacles of those who drive on the lot, or in an entry lane.
  struct Ground {
    Map map;
    std::unique_ptr<Obstacles> obstacles;
    void refresh();
  };

  [[nodiscard]] CostToGo make_cost_to_go(const Vehicle& body, const Pose& goal);
  /// Valid until the next decision.
  [[nodiscard]] const CostToGo& cost_to_go(const Vehicle& body, const Pose& goal);
  void begin_decision();
  [[nodiscard]] const Ground& ground_of_leaving(const Vehicle& body, const Pose& goal);
  /// The body with its margin, and the curves and speed that it is planned with.
  [[nodiscard]] Vehicle grown(Vehicle body) const;
  [[nodiscard]] bool in_entry(const Vehicle& body, const Pose& pose) const;

  ParkingLot lot_;
  LotPlannerOptions options_;
  TimeGrid time_;
  Clearance clearance_ = Clearance::unknown();
  Map walls_;
  Obstacles entries_;  ///< the strips of the entry lanes
  Ground open_;        ///< for cars in an entry lane
  Ground closed_;      ///< for all others: the entry lanes are closed, as exit lanes are for both
  Map exits_open_;     ///< for those who leave: the entry lanes are closed;
  std::map<std::tuple<double, double, double>, Ground> leaving_;  ///< by front overhang and goal
  KeepClear footpaths_;
  std::map<double, std::shared_ptr<const ObstacleGrid>> grids_;
  std::map<GoalKey, KnownCost> costs_to_go_;
  std::int64_t decisions_ = 0;
  SoftHybridAstar search_{kMostRobots};
  std::int64_t improvements_ = 0;  ///< attempts so far
  /// PreCheck: a car for which no better order was found is not tried again before that attempt.
  std::map<std::int64_t, std::int64_t> failed_;
};

}  // namespace mvtp
