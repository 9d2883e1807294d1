#pragma once

#include <barrier>
#include <cstdint>
#include <limits>
#include <vector>

#include "planner/motion/arc_trajectory.hpp"

namespace mvtp {

/// A plan that is free of conflicts; none yet if `trajectories` is empty.
struct ConflictFreePlan {
  std::vector<ArcTrajectory> trajectories;
  int makespan = std::numeric_limits<int>::max();                    ///< [time steps]
  std::int64_t flowtime = std::numeric_limits<std::int64_t>::max();  ///< [time steps]

  [[nodiscard]] bool better_than(const ConflictFreePlan& other) const {
    return makespan != other.makespan ? makespan < other.makespan : flowtime < other.flowtime;
  }
};

/// Where searchers in several threads compare their plans, at the same expansions of each.
///
/// Everyone waits for everyone, so that the result depends on the number of searchers only.
class Exchange {
 public:
  /// @param goal  a plan of this makespan ends the search [time steps]
  Exchange(int searchers, int goal);

  /// Offers a plan and takes over the best of all, if it is better. To be called by every searcher
  /// equally often. @return true if the search has ended
  bool meet(int searcher, ConflictFreePlan& plan, bool finished);

 private:
  void compare() noexcept;

  struct Slot {
    ConflictFreePlan* plan = nullptr;
    bool finished = false;
  };
  /// What std::barrier calls when everyone has come.
  struct Completion {
    Exchange* exchange;
    void operator()() noexcept { exchange->compare(); }
  };

  int goal_;
  std::vector<Slot> slots_;
  ConflictFreePlan best_;
  bool ended_ = false;
  std::barrier<Completion> barrier_;
};

}  // namespace mvtp
