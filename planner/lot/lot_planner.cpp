#include "planner/lot/lot_planner.hpp"

#include <algorithm>
#include <cmath>

#include "planner/lot/lot_ground.hpp"
#include "planner/lot/lot_world.hpp"
#include "planner/motion/inertial_car.hpp"

namespace mvtp {
namespace {

constexpr double kReach = 4.0;         ///< [m] of sweeps that are looked up quickly
constexpr double kSpareRadius = 1.02;  ///< times the turning radius: no bend is the tightest
constexpr double kInflation = 0.8;     ///< of half the width, on the grid of the cost-to-go
constexpr double kMouth = 0.5;         ///< [m] of an exit lane's begin that all may use
constexpr double kBeforeGoal = 0.4;    ///< [m] of it ahead of those who are at their goal there

}  // namespace

LotPlanner::LotPlanner(const ParkingLot& lot, const LotPlannerOptions& options)
    : lot_(lot),
      options_(options),
      walls_(walls_of(lot)),
      entries_(entry_strips(lot, walls_), kReach),
      footpaths_(lot.footpaths) {
  time_.dt = kTimeStep;
  time_.macro_step = std::max(2, int(kPrimitive / (options.limits.speed * kTimeStep)));
  set_standing({});
}

void LotPlanner::Ground::refresh() { obstacles = std::make_unique<Obstacles>(map, kReach); }

void LotPlanner::set_standing(std::vector<StandingCar> standing) {
  open_.map = walls_;
  for (const StandingCar& car : standing) open_.map.polygons.push_back(outline(car));
  exits_open_ = open_.map;
  for (const LotLane& lane : lot_.entries) exits_open_.polygons.push_back(entry_strip(lane));
  for (const LotLane& lane : lot_.exits) {
    open_.map.polygons.push_back(strip(lane, kMouth, lane.length));
  }
  closed_.map = open_.map;
  for (const LotLane& lane : lot_.entries) closed_.map.polygons.push_back(entry_strip(lane));
  open_.refresh();
  closed_.refresh();
  leaving_.clear();
}

/// Nobody drives past its goal in an exit lane and comes back: others have left there already, and
/// have human drivers.
const LotPlanner::Ground& LotPlanner::ground_of_leaving(const Vehicle& body, const Pose& goal) {
  const auto [place, is_new] = leaving_.try_emplace({body.front, goal.x, goal.y});
  Ground& ground = place->second;
  if (!is_new) return ground;
  ground.map = exits_open_;
  for (const LotLane& lane : lot_.exits) {
    const Pose local = relative(lane.begin, goal);
    const bool its_own = std::abs(local.y) < kMouth && local.x > 0.0 && local.x < lane.length;
    const double end = its_own ? local.x + body.front + kBeforeGoal : kMouth;
    if (end < lane.length) ground.map.polygons.push_back(strip(lane, end, lane.length));
  }
  ground.refresh();
  return ground;
}

CostToGo LotPlanner::make_cost_to_go(const Vehicle& body, const Pose& goal) {
  std::shared_ptr<const ObstacleGrid>& grid = grids_[body.width];
  if (!grid) grid = std::make_shared<ObstacleGrid>(walls_, kInflation * body.width / 2);
  return {goal, body.min_turning_radius * kSpareRadius, ReedsSheppTable::shared(), grid};
}

const CostToGo& LotPlanner::cost_to_go(const Vehicle& body, const Pose& goal) {
  const GoalKey key{goal.x, goal.y, goal.theta, body.min_turning_radius, body.width};
  auto known = costs_to_go_.find(key);
  if (known == costs_to_go_.end()) {
    known = costs_to_go_.emplace(key, KnownCost{make_cost_to_go(body, goal)}).first;
  }
  known->second.used = decisions_;
  return known->second.cost;
}

/// Forgets the costs-to-go used least recently, and failures that may be tried again.
void LotPlanner::begin_decision() {
  ++decisions_;
  std::erase_if(failed_, [this](const auto& failed) { return improvements_ >= failed.second; });
  if (costs_to_go_.size() <= kMostCosts) return;
  std::vector<std::int64_t> times;
  for (const auto& [goal, known] : costs_to_go_) times.push_back(known.used);
  const auto last = times.end() - std::ptrdiff_t(kMostCosts / 2);
  std::ranges::nth_element(times, last);
  std::erase_if(costs_to_go_,
                [oldest = *last](const auto& entry) { return entry.second.used < oldest; });
  if (costs_to_go_.size() > kMostCosts) costs_to_go_.clear();  // all in one decision
}

Vehicle LotPlanner::grown(Vehicle body) const {
  body.front += options_.margin;
  body.rear += options_.margin;
  body.width += 2 * options_.margin;
  body.min_turning_radius *= kSpareRadius;
  body.max_speed = options_.limits.speed;
  return body;
}

bool LotPlanner::in_entry(const Vehicle& body, const Pose& pose) const {
  return entries_.hit(Sweep(grown(body), pose, {}));
}

double LotPlanner::distance(const Vehicle& body, const Pose& from, const Pose& goal) {
  return cost_to_go(body, goal)(from);
}

double LotPlanner::prefix_length(double speed) const {
  const LotLimits& limits = options_.limits;
  double driven = 0.0;
  double v = speed;
  for (double t = 0.0; t < options_.ahead && speed > 0.0; t += kTimeStep) {
    const double next = std::max(limits.speed, v - limits.braking * kTimeStep);
    driven += (v + next) / 2 * kTimeStep;
    v = next;
  }
  return std::max(driven, stopping_distance(speed, limits.braking));
}

std::optional<LotAdmission> LotPlanner::admit(LotMotion& motion, const LotRequest& request,
                                              std::span<const StandingCar> waiting) {
  begin_decision();
  World world(*this, motion, &request, waiting);
  const std::vector<World::Motion> motions = generate_config(world, world.states());
  const std::optional<LotAdmission> result = world.carry_out(motions, motion);
  if (result) failed_.clear();
  return result;
}

int LotPlanner::decide(LotMotion& motion, std::span<const StandingCar> waiting) {
  const bool all_keep_their_plans =
      options_.plans_groups && (!options_.regroup || motion.cars().size() < 2);
  if (motion.cars().empty() || all_keep_their_plans) return 0;
  begin_decision();
  World world(*this, motion, nullptr, waiting);
  const std::vector<World::Motion> motions = generate_config(world, world.states());
  (void)world.carry_out(motions, motion);
  if (world.replanned() > 0) failed_.clear();
  return world.replanned();
}

}  // namespace mvtp
