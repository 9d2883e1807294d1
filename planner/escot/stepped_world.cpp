#include "planner/escot/stepped_world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <ranges>
#include <tuple>

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
/// A robot that may have no reference path is not searched for one again for twice so many steps,
/// then four times so many, ...
constexpr int kReferencePathRetry = 10;
/// Groups avoid robots that they could meet within so many windows, for that long.
constexpr double kLookahead = 2.0;
/// Chances of a robot that is under way when a configuration repeats.
constexpr double kRandomPrimitive = 0.3;
constexpr double kRandomLast = 0.3;

bool is_wait(const Arc& arc) { return arc.length == 0.0; }

/// Disjoint sets of robots that grow by links, up to a size.
class Groups {
 public:
  Groups(int robots, int max_size) : max_size_(std::size_t(max_size)) {
    for (int i = 0; i < robots; ++i) {
      members_.push_back({i});
      group_of_.push_back(std::size_t(i));
    }
  }
  /// Joins the groups of i and j, unless that would be too large a group.
  void link(int i, int j) {
    const std::size_t a = group_of_[std::size_t(std::min(i, j))];
    const std::size_t b = group_of_[std::size_t(std::max(i, j))];
    if (a == b || members_[a].size() + members_[b].size() > max_size_) return;
    for (const int k : members_[b]) group_of_[std::size_t(k)] = a;
    members_[a].insert(members_[a].end(), members_[b].begin(), members_[b].end());
    members_[b].clear();
    std::ranges::sort(members_[a]);
  }
  /// Including robots on their own; ordered by the least robot that started the group.
  [[nodiscard]] std::vector<Group> all() && {
    std::erase_if(members_, [](const Group& group) { return group.empty(); });
    return std::move(members_);
  }

 private:
  std::size_t max_size_;
  std::vector<Group> members_;
  std::vector<std::size_t> group_of_;
};

double squared_distance(const Point& a, const Point& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

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
  return {*this, i, pose, paths_to_keep_clear(i)};
}

std::optional<SteppedWorld::Motion> SteppedWorld::first_choice(int i, const Pose& pose) const {
  if (robots_[std::size_t(i)].random_primitive) return std::nullopt;
  const std::vector<PredictedPath> paths = paths_to_keep_clear(i);
  if (!has_reference_path(i)) {
    Motion wait = safe_stop(i, pose);
    const bool may_stay = pose == problem_.goal(i) && blocking_cost(i, wait, false, paths) == 0.0;
    return may_stay ? std::optional(wait) : std::nullopt;
  }
  // No other candidate comes closer to the goal or takes less than a straight step ahead.
  const Motion greedy = greedy_motion(i, pose);
  const bool best =
      penalty(i, greedy.arc) * times_in_cell(i, greedy.end) <= problem_.car(i).step_length() &&
      blocking_cost(i, greedy, true, paths) == 0.0;
  return best ? std::optional(greedy) : std::nullopt;
}

SteppedWorld::Ranking SteppedWorld::push_candidates(int i, const Pose& pose, int pusher,
                                                    const Motion& motion) const {
  std::vector<PredictedPath> paths = paths_to_keep_clear(i);
  std::erase_if(paths, [&](const PredictedPath& path) { return path.of == pusher; });
  // The pusher goes on along its reference path, if that is what it does now, or else as it does
  // now.
  const Robot& robot = robots_[std::size_t(pusher)];
  const bool follows = has_reference_path(pusher) && motion.arc == robot.reference_path[robot.next];
  if (follows) {
    paths.push_back(path_along(pusher, motion.end, *robot.prediction, int(robot.next) + 1));
    return {*this, i, pose, std::move(paths)};
  }
  auto straight_on = std::make_shared<const SweptTrajectory>(
      problem_.car(pusher), motion.end,
      std::vector<Arc>(std::size_t(look_ahead(pusher)), motion.arc));
  paths.push_back(path_along(pusher, motion.end, *straight_on, 0));
  return {*this, i, pose, std::move(paths), std::move(straight_on)};
}

std::vector<SteppedWorld::PredictedPath> SteppedWorld::paths_to_keep_clear(int i) const {
  const Robot& robot = robots_[std::size_t(i)];
  std::vector<PredictedPath> paths;
  paths.reserve(robot.within_lookahead.size() + 1);
  for (const int j : robot.within_lookahead) {
    const Robot& other = robots_[std::size_t(j)];
    // Those on a joint trajectory are decided before all others.
    const bool before = other.rank < robot.rank || other.joint >= 0;
    if (!before || !has_reference_path(j)) continue;
    paths.push_back(path_along(j, other.expected, *other.prediction, int(other.next) + 1));
  }
  return paths;
}

SteppedWorld::PredictedPath SteppedWorld::path_along(int i, const Pose& from,
                                                     const SweptTrajectory& along, int next) const {
  // Half way is within half of it from both ends.
  const int half = look_ahead(i) / 2;
  const Sweep& middle = along.at(next + half);
  const double radius = middle.radius() + problem_.car(i).step_length() * (half + 1);
  return {i, from, &along, next, look_ahead(i), middle.centre(), radius};
}

bool SteppedWorld::PredictedPath::may_meet(const PredictedPath& other) const {
  const double reach = radius + other.radius;
  return squared_distance(middle, other.middle) <= reach * reach;
}

double SteppedWorld::still_to_clear(int i, const Pose& pose, const PredictedPath& path) const {
  const Vehicle& own = problem_.car(i).vehicle();
  const Pose seen = relative(path.from, pose);
  const double radius = own.min_turning_radius;
  const double clear = (own.width + problem_.car(path.of).vehicle().width) / 2 + radius;
  return std::max(0.0, clear - std::abs(seen.y) - radius * std::abs(std::sin(seen.theta)));
}

SteppedWorld::Ranking::Ranking(const SteppedWorld& world, int robot, const Pose& pose,
                               std::vector<PredictedPath> paths,
                               std::shared_ptr<const SweptTrajectory> along)
    : world_(world),
      robot_(robot),
      pose_(pose),
      paths_(std::move(paths)),
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
      entry.score += world_.blocking_cost(robot_, entry.motion, entry.greedy, paths_);
      entry.known = true;
    } else {
      left_.erase(best);
    }
  }
  return false;
}

double SteppedWorld::score(int i, const Motion& m, bool greedy) const {
  const Robot& robot = robots_[std::size_t(i)];
  const double step = problem_.car(i).step_length();

  // The reference path knows more than the cost-to-go: nobody gets closer to the goal than along
  // it.
  double to_go = 0.0;
  const double left_on_path = step * double(robot.reference_path.size() - robot.next);
  if (greedy) {
    to_go = left_on_path - step;
  } else {
    to_go = problem_.cost_to_go(i)(m.end);
    if (left_on_path > 0.0)
      to_go = std::max(to_go, is_wait(m.arc) ? left_on_path : left_on_path - step);
    const double spread = step * std::min(kMaxNoise, kNoise * robot.stuck);
    const auto arc = std::uint64_t(3 * (m.arc.length > 0.0) + 6 * (m.arc.length < 0.0) +
                                   (m.arc.curvature > 0.0) + 2 * (m.arc.curvature < 0.0));
    to_go += spread * noise(options_.seed, std::uint64_t(step_), std::uint64_t(i), arc);
  }

  return to_go +
         kWeight * penalty(i, m.arc) * (1.0 + times_in_cell(i, m.end) - (greedy ? 1.0 : 0.0));
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
                                   std::span<const PredictedPath> paths) const {
  if (paths.empty()) return 0.0;
  const Robot& robot = robots_[std::size_t(i)];
  const double step = problem_.car(i).step_length();
  const OrientedBox standing = footprint(problem_.car(i).vehicle(), m.end);
  // What robot i will do then: go on along its reference path, or stand.
  const PredictedPath own =
      greedy ? path_along(i, m.end, *robot.prediction, int(robot.next) + 1)
             : PredictedPath{.middle = {standing.x, standing.y},
                             .radius = std::sqrt(standing.half_length * standing.half_length +
                                                 standing.half_width * standing.half_width)};
  const auto meets = [&](const PredictedPath& path) {
    if (!own.may_meet(path)) return false;
    return std::ranges::any_of(std::views::iota(0, path.steps), [&](int k) {
      const Sweep& other = path.along->at(path.next + k);
      return greedy ? collide(own.along->at(own.next + k), other) : collide(other, standing);
    });
  };
  double worst = 0.0;  // [m]
  for (const PredictedPath& path : paths) {
    if (!meets(path)) continue;
    const double clear = still_to_clear(i, m.end, path);
    const double urgent =
        std::min(kMaxUrgency, 1.0 + kUrgency * robots_[std::size_t(path.of)].stuck);
    worst = std::max(worst, urgent * (kBlocking * step + kAside * clear));
  }
  return worst;
}

double SteppedWorld::times_in_cell(int i, const Pose& pose) const {
  const auto& all = robots_[std::size_t(i)].times_in_cell;
  const auto found = all.find(cell(i, pose));
  if (found == all.end()) return 0.0;
  return found->second.value * std::pow(kForget, step_ - found->second.step);
}

std::uint64_t SteppedWorld::cell(int i, const Pose& pose) const {
  const double side = problem_.car(i).step_length();
  const double turn = side * problem_.car(i).vehicle().max_curvature();
  const auto part = [](double value) {
    return std::uint64_t(std::int64_t(std::floor(value)) + (1 << 19)) & 0xfffffU;
  };
  return part(pose.x / side) | part(pose.y / side) << 20U | part(pose.theta / turn) << 40U;
}

std::optional<int> SteppedWorld::predicted_conflict(int i, int j) const {
  const Robot& a = robots_[std::size_t(i)];
  const Robot& b = robots_[std::size_t(j)];
  if (a.joint >= 0 && a.joint == b.joint) return std::nullopt;  // planned together
  const auto pose = [this](int k) { return now_[std::size_t(k)]; };
  if (!now_.empty() && problem_.overlapping_pairs().not_yet_apart(i, pose(i), j, pose(j))) {
    return std::nullopt;  // no joint trajectory begins like this
  }
  // What was foreseen to be free at the last step needs no second look but at the step that has
  // come into the window since.
  const bool free_before = as_foreseen(i) && as_foreseen(j) && !(a.disputed && b.disputed);
  for (int k = free_before ? options_.window - 1 : 0; k < options_.window; ++k) {
    if (collide(a.prediction->at(int(a.next) + k), b.prediction->at(int(b.next) + k))) return k;
  }
  return std::nullopt;
}

std::vector<Group> SteppedWorld::group_robots(const Configuration& q) {
  if (!options_.grouping) return {};
  std::vector<std::tuple<int, int, int>> conflicts;  // steps from now, robots
  std::vector<int> near;
  for (int i = 0; i < problem_.size(); ++i) {
    const double lookahead =
        reach(i) + longest_reach_ +
        (options_.window - 1) * (problem_.car(i).step_length() + longest_step_);
    neighbours_.within(lookahead, q[std::size_t(i)], near);
    for (const int j : near) {
      if (j >= i) continue;
      if (const auto k = predicted_conflict(i, j)) conflicts.emplace_back(*k, j, i);
    }
  }
  grouped_at_ = step_;
  for (Robot& robot : robots_) robot.disputed = false;
  for (const auto& [k, i, j] : conflicts) {
    robots_[std::size_t(i)].disputed = robots_[std::size_t(j)].disputed = true;
  }
  // The most urgent conflicts are grouped first; what does not fit any more is left for later.
  std::ranges::sort(conflicts);
  Groups linked(problem_.size(), options_.max_group);
  for (const auto& [k, i, j] : conflicts) {
    // A random motion primitive is to be taken, and not what planning together would make of it.
    const bool random =
        robots_[std::size_t(i)].random_primitive || robots_[std::size_t(j)].random_primitive;
    if (!random) linked.link(i, j);
  }

  std::vector<Group> groups;
  std::map<int, Group> kept;  // by joint trajectory
  for (Group& group : std::move(linked).all()) {
    if (group.size() > 1) {
      groups.push_back(std::move(group));
    } else if (const int joint = robots_[std::size_t(group.front())].joint; joint >= 0) {
      kept[joint].push_back(group.front());
    }
  }
  for (auto& [joint, group] : kept) groups.push_back(std::move(group));
  return groups;
}

bool SteppedWorld::pre_check(const Group& group) const {
  return int(group.size()) <= options_.max_group && !failed_.contains(group);
}

std::vector<std::optional<SteppedWorld::Motion>> SteppedWorld::get_opt_traj(const Configuration& q,
                                                                            const Group& group) {
  const auto first_motions = [&] {
    std::vector<std::optional<Motion>> motions;
    for (const int i : group) {
      const Robot& robot = robots_[std::size_t(i)];
      const Arc arc =
          robot.next < robot.reference_path.size() ? robot.reference_path[robot.next] : Arc{};
      motions.push_back(motion(i, q[std::size_t(i)], arc));
    }
    return motions;
  };
  // The joint trajectory is kept as long as nobody pushes a member off it.
  const int joint = robots_[std::size_t(group.front())].joint;
  if (joint >= 0 &&
      std::ranges::all_of(group, [&](int i) { return robots_[std::size_t(i)].joint == joint; })) {
    return first_motions();
  }

  std::vector<CbsRobot> members;
  for (const int i : group) {
    members.push_back({&problem_.car(i), &problem_.cost_to_go(i), q[std::size_t(i)]});
  }
  // Only those who may be met soon: the path to the goal is long, and much will change until then.
  const auto near = [&](int i) {
    const Circle& own = reachable_discs_[std::size_t(i)];
    return std::ranges::any_of(group, [&](int k) {
      const Circle& member = reachable_discs_[std::size_t(k)];
      const double reach = own.radius + member.radius;
      return squared_distance({own.x, own.y}, {member.x, member.y}) <= reach * reach;
    });
  };
  std::vector<SweptTrajectory> others;
  for (int i = 0; i < problem_.size(); ++i) {
    if (!near(i) || std::ranges::binary_search(group, i)) continue;
    const Robot& robot = robots_[std::size_t(i)];
    others.push_back(robot.prediction->part(int(robot.next), options_.eccr.lookahead));
  }
  std::vector<const SweptTrajectory*> to_avoid;
  for (const SweptTrajectory& other : others) to_avoid.push_back(&other);

  CbsResult result = conflict_based_search(members, to_avoid, planner_, options_.eccr, deadline_);
  if (result.failure != CbsFailure::kNone) {
    failed_[group] = step_;
    return std::vector<std::optional<Motion>>(group.size());
  }
  for (std::size_t k = 0; k < group.size(); ++k) {
    set_reference_path(group[k], q[std::size_t(group[k])], std::move(result.steps[k]), joints_);
    reachable_discs_[std::size_t(group[k])] = reachable_disc(group[k]);
  }
  ++joints_;
  return first_motions();
}

void SteppedWorld::set_order() {
  order_.resize(robots_.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::ranges::sort(order_, {}, [&](int i) {
    const Robot& robot = robots_[std::size_t(i)];
    return std::tuple(-robot.steps_under_way, -robot.distance, i);
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

std::optional<SpacetimePath> SteppedWorld::find_reference_path(int i, const Pose& pose) const {
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
    std::optional<SpacetimePath> path;
    if (!not_yet) {
      path = find_reference_path(i, pose);
      robot.searched_in_vain = path ? 0 : robot.searched_in_vain + 1;
      robot.search_again =
          path ? 0 : step_ + (kReferencePathRetry << std::min(robot.searched_in_vain, 8));
    }
    set_reference_path(i, pose, path ? std::move(path->steps) : std::vector<Arc>{}, -1);
  }
  set_order();
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
      continue;
    }
    ++robot.steps_under_way;
    robot.stuck = on_reference_path ? 0 : robot.stuck + 1;
    if (on_reference_path) continue;  // a robot that follows its path is not stuck
    const double before = times_in_cell(i, m.end);
    const auto [counted, first] =
        robot.times_in_cell.try_emplace(cell(i, m.end), CellCount{0.0, step_});
    if (!first) counted->second = {before + 1.0, step_};
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
