// Where vehicles are handed back, somebody else under control may want to be.

#include <gtest/gtest.h>

#include "tests/coordinator/closed_loop.hpp"
#include "tests/coordinator/placed_people.hpp"
#include "tests/coordinator/shapes.hpp"

namespace mvtp {
namespace {

/// At a node of the road from west to east: a road from south to north crosses it.
void add_cross_road(NetworkMaker& maker, const std::string& at, double x) {
  maker.node("S" + at, {x, -150.0}, 0.0);
  maker.node("N" + at, {x, 150.0}, 0.0);
  maker.one_way("S" + at, at);
  maker.one_way(at, "N" + at);
  maker.connect("S" + at + "-" + at + "_0", at + "-N" + at + "_0");
}

/// Two crossroads on a road of two lanes from west to east. At the second one the left lane leads
/// to the left only.
NetworkShape left_lane_ends(double apart) {
  NetworkShape shape{.name = "left_lane_ends"};
  NetworkMaker maker;
  maker.node("W", {-150.0, 0.0}, 0.0);
  maker.node("A", {0.0, 0.0}, 12.0);
  maker.node("B", {apart, 0.0}, 12.0);
  maker.node("E", {apart + 150.0, 0.0}, 0.0);
  add_cross_road(maker, "A", 0.0);
  add_cross_road(maker, "B", apart);
  maker.one_way("W", "A", 2);
  maker.one_way("A", "B", 2);
  maker.one_way("B", "E");
  maker.connect("W-A_0", "A-B_0");
  maker.connect("W-A_1", "A-B_1");
  maker.connect("A-B_0", "B-E_0");
  maker.connect("A-B_1", "B-NB_0");
  shape.network = maker.make();
  return shape;
}

class HandBackBeside : public testing::TestWithParam<double> {};

/// A bus has to come over to the lane of a car that is handed back, its route ends on this road.
TEST_P(HandBackBeside, WhoComesOverTouchesNobody) {
  for (const double apart : {150.0, 170.0, 190.0}) {
    const NetworkShape shape = left_lane_ends(apart);
    ClosedLoop run(shape, {{.id = "bus",
                            .depart = 3.0,
                            .from = "W-A",
                            .to = "B-E",
                            .type = "bus",
                            .lane = 1,
                            .edges = {"W-A", "A-B", "B-E"}},
                           {.id = "car",
                            .depart = 3.0 + GetParam(),
                            .from = "W-A",
                            .to = "A-B",
                            .lane = 0,
                            .edges = {"W-A", "A-B"}}});
    run.run_until(120.0);
    EXPECT_EQ(run.traffic.arrived(), 2) << apart;
    EXPECT_EQ(run.audit.figures().overlap_pairs, 0) << apart;
    EXPECT_EQ(run.audit.figures().hard_brakings_after_handback, 0) << apart;
    EXPECT_EQ(run.broken, std::vector<std::string>{}) << apart;
  }
}

/// A road from west to east with a crossroads at its begin and one at its end, where vehicles
/// turn slowly, and between them a node without conflicts.
NetworkShape seam_between_crossroads(double seam, double apart) {
  NetworkShape shape{.name = "seam_between_crossroads"};
  NetworkMaker maker;
  maker.node("W", {-150.0, 0.0}, 0.0);
  maker.node("A", {0.0, 0.0}, 12.0);
  maker.node("D", {seam, 0.0}, 2.0);
  maker.node("B", {apart, 0.0}, 12.0);
  add_cross_road(maker, "A", 0.0);
  add_cross_road(maker, "B", apart);
  maker.one_way("W", "A");
  maker.one_way("A", "D");
  maker.one_way("D", "B");
  maker.connect("W-A_0", "A-D_0");
  maker.connect("D-B_0", "B-NB_0");
  maker.limit_bends(4.0);
  shape.network = maker.make();
  return shape;
}

class HandBackBehind : public testing::TestWithParam<double> {};

/// A car goes on through the next junction and slows down for its turn. The one behind it is handed
/// back before, its route ends on this road.
TEST_P(HandBackBehind, WhoIsHandedBackCanFollow) {
  for (const double seam : {50.0, 70.0, 90.0}) {
    ClosedLoop run(seam_between_crossroads(seam, 130.0),
                   {{.id = "ahead",
                     .depart = 1.0,
                     .from = "W-A",
                     .to = "B-NB",
                     .edges = {"W-A", "A-D", "D-B", "B-NB"},
                     .at = std::pair(50.0, 13.0)},
                    {.id = "car",
                     .depart = 1.0,
                     .from = "W-A",
                     .to = "D-B",
                     .edges = {"W-A", "A-D", "D-B"},
                     .at = std::pair(50.0 - GetParam(), 13.0)}});
    run.run_until(120.0);
    EXPECT_EQ(run.traffic.arrived(), 2) << seam;
    EXPECT_EQ(run.audit.figures().hard_brakings_after_handback, 0) << seam;
    EXPECT_EQ(run.broken, std::vector<std::string>{}) << seam;
  }
}

/// Whoever waits for room behind the one ahead may come to the next node meanwhile.
TEST(HandBack, IsNotInsideANode) {
  for (double seam = 40.0; seam < 110.0; seam += 3.0) {
    ClosedLoop run(
        seam_between_crossroads(seam, 170.0),
        {{.id = "ahead", .depart = 1.0, .from = "W-A", .to = "D-B", .at = std::pair(50.0, 11.0)},
         {.id = "car", .depart = 1.0, .from = "W-A", .to = "B-NB", .at = std::pair(38.0, 13.0)}});
    run.run_until(120.0);
    EXPECT_EQ(run.traffic.arrived(), 2) << seam;
    EXPECT_EQ(run.broken, std::vector<std::string>{}) << seam;
  }
}

/// There SUMO's vehicles may not come as far as they drive.
TEST(HandBack, IsNotInTheStepInWhichItLeavesItsLane) {
  for (double seam = 60.0; seam < 90.0; seam += 0.7) {
    ClosedLoop run(seam_between_crossroads(seam, 170.0),
                   {{.id = "car", .depart = 1.0, .from = "W-A", .to = "D-B"}});
    std::string lane;
    while (run.traffic.running() && run.traffic.time() < 120.0) {
      run.step();
      for (const VehicleState& v : run.traffic.vehicles()) {
        if (!run.coordinator.handed_back().empty()) EXPECT_EQ(v.lane, lane) << seam;
        lane = v.lane;
      }
    }
    EXPECT_EQ(run.handed_back, 1) << seam;
  }
}

/// Nobody is ahead of it: not even itself, where the lanes put it a little further on than its
/// path.
TEST(HandBack, IsWhereItIsDueIfNobodyIsAhead) {
  const NetworkShape shape = crossroads_shape();
  for (const std::string from : {"W", "S", "E", "N"}) {
    for (const std::string to : {"W", "S", "E", "N"}) {
      if (from == to) continue;
      ClosedLoop run(shape, {{.id = "car", .depart = 1.0, .from = from + "-C", .to = "C-" + to}});
      double beyond = -1e9;  // [m]
      while (run.traffic.running() && run.traffic.time() < 60.0) {
        run.step();
        for (const auto& [id, driven] : run.coordinator.driven()) {
          beyond = run.coordinator.scene().vehicle(driven.key).now.s - driven.road.s_handback;
        }
      }
      EXPECT_EQ(run.handed_back, 1) << from << to;
      EXPECT_LE(beyond, 2.0) << from << to << ": a step and no more";
    }
  }
}

/// Somebody departs right before it, and stays there for a while: each might wait for the other.
TEST(HandBack, WhoStandsAgainstAnotherBodyGetsItsDriverBack) {
  ClosedLoop run(
      crossroads_shape(),
      {{.id = "car", .depart = 1.0, .from = "W-C", .to = "C-E", .at = std::pair(40.0, 13.0)},
       {.id = "other",
        .depart = 2.0,
        .from = "W-C",
        .to = "C-E",
        .stop = FakeStop{"W-C_0", 79.0, 40.0},
        .at = std::pair(79.0, 0.0)}});
  const auto go_on = [&](double end) {
    while (run.traffic.running() && run.traffic.time() < end) run.step();
  };
  go_on(6.0);
  EXPECT_TRUE(run.coordinator.drives("car"));
  EXPECT_GT(run.audit.figures().overlap_pairs, 0);
  go_on(20.0);
  EXPECT_FALSE(run.coordinator.drives("car"));
  go_on(120.0);
  EXPECT_EQ(run.traffic.arrived(), 2);
}

/// As it leaves the junction somebody stands beside it, within the turn of its body, from one
/// moment to the next, as where people depart right at a crossing.
TEST(HandBack, WhoStandsAgainstSomebodyOnFootGetsItsDriverBack) {
  const NetworkShape shape = with_crossings(crossroads_shape());
  PlacedPeople traffic(shape.network, {{"bus", 0.0, "N-C", "C-E", "bus"}});
  const DrivableArea area(traffic.network());
  Coordinator coordinator(traffic, area, {});
  Simulation simulation(traffic);
  simulation.add(coordinator);
  bool stood = false;
  while (traffic.running() && traffic.time() < 90.0) {
    simulation.step();
    for (const VehicleState& v : traffic.vehicles()) {
      stood |= coordinator.drives(v.id) && v.speed == 0.0;
      if (v.lane != "C-E_0" || !traffic.people.empty()) continue;
      const std::string& crossing = east_crossing(shape.network).id;
      traffic.people = {{.id = "p", .position = {7.0, -0.4}, .edge = crossing}};
    }
  }
  EXPECT_TRUE(stood);
  EXPECT_EQ(traffic.arrived(), 1);
}

INSTANTIATE_TEST_SUITE_P(Distances, HandBackBehind,
                         testing::Values(13.0, 15.0, 17.0, 20.0, 23.0, 26.0));

INSTANTIATE_TEST_SUITE_P(Offsets, HandBackBeside,
                         testing::Values(-1.0, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.2,
                                         2.6, 3.0));

}  // namespace
}  // namespace mvtp
