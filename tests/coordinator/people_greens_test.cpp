// Who is expected on a crossing, and who gets its green, decision by decision.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "coordinator/network/crossing_paths.hpp"
#include "coordinator/network/partition.hpp"
#include "coordinator/network/polyline.hpp"
#include "coordinator/people/people.hpp"
#include "tests/coordinator/placed_people.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class PeopleAtLights : public testing::Test {
 protected:
  PlacedPeople traffic{with_crossings(with_signals(crossroads_shape())).network,
                       std::vector<FakeTrip>{}};
  LaneGraph graph{traffic.network()};
  PathLibrary library{Margins{}};
  SignalHeads heads{traffic, graph, select_junctions(graph, {}, 50.0), SignalTiming::real()};
  DecisionGrid grid;
  People people{traffic, graph, library, heads, grid};
  std::int64_t step = 100;

  void SetUp() override { heads.own(); }

  const PedestrianCrossing& crossing() const { return *graph.crossing(0).crossing; }
  /// At a kerb of the first crossing, which he wants to go over.
  Pedestrian at_kerb() const {
    return {.id = "p",
            .position = crossing().shape.front(),
            .edge = crossing().ends.front(),
            .next = crossing().id};
  }
  void decide() {
    people.begin(step, [](const std::string&) { return true; });
    for (int i = 0; i < grid.steps_per_decision; ++i) traffic.step();
    step += grid.steps_per_decision;
  }
  void wait(double seconds) {
    for (double t = 0.0; t < seconds - 1e-9; t += grid.decision()) decide();
  }
  std::vector<std::string> offered(double driver_waited = 0.0) {
    return people.propose([driver_waited](int) { return driver_waited; });
  }
  /// On which crossings is this person expected?
  std::vector<int> expected_on(const std::vector<std::string>& greens) {
    std::vector<int> crossings;
    for (const People::Expected& e : people.expect(greens)) crossings.push_back(e.crossing);
    return crossings;
  }
};

TEST_F(PeopleAtLights, NobodyGoesBackOverTheCrossingThatHeComesFrom) {
  Pedestrian person = at_kerb();
  person.edge = crossing().id;
  person.next = {};
  traffic.people = {person};
  decide();
  person.edge = crossing().ends.front();
  person.speed = 1.3;
  Pedestrian other = person;
  other.id = "other";
  traffic.people = {person};
  for (int i = 0; i < 3; ++i) {
    decide();
    EXPECT_THAT(expected_on({}), testing::Each(testing::Ne(0))) << i;
  }
  traffic.people = {other};  // who has come along the road
  decide();
  EXPECT_THAT(expected_on({}), testing::Contains(0));
}

TEST_F(PeopleAtLights, WhoWantsToGoBackIsExpectedTo) {
  Pedestrian person = at_kerb();
  person.edge = crossing().id;
  traffic.people = {person};
  decide();
  traffic.people = {at_kerb()};
  decide();
  EXPECT_THAT(expected_on({}), ElementsAre(0));
}

TEST_F(PeopleAtLights, LetDriversGoFirstWhoHaveWaitedLongerButNotForEver) {
  traffic.people = {at_kerb()};
  decide();
  wait(2.0);
  EXPECT_THAT(offered(1.0), ElementsAre(crossing().id));
  EXPECT_THAT(offered(60.0), IsEmpty());
  wait(6.5);
  EXPECT_THAT(offered(60.0), ElementsAre(crossing().id));
}

TEST_F(PeopleAtLights, ArePromisedAGreenOnlyWhereNoneAtOnceWasPossible) {
  const int light = heads.light_of_crossing(0);
  traffic.people = {at_kerb()};
  decide();
  wait(5.0);
  ASSERT_THAT(offered(), ElementsAre(crossing().id));
  decide();  // it was not granted
  ASSERT_THAT(offered(), ElementsAre(crossing().id));
  people.grant(crossing().id);
  EXPECT_EQ(heads.light(light), Light::kRed);
  wait(2.5);
  EXPECT_EQ(heads.light(light), Light::kRed);
  decide();
  EXPECT_EQ(heads.light(light), Light::kGreen);
}

TEST_F(PeopleAtLights, WhoHasWaitedForLongButCouldNotBeOfferedGoesAtOnce) {
  traffic.people = {at_kerb()};
  decide();
  wait(5.0);
  ASSERT_THAT(offered(), ElementsAre(crossing().id));
  people.grant(crossing().id);
  EXPECT_EQ(heads.light(heads.light_of_crossing(0)), Light::kGreen);
}

TEST_F(PeopleAtLights, NeedLessOfTheCrossingWhenTheyHaveWaitedForVeryLong) {
  traffic.people = {at_kerb()};
  const auto width = [&] {
    const std::vector<People::Expected> all = people.expect({crossing().id});
    return library.body(all.front().forecast.vehicle.path).width;
  };
  decide();
  wait(18.0);
  const double whole = width();
  wait(4.0);
  EXPECT_NEAR(width(), whole - 2.0, 1e-9);
}

// The rest is left to vehicles that stand on its edge: they could not go on before he has crossed.
TEST_F(PeopleAtLights, NeedWhatIsOnTheirOwnSideWhenTheyHaveWaitedForVeryLong) {
  const Point& kerb = crossing().shape.front();
  const double theta = heading(kerb, crossing().shape.back());
  const Pose middle{kerb.x, kerb.y, theta};
  for (const double aside : {-1.6, -0.4, 0.0, 0.8, 1.6}) {
    const Pose place = compose(middle, {0.0, aside, 0.0});
    traffic.people = {at_kerb()};
    traffic.people.front().id = fmt::format("aside {}", aside);
    traffic.people.front().position = {place.x, place.y};
    decide();
    wait(22.0);
    const std::vector<People::Expected> all = people.expect({crossing().id});
    const int path = all.front().forecast.vehicle.path;
    const Pose there = relative(middle, library.path(path).at(CrossingPaths::kKerb));
    const double half = 0.5 * library.body(path).width;
    EXPECT_NEAR(there.x, 0.0, 1e-6);
    EXPECT_LE(std::abs(there.y - aside), half + 0.1) << "he is in it";
    EXPECT_NEAR(there.y, std::clamp(aside, -1.0, 1.0), 0.11);
    traffic.people.clear();
    wait(20.0);
  }
}

// Lanes lie right beside sidewalks: if nobody in them passed those at the kerb, each would wait for
// the other.
TEST_F(PeopleAtLights, LetABusPassThatKeepsToTheLaneBesideTheirKerb) {
  const Point& kerb = crossing().shape.front();
  const Pose across{kerb.x, kerb.y, heading(kerb, crossing().shape.back())};
  const auto lane_at = [&](double from_kerb) {
    const Pose begin = compose(across, {from_kerb, -30.0, 0.0});
    const Pose end = compose(across, {from_kerb, 30.0, 0.0});
    return library.add(ReferencePath({{begin.x, begin.y}, {end.x, end.y}}), fake_type("bus").body);
  };
  const int in_lane = lane_at(1.6);
  const int too_near = lane_at(1.2);
  const auto meets = [&](int lane, const Forecast& person) {
    const ContactTable& contacts = library.contacts(lane, person.vehicle.path);
    return contacts.reaches(0.0, library.path(lane).length(), person.vehicle.now.s,
                            person.vehicle.s_end);
  };
  for (const bool stands : {true, false}) {
    for (const double aside : {-1.2, 0.0, 1.0}) {
      const Pose place = compose(across, {stands ? -0.1 : -3.0, aside, 0.0});
      Pedestrian person = at_kerb();
      person.position = {place.x, place.y};
      person.speed = stands ? 0.0 : 1.3;
      traffic.people = {person};
      decide();
      const Forecast waits = people.expect({}).front().forecast;
      // Who comes to the kerb may come too far round the corner first.
      EXPECT_EQ(meets(in_lane, waits), !stands) << aside;
      EXPECT_TRUE(meets(too_near, waits)) << stands << ", " << aside;
      EXPECT_TRUE(meets(in_lane, people.expect({crossing().id}).front().forecast));
      traffic.people.clear();
      decide();
    }
  }
}

TEST_F(PeopleAtLights, KeepTheLightsOfThoseRedWhoCrossThem) {
  traffic.people = {at_kerb()};
  decide();
  offered();
  people.grant(crossing().id);
  decide();
  for (int k = 0; k < graph.links(); ++k) {
    const double until = heads.barred_until(k);
    if (heads.cross(k, heads.light_of_crossing(0))) {
      EXPECT_GT(until, traffic.time() + SignalTiming::real().least_green - 1.0);
      EXPECT_LT(until, traffic.time() + 30.0);
    } else {
      EXPECT_LT(until, traffic.time());
    }
  }
}

/// How far somebody on the corner before a zebra may come on the path over it [m].
double goes_to(const std::string& next) {
  PlacedPeople traffic(with_crossings(crossroads_shape()).network, std::vector<FakeTrip>{});
  const LaneGraph graph(traffic.network());
  PathLibrary library{Margins{}};
  SignalHeads heads(traffic, graph, select_junctions(graph, {}, 50.0), SignalTiming::real());
  People people(traffic, graph, library, heads, DecisionGrid{});
  const PedestrianCrossing& crossing = *graph.crossing(0).crossing;
  traffic.people = {{.id = "p",
                     .position = crossing.shape.front(),
                     .speed = 1.3,
                     .edge = crossing.ends.front(),
                     .next = next == "crossing" ? crossing.id : next}};
  people.begin(100, [](const std::string&) { return true; });
  for (const People::Expected& e : people.expect({})) {
    if (e.crossing == 0) return e.forecast.vehicle.s_end;
  }
  return -1.0;
}

TEST(PeopleAtZebras, WhoLeavesTheCornerAlongTheRoadIsNotExpectedOnIt) {
  constexpr double kOther = CrossingPaths::kKerb + 3.0;  // [m]
  EXPECT_GT(goes_to("crossing"), kOther);
  EXPECT_GT(goes_to(""), kOther) << "nobody knows where he goes";
  EXPECT_NEAR(goes_to("sidewalk"), CrossingPaths::kKerb, 0.2) << "but before it";
}

}  // namespace
}  // namespace mvtp
