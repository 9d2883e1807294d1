// Groups that stand as they stood one decision before.

#include "coordinator/junctions/stagnation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace mvtp {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAre;

using Keys = std::vector<std::int64_t>;
using States = std::map<std::int64_t, InertialState>;

const States kStanding = {{1, {10.0, 0.0}}, {2, {4.0, 0.0}}, {3, {7.0, 0.0}}, {7, {1.0, 0.0}}};

/// What is found at the second of two decisions.
Keys second(const std::vector<Keys>& groups, const States& before, const States& now,
            std::uint64_t seed = 1) {
  Stagnation stagnation;
  EXPECT_THAT(stagnation.duplicates(groups, before, seed), IsEmpty()) << "nothing came before";
  return stagnation.duplicates(groups, now, seed);
}

TEST(Stagnation, AGroupThatStandsTwicePlansAnew) {
  EXPECT_THAT(second({{1, 2, 3}, {7}}, kStanding, kStanding), UnorderedElementsAre(1, 2, 3));
}

TEST(Stagnation, GroupsAreJudgedOnTheirOwn) {
  States now = kStanding;
  now.at(2) = {4.1, 0.5};
  now.emplace(8, InertialState{0.0, 0.0});
  States before = kStanding;
  before.emplace(8, InertialState{0.0, 0.0});
  EXPECT_THAT(second({{1, 2}, {3, 7, 8}}, before, now), UnorderedElementsAre(3, 7, 8));
}

TEST(Stagnation, WhoeverMovesOrIsAboutToMovesTheGroupOn) {
  States crept = kStanding;
  crept.at(3).s += 0.01;
  EXPECT_THAT(second({{1, 2, 3}}, kStanding, crept), IsEmpty());
  States starts = kStanding;
  starts.at(3).v = 0.2;
  EXPECT_THAT(second({{1, 2, 3}}, starts, starts), IsEmpty()) << "it drives";
}

TEST(Stagnation, ANewcomerIsNoDuplicateAndOneThatLeftIsNotAskedOf) {
  States before = kStanding;
  before.erase(3);
  EXPECT_THAT(second({{1, 2, 3}}, before, kStanding), IsEmpty());
  EXPECT_THAT(second({{1, 2, 3}}, kStanding, before), UnorderedElementsAre(1, 2));
  States alone = {{1, kStanding.at(1)}};
  EXPECT_THAT(second({{1, 2, 3}}, kStanding, alone), IsEmpty()) << "alone there is no order";
}

TEST(Stagnation, OnlyTheLastDecisionCounts) {
  Stagnation stagnation;
  States moved = kStanding;
  moved.at(1).s += 1.0;
  const std::vector<Keys> groups = {{1, 2}};
  (void)stagnation.duplicates(groups, kStanding, 1);
  (void)stagnation.duplicates(groups, moved, 1);
  EXPECT_THAT(stagnation.duplicates(groups, kStanding, 1), IsEmpty());
  EXPECT_THAT(stagnation.duplicates(groups, kStanding, 1), UnorderedElementsAre(1, 2));
}

TEST(Stagnation, EveryOrderIsDrawnSoonerOrLaterAndTheSameForTheSameSeed) {
  std::set<Keys> orders;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    orders.insert(second({{1, 2, 3}}, kStanding, kStanding, seed));
    EXPECT_EQ(second({{1, 2, 3}}, kStanding, kStanding, seed),
              second({{1, 2, 3}}, kStanding, kStanding, seed));
  }
  EXPECT_EQ(orders.size(), 6U);
}

}  // namespace
}  // namespace mvtp
