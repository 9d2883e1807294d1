#include "planner/escot/stepped_world.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace mvtp {
namespace {

/// A robot that may have no reference path is not searched for one again for twice so many steps,
/// then four times so many, ...
constexpr int kReferencePathRetry = 10;
/// Groups avoid robots that they could meet within so many windows, for that long.
constexpr double kLookahead = 2.0;
/// Chances of a robot that is under way when a configuration repeats.
constexpr double kRandomPrimitive = 0.3;
constexpr double kRandomLast = 0.3;

double uniform(std::mt19937_64& rng) { return double(rng() >> 11U) * 0x1p-53; }

}  // namespace

SteppedWorld::SteppedWorld(const PlanningProblem& planning_problem,
                           const SteppedWorldOptions& options, const Deadline& deadline)
    : problem_(planning_problem),
      options_(options),
      deadline_(deadline),
      planner_(planning_problem.curves()),
      robots_(std::size_t(planning_problem.size())) {
  options_.eccr.lookahead = int(kLookahead * options.window);
  const Configuration starts = planning_problem.starts();
  for (int i = 0; i < planning_problem.size(); ++i) {
    robots_[std::size_t(i)].distance = planning_problem.cost_to_go(i)(starts[std::size_t(i)]);
    longest_reach_ = std::max(longest_reach_, reach(i));
    longest_step_ = std::max(longest_step_, planning_problem.car(i).step_length());
  }
}

bool SteppedWorld::is_exempt(int i, const Motion& a, int j, const Motion& b) const {
  if (now_.empty()) return false;
  return problem_.overlapping_pairs().allow({i, now_[std::size_t(i)], a.arc},
                                            {j, now_[std::size_t(j)], b.arc});
}

SteppedWorld::Motion SteppedWorld::motion(int i, const Pose& pose, const Arc& arc) const {
  return {arc, problem_.after(i, pose, arc), problem_.car(i).sweep(pose, arc)};
}

void SteppedWorld::set_order(const Configuration& q) {
  order_.resize(robots_.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::ranges::sort(order_, {}, [&](int i) {
    const Robot& robot = robots_[std::size_t(i)];
    const double then = is_plain() ? problem_.cost_to_go(i)(q[std::size_t(i)]) : -robot.distance;
    return std::tuple(-robot.steps_under_way, then, i);
  });
  for (std::size_t k = 0; k < order_.size(); ++k) robots_[std::size_t(order_[k])].rank = int(k);
}

double SteppedWorld::reach(int i) const {
  const Vehicle& vehicle = problem_.car(i).vehicle();
  return problem_.car(i).step_length() +
         std::hypot(std::max(vehicle.front, vehicle.rear), vehicle.width / 2);
}

Circle SteppedWorld::reachable_disc(int i) const {
  // In all that time nobody is farther from its place at half time than it drives in half of it.
  const int half = options_.eccr.lookahead / 2;
  const Robot& robot = robots_[std::size_t(i)];
  const Sweep& halfway = robot.prediction->at(int(robot.next) + half);
  return {halfway.centre().x, halfway.centre().y,
          halfway.radius() + problem_.car(i).step_length() * (half + 1)};
}

void SteppedWorld::update_neighbours(const Configuration& q) {
  neighbours_ = Neighbours(q);
  reachable_discs_.clear();
  for (int i = 0; i < problem_.size(); ++i) reachable_discs_.push_back(reachable_disc(i));
  for (int i = 0; i < problem_.size(); ++i) {
    Robot& robot = robots_[std::size_t(i)];
    const Pose& pose = q[std::size_t(i)];
    const double one_step = reach(i) + longest_reach_;
    robot.near.clear();
    const double drives = problem_.car(i).step_length() + longest_step_;
    neighbours_.within(one_step + look_ahead(i) * drives, pose, robot.within_lookahead);
    std::erase(robot.within_lookahead, i);
    for (const int j : robot.within_lookahead) {
      const Pose& other = q[std::size_t(j)];
      const double d2 = squared_distance({pose.x, pose.y}, {other.x, other.y});
      if (d2 <= one_step * one_step) robot.near.push_back(j);
    }
    std::ranges::sort(robot.near, {}, [&](int j) { return robots_[std::size_t(j)].rank; });
  }
}

void SteppedWorld::set_reference_path(int i, const Pose& pose, std::vector<Arc> reference_path,
                                      int joint) {
  Robot& robot = robots_[std::size_t(i)];
  robot.prediction.emplace(problem_.car(i), pose, reference_path);
  robot.reference_path = std::move(reference_path);
  robot.next = 0;
  robot.expected = pose;
  robot.joint = joint;
  robot.changed = step_;
}

void SteppedWorld::break_joint(int joint) {
  if (joint < 0) return;
  for (Robot& robot : robots_) {
    if (robot.joint != joint) continue;
    robot.joint = -1;
    robot.changed = step_;
  }
}

std::optional<SearchResult> SteppedWorld::find_reference_path(int i, const Pose& pose) const {
  SearchProblem problem;
  problem.car = &problem_.car(i);
  problem.cost_to_go = &problem_.cost_to_go(i);
  problem.start = pose;
  return planner_.search_with_shorter_steps(
      problem,
      {.w = options_.reference_path_w, .max_expansions = options_.reference_path_expansions},
      deadline_);
}

void SteppedWorld::update_reference_paths(const Configuration& q) {
  if (!problem_.overlapping_pairs().empty()) now_ = q;
  for (int i = 0; i < problem_.size(); ++i) {
    Robot& robot = robots_[std::size_t(i)];
    const Pose& pose = q[std::size_t(i)];
    const bool not_yet = step_ < robot.search_again;
    if (robot.prediction && pose == robot.expected && (not_yet || !robot.search_again)) continue;
    break_joint(robot.joint);
    std::optional<SearchResult> path;
    if (!not_yet) {
      path = find_reference_path(i, pose);
      robot.searched_in_vain = path ? 0 : robot.searched_in_vain + 1;
      robot.search_again =
          path ? 0 : step_ + (kReferencePathRetry << std::min(robot.searched_in_vain, 8));
    }
    set_reference_path(i, pose, path ? std::move(path->steps) : std::vector<Arc>{}, -1);
  }
  set_order(q);
  update_neighbours(q);
}

void SteppedWorld::advance(const std::vector<Motion>& motions) {
  ++step_;
  std::erase_if(failed_, [&](const auto& f) { return step_ - f.second >= options_.retry_after; });
  for (int i = 0; i < problem_.size(); ++i) {
    Robot& robot = robots_[std::size_t(i)];
    const Motion& m = motions[std::size_t(i)];
    robot.random_primitive.reset();
    if (!is_wait(m.arc)) robot.last = m.arc;

    const bool under_way = robot.next < robot.reference_path.size();
    const bool on_reference_path = under_way && m.arc == robot.reference_path[robot.next];
    if (on_reference_path) {
      ++robot.next;
      robot.expected = m.end;
    } else if (under_way || !is_wait(m.arc)) {
      robot.changed = step_;  // late, or pushed off
      break_joint(robot.joint);
    }

    if (m.end == problem_.goal(i)) {
      robot.steps_under_way = 0;
      robot.stuck = 0;
      if (is_plain()) robot.times_in_cell.clear();
      continue;
    }
    ++robot.steps_under_way;
    robot.stuck = on_reference_path ? 0 : robot.stuck + 1;
    // A robot that follows its path is not stuck.
    if (is_plain() || !on_reference_path) count_cell(i, m.end);
  }
}

void SteppedWorld::add_randomness(const Configuration& q, std::mt19937_64& rng) {
  for (int i = 0; i < problem_.size(); ++i) {
    Robot& robot = robots_[std::size_t(i)];
    const auto random_arc = [&] { return problem_.car(i).arcs()[rng() % 6]; };
    const bool under_way = q[std::size_t(i)] != problem_.goal(i);
    if (under_way && uniform(rng) < kRandomPrimitive) {
      robot.random_primitive = random_arc();
      break_joint(robot.joint);
    }
    if (under_way && uniform(rng) < kRandomLast) robot.last = random_arc();
  }
}

}  // namespace mvtp
