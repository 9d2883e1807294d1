#include "coordinator/network/lanes_beside.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/closed_loop.hpp"
#include "tests/coordinator/network_maker.hpp"
#include "tests/coordinator/predictions.hpp"
#include "tests/coordinator/shapes.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Crossroads, and a road that nothing connects with them: its bend is `apart` beside the middle of
/// the lane from the west.
NetworkShape bend_beside(double apart) {
  NetworkShape shape{.name = "bend_beside"};
  NetworkMaker maker;
  add_crossroads(maker, shape);
  const double lane = -0.5 * NetworkMaker::kLaneWidth;  // [m] y of that from the west
  maker.node("A", {-65, -60}, 0.0);
  maker.node("B", {-14, -60}, 1.0);
  maker.node("D", {-14, -120}, 0.0);
  maker.one_way("B", "D");
  maker.node("M", {-45, -20}, 1.0);
  maker.limit_bends(13.9);
  maker.one_way("A", "M");
  maker.one_way("M", "B", 1, {{-40, -12}, {-25, lane - apart}, {-14, -14}});
  shape.network = maker.make();
  return shape;
}

std::vector<std::string> ids_beside(const RoadNetwork& network, const std::string& lane) {
  const LaneGraph graph(network);
  const LanesBeside beside(graph);
  std::vector<std::string> ids;
  for (const int l : beside.of(graph.find_lane(lane))) ids.push_back(graph.lane(l).id);
  return ids;
}

TEST(LanesBeside, AreThoseThatComeNearWithoutAConnection) {
  EXPECT_THAT(ids_beside(bend_beside(1.5).network, "W-C_0"), ElementsAre("M-B_0"));
  EXPECT_THAT(ids_beside(bend_beside(1.5).network, "M-B_0"), ElementsAre("W-C_0"));
  EXPECT_THAT(ids_beside(bend_beside(1.5).network, "C-E_0"), IsEmpty());
  EXPECT_THAT(ids_beside(bend_beside(5.0).network, "W-C_0"), IsEmpty());
}

TEST(LanesBeside, AreNotThoseThatCrossOnABridge) {
  EXPECT_THAT(ids_beside(bend_beside(-20.0).network, "W-C_0"), IsEmpty());
}

/// A road with a lane each way that turns by so much [rad] at M.
NetworkShape bent_road(double turn) {
  NetworkShape shape{.name = "bent_road"};
  NetworkMaker maker;
  maker.node("A", {-80, 0}, 0.0);
  maker.node("M", {0, 0}, 7.0);
  maker.node("B", {80 * std::cos(turn), 80 * std::sin(turn)}, 0.0);
  maker.road("A", "M");
  maker.road("M", "B");
  shape.network = maker.make();
  return shape;
}

// 3.2 m apart, as the lanes of any road are.
TEST(LanesBeside, AreThoseOfTheOtherDirectionWhereTheRoadBends) {
  for (const double turn : {1.2, -1.2}) {
    const NetworkShape shape = bent_road(turn);
    EXPECT_THAT(ids_beside(shape.network, ":M_0_0"), testing::SizeIs(testing::Ge(1U))) << turn;
  }
  EXPECT_THAT(ids_beside(bent_road(0.2).network, ":M_0_0"), IsEmpty());
}

TEST(LanesBeside, AreTheSameInBothDirections) {
  for (const NetworkShape& shape :
       {crossroads_shape(), roundabout_shape(), seam_shape(), bent_road(1.2)}) {
    const LaneGraph graph(shape.network);
    const LanesBeside beside(graph);
    for (int l = 0; l < graph.lanes(); ++l) {
      for (const int other : beside.of(l)) {
        EXPECT_THAT(beside.of(other), testing::Contains(l)) << graph.lane(l).id;
      }
    }
  }
}

// A driver on the other road sees nobody; who is under control knows of him long before they meet.
TEST(LanesBeside, WhoComesNearThereIsExpectedAndNotTouched) {
  int expected = 0;
  for (double depart = 3.0; depart < 9.0; depart += 0.25) {
    ClosedLoop run(bend_beside(1.2),
                   {{.id = "car", .depart = 4.0, .from = "W-C", .to = "C-E"},
                    {.id = "other", .depart = depart, .from = "A-M", .to = "M-B"}});
    while (run.traffic.running() && run.traffic.time() < 60.0) {
      run.step();
      const auto vehicles = run.traffic.vehicles();
      const bool both = vehicles.size() == 2 && run.coordinator.drives("car") &&
                        run.traffic.time() > depart + 1.0;
      if (!both || vehicles.back().pose.y > -30.0 || vehicles.back().pose.x > -40.0) continue;
      ASSERT_THAT(run.coordinator.forecasts(), testing::SizeIs(1)) << run.traffic.time();
      EXPECT_FALSE(run.coordinator.forecasts().front().yields) << "he sees nobody there";
      ++expected;
    }
    EXPECT_THAT(run.broken, IsEmpty()) << depart;
    EXPECT_EQ(run.audit.figures().overlap_pairs_coordinated, 0) << depart;
    EXPECT_FALSE(run.traffic.running());
  }
  EXPECT_GT(expected, 50);
}

TEST(LanesBeside, ThoseWhoComeOntoThemAndTheirLeadersAreLookedOutForToo) {
  NetworkShape shape = bend_beside(1.2);
  Prediction p(shape);
  const auto watched = [&](const std::string& id) {
    return p.predictor.watches(p.walk.graph.find_lane(id));
  };
  for (const char* lane : {"M-B_0", ":M_0_0", "A-M_0", ":B_0_0", "B-D_0"})
    EXPECT_FALSE(watched(lane)) << lane;
  const auto course = p.walk.finder.find(p.walk.at("W-C_0", 60.0, {"W-C", "C-E"}));
  p.predictor.watch(p.map[p.map.corridor_for(course.value(), p.car)]);
  for (const char* lane : {"M-B_0", ":M_0_0", "A-M_0", ":B_0_0", "B-D_0"})
    EXPECT_TRUE(watched(lane)) << lane;
}

// In a queue that dissolves just then, he would be where somebody counts on his not being yet.
TEST(LanesBeside, WhoSeesNobodyMaySpeedUpAtOnceOrGoOnAsHeDoes) {
  for (const bool beside : {false, true}) {
    Prediction p(bend_beside(1.2));
    if (beside) {
      const auto course = p.walk.finder.find(p.walk.at("W-C_0", 60.0, {"W-C", "C-E"}));
      p.predictor.watch(p.map[p.map.corridor_for(course.value(), p.car)]);
    }
    const double near = p.shape.network.lanes.at("A-M_0").length - 5.0;
    const auto forecasts = p.predict("A-M_0", near, 1.0, {"A-M", "M-B"}, Intent::kWaits);
    if (!beside) {
      for (const Forecast& f : forecasts) EXPECT_FALSE(f.latest);
      continue;
    }
    ASSERT_THAT(forecasts, testing::SizeIs(1));
    const Forecast& f = forecasts.front();
    ASSERT_TRUE(f.latest);
    EXPECT_GT(f.earliest.at(7 + 20).s, f.vehicle.now.s + 5.0);
    EXPECT_LT(f.latest->at(7 + 20).s, f.vehicle.now.s + 2.1);
    for (std::int64_t k = 7; k < f.latest->end(); ++k) {
      ASSERT_LE(f.latest->at(k).s, f.earliest.at(k).s) << k;
      ASSERT_LE(f.latest->at(k).s, f.latest->at(k + 1).s) << k;
    }
  }
}

}  // namespace
}  // namespace mvtp
