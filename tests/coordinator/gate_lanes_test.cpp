// Whom the gate keeps in his lane.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/gate_fixture.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAre;

TEST_F(GateTest, KeepsWhoPassesInItsLaneInsideTheJunction) {
  decide({"a"});
  EXPECT_THAT(traffic.in_lane, IsEmpty()) << "before the line it may look for a better one";
  gate.let_through("a");
  EXPECT_THAT(traffic.in_lane, UnorderedElementsAre("a")) << "its passage is planned in this one";
  const auto see_at = [&](double to_line) {
    gate.begin();
    see("a", to_line, 8.0, true, /*has_room=*/false, /*line=*/1);
    gate.end();
  };
  see_at(30.0);
  EXPECT_THAT(traffic.in_lane, IsEmpty());
  see_at(0.0);
  EXPECT_THAT(traffic.in_lane, UnorderedElementsAre("a"));
  see_at(30.0);
  EXPECT_THAT(traffic.in_lane, IsEmpty()) << "between two junctions";
  see_at(0.0);
  gate.release("a");
  EXPECT_THAT(traffic.in_lane, IsEmpty());
}

// The next line is far.
TEST_F(GateTest, KeepsWhoPassesInItsLaneUntilItsTailIsOut) {
  decide({"a"});
  gate.let_through("a");
  see_only("a", {.is_inside = true, .is_clear = false});
  see_only("a", {.line = 1, .to_line = 60.0, .to_hold = 60.0, .is_clear = false});
  EXPECT_THAT(traffic.in_lane, UnorderedElementsAre("a"));
  EXPECT_TRUE(gate.holds("a")) << "before that line, but not to change lanes here";
  see_only("a", {.line = 1, .to_line = 55.0, .to_hold = 55.0});
  EXPECT_THAT(traffic.in_lane, IsEmpty());
}

TEST_F(GateTest, KeepsWhoIsLetThroughInTheLaneInWhichItWasPlanned) {
  gate.begin();
  see("a", 40.0, 13.0);
  gate.end();
  EXPECT_THAT(traffic.in_lane, IsEmpty());
  gate.let_through("a");
  EXPECT_THAT(traffic.in_lane, UnorderedElementsAre("a"));
}

// It would stand there for good.
TEST_F(GateTest, LetsChangeLanesWhoseLaneLeadsElsewhere) {
  const auto see_it = [&](double to_line, bool leads_on) {
    gate.begin();
    see("a", to_line, 0.0, leads_on);
    gate.end();
  };
  see_it(1.0, false);
  gate.let_through("a");
  see_it(1.0, false);
  EXPECT_THAT(traffic.in_lane, IsEmpty());
  see_it(1.0, true);
  EXPECT_THAT(traffic.in_lane, UnorderedElementsAre("a"));
}

// Once over a first line he is not held at the next until he can be: changing lanes right before it
// he would go over it, too, on a path that nobody has expected.
TEST_F(GateTest, KeepsWhoseLaneLeadsElsewhereWhileItCouldNotBeHeldOnAnother) {
  decide({"a"});
  gate.let_through("a");
  const Gate::Place next = {.line = 1, .to_line = 9.0, .to_hold = 9.0, .leads_on = false};
  see_only("a", next, 9.0);
  EXPECT_THAT(traffic.in_lane, UnorderedElementsAre("a"));
  see_only("a", next, 5.0);  // it needs 6 m
  EXPECT_THAT(traffic.in_lane, IsEmpty());
}

// From the end of a lane that leads elsewhere he changes to one at whose line he already is. He is
// held there, and waits for his turn as others do; with room left he could be held on his way.
TEST_F(GateTest, HoldsWhoStandsAtTheEndOfALaneThatLeadsElsewhere) {
  for (const double to_hold : {0.0, 1.0, 5.0}) {
    decide({"a"});
    gate.let_through("a");
    Gate::Place place = {.line = 1, .to_line = to_hold, .to_hold = to_hold, .is_between = true};
    see_only("a", place, 0.0);
    EXPECT_TRUE(gate.passes("a")) << "plans count on its going on";
    place.leads_on = false;
    see_only("a", place, 0.0);
    EXPECT_EQ(gate.holds("a"), to_hold < 2.0) << to_hold;
    EXPECT_THAT(traffic.in_lane, IsEmpty()) << "he may change";
    place.leads_on = true;
    see_only("a", place, 0.0);
    EXPECT_EQ(propose() == "a", to_hold < 2.0) << to_hold;
    gate.release("a");
  }
}

}  // namespace
}  // namespace mvtp
