#include "planner/lot/replanning_session.hpp"

#include <cmath>

#include "planner/search/reeds_shepp_planner.hpp"

namespace mvtp {
namespace {

constexpr double kAnySoftCost = 1.0;  ///< [s] per macro step: the searches are hard
constexpr int kMoreAlone = 8;         ///< times the expansions of a thorough search alone,
constexpr int kMoreAmongOthers = 4;   ///< and among others
constexpr int kLatest = 200;          ///< time steps that a path alone may begin later
constexpr double kTail = 12.0;        ///< [m] before a slot that are driven as if alone

SoftOptions soft_options(const LotPlannerOptions& options) {
  SoftOptions soft;
  soft.weight = options.weight;
  soft.max_expansions = options.expansions;
  soft.cell = 0.8;
  soft.cell_heading = 0.25;
  soft.waits = false;  // who finds no path waits where it stands, and asks again
  soft.reversal = options.limits.speed / options.limits.braking;
  return soft;
}

}  // namespace

LotPlanner::ReplanningSession::ReplanningSession(LotPlanner& planner, const LotMotion& motion,
                                                 const LotRequest* request,
                                                 std::span<const StandingCar> waiting)
    : planner_(planner), motion_(motion), forecast_(motion.forecast()) {
  add_cars();
  if (request != nullptr) add_request(*request);
  const std::size_t first_standing = robots_.size();
  for (const StandingCar& car : waiting) add_standing(car);
  if (request != nullptr && request->entry >= 0) {
    add_queue(*request, macro_robots_[std::size_t(robot_of_goal(0))].start);
  }
  joint_.emplace(macro_robots_, planner_.time_);
  for (int i = 0; i < cars(); ++i) joint_->place(i, forecast_trajectory(i));
  for (std::size_t i = first_standing; i < robots_.size(); ++i) {
    const MacroRobot& robot = macro_robots_[i];
    joint_->place(int(i),
                  ArcTrajectory(robot.car->vehicle(), robot.start, {}, planner_.time_.macro_step));
  }
}

void LotPlanner::ReplanningSession::add(Robot robot, const Pose& start, bool in_entry) {
  const Ground& ground = in_entry       ? planner_.open_
                         : robot.leaves ? planner_.ground_of_leaving(robot.body, robot.goal)
                                        : planner_.closed_;
  // Who stands needs no margin of its own, no more than those that are solid.
  const Vehicle body = robot.stands ? robot.body : planner_.grown(robot.body);
  macro_cars_.push_back(std::make_unique<MotionPrimitives>(body, planner_.time_, ground.map,
                                                           *ground.obstacles, planner_.clearance_));
  const CostToGo* const to_go =
      robot.stands ? nullptr : &planner_.cost_to_go(robot.body, robot.goal);
  macro_robots_.push_back({macro_cars_.back().get(), to_go, start});
  robots_.push_back(std::move(robot));
}

void LotPlanner::ReplanningSession::add_cars() {
  for (std::size_t i = 0; i < motion_.cars().size(); ++i) {
    const LotCar& car = motion_.cars()[i];
    const double braking = car.v * car.v / (2 * motion_.limits().braking);
    const double end = std::clamp(std::max(forecast_.driven_at(i, ahead()), car.s + braking), car.s,
                                  std::max(car.s, car.path.length()));
    Robot robot{car.body, car.path, car.s, car.v, 0, car.key, car.goal, car.leaves};
    robot.prefix.truncate(end);
    const bool moves = forecast_.driven_at(i, ahead() + kTimeStep) > end + 1e-3;
    if (moves || car.v > 0.0) robot.direction = car.path.direction_from(std::max(0.0, end - 1e-3));
    const Pose start = car.path.at(end);
    add(std::move(robot), start, planner_.in_entry(car.body, start));
  }
}

void LotPlanner::ReplanningSession::add_request(const LotRequest& request) {
  ArcPath prefix(request.pose);
  prefix.append({Arc{planner_.prefix_length(request.speed), 0.0}});
  for (const Pose& goal : request.goals) {
    Robot robot{request.body, prefix, 0.0, request.speed, 0, request.key, goal, request.leaves};
    robot.direction = prefix.direction_from(0.0);
    add(std::move(robot), prefix.at(prefix.length()), request.entry >= 0);
  }
}

void LotPlanner::ReplanningSession::add_standing(const StandingCar& car) {
  add({.body = car.body, .prefix = ArcPath(car.pose), .goal = car.pose, .stands = true}, car.pose,
      false);
}

/// The lane behind a car that comes in: the next ones follow it there.
void LotPlanner::ReplanningSession::add_queue(const LotRequest& request, const Pose& start) {
  constexpr double kBehind = 0.4;  // [m]
  const LotLane& lane = planner_.lot_.entries[std::size_t(request.entry)];
  const double along = relative(lane.begin, start).x;
  const double length = along - request.body.rear - planner_.options_.margin - kBehind;
  if (length < 0.5) return;
  Vehicle body = request.body;
  body.rear = 0.0;
  body.front = length;
  add({.body = body, .prefix = ArcPath(lane.begin), .goal = lane.begin}, lane.begin, true);
}

ArcTrajectory LotPlanner::ReplanningSession::forecast_trajectory(int i) const {
  const auto k = std::size_t(i);
  const LotCar& car = motion_.cars()[k];
  std::vector<Arc> steps;
  double s = robots_[k].prefix.length();
  Pose from = car.path.at(s);
  for (double t = ahead() + kTimeStep; t < forecast_.arrival(k) + kTimeStep; t += kTimeStep) {
    const double next = std::max(s, forecast_.driven_at(k, t));
    if (next - s < 1e-6) {
      steps.push_back({});
      continue;
    }
    const Pose to = car.path.at(next);
    const double length = car.path.direction_from((s + next) / 2) * (next - s);
    steps.push_back({length, wrap_to_pi(to.theta - from.theta) / length});
    from = to;
    s = next;
  }
  return {macro_robots_[k].car->vehicle(), macro_robots_[k].start, std::move(steps),
          planner_.time_.macro_step, car.leaves};
}

SoftProblem LotPlanner::ReplanningSession::problem(int robot) const {
  const MacroRobot& macro = macro_robots_[std::size_t(robot)];
  SoftProblem problem;
  problem.car = macro.car;
  problem.cost_to_go = macro.cost_to_go;
  problem.start = macro.start;
  problem.direction = robots_[std::size_t(robot)].direction;
  problem.leaves = robots_[std::size_t(robot)].leaves;
  return problem;
}

/// From both ends where it parks: one search may be lost where the other finds a path at once.
std::optional<ArcTrajectory> LotPlanner::ReplanningSession::alone(int robot, Effort effort) {
  const int expansions = planner_.options_.expansions * (effort == Effort::kQuick ? 1 : kMoreAlone);
  std::optional<SoftResult> path = search_alone(problem(robot), expansions);
  if (!robots_[std::size_t(robot)].leaves) {
    std::optional<SoftResult> other = search_alone_backwards(robot, expansions);
    if (other && (!path || other->cost < path->cost)) path = std::move(other);
  }
  std::optional<std::vector<Arc>> steps;
  if (path) steps = std::move(path->steps);
  if (!steps && effort == Effort::kThorough) steps = sample_alone(robot);
  if (!steps) return std::nullopt;
  const MacroRobot& macro = macro_robots_[std::size_t(robot)];
  return ArcTrajectory(macro.car->vehicle(), macro.start, *std::move(steps),
                       planner_.time_.macro_step, robots_[std::size_t(robot)].leaves);
}

/// Out of slots between long cars, or into them, for one that stands: there a lattice is too
/// coarse.
std::optional<std::vector<Arc>> LotPlanner::ReplanningSession::sample_alone(int robot) const {
  const Robot& r = robots_[std::size_t(robot)];
  if (r.v > 0.0 || r.prefix.length() > 0.0) return std::nullopt;
  const MotionPrimitives& car = *macro_robots_[std::size_t(robot)].car;
  const LotLimits& limits = planner_.options_.limits;
  SamplingOptions options;
  options.cusp = limits.speed * limits.speed / limits.braking;
  const std::optional<std::vector<Arc>> arcs = plan_by_sampling(
      macro_robots_[std::size_t(robot)].start, r.goal, car.vehicle().min_turning_radius,
      {planner_.walls_.width, planner_.walls_.height}, options,
      [&](const Pose& from, const Arc& arc) { return car.is_free(from, arc); });
  if (!arcs) return std::nullopt;
  return by_time_steps(*arcs, car.step_length());
}

std::optional<ArcTrajectory> LotPlanner::ReplanningSession::alone(int robot) {
  std::optional<ArcTrajectory> path = alone(robot, Effort::kQuick);
  return path ? std::move(path) : alone(robot, Effort::kThorough);
}

std::optional<SoftResult> LotPlanner::ReplanningSession::search_alone(SoftProblem problem,
                                                                      int expansions) {
  const Occupancy nobody(1, planner_.time_);
  problem.others = {.occupancy = &nobody};
  SoftOptions options = soft_options(planner_.options_);
  options.max_expansions = expansions;
  return planner_.search_.search(problem, options, Deadline::never());
}

/// From the goal to the start, driven the other way round.
std::optional<SoftResult> LotPlanner::ReplanningSession::search_alone_backwards(int robot,
                                                                                int expansions) {
  const Robot& r = robots_[std::size_t(robot)];
  SoftProblem reversed = problem(robot);
  const CostToGo to_start = planner_.make_cost_to_go(r.body, reversed.start);
  reversed.start = r.goal;
  reversed.cost_to_go = &to_start;
  reversed.direction = 0;
  std::optional<SoftResult> path = search_alone(reversed, expansions);
  if (!path) return path;
  std::ranges::reverse(path->steps);
  for (Arc& arc : path->steps) arc.length = -arc.length;
  return path;
}

/// The last metres of a path: a search among others need only find the rest.
std::vector<Arc> LotPlanner::ReplanningSession::tail(const ArcTrajectory& alone) const {
  ArcPath path(alone.start());
  path.append(alone.steps());
  std::vector<Arc> result;
  double left = kTail;
  for (auto piece = path.pieces().rbegin(); piece != path.pieces().rend() && left > 0.0; ++piece) {
    const double length = std::min(left, std::abs(piece->arc.length));
    result.push_back({piece->direction() * length, piece->arc.curvature});
    left -= length;
  }
  std::ranges::reverse(result);
  return result;
}

bool LotPlanner::ReplanningSession::plan(int robot, const ArcTrajectory& alone) {
  return plan(robot, alone, Effort::kQuick) || plan(robot, alone, Effort::kThorough);
}

/// Quickly: by a short search, or else the single-agent path, begun later.
bool LotPlanner::ReplanningSession::plan(int robot, const ArcTrajectory& alone, Effort effort) {
  SoftProblem soft = problem(robot);
  soft.others = joint_->others(robot, kAnySoftCost);
  const std::vector<Arc> tail = soft.leaves ? std::vector<Arc>{} : this->tail(alone);
  std::optional<CostToGo> to_tail;
  if (!tail.empty()) {
    Pose begin = robots_[std::size_t(robot)].goal;
    for (auto arc = tail.rbegin(); arc != tail.rend(); ++arc) {
      begin = drive(begin, Arc{-arc->length, arc->curvature});
    }
    to_tail.emplace(planner_.make_cost_to_go(robots_[std::size_t(robot)].body, begin));
    soft.cost_to_go = &*to_tail;
    soft.tail = tail;
  }
  SoftOptions options = soft_options(planner_.options_);
  options.hard = true;
  if (effort == Effort::kThorough) options.max_expansions *= kMoreAmongOthers;
  std::optional<SoftResult> path = planner_.search_.search(soft, options, Deadline::never());
  if (!path && effort == Effort::kQuick) return drive_alone_later(robot, alone);
  if (!path || comes_back_into_entry(robot, path->steps)) return false;
  joint_->place(robot, ArcTrajectory(soft.car->vehicle(), soft.start, std::move(path->steps),
                                     planner_.time_.macro_step, soft.leaves));
  return true;
}

/// The single-agent path, begun as soon as it touches nobody.
bool LotPlanner::ReplanningSession::drive_alone_later(int robot, const ArcTrajectory& alone) {
  if (comes_back_into_entry(robot, alone.steps())) return false;
  const bool leaves = robots_[std::size_t(robot)].leaves;
  return joint_->place_later(robot, alone.steps(), kLatest, leaves);
}

bool LotPlanner::ReplanningSession::comes_back_into_entry(int robot,
                                                          const std::vector<Arc>& steps) const {
  const MacroRobot& macro = macro_robots_[std::size_t(robot)];
  const Vehicle& body = robots_[std::size_t(robot)].body;
  if (!planner_.in_entry(body, macro.start)) return false;
  constexpr std::size_t kEvery = 10;  // steps between two looks
  Pose pose = macro.start;
  bool out = false;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    pose = drive(pose, steps[k]);
    const bool reverses = steps[k].length < 0.0 && (k == 0 || steps[k - 1].length >= 0.0);
    if (k % kEvery != 0 && !reverses) continue;
    const bool in = planner_.in_entry(body, pose);
    if (in && (out || reverses)) return true;
    out = out || !in;
  }
  return false;
}

std::vector<int> LotPlanner::ReplanningSession::blockers_of(int robot,
                                                            const ArcTrajectory& trajectory) {
  joint_->place(robot, trajectory);
  std::vector<int> result = joint_->conflicts_of(robot);
  (void)joint_->remove(robot);
  return result;
}

std::vector<int> LotPlanner::ReplanningSession::plan_before(int robot, const ArcTrajectory& alone,
                                                            std::span<const int> others) {
  for (const int i : others) (void)take(i);
  if (!plan(robot, alone)) return {};
  std::vector<int> group = {robot};
  for (const int i : others) {
    const std::optional<ArcTrajectory> path = this->alone(i);
    if (!path || !plan(i, *path)) return {};
    group.push_back(i);
  }
  return group;
}

}  // namespace mvtp
