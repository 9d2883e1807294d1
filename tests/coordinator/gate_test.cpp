#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/coordinator/gate_fixture.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAre;

TEST_F(GateTest, HoldsWhoeverCanStillStop) {
  gate.begin();
  see("far", 60.0, 13.0);
  see("near", 10.0, 13.0);  // it needs 23 m to stop
  gate.end();
  EXPECT_THAT(traffic.held, UnorderedElementsAre("far"));
  EXPECT_THAT(traffic.passing, UnorderedElementsAre("near"));
  EXPECT_FALSE(gate.passes("far"));
  EXPECT_TRUE(gate.passes("near"));
}

TEST_F(GateTest, KnowsGuestsThatItHoldsFromThoseWhoAreToBeTakenOver) {
  gate.begin();
  see("guest", 60.0, 13.0);
  see("goes", 10.0, 13.0);
  gate.hold("newcomer");
  gate.end();
  EXPECT_TRUE(gate.holds_guest("guest"));
  EXPECT_FALSE(gate.holds_guest("goes"));
  EXPECT_FALSE(gate.holds_guest("newcomer"));
  EXPECT_FALSE(gate.holds_guest("nobody"));
}

TEST_F(GateTest, ProposesNobodyWhoIsStillFarFromItsLine) {
  gate.begin();
  see("a", 40.0, 10.0);
  gate.end();
  EXPECT_FALSE(propose());
}

// To brake and to start again costs more time than anything else.
TEST_F(GateTest, ProposesWhoWouldSoonHaveToBrake) {
  gate.begin();
  see("slow", 45.0, 8.0);
  see("fast", 45.0, 13.0);
  gate.end();
  EXPECT_EQ(propose(), "fast");
}

TEST_F(GateTest, ProposesAsManyAsCannotMeet) {
  const Gate::MayMeet crosses = [](const Gate::Pair& pair) {
    return pair.id.front() != pair.other.front();
  };
  decide({"a1", "a2", "b1", "b2"});
  for (const std::string id : {"a1", "a2", "b1", "b2"}) ASSERT_FALSE(gate.passes(id));
  EXPECT_THAT(gate.propose({first, crosses, nobody}),
              testing::AnyOf(UnorderedElementsAre("a1", "a2"), UnorderedElementsAre("b1", "b2")));
  gate.let_through("a1");
  EXPECT_THAT(gate.propose({first, crosses, nobody}), UnorderedElementsAre("a2"))
      << "not across who passes";
}

TEST_F(GateTest, ProposesThoseFromOneLaneTogetherUnlessTheirPathsMeetAgain) {
  gate.begin();
  for (const char* id : {"a", "b"}) {
    gate.see({.id = id, .type = "car", .speed = 0.0, .lane = "lane"},
             {.line = 0, .to_line = 1.0, .to_hold = 1.0}, car);
  }
  gate.end();
  for (const bool again : {false, true}) {
    const auto meets_again = [&](const Gate::Pair& pair) {
      EXPECT_TRUE(pair.from_one_lane);
      return again;
    };
    const auto proposed = gate.propose({first, meets_again, nobody});
    EXPECT_EQ(proposed.size(), again ? 1U : 2U);
  }
}

// On a roundabout all of them may wait for somebody who waits behind them.
TEST_F(GateTest, WhoIsAheadOnItsLaneDoesNotWaitForItsFollower) {
  for (const bool is_ahead : {true, false}) {
    const auto see_both = [&](double follower) {
      gate.begin();
      for (const auto& [id, to_hold] : {std::pair("waits", 9.0), {"passes", follower}}) {
        gate.see({.id = id, .type = "car", .speed = 0.0, .lane = "lane"},
                 {.line = 0, .to_line = to_hold, .to_hold = to_hold}, car);
      }
      gate.end();
    };
    see_both(is_ahead ? 17.0 : 1.0);
    gate.let_through("passes");
    see_both(is_ahead ? 17.0 : 1.0);
    EXPECT_EQ(gate.propose({first, anybody, nobody}).size(), is_ahead ? 1U : 0U);
    gate.release_all();
  }
}

// Else those from outside fill the room between the lines, and nobody gets out.
TEST_F(GateTest, WhoWaitsBetweenTwoLinesGoesBeforeThoseOutside) {
  const auto see_both = [&] {
    gate.begin();
    for (const bool is_between : {false, true}) {
      const std::string id = is_between ? "between" : "outside";
      gate.see({.id = id, .type = "car", .speed = 0.0, .lane = id},
               {.line = is_between, .to_line = 1.0, .to_hold = 1.0, .is_between = is_between}, car);
    }
    gate.end();
  };
  for (int i = 0; i < 3; ++i) {
    see_both();
    EXPECT_EQ(propose(), "between") << i;
  }
  // After a while also when it cannot go itself yet.
  const Gate::MayMeet meets = [](const Gate::Pair& pair) {
    if (pair.id == "between") return pair.other == "third";
    return pair.id == "outside" && pair.other == "between";
  };
  for (int i = 0; i < 20; ++i) {
    gate.begin();
    for (const std::string id : {"between", "outside", "third"}) {
      gate.see({.id = id, .type = "car", .speed = id == "third" ? 2.0 : 0.0, .lane = id},
               {.line = 0, .to_line = 1.0, .to_hold = 1.0, .is_between = id == "between"}, car);
    }
    gate.end();
    if (i == 0) gate.let_through("third");
    const auto proposed = gate.propose({first, meets, nobody});
    EXPECT_EQ(std::ranges::count(proposed, "between"), 0);
    EXPECT_EQ(std::ranges::count(proposed, "outside"), i < 8 ? 1 : 0) << i;
  }
}

//   "stuck" has its tail in the junction behind it, and is not first on its lane.
TEST_F(GateTest, WhoCannotGoIsExpectedToStay) {
  const Gate::IsFirst is_first = [](const std::string& id) { return id != "stuck"; };
  std::map<std::string, bool> stays;
  const Gate::MayMeet notes = [&](const Gate::Pair& pair) {
    if (pair.id == "waits") stays[pair.other] = pair.other_stays;
    return false;
  };
  gate.begin();
  for (const std::string id : {"first", "passes", "stuck", "waits"}) {
    gate.see({.id = id, .type = "car", .lane = id},
             {.line = 0, .to_line = 1.0, .to_hold = 1.0, .is_clear = id != "stuck"}, car);
  }
  gate.end();
  gate.let_through("passes");
  EXPECT_THAT(gate.propose({is_first, notes, nobody}), UnorderedElementsAre("first", "waits"));
  EXPECT_EQ(stays,
            (std::map<std::string, bool>{{"first", false}, {"passes", false}, {"stuck", true}}));
}

// Between two junctions that are near to each other.
TEST_F(GateTest, HoldsWhoGoesOnOnlyForOneThatItWouldMeetAndThatWasLetThroughBefore) {
  for (const auto& [meets, leads_on] : {std::pair{false, true}, {true, true}, {true, false}}) {
    const Gate::Place between{.line = 1,
                              .to_line = 18.0,
                              .to_hold = 18.0,
                              .leads_on = leads_on,
                              .is_clear = true,
                              .is_between = true};
    const auto see_both = [&](const Gate::Place& place) {
      gate.begin();
      for (const char* id : {"early", "late"}) {
        gate.see({.id = id, .type = "car", .speed = 5.0, .lane = id}, place, car);
      }
      gate.end();
    };
    see_both({.line = 0, .to_line = 10.0, .to_hold = 10.0});
    gate.let_through("early");
    see_both({.line = 0, .to_line = 8.0, .to_hold = 8.0});
    gate.let_through("late");
    see_both(between);
    const auto may_meet = [&](const Gate::Pair&) { return meets; };
    const auto proposed = gate.propose({first, may_meet, nobody});
    EXPECT_THAT(proposed, IsEmpty());
    EXPECT_TRUE(gate.passes("early"));
    EXPECT_EQ(gate.holds("late"), meets && leads_on);
    EXPECT_EQ(gate.passes("late"), !gate.holds("late"));
    gate.release_all();
  }
}

TEST_F(GateTest, HoldsNobodyWhoGoesOnWhereItWouldBlockTheOther) {
  const Gate::Place between{
      .line = 1, .to_line = 18.0, .to_hold = 18.0, .is_clear = true, .is_between = true};
  for (const auto& [id, lane] : {std::pair{"early", "x"}, {"late", "y"}}) {
    for (const Gate::Place& place :
         {Gate::Place{.line = 0, .to_line = 9.0, .to_hold = 9.0}, between}) {
      gate.see({.id = id, .type = "car", .speed = 5.0, .lane = lane}, place, car);
      if (!gate.passes(id)) gate.let_through(id);
    }
  }
  double asked = 0.0;
  const Gate::Blocks blocks = [&](const std::string&, double to_hold, const std::string&) {
    asked = to_hold;
    return true;
  };
  EXPECT_THAT(gate.propose({first, anybody, blocks}), IsEmpty());
  EXPECT_TRUE(gate.passes("early") && gate.passes("late"));
  EXPECT_EQ(asked, between.to_hold);
}

// Who waits for people may wait for long: on a busy zebra there is somebody most of the time.
TEST_F(GateTest, LetsOthersGoBeforeWhoHasToWaitForPeople) {
  for (int i = 0; i < 2; ++i) decide({"a", "b"});  // "a" has been asked for last
  bool is_anybody_there = true;
  const Gate::WaitsForPeople waits = [&](const auto& id) { return is_anybody_there && id == "b"; };
  EXPECT_THAT(gate.propose({first, anybody, nobody, waits}), UnorderedElementsAre("a"));
  is_anybody_there = false;
  EXPECT_THAT(gate.propose({first, anybody, nobody, waits}), UnorderedElementsAre("b"));
}

// It would stand where it is, whatever it may.
TEST_F(GateTest, ProposesNobodyBehindAQueue) {
  gate.begin();
  see("a", 30.0, 3.0);
  gate.end();
  gate.begin();
  see("a", 20.0, 0.0);
  gate.end();
  EXPECT_THAT(gate.propose({[](const std::string&) { return false; }, anybody, nobody}), IsEmpty());
  EXPECT_EQ(propose(), "a");
}

TEST_F(GateTest, LetsThroughOnceAndForgetsWhoHasPassed) {
  gate.begin();
  see("a", 40.0, 10.0);
  gate.end();
  EXPECT_EQ(decide({"a"}), "a");
  gate.let_through("a");
  EXPECT_THAT(traffic.held, IsEmpty());
  EXPECT_THAT(traffic.passing, UnorderedElementsAre("a"));
  EXPECT_EQ(traffic.last, Passage::kOneLine);
  EXPECT_FALSE(decide({"a"})) << "it has been let through";
  EXPECT_FALSE(decide({})) << "it has departed";
  EXPECT_THAT(traffic.passing, IsEmpty());
  EXPECT_FALSE(gate.passes("a"));
}

//   Somebody blocking its path waits for it to be departed, and it for that one.
TEST_F(GateTest, HoldsAgainWhoStandsAlthoughItMayGo) {
  decide({"a", "b"});
  gate.let_through("a");
  int decisions = 0;
  while (gate.passes("a") && decisions < 20) {
    gate.begin();
    for (const std::string id : {"a", "b"}) see(id, 1.0, 0.0);
    gate.end();
    ++decisions;
  }
  EXPECT_GE(decisions, 4) << "a driver takes his time to start";
  EXPECT_LE(decisions, 6);
  EXPECT_THAT(traffic.held, UnorderedElementsAre("a", "b"));
  EXPECT_THAT(traffic.passing, IsEmpty());
  EXPECT_EQ(decide({"a", "b"}), "b") << "it waits for its next turn";
}

TEST_F(GateTest, DoesNotHoldWhoStandsInsideTheJunction) {
  decide({"a"});
  gate.let_through("a");
  for (int i = 0; i < 20; ++i) {
    gate.begin();
    see("a", 0.0, 0.0);
    gate.end();
  }
  EXPECT_TRUE(gate.passes("a"));
}

TEST_F(GateTest, ReleasesWhoHasPassedUnheld) {
  gate.begin();
  see("a", 40.0, 10.0);
  gate.end();
  EXPECT_THAT(traffic.held, UnorderedElementsAre("a"));
  EXPECT_FALSE(decide({}));
  EXPECT_THAT(traffic.held, IsEmpty());
}

TEST_F(GateTest, ReleasesWhoIsTakenOver) {
  gate.begin();
  see("a", 40.0, 10.0);
  gate.end();
  gate.release("a");
  EXPECT_THAT(traffic.held, IsEmpty());
  gate.release("a");
  gate.release("nobody");
}

TEST_F(GateTest, ProposesEverybodyInTurn) {
  gate.begin();
  for (const std::string id : {"a", "b", "c"}) see(id, 40.0, 10.0);
  gate.end();
  std::map<std::string, int> proposed;
  for (int i = 0; i < 30; ++i) {
    const auto id = decide({"a", "b", "c"});
    ASSERT_TRUE(id);
    ++proposed[*id];
  }
  for (const std::string id : {"a", "b", "c"}) EXPECT_EQ(proposed[id], 10) << id;
}

TEST_F(GateTest, ANewcomerDoesNotStarveThoseWhoWait) {
  gate.begin();
  see("z", 40.0, 10.0);
  gate.end();
  EXPECT_EQ(decide({"z"}), "z");
  int since = 0;
  for (int i = 0; i < 20; ++i) {  // at each decision another one comes
    const std::string other = fmt::format("a{}", i);
    gate.begin();
    see("z", 1.0, 0.0);
    see(other, 40.0, 10.0);
    gate.end();
    gate.begin();
    see("z", 1.0, 0.0);
    see(other, 1.0, 0.0);
    gate.end();
    since = propose() == "z" ? 0 : since + 1;
    ASSERT_LT(since, 3);
  }
}

TEST_F(GateTest, HoldsNobodyAgainBeforeTheLineForWhichItWasLetThrough) {
  gate.begin();
  see("a", 90.0, 22.0);
  gate.end();
  gate.let_through("a");
  for (const double to_line : {80.0, 70.0, 60.0, 0.0, 0.0}) {
    gate.begin();
    see("a", to_line, 10.0);
    gate.end();
    EXPECT_TRUE(gate.passes("a")) << to_line << " m before its line";
  }
}

// Two junctions that are near each other: it stops between them only where nobody minds its tail.
TEST_F(GateTest, HoldsAgainOnlyWhereItsTailIsClearOfTheJunctionBehind) {
  for (const bool has_room : {false, true}) {
    gate.release("a");
    gate.begin();
    see("a", 40.0, 10.0);
    gate.end();
    gate.let_through("a");
    for (const double to_line : {0.0, 20.0}) {  // inside, and behind it
      gate.begin();
      see("a", to_line, 5.0, true, has_room, /*line=*/1);
      gate.end();
    }
    EXPECT_EQ(gate.passes("a"), !has_room);
  }
}

// A junction without conflicts is 20 m ahead, its line 60 m behind that: nothing holds it so soon.
TEST_F(GateTest, LetsNobodyThroughWhoseLineIsFarBehindTheEndOfItsLane) {
  see_only("a", {.line = 0, .to_line = 80.0, .to_hold = 20.0}, 13.9);
  EXPECT_FALSE(gate.passes("a"));
  EXPECT_FALSE(gate.holds("a"));
  see_only("a", {.line = 0, .to_line = 60.0, .to_hold = 0.0}, 13.9);
  EXPECT_FALSE(gate.passes("a")) << "inside that junction";
  see_only("a", {.line = 0, .to_line = 55.0, .to_hold = 55.0}, 13.9);
  EXPECT_TRUE(gate.holds("a"));
}

TEST_F(GateTest, HoldsBeforeTheNextLineWhoWasFirstSeenInsideAJunction) {
  see_only("a", {.line = 1, .to_line = 70.0, .is_inside = true, .is_clear = false});
  EXPECT_TRUE(gate.passes("a"));
  see_only("a", {.line = 1, .to_line = 60.0, .to_hold = 60.0});
  EXPECT_TRUE(gate.holds("a"));
}

// Its driver did not stop at the first.
TEST_F(GateTest, HoldsBeforeTheNextLineWhoDidNotStop) {
  decide({"a"});
  EXPECT_TRUE(gate.holds("a"));
  see_only("a", {.line = 1, .to_line = 60.0, .is_inside = true, .is_clear = false});
  EXPECT_TRUE(gate.passes("a")) << "others have to expect it to go on";
  EXPECT_THAT(traffic.held, IsEmpty());
  see_only("a", {.line = 1, .to_line = 50.0, .to_hold = 50.0});
  EXPECT_THAT(traffic.held, UnorderedElementsAre("a"));
}

// Its tail lies there.
TEST_F(GateTest, ProposesNobodyAcrossOneWhoStandsInsideTheJunction) {
  decide({"a"});
  gate.let_through("a");
  for (const bool is_inside : {true, false}) {
    for (int i = 0; i < 10; ++i) {
      gate.begin();
      gate.see({.id = "a", .type = "car", .speed = 0.0, .lane = "a"},
               {.line = 1,
                .to_line = is_inside ? 40.0 : 20.0,
                .to_hold = is_inside ? -1.0 : 20.0,
                .is_inside = is_inside,
                .is_clear = false},
               car);
      see("b", 1.0, 0.0);
      gate.end();
      const std::vector<std::string> proposed =
          gate.propose({[](const std::string& id) { return id == "b"; }, anybody, nobody});
      EXPECT_THAT(proposed, IsEmpty());
    }
    EXPECT_EQ(gate.passes("a"), is_inside);
  }
}

//   One after the other comes on the main road, each before the last has left the junction.
TEST_F(GateTest, AStreamOfGuestsDoesNotStarveWhoWaitsBesideIt) {
  const Gate::MayMeet crosses = [](const Gate::Pair& pair) {
    return (pair.id == "side") != (pair.other == "side");
  };
  for (int i = 0; i < 60; ++i) {
    const std::string next = fmt::format("w{}", i);
    const std::string last = fmt::format("w{}", i - 1);
    gate.begin();
    if (i > 0) see("side", 1.0, 0.0);
    see(next, 20.0, 8.0);
    if (i > 0 && gate.passes(last)) see(last, 0.0, 8.0);
    gate.end();
    for (const std::string& id : gate.propose({first, crosses, nobody})) gate.let_through(id);
    if (gate.passes("side")) {
      EXPECT_GT(i, 10) << "not before those who were there first";
      return;
    }
  }
  FAIL() << "it never gets through";
}

TEST_F(GateTest, HoldsAgainBeforeTheNextLine) {
  gate.begin();
  see("a", 40.0, 10.0);
  gate.end();
  gate.let_through("a");
  gate.begin();
  see("a", 75.0, 10.0, true, true, /*line=*/1);
  gate.end();
  EXPECT_FALSE(gate.passes("a"));
  EXPECT_THAT(traffic.held, UnorderedElementsAre("a"));
}

}  // namespace
}  // namespace mvtp
