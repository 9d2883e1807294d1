// How far before a line vehicles come under control.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "coordinator/corridor/corridor.hpp"
#include "tests/coordinator/fake_traffic.hpp"
#include "tests/coordinator/network_maker.hpp"
#include "tests/coordinator/walk.hpp"

namespace mvtp {
namespace {

constexpr double kRadius = 80.0;   ///< [m] where nobody is fast
constexpr double kDecision = 0.5;  ///< [s] until a vehicle is noticed

struct Limits {
  double far = 13.9;   ///< [m/s] on the road from the west, up to the seam
  double near = 13.9;  ///< [m/s] on the rest of it, to the line
  double other = 13.9;
};

// W ────────seam──A── E    the seam is no junction: nobody meets anybody there
//                 │
//                 S
RoadNetwork seam_before_a_line(const Limits& limits, double near_length = 40.0) {
  NetworkMaker maker;
  maker.node("W", {-400.0 - near_length, 0.0}, 0.0);
  maker.node("seam", {-near_length, 0.0}, 1.0);
  maker.node("A", {0.0, 0.0});
  maker.node("E", {300.0, 0.0}, 0.0);
  maker.node("S", {0.0, -300.0}, 0.0);
  maker.one_way("W", "seam");
  maker.one_way("seam", "A");
  maker.one_way("S", "A");
  maker.one_way("A", "E");
  RoadNetwork network = maker.make();
  network.lanes.at("W-seam_0").speed_limit = limits.far;
  network.lanes.at("seam-A_0").speed_limit = limits.near;
  network.lanes.at("S-A_0").speed_limit = limits.other;
  return network;
}

double takeover_before(const Walk& walk, const std::string& edge) {
  return walk.finder.takeover_before(walk.graph.find_edge(edge));
}

TEST(TakeoverDistance, LeavesRoomToStopFromEveryLimit) {
  for (double limit = 5.0; limit <= 37.0; limit += 2.0) {
    Walk walk(seam_before_a_line({.other = limit}));
    const double takeover = takeover_before(walk, "S-A");
    for (const std::string type : {"car", "bus"}) {
      const double braking = fake_type(type).body.max_decel;
      EXPECT_GE(takeover, limit * kDecision + stopping_distance(limit, std::min(3.5, braking)))
          << type << ' ' << limit;
    }
    EXPECT_GE(takeover, kRadius);
    // Where 80 m are enough, they are it.
    if (limit <= 20.0) EXPECT_EQ(takeover, kRadius) << limit;
    EXPECT_EQ(takeover_before(walk, "seam-A"), kRadius) << "a slow road beside a fast one";
  }
}

TEST(TakeoverDistance, CountsHowFastVehiclesComeOntoTheLastRoad) {
  Walk even(seam_before_a_line({.far = 30.0, .near = 30.0}));
  Walk slow_end(seam_before_a_line({.far = 30.0}));
  EXPECT_EQ(takeover_before(slow_end, "seam-A"), takeover_before(even, "seam-A"));
  // But not who has room to stop between the fast road and the line.
  Walk long_end(seam_before_a_line({.far = 30.0}, 300.0));
  EXPECT_EQ(takeover_before(long_end, "seam-A"), kRadius);
}

TEST(TakeoverDistance, IsWhereVehiclesAreFound) {
  for (const double limit : {13.9, 30.0}) {
    Walk walk(seam_before_a_line({.far = limit, .near = limit}));
    const double takeover = takeover_before(walk, "seam-A");
    const Lane& far = walk.graph.lane(walk.graph.find_lane("W-seam_0"));
    const double last = walk.graph.lane(walk.graph.find_lane("seam-A_0")).length;
    const double inside =
        walk.graph.link(walk.graph.links_from(walk.graph.find_lane("W-seam_0")).front()).length;
    const double at = far.length - (takeover - last - inside);
    for (const double nearer : {-1.0, 1.0}) {
      const CourseQuery query = walk.at("W-seam_0", at + nearer, {"W-seam", "seam-A", "A-E"});
      EXPECT_EQ(walk.finder.find(query).has_value(), nearer > 0.0) << limit;
      EXPECT_TRUE(walk.finder.may_approach(query.lane, query.position)) << limit;
      const auto line = walk.finder.line_ahead(query);
      ASSERT_TRUE(line);
      EXPECT_EQ(line->takeover, takeover);
      EXPECT_EQ(line->is_near(), nearer > 0.0) << limit;
    }
  }
}

// A vehicle that needs time to answer comes under control as much earlier.
TEST(TakeoverDistance, GrowsWithTheTimeUntilAVehicleAnswers) {
  const Limits fast{.other = 30.0};
  Walk at_once(seam_before_a_line(fast));
  Walk late(seam_before_a_line(fast), {.latency = 1.0});
  EXPECT_NEAR(takeover_before(late, "S-A") - takeover_before(at_once, "S-A"), 30.0, 1e-9);
}

}  // namespace
}  // namespace mvtp
