#include "coordinator/drivers/lane_keeping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Reason = LaneKeeping::Reason;

/// Notes who is kept in his lane.
class KeepingTraffic : public FakeTraffic {
 public:
  KeepingTraffic() : FakeTraffic(make_crossroads(), {}) {}
  void keep_lane(const std::string& id, bool keep) override {
    keep ? (void)kept.insert(id) : (void)kept.erase(id);
  }
  std::set<std::string> kept;
};

class LaneKeepingTest : public testing::Test {
 protected:
  KeepingTraffic traffic;
  LaneKeeping keeping{traffic};
};

TEST_F(LaneKeepingTest, WhoIsKeptForTwoReasonsIsFreeWhenBothHaveEnded) {
  constexpr Reason kAll[] = {Reason::kSignal, Reason::kGuest, Reason::kBeside, Reason::kExit};
  for (const Reason first : kAll) {
    for (const Reason second : kAll) {
      if (first == second) continue;
      keeping.keep("a", first, true);
      keeping.keep("a", second, true);
      keeping.keep("a", second, false);
      EXPECT_THAT(traffic.kept, ElementsAre("a"));
      keeping.keep("a", first, false);
      EXPECT_THAT(traffic.kept, IsEmpty());
    }
  }
}

TEST_F(LaneKeepingTest, AReasonCountsOnceHoweverOftenItIsGiven) {
  keeping.keep("a", Reason::kSignal, true);
  keeping.keep("a", Reason::kSignal, true);
  keeping.keep("a", Reason::kSignal, false);
  EXPECT_THAT(traffic.kept, IsEmpty());
}

TEST_F(LaneKeepingTest, KeepingOnlySomeLetsOthersGoWhoWereKeptForTheSameReason) {
  keeping.keep_only({"a", "b"}, Reason::kExit);
  EXPECT_THAT(traffic.kept, ElementsAre("a", "b"));
  keeping.keep("b", Reason::kGuest, true);
  keeping.keep_only({"c"}, Reason::kExit);
  EXPECT_THAT(traffic.kept, ElementsAre("b", "c"));
  keeping.keep_only({}, Reason::kExit);
  EXPECT_THAT(traffic.kept, ElementsAre("b"));
}

TEST_F(LaneKeepingTest, WhatHoldsForOneDoesNotForAnother) {
  keeping.keep("a", Reason::kBeside, true);
  keeping.keep("b", Reason::kBeside, false);
  EXPECT_THAT(traffic.kept, ElementsAre("a"));
}

}  // namespace
}  // namespace mvtp
