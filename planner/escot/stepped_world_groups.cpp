// Who is planned together: groups by predicted conflicts, and their joint trajectories.

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "planner/escot/stepped_world.hpp"

namespace mvtp {
namespace {

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

}  // namespace

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

bool SteppedWorld::pre_check(const Group& group) const { return !failed_.contains(group); }

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

}  // namespace mvtp
