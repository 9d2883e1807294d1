#include "planner/algorithms/first_plan.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>

#include "planner/algorithms/taking_turns.hpp"

namespace mvtp {
namespace {

constexpr int kExpansions = 500;  ///< of the first search for a robot
/// If robots on their ways alone have so many conflicts each, the plan is found window by window
/// of time: what comes later changes too often to be worth the work.
constexpr double kCrowded = 1.0;
constexpr int kWindow = 16;  ///< [buckets]
constexpr int kSight = 20;   ///< searches see so much further than the window [buckets]
/// The plan is looked for within so much of the longest way alone; a deadline does not make it
/// harder to find, but much better. It is put off by kRelax whenever the repair comes to a halt.
constexpr double kLimit = 1.2;
constexpr double kCrowdedLimit = 1.25;
constexpr double kRelax = 1.25;
constexpr double kNoLimit = 1e9;  ///< [instants]
/// Expansions per robot without progress until the repair has come to a halt; half of them before
/// robots take turns, which costs little where it fails.
constexpr std::int64_t kPatiencePerRobot = 1'500;

}  // namespace

FirstPlan::FirstPlan(JointMotion& motion, Repair& repair, const std::vector<TimedTrack>& alone,
                     const Deadline& deadline, Repair::Interrupt interrupt)
    : motion_(motion),
      repair_(repair),
      alone_(alone),
      deadline_(deadline),
      interrupt_(std::move(interrupt)) {}

bool FirstPlan::find() {
  motion_.place_all(alone_);
  const bool crowded = double(motion_.conflicts().size()) > kCrowded * motion_.size();
  motion_.clear();
  set_limit((crowded ? kCrowdedLimit : kLimit) * longest_way_alone());
  return crowded ? resolve_by_windows() : place_one_by_one() && resolve();
}

void FirstPlan::set_limit(double limit) {
  limit_ = std::min(limit, kNoLimit);
  repair_.set_limit(int(limit_));
}

std::int64_t FirstPlan::patience() const { return kPatiencePerRobot * motion_.size(); }

/// The arrival of the last robot if each were alone [instants].
int FirstPlan::longest_way_alone() const {
  return std::ranges::max_element(alone_, {}, &TimedTrack::arrival)->arrival();
}

/// False if the time ran out before everyone was placed.
bool FirstPlan::place_one_by_one() {
  std::vector<int> order(alone_.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater<>(),
                           [&](int i) { return alone_[std::size_t(i)].arrival(); });
  for (const int i : order) {
    if (deadline_.expired()) return false;
    plan_softly(i);
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
  while (!repair_.run(turns_taken_ ? patience() : patience() / 2, interrupt_)) {
    if (over()) return false;
    if (!std::exchange(turns_taken_, true) && take_turns()) return true;
    if (over()) return false;
    set_limit(kRelax * limit_);
  }
  return true;
}

/// From the ways alone on: conflicts are resolved up to a horizon that is moved on.
bool FirstPlan::resolve_by_windows() {
  motion_.set_horizon(kWindow, kWindow + kSight);
  for (int i = 0; i < motion_.size(); ++i) motion_.place(i, alone_[std::size_t(i)]);
  for (int end = kWindow; resolve(); end += kWindow) {
    if (!motion_.has_horizon() || end * motion_.time().bucket > motion_.makespan()) return true;
    motion_.set_horizon(end + kWindow, end + kWindow + kSight);
  }
  return false;
}

/// True if nobody overlaps any more, with no horizon; if not, nothing has changed.
bool FirstPlan::take_turns() {
  const JointMotion::State before = motion_.state();
  const double limit = limit_;
  set_limit(kNoLimit);
  TakingTurns turns(motion_, alone_, deadline_);
  turns.run(patience());
  const bool most = turns.gone() > motion_.size() / 2;
  for (int i = 0; i < motion_.size() && most; ++i) {
    if (turns.has_gone(i)) continue;
    (void)motion_.remove(i);
    plan_softly(i);
  }
  if (most && repair_.run(patience(), interrupt_)) return true;
  motion_.restore(before);
  set_limit(limit);
  return false;
}

}  // namespace mvtp
