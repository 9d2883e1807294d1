#include "coordinator/junctions/referee.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const Vehicle kCar = {.front = 3.6, .rear = 0.9, .width = 1.8};
const Vehicle kCube = {.front = 0.5, .rear = 0.5, .width = 1.0};

//        | 1      Paths 0 and 1 cross at s = 50, 2 is path 0 again, 3 is far away.
//   0, 2 +--->
class RefereeTest : public testing::Test {
 protected:
  explicit RefereeTest(const Vehicle& body = kCar) {
    library.add(ReferencePath(std::vector<Point>{{-50, 0}, {50, 0}}), body);
    library.add(ReferencePath(std::vector<Point>{{0, -50}, {0, 50}}), body);
    library.add(ReferencePath(std::vector<Point>{{-50, 0}, {50, 0}}), body);
    library.add(ReferencePath(std::vector<Point>{{-50, 90}, {50, 90}}), body);
    scene.library = &library;
  }

  /// A vehicle that drives at an even speed from s on, and what it was planned to do.
  void add(int path, double s, double per_step, int steps) {
    const auto key = std::int64_t(scene.vehicles.size());
    scene.vehicles.push_back({.key = key, .path = path, .now = {s, per_step * 10}});
    plan.entries.push_back({key, even(s, per_step, steps)});
  }
  static std::shared_ptr<SpeedProfile> even(double s, double per_step, int steps) {
    SpeedProfile t;
    for (int k = 0; k < steps; ++k) t.states.push_back({s + per_step * k, per_step * 10});
    return std::make_shared<SpeedProfile>(t);
  }

  PathLibrary library{Margins{}};
  RoadScene scene;
  JointPlan plan;
};

class RefereeOfCubesTest : public RefereeTest {
 protected:
  RefereeOfCubesTest() : RefereeTest(kCube) {}
};

TEST_F(RefereeTest, SeesTwoVehiclesThatWouldMeet) {
  add(0, 0.0, 1.0, 90);
  add(1, 0.0, 1.0, 90);
  const auto contacts = find_planned_contacts(scene, plan);
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0].first, 0);
  EXPECT_EQ(contacts[0].second, 1);
  EXPECT_NEAR(double(contacts[0].step), 46.0, 2.0);

  plan.entries[1].profile = even(-20.0, 1.0, 110);  // two seconds behind
  EXPECT_THAT(find_planned_contacts(scene, plan), IsEmpty());
}

// A guest on path 1 leaves between now and five seconds later; the crossing is at s = 50.
TEST_F(RefereeTest, SeesWhoWouldTouchAPassageWheneverItGoes) {
  Forecast passage;
  passage.vehicle = {.key = -1, .path = 1, .s_end = 100.0};
  passage.earliest = *even(0.0, 1.0, 100);
  SpeedProfile latest = *even(0.0, 1.0, 100);
  latest.states.insert(latest.states.begin(), 50, latest.states.front());
  passage.latest = latest;
  const auto touches = [&](const SpeedProfile& t) {
    return touches_passage(library, 0, t, passage, 0);
  };
  SpeedProfile stands{.begin = 0, .states = {{48.0, 0.0}}, .complete = false};
  EXPECT_TRUE(touches(stands)) << "its front is on path 1";
  stands.states[0].s = 50.0 - 0.9 - 3.6 - 0.1;
  EXPECT_FALSE(touches(stands)) << "within the margins only";
  EXPECT_TRUE(touches(*even(0.0, 1.0, 100))) << "with the earliest";
  EXPECT_TRUE(touches(*even(-25.0, 1.0, 125))) << "in between";
  EXPECT_TRUE(touches(*even(-50.0, 1.0, 150))) << "with the latest";
  EXPECT_FALSE(touches(*even(-70.0, 1.0, 170))) << "behind it";
  EXPECT_FALSE(touches(*even(20.0, 1.0, 80))) << "before it";
}

// 4 m per step: at the steps both cubes are 2 m before, and then 2 m behind the crossing.
TEST_F(RefereeOfCubesTest, SeesWhatHappensBetweenTwoSteps) {
  add(0, 46.0, 4.0, 4);
  add(1, 46.0, 4.0, 4);
  ASSERT_EQ(find_planned_contacts(scene, plan).size(), 1U);
  add(3, 0.0, 4.0, 4);
  plan.entries[1].profile = even(44.0, 4.0, 4);  // just behind each other
  EXPECT_THAT(find_planned_contacts(scene, plan), IsEmpty());
}

TEST_F(RefereeTest, ReturnsEveryPairOnce) {
  add(0, 40.0, 1.0, 40);
  add(1, 40.0, 1.0, 40);
  add(2, 30.0, 2.0, 40);  // runs into vehicle 0 from behind
  add(3, 40.0, 1.0, 40);
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  for (const PlannedContact& c : find_planned_contacts(scene, plan)) {
    pairs.emplace_back(c.first, c.second);
  }
  EXPECT_THAT(pairs, ElementsAre(testing::Pair(0, 1), testing::Pair(0, 2), testing::Pair(1, 2)));
}

TEST_F(RefereeTest, WhoOverlapsAlreadyMayDriveApart) {
  add(0, 40.0, 1.0, 40);
  add(2, 36.0, 0.5, 40);  // half a metre inside the one ahead
  EXPECT_THAT(find_planned_contacts(scene, plan), IsEmpty());
  plan.entries[0].profile = even(40.0, 0.4, 40);
  plan.entries[1].profile = even(34.0, 0.5, 40);  // not yet inside, but soon
  EXPECT_EQ(find_planned_contacts(scene, plan).size(), 1U);
}

TEST_F(RefereeTest, DoesNotLookAgainAtPairsThatWereJudged) {
  add(0, 40.0, 1.0, 40);
  add(1, 40.0, 1.0, 40);
  EXPECT_THAT(find_planned_contacts(scene, plan, plan), IsEmpty());
  JointPlan before = plan;
  before.entries[1].profile = even(10.0, 1.0, 40);
  EXPECT_EQ(find_planned_contacts(scene, plan, before).size(), 1U);
}

TEST_F(RefereeTest, OneWhoStandsForGoodBlocksToTheEnd) {
  add(0, 0.0, 1.0, 90);
  add(1, 49.0, 0.0, 1);
  SpeedProfile stands{.states = {{49.0, 0.0}}, .complete = false};
  plan.entries[1].profile = std::make_shared<SpeedProfile>(stands);
  EXPECT_EQ(find_planned_contacts(scene, plan).size(), 1U);
}

// A plan that is refused is still better than an old one that leads to contact sooner, or as soon
// and to more.
TEST(BetterAsBefore, AreGroupsWhoseOldPlansTouchLaterOrLess) {
  const std::vector<std::vector<std::int64_t>> groups = {{0, 1, 2}, {3, 4}};
  const std::vector<PlannedContact> contacts = {{0, 1, 46}};
  const auto better = [&](const std::vector<PlannedContact>& before) {
    return better_as_before(groups, contacts, before);
  };
  EXPECT_THAT(better({}), ElementsAre(0)) << "the old one is free of contacts";
  EXPECT_THAT(better({{3, 4, 10}}), ElementsAre(0)) << "and those of others do not count";
  EXPECT_THAT(better({{0, 1, 46}}), IsEmpty()) << "both are the same";
  EXPECT_THAT(better({{1, 2, 47}}), ElementsAre(0)) << "later";
  EXPECT_THAT(better({{0, 1, 60}, {1, 2, 80}}), ElementsAre(0)) << "more, but later";
  EXPECT_THAT(better({{0, 1, 46}, {0, 2, 46}}), IsEmpty()) << "as soon, and more";
  EXPECT_THAT(better({{0, 1, 45}}), IsEmpty()) << "sooner";
  EXPECT_THAT(better_as_before(groups, {}, contacts), IsEmpty()) << "nobody is refused";
}

TEST(GroupsInContact, AreThoseWithAVehicleThatTouches) {
  const std::vector<std::vector<std::int64_t>> groups = {{0, 3}, {1}, {2, 4}};
  const std::vector<PlannedContact> contacts = {{2, 4, 10}, {0, 3, 5}};
  EXPECT_THAT(groups_in_contact(groups, contacts), ElementsAre(0, 2));
  EXPECT_THAT(groups_in_contact(groups, {}), IsEmpty());
}

}  // namespace
}  // namespace mvtp
