#include "planner/anytime/repair.hpp"

#include <algorithm>

#include "planner/anytime/windows.hpp"

namespace mvtp {

Repair::Repair(JointMotion& motion, const std::vector<ArcTrajectory>& alone,
               const RepairOptions& options, std::uint64_t seed, const Deadline& deadline)
    : motion_(motion),
      alone_(alone),
      options_(options),
      deadline_(deadline),
      search_(motion.size()),
      random_(seed),
      last_tried_(std::size_t(motion.size()), 0) {}

SoftProblem Repair::problem(int i) {
  SoftProblem problem;
  problem.car = motion_.robot(i).car;
  problem.cost_to_go = motion_.robot(i).cost_to_go;
  problem.others = motion_.others(i, options_.soft_cost);
  problem.start = motion_.robot(i).start;
  problem.deadline = limit_;
  return problem;
}

SoftOptions Repair::soft_options(int expansions, bool finely) const {
  SoftOptions options;
  options.weight = options_.weight;
  options.max_expansions = expansions;
  if (finely) {
    options.refine();
    options.cell_macro_steps = 1;
    options.slowly = true;
  }
  return options;
}

bool Repair::plan(int i, const SoftOptions& options, const ArcTrajectory* old, int from) {
  SoftProblem among = problem(i);
  const Pose start = among.start;
  std::vector<Arc> steps;
  if (old != nullptr && from > 0) {
    const int t = from * motion_.time().macro_step;
    among.start = old->pose(t);
    among.start_macro_step = from;
    steps.assign(old->steps().begin(), old->steps().begin() + std::min(t, old->arrival()));
    steps.resize(std::size_t(t));
  }
  const std::optional<SoftResult> path = search_.search(among, options, deadline_);
  if (!path) return false;
  steps.insert(steps.end(), path->steps.begin(), path->steps.end());
  motion_.place(
      i, ArcTrajectory(among.car->vehicle(), start, std::move(steps), motion_.time().macro_step));
  return true;
}

bool Repair::run(std::int64_t stagnation_limit, const Interrupt& interrupt) {
  std::int64_t end = expansions() + stagnation_limit;
  std::size_t fewest = motion_.conflicts().size();
  while (!motion_.conflicts().empty()) {
    if (expansions() > end || deadline_.expired() || interrupt()) return false;
    stagnates_ = expansions() > end - stagnation_limit + options_.finer_after * motion_.size();
    try_one();
    if (motion_.conflicts().size() < fewest) {
      fewest = motion_.conflicts().size();
      end = expansions() + stagnation_limit;
    }
  }
  return true;
}

/// Of any pair in conflict the robot that was left alone for longer.
Repair::Choice Repair::choose() {
  const std::vector<JointMotion::Pair>& conflicts = motion_.conflicts();
  const JointMotion::Pair pair = conflicts[std::size_t(random_.below(int(conflicts.size())))];
  const auto last_tried = [&](int i) { return last_tried_[std::size_t(i)]; };
  const int robot = std::ranges::min(pair.first, pair.second, {}, last_tried);
  int from = 0;
  if (random_.below(100) < options_.tail_percent) {
    from = motion_.first_conflict(robot) - 1 - random_.below(options_.tail_macro_steps);
  }
  return {robot, std::max(from, 0)};
}

/// Places the robot, absent so far; or leaves it absent.
bool Repair::plan_anew(const Choice& choice, const ArcTrajectory& old) {
  const bool larger = random_.below(options_.larger_every) == 0;
  const bool finely = larger && stagnates_ && random_.below(2) == 0;
  const SoftOptions options =
      soft_options(options_.expansions * (larger ? options_.larger_factor : 1), finely);
  return plan(choice.robot, options, &old, choice.from) || drive_alone(choice.robot);
}

/// For want of anything better robot i, absent so far, drives the single-agent path, begun at any
/// time. This is all there is in places too tight for a small search. False if it would be late.
bool Repair::drive_alone(int i) {
  const ArcTrajectory& path = alone_[std::size_t(i)];
  if (path.arrival() > limit_) return false;
  const int latest =
      std::min(limit_ - path.arrival(), motion_.makespan()) / motion_.time().macro_step;
  motion_.place(i, motion_.trajectory_after(i, random_.below(latest + 1), path.steps()));
  return true;
}

/// Robot i moves as before, whatever was planned for it since.
void Repair::put_back(int i, ArcTrajectory old) {
  if (motion_.present(i)) motion_.remove(i);
  motion_.place(i, std::move(old));
}

void Repair::try_one() {
  ++tried_;
  const Choice choice = choose();
  const int i = choice.robot;
  last_tried_[std::size_t(i)] = tried_;
  const double before = motion_.cost();
  const std::vector<int> overlapped = motion_.conflicts_of(i);
  ArcTrajectory old = motion_.remove(i);
  if (!plan_anew(choice, old) || motion_.cost() > before) put_back(i, std::move(old));
  for (const int j : overlapped) {
    if (!motion_.in_conflict(i, j)) continue;
    motion_.set_weight(i, j, float(motion_.weight(i, j)) + options_.weight_step);
  }
}

bool Repair::tighten(int limit, std::int64_t stagnation_limit, int expansions,
                     const Interrupt& interrupt, bool& unreachable) {
  limit_ = limit;
  unreachable = false;
  std::vector<int> late;
  for (int i = 0; i < motion_.size(); ++i) {
    if (motion_.trajectory(i).arrival() > limit) late.push_back(i);
  }
  random_.shuffle(late);
  for (const int i : late) motion_.remove(i);
  for (const int i : late) {
    if (plan(i, soft_options(expansions))) continue;
    const ArcTrajectory& trajectory = alone_[std::size_t(i)];
    unreachable = trajectory.arrival() > limit && !deadline_.expired();
    if (unreachable || deadline_.expired()) return false;
    motion_.place(i, trajectory);
  }
  const auto resolve = [&] { return run(stagnation_limit, interrupt); };
  return needs_windows(motion_) ? resolve_by_windows(motion_, resolve) : resolve();
}

bool Repair::shorten(int i, int expansions) {
  ArcTrajectory old = motion_.remove(i);
  if (plan(i, soft_options(expansions)) && motion_.conflicts().empty() &&
      motion_.trajectory(i).arrival() < old.arrival()) {
    return true;
  }
  put_back(i, std::move(old));
  return false;
}

}  // namespace mvtp
