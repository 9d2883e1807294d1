#include "planner/algorithms/stepped_world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

namespace mvtp {
namespace {

// The score of a candidate is H(end) + kWeight * penalty * (1 + visits - greedy), as in the code of
// PBCR's authors: what it costs to get there counts less than where it leads.
constexpr double kWeight = 0.3;
constexpr double kTurnPenalty = 1.5;
constexpr double kReversePenalty = 2.0;
constexpr double kSwitchPenalty = 2.0;  // of driving direction
constexpr double kInTheWay = 6.0;       // of where the pusher goes next
constexpr double kAside = 0.5;          // per metre that is left to leave the pusher's lane
/// A robot that was pushed straight back for so many steps is not any longer: nose to nose it would
/// be driven back until the pusher is at its goal. The pusher has to swerve.
constexpr int kLongRetreat = 3;
constexpr int kLookAhead = 4;     // [steps] of the pusher
constexpr double kForget = 0.99;  // of visits, per further visit
/// A robot that may have no guide path is not searched for one again for so many steps.
constexpr int kGuideRetry = 20;
/// Groups avoid robots that they could meet within so many windows, both driving.
constexpr double kSight = 2.0;
/// Chances of a robot that is under way when a configuration repeats.
constexpr double kRandomAction = 0.3;
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

double uniform(std::mt19937_64& rng) { return double(rng() >> 11U) * 0x1p-53; }

}  // namespace

SteppedWorld::SteppedWorld(const Fleet& fleet, const SteppedWorldOptions& options,
                           const Deadline& deadline)
    : fleet_(fleet),
      options_(options),
      deadline_(deadline),
      planner_(fleet.curves()),
      robots_(std::size_t(fleet.size())) {}

SteppedWorld::Motion SteppedWorld::motion(int i, const Pose& pose, const Arc& arc) const {
  return {arc, fleet_.after(i, pose, arc), fleet_.car(i).sweep(pose, arc)};
}

std::vector<SteppedWorld::Motion> SteppedWorld::candidates(int i, const Pose& pose) const {
  return candidates_away_from(i, pose, {});
}

std::vector<SteppedWorld::Motion> SteppedWorld::evasions(int i, const Pose& pose, int pusher,
                                                         const Motion& motion) const {
  // Where the pusher goes on to: along its guide, if that is what it does now.
  const Robot& robot = robots_[std::size_t(pusher)];
  const bool guided = robot.next < robot.guide.size() && motion.arc == robot.guide[robot.next];
  std::vector<Sweep> ahead;
  if (guided) {
    for (int k = 1; k <= kLookAhead; ++k)
      ahead.push_back(robot.prediction->at(int(robot.next) + k));
  } else {
    const SteppedCar& car = fleet_.car(pusher);
    Pose at = motion.end;
    for (int k = 0; k < kLookAhead && !is_wait(motion.arc); ++k, at = drive(at, motion.arc)) {
      ahead.push_back(car.sweep(at, motion.arc));
    }
  }
  return candidates_away_from(i, pose, {&ahead, pusher, motion.end});
}

double SteppedWorld::still_to_clear(int i, const Pose& pose, int pusher,
                                    const Pose& pushed_by) const {
  const Vehicle& own = fleet_.car(i).vehicle();
  const Pose seen = relative(pushed_by, pose);
  const double radius = own.min_turning_radius;
  const double clear = (own.width + fleet_.car(pusher).vehicle().width) / 2 + radius;
  return std::max(0.0, clear - std::abs(seen.y) - radius * std::abs(std::sin(seen.theta)));
}

std::vector<SteppedWorld::Motion> SteppedWorld::candidates_away_from(int i, const Pose& pose,
                                                                     const Push& push) const {
  const SteppedCar& car = fleet_.car(i);
  const Robot& robot = robots_[std::size_t(i)];
  std::vector<std::pair<double, Motion>> scored;
  const auto add = [&](const Arc& arc, bool greedy) {
    const Motion m = motion(i, pose, arc);
    if (!car.is_free(pose, arc, m.sweep)) return;
    double value = score(i, m, greedy);
    if (push.ahead != nullptr) {
      const Sweep standing = car.sweep(m.end, {});
      const bool in_the_way = std::ranges::any_of(
          *push.ahead, [&](const Sweep& sweep) { return collide(standing, sweep); });
      if (in_the_way && robot.retreat >= kLongRetreat && arc.curvature == 0.0) return;
      if (in_the_way) {
        value += kWeight * kInTheWay * car.step_length() +
                 kAside * still_to_clear(i, m.end, push.by, push.from);
      }
    }
    scored.emplace_back(value, m);
  };
  const bool guided = robot.next < robot.guide.size();
  if (guided) add(robot.guide[robot.next], true);
  for (const Arc& arc : car.arcs()) {
    if (!guided || arc != robot.guide[robot.next]) add(arc, false);
  }
  add({}, false);
  std::ranges::stable_sort(scored, {}, [](const auto& entry) { return entry.first; });
  std::vector<Motion> result;
  if (robot.random_action) {
    const Motion m = motion(i, pose, *robot.random_action);
    if (car.is_free(pose, m.arc, m.sweep)) result.push_back(m);
  }
  for (const auto& [unused, m] : scored) result.push_back(m);
  return result;
}

double SteppedWorld::score(int i, const Motion& m, bool greedy) const {
  const Robot& robot = robots_[std::size_t(i)];
  const double step = fleet_.car(i).step_length();

  // The guide knows more than the cost-to-go: nobody gets closer to the goal than along it.
  double to_go = fleet_.cost_to_go(i)(m.end);
  const double guide_left = step * double(robot.guide.size() - robot.next);
  if (greedy) {
    to_go = guide_left - step;
  } else if (guide_left > 0.0) {
    to_go = std::max(to_go, is_wait(m.arc) ? guide_left : guide_left - step);
  }

  double penalty = step;
  if (m.arc.curvature != 0.0) penalty *= kTurnPenalty;
  if (m.arc.length < 0.0) penalty *= kReversePenalty;
  if (m.arc.length * robot.last.length < 0.0) penalty *= kSwitchPenalty;
  const auto seen = robot.visits.find(cell(i, m.end));
  const double visits = seen == robot.visits.end() ? 0.0 : seen->second;
  return to_go + kWeight * penalty * (1.0 + visits - (greedy ? 1.0 : 0.0));
}

std::uint64_t SteppedWorld::cell(int i, const Pose& pose) const {
  const double side = fleet_.car(i).step_length();
  const double turn = side * fleet_.car(i).vehicle().max_curvature();
  const auto part = [](double value) {
    return std::uint64_t(std::int64_t(std::floor(value)) + (1 << 19)) & 0xfffffU;
  };
  return part(pose.x / side) | part(pose.y / side) << 20U | part(pose.theta / turn) << 40U;
}

std::optional<int> SteppedWorld::predicted_conflict(int i, int j) const {
  const Robot& a = robots_[std::size_t(i)];
  const Robot& b = robots_[std::size_t(j)];
  if (a.joint >= 0 && a.joint == b.joint) return std::nullopt;  // planned together
  for (int k = 0; k < options_.window; ++k) {
    if (collide(a.prediction->at(int(a.next) + k), b.prediction->at(int(b.next) + k))) return k;
  }
  return std::nullopt;
}

std::vector<Group> SteppedWorld::group_robots(const Configuration& q) {
  if (!options_.grouping) return {};
  std::vector<std::tuple<int, int, int>> conflicts;  // steps from now, robots
  for (int i = 0; i < fleet_.size(); ++i) {
    for (int j = 0; j < i; ++j) {
      const double reach =
          options_.window * (fleet_.car(i).step_length() + fleet_.car(j).step_length()) +
          fleet_.car(i).sweep(q[std::size_t(i)], {}).radius() +
          fleet_.car(j).sweep(q[std::size_t(j)], {}).radius() + 10.0;
      if (distance(q[std::size_t(i)], q[std::size_t(j)]) > reach) continue;
      if (const auto k = predicted_conflict(i, j)) conflicts.emplace_back(*k, j, i);
    }
  }
  // The most urgent conflicts are grouped first; what does not fit any more is left for later.
  std::ranges::sort(conflicts);
  Groups linked(fleet_.size(), options_.max_group);
  for (const auto& [k, i, j] : conflicts) linked.link(i, j);

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
  if (int(group.size()) > options_.max_group) return false;
  const auto failure = failed_.find(group);
  return failure == failed_.end() || step_ - failure->second >= options_.retry_after;
}

std::optional<std::vector<SteppedWorld::Motion>> SteppedWorld::get_opt_traj(const Configuration& q,
                                                                            const Group& group) {
  const auto first_motions = [&] {
    std::vector<Motion> motions;
    for (const int i : group) {
      const Robot& robot = robots_[std::size_t(i)];
      const Arc arc = robot.next < robot.guide.size() ? robot.guide[robot.next] : Arc{};
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
    members.push_back({&fleet_.car(i), &fleet_.cost_to_go(i), q[std::size_t(i)]});
  }
  // Only those who may be met soon: the way to the goal is long, and much will change until then.
  const auto near = [&](int i) {
    return std::ranges::any_of(group, [&](int k) {
      const double steps = fleet_.car(i).step_length() + fleet_.car(k).step_length();
      return distance(q[std::size_t(i)], q[std::size_t(k)]) <= kSight * options_.window * steps;
    });
  };
  std::vector<MovingObstacle> others;
  for (int i = 0; i < fleet_.size(); ++i) {
    if (std::ranges::binary_search(group, i) || !near(i)) continue;
    const Robot& robot = robots_[std::size_t(i)];
    others.emplace_back(
        fleet_.car(i), q[std::size_t(i)],
        std::vector<Arc>(robot.guide.begin() + std::ptrdiff_t(robot.next), robot.guide.end()));
  }
  std::vector<const MovingObstacle*> to_avoid;
  for (const MovingObstacle& other : others) to_avoid.push_back(&other);

  CbsResult result = conflict_based_search(members, to_avoid, planner_, options_.eccr, deadline_);
  if (result.failure != CbsFailure::kNone) {
    failed_[group] = step_;
    return std::nullopt;
  }
  for (std::size_t k = 0; k < group.size(); ++k) {
    set_guide(group[k], q[std::size_t(group[k])], std::move(result.steps[k]), joints_);
  }
  ++joints_;
  return first_motions();
}

std::vector<int> SteppedWorld::order(const Configuration& q) const {
  std::vector<double> to_go(robots_.size());
  for (int i = 0; i < fleet_.size(); ++i) {
    to_go[std::size_t(i)] = fleet_.cost_to_go(i)(q[std::size_t(i)]);
  }
  std::vector<int> result(robots_.size());
  std::iota(result.begin(), result.end(), 0);
  std::ranges::sort(result, {}, [&](int i) {
    return std::tuple(-robots_[std::size_t(i)].steps_under_way, to_go[std::size_t(i)], i);
  });
  return result;
}

void SteppedWorld::set_guide(int i, const Pose& pose, std::vector<Arc> guide, int joint) {
  Robot& robot = robots_[std::size_t(i)];
  robot.prediction.emplace(fleet_.car(i), pose, guide);
  robot.guide = std::move(guide);
  robot.next = 0;
  robot.expected = pose;
  robot.joint = joint;
}

void SteppedWorld::break_joint(int joint) {
  if (joint < 0) return;
  for (Robot& robot : robots_) {
    if (robot.joint == joint) robot.joint = -1;
  }
}

std::optional<TimedPath> SteppedWorld::find_guide(int i, const Pose& pose) const {
  SearchProblem problem;
  problem.car = &fleet_.car(i);
  problem.cost_to_go = &fleet_.cost_to_go(i);
  problem.start = pose;
  SearchOptions search{.w = options_.guide_w, .max_expansions = options_.guide_expansions};
  // Full steps do not get out of every narrow place; shorter ones may.
  for (const double scale : {1.0, 0.5, 0.25}) {
    search.arc_scale = scale;
    if (auto path = planner_.search(problem, search, deadline_)) return path;
  }
  return std::nullopt;
}

void SteppedWorld::prepare(const Configuration& q) {
  for (int i = 0; i < fleet_.size(); ++i) {
    Robot& robot = robots_[std::size_t(i)];
    const Pose& pose = q[std::size_t(i)];
    const bool searched_in_vain = step_ < robot.search_again;
    if (robot.prediction && pose == robot.expected && (searched_in_vain || !robot.search_again)) {
      continue;
    }
    break_joint(robot.joint);
    std::optional<TimedPath> path;
    if (!searched_in_vain) {
      path = find_guide(i, pose);
      robot.search_again = path ? 0 : step_ + kGuideRetry;
    }
    set_guide(i, pose, path ? std::move(path->steps) : std::vector<Arc>{}, -1);
  }
}

void SteppedWorld::advance(const std::vector<Motion>& motions) {
  ++step_;
  for (int i = 0; i < fleet_.size(); ++i) {
    Robot& robot = robots_[std::size_t(i)];
    const Motion& m = motions[std::size_t(i)];
    robot.random_action.reset();
    if (!is_wait(m.arc)) robot.last = m.arc;

    const bool under_way = robot.next < robot.guide.size();
    const bool straight = !is_wait(m.arc) && m.arc.curvature == 0.0;
    const bool on_guide = under_way && m.arc == robot.guide[robot.next];
    if (on_guide) {
      ++robot.next;
      robot.expected = m.end;
    } else if (under_way || !is_wait(m.arc)) {
      break_joint(robot.joint);  // late, or pushed off
    }

    robot.retreat = straight && !on_guide ? robot.retreat + 1 : 0;
    if (m.end == fleet_.goal(i)) {
      robot.steps_under_way = 0;
    } else {
      ++robot.steps_under_way;
      if (on_guide) continue;  // a robot on its own way is in nobody's
      const auto [visit, first] = robot.visits.try_emplace(cell(i, m.end), 0.0);
      if (!first) visit->second = kForget * visit->second + 1.0;
    }
  }
}

void SteppedWorld::add_randomness(const Configuration& q, std::mt19937_64& rng) {
  for (int i = 0; i < fleet_.size(); ++i) {
    Robot& robot = robots_[std::size_t(i)];
    const auto random_arc = [&] { return fleet_.car(i).arcs()[rng() % 6]; };
    const bool under_way = q[std::size_t(i)] != fleet_.goal(i);
    if (under_way && uniform(rng) < kRandomAction) {
      robot.random_action = random_arc();
      break_joint(robot.joint);
    }
    if (under_way && uniform(rng) < kRandomLast) robot.last = random_arc();
  }
}

}  // namespace mvtp
