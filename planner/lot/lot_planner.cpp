#include "planner/lot/lot_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "planner/lot/lot_ground.hpp"
#include "planner/lot/replanning_session.hpp"
#include "planner/motion/inertial_car.hpp"

namespace mvtp {
namespace {

constexpr double kReach = 4.0;         ///< [m] of sweeps that are looked up quickly
constexpr double kSpareRadius = 1.02;  ///< times the turning radius: no bend is the tightest
constexpr double kInflation = 0.8;     ///< of half the width, on the grid of the cost-to-go
constexpr double kMouth = 0.5;         ///< [m] of an exit lane's begin that all may use
constexpr double kBeforeGoal = 0.4;    ///< [m] of it ahead of those who are at their goal there
constexpr int kAttemptsAfterFailure = 10;
constexpr double kGain = 0.5;  ///< [s] that a new order must save at least

}  // namespace

LotPlanner::LotPlanner(const ParkingLot& lot, const LotPlannerOptions& options)
    : lot_(lot),
      options_(options),
      walls_(walls_of(lot)),
      entries_(entry_strips(lot, walls_), kReach),
      footpaths_(lot.footpaths) {
  time_.dt = kTimeStep;
  time_.macro_step = std::max(2, int(kAction / (options.limits.speed * kTimeStep)));
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

/// A request under way: places to choose from, and the best motion found so far.
class LotPlanner::RequestPlanner {
 public:
  RequestPlanner(LotPlanner& planner, const LotMotion& motion, const LotRequest& request,
                 std::span<const StandingCar> waiting)
      : options_(planner.options_),
        session_(planner, motion, &request, waiting),
        before_(session_.forecast().cost()) {
    find_choices(request.goals.size(), Effort::kQuick);
    if (choices_.empty()) find_choices(request.goals.size(), Effort::kThorough);
    std::ranges::stable_sort(choices_, {}, &Choice::duration);
  }

  /// As things are: the quickest place first, and that one again with more effort if none will do.
  void try_places() {
    for (const Choice& choice : choices_) try_place(choice, Effort::kQuick);
    if (!best_ && !choices_.empty()) try_place(choices_.front(), Effort::kThorough);
  }

  /// If it would have to wait for the quickest place: before those who are blocking its path there.
  void try_before_others() {
    if (!options_.regroup || choices_.empty()) return;
    const Choice& wish = choices_.front();
    if (best_ && best_->cost - before_ <= wish.duration + options_.worth) return;
    const int robot = session_.robot_of_goal(wish.goal);
    const std::vector<int> blockers = session_.in_the_way(robot, wish.alone);
    if (blockers.empty() || !session_.may_replan(blockers)) return;
    const std::vector<int> group = session_.plan_before(robot, wish.alone, blockers);
    if (!group.empty()) consider(wish, group);
  }

  /// The best that was found becomes the motion.
  [[nodiscard]] std::optional<LotAdmission> carry_out(LotMotion& motion) {
    if (!best_) return std::nullopt;
    motion = std::move(best_->motion);
    return LotAdmission{best_->goal, best_->alone, best_->replanned};
  }

 private:
  using Effort = ReplanningSession::Effort;

  struct Choice {
    std::size_t goal;
    ArcTrajectory alone;
    double duration;  ///< alone [s]
  };
  struct Candidate {
    LotMotion motion;
    double cost;
    std::size_t goal;
    double alone;
    int replanned;
  };

  void find_choices(std::size_t goals, Effort effort) {
    for (std::size_t g = 0; g < goals; ++g) {
      const int robot = session_.robot_of_goal(g);
      std::optional<ArcTrajectory> alone = session_.alone(robot, effort);
      if (!alone) continue;
      const double duration = session_.duration_alone(robot, *alone);
      choices_.push_back({g, *std::move(alone), duration});
    }
  }

  void try_place(const Choice& choice, Effort effort) {
    if (best_ && best_->cost - before_ <= choice.duration) return;  // it cannot get better
    const int robot = session_.robot_of_goal(choice.goal);
    if (!session_.plan(robot, choice.alone, effort)) return;
    consider(choice, std::array{robot});
    (void)session_.take(robot);
  }

  void consider(const Choice& choice, std::span<const int> changed) {
    LotMotion result = session_.result(changed);
    const LotForecast forecast = result.forecast();
    if (!forecast.complete || !forecast.gentle) return;
    const double cost = forecast.cost();
    if (best_ && cost >= best_->cost) return;
    best_ =
        Candidate{std::move(result), cost, choice.goal, choice.duration, int(changed.size()) - 1};
  }

  const LotPlannerOptions& options_;
  ReplanningSession session_;
  double before_;                ///< cost without the newcomer
  std::vector<Choice> choices_;  ///< places with a way alone, the quickest first
  std::optional<Candidate> best_;
};

std::optional<LotAdmission> LotPlanner::admit(LotMotion& motion, const LotRequest& request,
                                              std::span<const StandingCar> waiting) {
  begin_decision();
  RequestPlanner request_planner(*this, motion, request, waiting);
  request_planner.try_places();
  request_planner.try_before_others();
  const std::optional<LotAdmission> result = request_planner.carry_out(motion);
  if (result) failed_.clear();
  return result;
}

int LotPlanner::improve(LotMotion& motion, std::span<const StandingCar> waiting) {
  if (!options_.regroup || motion.cars().size() < 2) return 0;
  ++improvements_;
  begin_decision();
  ReplanningSession session(*this, motion, nullptr, waiting);
  int focus = -1;
  double most = options_.worth;
  for (int i = 0; i < session.cars(); ++i) {
    const LotCar& car = motion.cars()[std::size_t(i)];
    if (session.is_fixed(i) || failed_.contains(car.key)) continue;
    LotMotion alone(options_.limits);
    alone.put(car);
    const double lost = session.forecast().arrival(std::size_t(i)) - alone.forecast().arrival(0);
    if (lost <= most) continue;
    most = lost;
    focus = i;
  }
  if (focus < 0) return 0;
  const std::int64_t key = motion.cars()[std::size_t(focus)].key;
  failed_[key] = improvements_ + kAttemptsAfterFailure;
  (void)session.take(focus);
  const std::optional<ArcTrajectory> alone = session.alone(focus);
  if (!alone) return 0;
  const std::vector<int> blockers = session.in_the_way(focus, *alone);
  if (!session.may_replan(blockers)) return 0;
  const std::vector<int> group = session.plan_before(focus, *alone, blockers);
  if (group.empty()) return 0;
  LotMotion result = session.result(group);
  const LotForecast forecast = result.forecast();
  if (!forecast.complete || !forecast.gentle) return 0;
  if (forecast.cost() > session.forecast().cost() - kGain) return 0;
  motion = std::move(result);
  failed_.clear();
  return int(group.size());
}

}  // namespace mvtp
