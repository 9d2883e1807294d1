#pragma once

#include "planner/road/road_escot.hpp"

namespace mvtp {

/// How much work replans may be, so that they come in time: the clock's last resort. A plan that
/// takes longer than the budget is dropped; the next ones get less work, until they have been in
/// time for a while. As long as nobody is late, the clock changes nothing.
class ReplanPace {
 public:
  /// @param budget_ms  [ms] of wall clock for one plan
  explicit ReplanPace(double budget_ms) : budget_ms_(budget_ms) {}

  /// How the next plan is to be made: `full` but for the work in it.
  [[nodiscard]] RoadEscotOptions for_next(RoadEscotOptions full) const;

  /// Notes what a plan took [ms]; true if it is late.
  bool note(double ms);

 private:
  double budget_ms_;
  int hurry_ = 0;    ///< 0: all the work; more: less of it
  int in_time_ = 0;  ///< plans in a row since the last change
};

}  // namespace mvtp
