// Human drivers at lights right behind a short last edge.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "coordinator/drivers/human_drivers.hpp"
#include "tests/coordinator/closed_loop.hpp"
#include "tests/coordinator/mixed_loop.hpp"
#include "tests/coordinator/network_maker.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;

/// The western arm is straight; its last edge is 11 m long.
NetworkShape short_last_edge_shape() { return with_signals(seam_shape({-140, 0}, {-20, 0}, 1.5)); }

// When he is on it, it is too late to stop.
TEST(HumanDrivers, AreExpectedFromBeforeAShortLastEdge) {
  ClosedLoop run(short_last_edge_shape(), {{"a", 0.0, "W-D", "C-E"}}, 0.1, share(0.0));
  double least = 1e9;
  int before = 0;
  while (run.traffic.running() && run.traffic.time() < 60.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      least = std::min(least, v.speed);
      before += int(v.lane == "W-D_0" && run.coordinator.humans()->passes("a"));
    }
  }
  EXPECT_GT(before, 5);
  EXPECT_GT(least, 12.0);
  EXPECT_EQ(run.coordinator.humans()->greens(), 1);
  EXPECT_EQ(run.coordinator.humans()->unplanned_passages(), 0);
}

// Not at the end of the edge before the last: nobody holds him there.
TEST(HumanDrivers, AreExpectedToStandAtTheirLightBehindAShortLastEdge) {
  CoordinatorOptions options;
  options.share = {.human_types = {"bike"}};
  ClosedLoop run(short_last_edge_shape(),
                 {{"turns", 12.0, "N-C", "C-E"}, {"human", 0.0, "W-D", "C-N", "bike"}}, 0.1,
                 options);
  int seen = 0;
  while (run.traffic.running() && run.traffic.time() < 60.0) {
    const std::size_t decisions = run.coordinator.replans().size();
    run.step();
    const bool is_new = run.coordinator.replans().size() > decisions;
    for (const VehicleState& v : run.traffic.vehicles()) {
      if (!is_new || v.lane != "W-D_0" || !run.coordinator.humans()->has_to_wait(v.id)) continue;
      const double to_end = run.traffic.network().lanes.at(v.lane).length - v.lane_position;
      for (const Forecast& f : run.coordinator.forecasts()) {
        const auto& states = f.earliest.states;
        const auto stands = std::ranges::find(states, 0.0, &InertialState::v);
        ASSERT_NE(stands, states.end());
        ++seen;
        EXPECT_GT(stands->s - states.front().s, to_end + 3.0) << "at t = " << run.traffic.time();
      }
    }
  }
  EXPECT_GT(seen, 0);
}

TEST(HumanDrivers, ArriveWithoutContactOverAShortLastEdge) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const NetworkShape shape = short_last_edge_shape();
    ClosedLoop run(shape, random_trips(shape, {.seed = seed}), 0.1, share(0.5));
    run.run_until(600.0);
    EXPECT_THAT(run.broken, IsEmpty()) << seed;
    EXPECT_EQ(run.audit.figures().overlap_pairs_coordinated, 0) << seed;
    EXPECT_EQ(run.traffic.arrived(), run.number_of_trips) << seed;
    EXPECT_EQ(run.coordinator.humans()->unplanned_passages(), 0) << seed;
  }
}

/// The only lane from the west leads onto both lanes of a last edge of 11 m: the left one of them
/// to the north, the right one to the east.
NetworkShape forked_last_edge_shape() {
  NetworkShape shape{.name = "forked last edge", .sources = {"W-D", "S-C"}, .sinks = {"C-N"}};
  NetworkMaker maker;
  maker.node("C", {0, 0});
  maker.node("D", {-20, 0}, 1.5);
  maker.node("W", {-140, 0}, 0.0);
  maker.node("S", {0, -110}, 0.0);
  maker.node("E", {110, 0}, 0.0);
  maker.node("N", {0, 110}, 0.0);
  maker.one_way("W", "D");
  maker.one_way("D", "C", 2);
  maker.one_way("S", "C");
  maker.one_way("C", "E");
  maker.one_way("C", "N");
  maker.connect("W-D_0", "D-C_0");
  maker.connect("W-D_0", "D-C_1");
  maker.connect("D-C_0", "C-E_0");
  maker.connect("D-C_1", "C-N_0");
  maker.connect("S-C_0", "C-N_0");
  shape.network = maker.make();
  return with_signals(shape);
}

TEST(HumanDrivers, AreExpectedOnTheLaneThatLeadsWhereTheyGo) {
  for (const std::string exit : {"C-N", "C-E"}) {
    ClosedLoop run(forked_last_edge_shape(), {{"a", 0.0, "W-D", exit}}, 0.1, share(0.0));
    double least = 1e9;
    while (run.traffic.running() && run.traffic.time() < 60.0) {
      run.step();
      for (const VehicleState& v : run.traffic.vehicles()) {
        if (v.lane == "W-D_0") least = std::min(least, v.speed);
      }
    }
    EXPECT_GT(least, 9.0) << exit;
    EXPECT_EQ(run.coordinator.humans()->greens(), 1) << exit;
    EXPECT_EQ(run.coordinator.humans()->unplanned_passages(), 0) << exit;
  }
}

}  // namespace
}  // namespace mvtp
