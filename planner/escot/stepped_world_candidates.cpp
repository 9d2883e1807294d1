// What a robot may do in one step, best first: the reference path, the cost-to-go, and whom it
// blocks.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <ranges>
#include <utility>

#include "planner/escot/stepped_world.hpp"
#include "planner/search/noise.hpp"

namespace mvtp {
namespace {

// The score of a candidate is H(end) + kWeight * penalty * (1 + been there - greedy), as in the
// code of PBCR's authors: what it costs to get there counts less than where it leads.
constexpr double kWeight = 0.3;
constexpr double kTurnPenalty = 1.5;
constexpr double kReversePenalty = 2.0;
constexpr double kSwitchPenalty = 2.0;  // of driving direction
constexpr double kForget = 0.95;        // of having been there, per step
constexpr double kForgetPlain = 0.99;   // the same in the authors' code, per time it is there again
constexpr double kHeadOn = 3.0;         // there: straight on or back for who is pushed straight
// Giving way in time: contact nose to nose leaves a car nothing but the path back.
constexpr double kLookAhead = 6.0;  // [m] of those that have priority
constexpr double kBlocking = 0.9;   // [steps] of standing where they go
constexpr double kAside = 2.0;      // per metre that is left to leave their lane
constexpr double kUrgency = 0.1;    // more, per step that they have been kept from those paths
constexpr double kMaxUrgency = 3.0;
// A robot that is kept from its reference path longer and longer tries more and more: noise, in
// steps.
constexpr double kNoise = 0.1;  // per step
constexpr double kMaxNoise = 2.0;

}  // namespace

SteppedWorld::Motion SteppedWorld::greedy_motion(int i, const Pose& pose) const {
  const Robot& robot = robots_[std::size_t(i)];
  const Arc& arc = robot.reference_path[robot.next];
  return {arc, problem_.after(i, pose, arc), robot.prediction->at(int(robot.next))};
}

SteppedWorld::Motion SteppedWorld::motion(int i, const Pose& pose, const Frame& frame,
                                          const Primitive& step) const {
  const Pose end = is_wait(step.arc) ? pose : problem_.at_goal_or(i, step.end_from(pose, frame));
  return {step.arc, end, step.sweep.moved_to(frame)};
}

SteppedWorld::Ranking SteppedWorld::candidates(int i, const Pose& pose) const {
  return {*this, i, pose, grounds_to_keep_clear(i)};
}

std::optional<SteppedWorld::Motion> SteppedWorld::first_choice(int i, const Pose& pose) const {
  if (is_plain() || robots_[std::size_t(i)].random_primitive) return std::nullopt;
  const std::vector<GroundAhead> grounds = grounds_to_keep_clear(i);
  if (!has_reference_path(i)) {
    Motion wait = safe_stop(i, pose);
    const bool may_stay = pose == problem_.goal(i) && blocking_cost(i, wait, false, grounds) == 0.0;
    return may_stay ? std::optional(wait) : std::nullopt;
  }
  // No other candidate comes closer to the goal or takes less than a straight step ahead.
  const Motion greedy = greedy_motion(i, pose);
  const bool best =
      penalty(i, greedy.arc) * times_in_cell(i, greedy.end) <= problem_.car(i).step_length() &&
      blocking_cost(i, greedy, true, grounds) == 0.0;
  return best ? std::optional(greedy) : std::nullopt;
}

SteppedWorld::Ranking SteppedWorld::push_candidates(int i, const Pose& pose, int pusher,
                                                    const Motion& motion) const {
  if (is_plain()) return {*this, i, pose, motion};
  std::vector<GroundAhead> grounds = grounds_to_keep_clear(i);
  std::erase_if(grounds, [&](const GroundAhead& ground) { return ground.of == pusher; });
  // The pusher goes on along its reference path, if that is what it does now, or else as it does
  // now.
  const Robot& robot = robots_[std::size_t(pusher)];
  const bool follows = has_reference_path(pusher) && motion.arc == robot.reference_path[robot.next];
  if (follows) {
    grounds.push_back(ground_ahead(pusher, motion.end, *robot.prediction, int(robot.next) + 1));
    return {*this, i, pose, std::move(grounds)};
  }
  auto straight_on = std::make_shared<const SweptTrajectory>(
      problem_.car(pusher), motion.end,
      std::vector<Arc>(std::size_t(look_ahead(pusher)), motion.arc));
  grounds.push_back(ground_ahead(pusher, motion.end, *straight_on, 0));
  return {*this, i, pose, std::move(grounds), std::move(straight_on)};
}

std::vector<SteppedWorld::GroundAhead> SteppedWorld::grounds_to_keep_clear(int i) const {
  std::vector<GroundAhead> grounds;
  if (is_plain()) return grounds;
  const Robot& robot = robots_[std::size_t(i)];
  grounds.reserve(robot.within_lookahead.size() + 1);
  for (const int j : robot.within_lookahead) {
    const Robot& other = robots_[std::size_t(j)];
    // Those on a joint trajectory are decided before all others.
    const bool before = other.rank < robot.rank || other.joint >= 0;
    if (!before || !has_reference_path(j)) continue;
    grounds.push_back(ground_ahead(j, other.expected, *other.prediction, int(other.next) + 1));
  }
  return grounds;
}

SteppedWorld::GroundAhead SteppedWorld::ground_ahead(int i, const Pose& from,
                                                     const SweptTrajectory& along, int next) const {
  // Half way is within half of it from both ends.
  const int half = look_ahead(i) / 2;
  const Sweep& middle = along.at(next + half);
  const double radius = middle.radius() + problem_.car(i).step_length() * (half + 1);
  return {i, from, &along, next, look_ahead(i), middle.centre(), radius};
}

bool SteppedWorld::GroundAhead::may_meet(const GroundAhead& other) const {
  const double reach = radius + other.radius;
  return squared_distance(middle, other.middle) <= reach * reach;
}

double SteppedWorld::still_to_clear(int i, const Pose& pose, const GroundAhead& ground) const {
  const Vehicle& own = problem_.car(i).vehicle();
  const Pose seen = relative(ground.from, pose);
  const double radius = own.min_turning_radius;
  const double clear = (own.width + problem_.car(ground.of).vehicle().width) / 2 + radius;
  return std::max(0.0, clear - std::abs(seen.y) - radius * std::abs(std::sin(seen.theta)));
}

SteppedWorld::Ranking::Ranking(const SteppedWorld& world, int robot, const Pose& pose,
                               const Motion& pusher)
    : Ranking(world, robot, pose, {}) {
  for (Entry& entry : entries_) {
    entry.score += world.head_on_cost(robot, pose, entry.motion, pusher);
  }
}

SteppedWorld::Ranking::Ranking(const SteppedWorld& world, int robot, const Pose& pose,
                               std::vector<GroundAhead> grounds,
                               std::shared_ptr<const SweptTrajectory> along)
    : world_(world),
      robot_(robot),
      pose_(pose),
      grounds_(std::move(grounds)),
      along_(std::move(along)) {
  const Robot& self = world.robots_[std::size_t(robot)];
  const std::vector<Primitive>& primitives = world.problem_.car(robot).primitives();
  const Frame frame(pose);
  entries_.reserve(primitives.size() + 2);
  if (self.random_primitive) {
    const double first = -std::numeric_limits<double>::infinity();
    entries_.push_back({world.motion(robot, pose, *self.random_primitive), first});
  }
  const auto add = [&](Motion motion, bool greedy) {
    const double score = world.score(robot, motion, greedy);
    entries_.push_back({std::move(motion), score, greedy});
  };
  const bool has_reference_path = world.has_reference_path(robot);
  if (has_reference_path) add(world.greedy_motion(robot, pose), true);
  for (const Primitive& step : primitives) {
    if (has_reference_path && step.arc == self.reference_path[self.next]) continue;
    add(world.motion(robot, pose, frame, step), false);
  }
  ranked_.reserve(entries_.size());
  left_.resize(entries_.size());
  std::iota(left_.begin(), left_.end(), std::size_t{0});
}

const SteppedWorld::Motion* SteppedWorld::Ranking::nth_motion(std::size_t k) {
  while (ranked_.size() <= k) {
    if (!find_next()) return nullptr;
  }
  return &entries_[ranked_[k]].motion;
}

bool SteppedWorld::Ranking::find_next() {
  while (!left_.empty()) {
    const auto best =
        std::ranges::min_element(left_, {}, [&](std::size_t k) { return entries_[k].score; });
    Entry& entry = entries_[*best];
    if (entry.known) {
      ranked_.push_back(*best);
      left_.erase(best);
      return true;
    }
    if (world_.problem_.car(robot_).is_free(pose_, entry.motion.arc, entry.motion.sweep)) {
      entry.score += world_.blocking_cost(robot_, entry.motion, entry.greedy, grounds_);
      entry.known = true;
    } else {
      left_.erase(best);
    }
  }
  return false;
}

double SteppedWorld::score(int i, const Motion& m, bool greedy) const {
  const double to_go = is_plain() ? problem_.cost_to_go(i)(m.end) : to_go_after(i, m, greedy);
  return to_go +
         kWeight * penalty(i, m.arc) * (1.0 + times_in_cell(i, m.end) - (greedy ? 1.0 : 0.0));
}

double SteppedWorld::head_on_cost(int i, const Pose& pose, const Motion& m,
                                  const Motion& pusher) const {
  const auto straight = [](const Motion& x) { return x.arc.curvature == 0.0 && !is_wait(x.arc); };
  if (!straight(pusher) || !straight(m)) return 0.0;
  const CostToGo& to_go = problem_.cost_to_go(i);
  return to_go(m.end) < to_go(pose) ? 0.0 : kWeight * penalty(i, m.arc) * kHeadOn;
}

double SteppedWorld::to_go_after(int i, const Motion& m, bool greedy) const {
  const Robot& robot = robots_[std::size_t(i)];
  const double step = problem_.car(i).step_length();
  // The reference path knows more than the cost-to-go: nobody gets closer to the goal than along
  // it.
  const double left_on_path = step * double(robot.reference_path.size() - robot.next);
  if (greedy) return left_on_path - step;
  double to_go = problem_.cost_to_go(i)(m.end);
  if (left_on_path > 0.0)
    to_go = std::max(to_go, is_wait(m.arc) ? left_on_path : left_on_path - step);
  const double spread = step * std::min(kMaxNoise, kNoise * robot.stuck);
  const auto arc = std::uint64_t(3 * (m.arc.length > 0.0) + 6 * (m.arc.length < 0.0) +
                                 (m.arc.curvature > 0.0) + 2 * (m.arc.curvature < 0.0));
  return to_go + spread * noise(options_.seed, std::uint64_t(step_), std::uint64_t(i), arc);
}

double SteppedWorld::penalty(int i, const Arc& arc) const {
  double penalty = problem_.car(i).step_length();
  if (arc.curvature != 0.0) penalty *= kTurnPenalty;
  if (arc.length < 0.0) penalty *= kReversePenalty;
  if (arc.length * robots_[std::size_t(i)].last.length < 0.0) penalty *= kSwitchPenalty;
  return penalty;
}

int SteppedWorld::look_ahead(int i) const {
  return int(std::ceil(kLookAhead / problem_.car(i).step_length() - 1e-9));
}

double SteppedWorld::blocking_cost(int i, const Motion& m, bool greedy,
                                   std::span<const GroundAhead> grounds) const {
  if (grounds.empty()) return 0.0;
  const Robot& robot = robots_[std::size_t(i)];
  const double step = problem_.car(i).step_length();
  const OrientedBox standing = footprint(problem_.car(i).vehicle(), m.end);
  // What robot i will do then: go on along its reference path, or stand.
  const GroundAhead own =
      greedy ? ground_ahead(i, m.end, *robot.prediction, int(robot.next) + 1)
             : GroundAhead{.middle = {standing.x, standing.y},
                           .radius = std::sqrt(standing.half_length * standing.half_length +
                                               standing.half_width * standing.half_width)};
  const auto meets = [&](const GroundAhead& ground) {
    if (!own.may_meet(ground)) return false;
    return std::ranges::any_of(std::views::iota(0, ground.steps), [&](int k) {
      const Sweep& other = ground.along->at(ground.next + k);
      return greedy ? collide(own.along->at(own.next + k), other) : collide(other, standing);
    });
  };
  double worst = 0.0;  // [m]
  for (const GroundAhead& ground : grounds) {
    if (!meets(ground)) continue;
    const double clear = still_to_clear(i, m.end, ground);
    const double urgent =
        std::min(kMaxUrgency, 1.0 + kUrgency * robots_[std::size_t(ground.of)].stuck);
    worst = std::max(worst, urgent * (kBlocking * step + kAside * clear));
  }
  return worst;
}

double SteppedWorld::times_in_cell(int i, const Pose& pose) const {
  const auto& all = robots_[std::size_t(i)].times_in_cell;
  const auto found = all.find(cell(i, pose));
  if (found == all.end()) return 0.0;
  if (is_plain()) return found->second.value;
  return found->second.value * std::pow(kForget, step_ - found->second.step);
}

void SteppedWorld::count_cell(int i, const Pose& pose) {
  const double before = times_in_cell(i, pose) * (is_plain() ? kForgetPlain : 1.0);
  const auto [counted, first] =
      robots_[std::size_t(i)].times_in_cell.try_emplace(cell(i, pose), CellCount{0.0, step_});
  if (!first) counted->second = {before + 1.0, step_};
}

std::uint64_t SteppedWorld::cell(int i, const Pose& pose) const {
  const double side = problem_.car(i).step_length();
  const double turn = side * problem_.car(i).vehicle().max_curvature();
  const auto part = [](double value) {
    return std::uint64_t(std::int64_t(std::floor(value)) + (1 << 19)) & 0xfffffU;
  };
  return part(pose.x / side) | part(pose.y / side) << 20U | part(pose.theta / turn) << 40U;
}

}  // namespace mvtp
