#include "planner/anytime/first_plan.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "planner/anytime/revised_prioritized_planning.hpp"
#include "planner/anytime/windows.hpp"

namespace mvtp {
namespace {

constexpr int kExpansions = 500;  ///< of the first search for a robot
constexpr int kDelays = 4;        ///< single-agent paths begin at multiples of so many macro steps
constexpr double kNoLimit = 1e9;  ///< [time steps]
constexpr std::int64_t kRevisedStagnationLimit = 1500;  ///< expansions per robot without progress

}  // namespace

FirstPlan::FirstPlan(JointMotion& motion, Repair& repair, const std::vector<ArcTrajectory>& alone,
                     const Deadline& deadline, Repair::Interrupt interrupt)
    : motion_(motion),
      repair_(repair),
      alone_(alone),
      deadline_(deadline),
      interrupt_(std::move(interrupt)) {}

bool FirstPlan::find() {
  if (!motion_.place_all(alone_, deadline_)) return false;
  const bool crowd = needs_windows(motion_);
  motion_.clear();
  options_ = crowd ? kCrowded : kCalm;
  set_limit(options_.limit * alone_[std::size_t(longest_path_first().front())].arrival());
  if (!crowd) return place_one_by_one() && resolve();
  return spread_out() && resolve_by_windows(motion_, [this] { return resolve(); });
}

void FirstPlan::set_limit(double limit) {
  limit_ = std::min(limit, kNoLimit);
  repair_.set_limit(int(limit_));
}

std::vector<int> FirstPlan::longest_path_first() const {
  std::vector<int> order(alone_.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater<>(),
                           [&](int i) { return alone_[std::size_t(i)].arrival(); });
  return order;
}

/// False if the time ran out before everyone was placed.
bool FirstPlan::place_one_by_one() {
  for (const int i : longest_path_first()) {
    if (deadline_.expired()) return false;
    plan_softly(i);
  }
  return true;
}

/// Everyone drives the single-agent path, begun when it meets fewest of those placed so far. All
/// the time there is gets used, so that far fewer are under way at once. False if the time ran out.
bool FirstPlan::spread_out() {
  const int macro_step = motion_.time().macro_step;
  for (const int i : longest_path_first()) {
    if (deadline_.expired()) return false;
    const ArcTrajectory& path = alone_[std::size_t(i)];
    int best = 0;
    int fewest = std::numeric_limits<int>::max();
    for (int wait = 0; fewest > 0; wait += kDelays) {
      if (wait > 0 && wait * macro_step + path.arrival() > limit_) break;
      const int met = motion_.overlaps(i, path, fewest, wait);
      if (met < fewest) {
        fewest = met;
        best = wait;
      }
    }
    motion_.place(i, motion_.trajectory_after(i, best, path.steps()));
  }
  return true;
}

/// Places robot i, absent so far, so that it overlaps few.
void FirstPlan::plan_softly(int i) {
  if (!repair_.plan(i, repair_.soft_options(kExpansions))) {
    motion_.place(i, alone_[std::size_t(i)]);
  }
}

/// Until nobody overlaps before the horizon.
bool FirstPlan::resolve() {
  const std::int64_t stagnation_limit = options_.stagnation_limit * motion_.size();
  const int stagnations_before_revising =
      options_.stagnations + motion_.size() / options_.robots_per_stagnation;
  for (int stagnations = 1; !repair_.run(stagnation_limit, interrupt_); ++stagnations) {
    if (over()) return false;
    const bool revises =
        stagnations >= stagnations_before_revising && !std::exchange(revised_, true);
    if (revises && revise_priorities()) return true;
    if (over()) return false;
    set_limit(options_.relax * limit_);
  }
  return true;
}

/// True if nobody overlaps any more, with no horizon; if not, nothing has changed.
bool FirstPlan::revise_priorities() {
  const JointMotion::State before = motion_.state();
  const double limit = limit_;
  set_limit(kNoLimit);
  RevisedPrioritizedPlanning revised(motion_, alone_, deadline_);
  const std::int64_t stagnation_limit = kRevisedStagnationLimit * motion_.size();
  revised.run(stagnation_limit);
  const bool most = revised.departed() > motion_.size() / 2;
  for (int i = 0; i < motion_.size() && most; ++i) {
    if (revised.has_departed(i)) continue;
    (void)motion_.remove(i);
    plan_softly(i);
  }
  if (most && repair_.run(stagnation_limit, interrupt_)) return true;
  motion_.restore(before);
  set_limit(limit);
  return false;
}

}  // namespace mvtp
