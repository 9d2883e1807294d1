#include "coordinator/replan_pace.hpp"

#include <algorithm>

namespace mvtp {
namespace {

constexpr int kShare = 4;       ///< of the work is done in the first hurry; in the second,
constexpr int kMostHurry = 2;   ///< orders are not searched at all
constexpr int kCalm = 10;       ///< plans in a row that have to be in time before there is more
constexpr double kEasy = 0.25;  ///< of the budget at most that those may take

}  // namespace

RoadEscotOptions ReplanPace::for_next(RoadEscotOptions full) const {
  for (int h = 0; h < hurry_; ++h) full.work /= kShare;
  if (hurry_ == kMostHurry) full.crossing.tries = 0;
  if (hurry_ > 0) full.crossing.tries /= kShare;
  return full;
}

bool ReplanPace::note(double ms) {
  const bool late = ms > budget_ms_;
  if (late) {
    hurry_ = std::min(hurry_ + 1, kMostHurry);
    in_time_ = 0;
  } else if (hurry_ > 0 && ++in_time_ >= kCalm && ms < kEasy * budget_ms_) {
    --hurry_;
    in_time_ = 0;
  }
  return late;
}

}  // namespace mvtp
