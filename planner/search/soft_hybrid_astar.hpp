#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "planner/motion/cost_to_go.hpp"
#include "planner/motion/motion_primitives.hpp"
#include "planner/motion/reeds_shepp.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/search/occupancy.hpp"

namespace mvtp {

/// The other robots, as one robot's search sees them. All spans are indexed by robot.
struct OtherRobots {
  const Occupancy* occupancy = nullptr;  ///< without the robot that is searched for
  std::span<const ArcTrajectory> trajectories;
  std::span<const BoxShape> shapes;
  std::span<const float> soft_costs;  ///< of overlapping robot j for one macro step of time [s]
  int horizon = std::numeric_limits<int>::max();  ///< nobody is seen from this macro step on
};

/// One robot's path from a pose at a time to its goal.
struct SoftProblem {
  const MotionPrimitives* car = nullptr;
  const CostToGo* cost_to_go = nullptr;  ///< names the goal
  OtherRobots others;
  Pose start;
  int start_macro_step = 0;
  int deadline = std::numeric_limits<int>::max();  ///< arrival, in time steps
  int direction = 0;    ///< in which it drives at the start: 1 forwards, -1 in reverse, 0 at rest
  bool leaves = false;  ///< nobody can touch it any more once it has arrived
  std::span<const Arc> tail = {};  ///< driven from the goal of cost_to_go on: to the true goal
};

struct SoftOptions {
  double weight = 1.5;         ///< of the cost-to-go, >= 1
  int max_expansions = 1000;   ///< > 0
  double cell = 1.5;           ///< side of a cell in which one node is kept [m]
  double cell_heading = 0.35;  ///< [rad]
  int cell_macro_steps = 2;    ///< macro steps of time that share a cell
  double reversal = 0.0;       ///< soft-collision cost of a change of direction [s]
  bool slowly = false;         ///< slow motion primitives, too: for tight places
  bool hard = false;           ///< nobody may be touched, at whatever soft-collision cost
  /// May it wait anywhere for any time, or only for less than a cell's macro steps at once? Paths
  /// out of tight places are found among fewer nodes then.
  bool waits = true;

  /// For paths among others that all rest: there is nothing to wait for.
  void leave_out_time() {
    cell_macro_steps = std::numeric_limits<int>::max();
    waits = false;
  }
  /// Smaller cells, for tight places.
  void refine() {
    cell /= 2;
    cell_heading /= 1.5;
  }
};

/// What the search found.
struct SoftResult {
  std::vector<Arc> steps;  ///< one per time step from the start of start_macro_step on
  double cost = 0.0;       ///< arrival and soft-collision costs of all overlaps and reversals [s]
  double soft_cost = 0.0;  ///< of overlaps alone: 0 if nobody is overlapped
};

/// Weighted hybrid A* in (x, y, theta, t) that may drive through other robots at a soft-collision
/// cost.
///
/// Primitives last one macro step of time; Reeds-Shepp analytic expansions lead to the goal
/// exactly, one arc per time step. Resting on the goal costs the soft-collision cost of whoever
/// passes later, and the cost-to-go knows when the goal gets free. Map, obstacles and the deadline
/// are hard. The best path found so far is returned when the expansions run out, or the time.
/// Source of the soft collisions: LNS2, Li et al. 2022. One object per thread: it keeps its memory.
class SoftHybridAstar {
 public:
  explicit SoftHybridAstar(int robots)
      : found_(std::size_t(robots) + Occupancy::kPadding),
        around_list_(std::size_t(robots) + Occupancy::kPadding) {}

  [[nodiscard]] std::optional<SoftResult> search(const SoftProblem& problem,
                                                 const SoftOptions& options,
                                                 const Deadline& deadline);

  /// Expansions of all searches so far.
  [[nodiscard]] std::int64_t expansions() const { return expansions_; }
  /// Cells of the last search, for one who looks after the memory.
  [[nodiscard]] std::size_t cells() const { return cells_.size(); }

 private:
  struct Node {
    Frame at;
    float soft_cost;
    float f;
    int parent;
    int macro_step;
    int turns;
    std::int8_t primitive;
    std::int8_t direction;  ///< of the last drive: 1, -1, or 0 if there was none
  };
  /// How far an analytic expansion has been propagated.
  struct PropagatedState {
    Frame at;
    double theta;
    int macro_step;
    int time_steps = 0;  ///< of this macro step driven so far, their boxes in boxes_
    double soft_cost = 0.0;
  };
  struct AnalyticExpansion {
    int node = -1;
    ReedsSheppPath arcs;
    double cost = std::numeric_limits<double>::infinity();
    double soft_cost = 0.0;
  };

  void start_search();
  void soft_cost_of_resting();
  [[nodiscard]] float soft_cost(int macro_step, const BoxPose* boxes, float travel, float radius);
  /// Keeps whom a body within the circle might touch during a macro step, as far as others are
  /// seen.
  void update_neighbours(int macro_step, const BoxPose& middle, float radius);
  /// Keeps of those around whom a motion might touch. @return whether there is anyone
  [[nodiscard]] bool anyone_nearby(int macro_step, const BoxPose& halfway, float radius,
                                   const SweptBox& swept);
  [[nodiscard]] float soft_cost_of_nearby(int macro_step, const BoxPose* boxes, float travel);
  [[nodiscard]] float soft_cost_of_primitive(int macro_step, const Frame& from,
                                             const BoxPose& halfway,
                                             const MotionPrimitives::Primitive& primitive);
  [[nodiscard]] double heading(int turns) const { return problem_->start.theta + turns * turn_; }
  [[nodiscard]] Pose pose(const Node& node) const {
    return {node.at.x, node.at.y, heading(node.turns)};
  }
  [[nodiscard]] double to_go(double x, double y, double theta) const;
  [[nodiscard]] float estimate(double soft_cost, int macro_step, double to_go) const;
  /// The least f of the nodes at a place and time so far; infinity if there was none.
  [[nodiscard]] float& least_f_at(double x, double y, double theta, int macro_step);
  [[nodiscard]] double cost_of_reversals(int direction, std::span<const Arc> arcs) const;
  [[nodiscard]] bool tries_analytic_expansion(int expansion, const Node& node) const;
  void expand(int node);
  void try_primitive(int node, int a);
  void try_analytic_expansion(int node);
  [[nodiscard]] double follow(const Pose& start, int macro_step, std::span<const Arc> arcs,
                              double most);
  [[nodiscard]] bool propagate_primitive(PropagatedState& state,
                                         const MotionPrimitives::Primitive& primitive);
  [[nodiscard]] bool propagate_arc(PropagatedState& state, const Arc& arc, int time_steps);
  void end_macro_step(PropagatedState& state);
  /// The path behind an analytic expansion, the tail included; valid until the next call.
  [[nodiscard]] std::span<const Arc> to_the_end(const ReedsSheppPath& analytic_expansion);
  [[nodiscard]] bool waits_in_its_cell(const Node& node) const;
  void push(const Node& node);
  [[nodiscard]] SoftResult path();

  std::vector<int> found_;        ///< the first nearby_ are those near the motion in question
  std::vector<int> around_list_;  ///< the first around_ are those near the node in question
  int nearby_ = 0;
  int around_ = 0;
  std::vector<Node> nodes_;
  std::vector<std::pair<float, int>> open_;
  std::unordered_map<std::uint64_t, float> cells_;  ///< see least_f_at(), of the last search
  std::vector<float> rest_soft_cost_;               ///< of resting on the goal from macro step k on
  std::vector<float>
      rest_cost_;  ///< least arrival time plus rest soft-collision cost from macro step k on
  std::vector<BoxPose> boxes_;
  AnalyticExpansion best_;
  std::int64_t expansions_ = 0;

  // Of the search under way.
  const SoftProblem* problem_ = nullptr;
  SoftOptions options_;
  double macro_step_duration_ = 0.0;
  double turn_ = 0.0;
  double tail_duration_ = 0.0;
  std::vector<Arc> to_the_end_;
};

}  // namespace mvtp
