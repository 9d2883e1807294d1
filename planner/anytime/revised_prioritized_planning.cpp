#include "planner/anytime/revised_prioritized_planning.hpp"

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

namespace mvtp {
namespace {

constexpr int kExpansions = 1000;      ///< of the search for a path in time
constexpr int kRestExpansions = 4000;  ///< of that for a path among robots at rest ...
constexpr int kMostFailures = 2;       ///< ... and, after each failure, of a larger and finer one
constexpr int kFactor = 3;

}  // namespace

RevisedPrioritizedPlanning::RevisedPrioritizedPlanning(JointMotion& motion,
                                                       const std::vector<ArcTrajectory>& alone,
                                                       const Deadline& deadline)
    : motion_(motion),
      alone_(alone),
      deadline_(deadline),
      repair_(motion, alone, {}, 0, deadline),
      robots_(alone.size()) {}

void RevisedPrioritizedPlanning::run(std::int64_t stagnation_limit) {
  find_who_blocks_whom();
  std::int64_t end = stagnation_limit;
  for (int i = next(); i >= 0 && repair_.expansions() < end; i = next()) {
    if (deadline_.expired()) return;
    if (let_go(i)) {
      leaves(i);
      end = repair_.expansions() + stagnation_limit;
    } else {
      ++robots_[std::size_t(i)].failures;
    }
  }
}

void RevisedPrioritizedPlanning::find_who_blocks_whom() {
  std::vector<ArcTrajectory> goals;
  std::vector<ArcTrajectory> starts;
  for (int i = 0; i < motion_.size(); ++i) {
    const MacroRobot& robot = motion_.robot(i);
    goals.emplace_back(robot.car->vehicle(), robot.cost_to_go->goal(), std::vector<Arc>{},
                       motion_.time().macro_step);
    starts.push_back(motion_.trajectory_after(i, 0, {}));
  }
  const auto blockers_of = [&](int i) {
    ArcTrajectory rest = motion_.remove(i);
    motion_.place(i, alone_[std::size_t(i)]);
    std::vector<int> met = motion_.conflicts_of(i);
    motion_.remove(i);
    motion_.place(i, std::move(rest));
    return met;
  };
  motion_.place_all(goals);
  for (int i = 0; i < motion_.size(); ++i) {
    Robot& robot = robots_[std::size_t(i)];
    robot.goals_on_path = blockers_of(i);
    for (const int j : robot.goals_on_path) ++robots_[std::size_t(j)].would_block;
  }
  motion_.place_all(starts);
  for (int i = 0; i < motion_.size(); ++i) {
    const std::vector<int> met = blockers_of(i);
    robots_[std::size_t(i)].starts_on_path = int(met.size());
    for (const int j : met) robots_[std::size_t(j)].starts_on_path_of.push_back(i);
  }
}

/// Whose turn it is: those who would block nobody if possible, with a free path, and the longest;
/// -1 if no one is left to ask.
int RevisedPrioritizedPlanning::next() const {
  const auto urgency = [&](int i) {
    const Robot& robot = robots_[std::size_t(i)];
    return std::tuple(robot.would_block > 0, robot.failures, robot.starts_on_path,
                      robot.would_block, -alone_[std::size_t(i)].arrival());
  };
  int best = -1;
  for (int i = 0; i < motion_.size(); ++i) {
    const Robot& robot = robots_[std::size_t(i)];
    if (robot.departed || robot.failures > kMostFailures) continue;
    if (best < 0 || urgency(i) < urgency(best)) best = i;
  }
  return best;
}

void RevisedPrioritizedPlanning::leaves(int i) {
  Robot& robot = robots_[std::size_t(i)];
  robot.departed = true;
  for (const int j : robot.goals_on_path) --robots_[std::size_t(j)].would_block;
  for (const int j : robot.starts_on_path_of) {
    --robots_[std::size_t(j)].starts_on_path;
    robots_[std::size_t(j)].failures = 0;
  }
}

bool RevisedPrioritizedPlanning::let_go(int i) {
  ArcTrajectory standing = motion_.remove(i);
  const Robot& robot = robots_[std::size_t(i)];
  SoftOptions options = repair_.soft_options(kExpansions);
  options.hard = true;
  if (repair_.plan(i, options)) return true;
  const int latest = motion_.makespan() + 2 * motion_.time().macro_step;  // all rest
  if (motion_.place_later(i, alone_[std::size_t(i)].steps(), latest)) return true;

  options = repair_.soft_options(kRestExpansions, robot.failures > 0);
  for (int n = 0; n < robot.failures; ++n) options.max_expansions *= kFactor;
  options.hard = true;
  options.leave_out_time();
  const int all_rest = latest / motion_.time().macro_step;
  if (repair_.plan(i, options, &standing, all_rest)) {
    const ArcTrajectory last = motion_.remove(i);
    const std::size_t wait = std::size_t(all_rest * motion_.time().macro_step);
    if (motion_.place_later(i, std::span(last.steps()).subspan(wait), latest)) return true;
  }
  motion_.place(i, std::move(standing));
  return false;
}

}  // namespace mvtp
