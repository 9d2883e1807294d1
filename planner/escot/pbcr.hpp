#pragma once

#include <algorithm>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace mvtp {

/// The motion number k of a list, from 0 on; nullptr if there are not so many.
template <class Motion>
[[nodiscard]] const Motion* nth(const std::vector<Motion>& motions, std::size_t k) {
  return k < motions.size() ? &motions[k] : nullptr;
}

/// Motions that are looked at one after the other: a vector, or what finds the next when asked. The
/// pointers stay valid.
template <class List, class Motion>
concept MotionList = std::move_constructible<List> && requires(List& list, std::size_t k) {
  { nth(list, k) } -> std::same_as<const Motion*>;
};

/// What PBCR asks of the world; the only thing it knows about vehicles, roads and obstacles.
///
/// A Motion is one step *and the safe stop after it*: the pose itself for a car that stands at
/// the end of every step, the drive while braking to rest for a car with inertia. Motions of two
/// robots are compared over their whole length, both stops running in lock-step, so that "everyone
/// brakes now" stays collision-free after the step if the motions are.
template <class W>
concept StepWorld = requires(const W& world, int i, const typename W::State& state,
                             const typename W::Motion& motion) {
  requires std::copyable<typename W::State> && std::copyable<typename W::Motion>;
  /// Motions of robot i from `state`, best first; those that hit an obstacle are left out.
  { world.candidates(i, state) } -> MotionList<typename W::Motion>;
  /// The motion of a robot that brakes now (waits, if it stands). Never hits an obstacle.
  { world.safe_stop(i, state) } -> std::same_as<typename W::Motion>;
  /// Do the two motions, begun at the same time, overlap? Symmetric.
  { world.conflict(i, motion, i, motion) } -> std::same_as<bool>;
};

/// A world may know better what a robot should do while it is pushed.
template <class W>
concept PushCandidateWorld = StepWorld<W> &&
    requires(const W& world, int i, const typename W::State& state,
             const typename W::Motion& motion) {
  /// Motions of robot i blocking another one and its motion; instead of candidates().
  { world.push_candidates(i, state, i, motion) } -> MotionList<typename W::Motion>;
};

/// A world may know which motion comes first in candidates() without looking at the others.
template <class W>
concept DecisiveWorld = StepWorld<W> &&
    requires(const W& world, int i, const typename W::State& state) {
  { world.first_choice(i, state) } -> std::same_as<std::optional<typename W::Motion>>;
};

/// A world may know who is too far away to be met.
template <class W>
concept LocalWorld = StepWorld<W> && requires(const W& world, int i) {
  /// The robots that any motion of robot i may conflict with in this step, i among them or not.
  { world.near(i) } -> std::convertible_to<std::span<const int>>;
};

struct PbcrOptions {
  /// Candidates that may be withdrawn for one robot of highest priority before everything it pushes
  /// may only brake; bounds the exponential worst case of backtracking. >= 0.
  int max_withdrawn = 2000;
};

/// Priority inheritance and backtracking for car-like robots: one step of all robots.
///
/// Safety: if "everyone brakes now" is collision-free before the step, it is so after it. An
/// undecided robot counts with its own safe stop, so that one is always left to it. If it is not,
/// whoever finds no motion without a conflict brakes.
/// Unlike classic PIBT, a withdrawn candidate undoes every decision made below it: with motions
/// instead of cells, a pushed robot that keeps its decision may drive over the place of its pusher
/// when that one stays, and not even waiting would be left.
/// Source: ESCoT paper, Algorithm 1 (function PBCR); Okumura et al. 2022 (PIBT).
template <StepWorld World>
class Pbcr {
 public:
  using State = typename World::State;
  using Motion = typename World::Motion;

  explicit Pbcr(const World& world, PbcrOptions options = {}) : world_(world), options_(options) {}

  /// The next motion of every robot.
  ///
  /// @param from     one state per robot; their safe stops should not conflict with each other.
  /// @param order    every robot once, highest priority first.
  /// @param decided  motions fixed beforehand, free of conflicts with each other; nullopt = free.
  ///                 They have the highest priority: free robots blocking their path are pushed.
  /// @return motions without conflicts (as far as the safe stops before the step had none), those
  ///         of `decided` unchanged. nullopt only if the robots in
  ///         a path of `decided` found no other place; never if `decided` is empty or all nullopt.
  [[nodiscard]] std::optional<std::vector<Motion>> step(
      std::span<const State> from, std::span<const int> order,
      std::vector<std::optional<Motion>> decided = {}) const {
    assert(order.size() == from.size() && (decided.empty() || decided.size() == from.size()));
    decided.resize(from.size());
    Step step(world_, from, order, std::move(decided), options_.max_withdrawn);
    return step.run();
  }

 private:
  class Step;

  const World& world_;
  PbcrOptions options_;
};

/// The state of one step: who is decided (OCCU of Algorithm 1), who is not (UNDE).
template <StepWorld World>
class Pbcr<World>::Step {
 public:
  Step(const World& world, std::span<const State> from, std::span<const int> order,
       std::vector<std::optional<Motion>> decided, int max_withdrawn)
      : world_(world),
        from_(from),
        order_(order),
        decided_(std::move(decided)),
        candidates_(from.size()),
        max_withdrawn_(max_withdrawn) {
    stops_.reserve(from.size());
    for (int i = 0; i < int(from.size()); ++i) stops_.push_back(world.safe_stop(i, at(from_, i)));
  }

  std::optional<std::vector<Motion>> run() {
    if (!push_blockers_of_decided()) return std::nullopt;
    for (const int i : order_) {
      if (at(decided_, i)) continue;
      withdrawn_ = 0;
      // No decided motion conflicts with the safe stop of an undecided robot, so one is left to i.
      // Only if their safe stops conflicted before the step, nothing better is left than to brake.
      if (!decide_freely(i)) at(decided_, i) = at(stops_, i);
    }
    std::vector<Motion> next;
    next.reserve(decided_.size());
    for (std::optional<Motion>& motion : decided_) next.push_back(*std::move(motion));
    return next;
  }

 private:
  using Candidates = decltype(std::declval<const World&>().candidates(0, std::declval<State>()));

  template <class Vector>
  static decltype(auto) at(Vector&& values, int i) {
    return values[std::size_t(i)];
  }

  /// Gives robot i the first of its candidates that can be, and with it every robot it pushes.
  bool decide_freely(int i) {
    if constexpr (DecisiveWorld<World>) {
      if (const auto best = world_.first_choice(i, at(from_, i))) {
        if (attempt(i, *best)) return true;
        return decide(i, candidates(i), 1);
      }
    }
    return decide(i, candidates(i));
  }

  /// Gives robot i one of the motions, the first that can be from number k on, and with it every
  /// robot that blocks it; or changes nothing.
  bool decide(int i, MotionList<Motion> auto&& motions, std::size_t k = 0) {
    for (; withdrawn_ <= max_withdrawn_; ++k) {  // Algorithm 1, line 13
      const Motion* motion = nth(motions, k);
      if (motion == nullptr) break;
      if (attempt(i, *motion)) return true;
    }
    return attempt(i, at(stops_, i));  // even if the world left it out
  }

  /// Decides `motion` for robot i if the decided robots leave room and the undecided ones can make
  /// room; or changes nothing.
  bool attempt(int i, const Motion& motion) {
    if (conflicts_with_decided(i, motion)) return false;  // Algorithm 1, lines 15-16
    const std::size_t mark = trail_.size();
    at(decided_, i) = motion;  // line 17
    trail_.push_back(i);
    if (push_blockers_of(i)) return true;  // lines 18-21
    withdraw(mark);                        // line 23
    return false;
  }

  /// The robots that i may meet; pushed in this order.
  std::span<const int> near(int i) const {
    if constexpr (LocalWorld<World>) {
      return world_.near(i);
    } else {
      return order_;
    }
  }

  /// Priority inheritance: each undecided robot blocking i is decided now, at i's priority.
  bool push_blockers_of(int i) {
    for (const int j : near(i)) {
      if (at(decided_, j) || !world_.conflict(i, *at(decided_, i), j, at(stops_, j))) continue;
      if (!decide(j, push_candidates(j, i))) return false;
    }
    return true;
  }

  /// What robot j may do while it is pushed by i.
  decltype(auto) push_candidates(int j, int i) {
    if constexpr (PushCandidateWorld<World>) {
      return world_.push_candidates(j, at(from_, j), i, *at(decided_, i));
    } else {
      return candidates(j);
    }
  }

  /// Backtracking: undoes every decision made since the trail had `mark` entries.
  void withdraw(std::size_t mark) {
    ++withdrawn_;
    while (trail_.size() > mark) {
      at(decided_, trail_.back()).reset();
      trail_.pop_back();
    }
  }

  bool push_blockers_of_decided() {
    std::vector<int> fixed;
    for (int i = 0; i < int(decided_.size()); ++i) {
      if (at(decided_, i)) fixed.push_back(i);
    }
    return std::ranges::all_of(fixed, [this](int i) { return push_blockers_of(i); });
  }

  bool conflicts_with_decided(int i, const Motion& motion) const {
    for (const int j : near(i)) {
      if (at(decided_, j) && world_.conflict(i, motion, j, *at(decided_, j))) return true;
    }
    return false;
  }

  Candidates& candidates(int i) {
    std::optional<Candidates>& list = at(candidates_, i);
    if (!list) list.emplace(world_.candidates(i, at(from_, i)));
    return *list;
  }

  const World& world_;
  std::span<const State> from_;
  std::span<const int> order_;
  std::vector<Motion> stops_;
  std::vector<std::optional<Motion>> decided_;
  std::vector<std::optional<Candidates>> candidates_;  ///< computed when first asked for
  std::vector<int> trail_;                             ///< decided robots, oldest first
  int withdrawn_ = 0;
  int max_withdrawn_;
};

}  // namespace mvtp
