// Where vehicles are handed back, somebody else under control may want to be.

#include <gtest/gtest.h>

#include "tests/coordinator/closed_loop.hpp"
#include "tests/coordinator/shapes.hpp"

namespace mvtp {
namespace {

/// Two crossroads on a road of two lanes from west to east. At the second one the left lane leads
/// to the left only.
NetworkShape left_lane_ends(double apart) {
  NetworkShape shape{.name = "left_lane_ends"};
  NetworkMaker maker;
  maker.node("W", {-150.0, 0.0}, 0.0);
  maker.node("A", {0.0, 0.0}, 12.0);
  maker.node("B", {apart, 0.0}, 12.0);
  maker.node("E", {apart + 150.0, 0.0}, 0.0);
  for (const std::string at : {"A", "B"}) {
    const double x = at == "A" ? 0.0 : apart;
    maker.node("S" + at, {x, -150.0}, 0.0);
    maker.node("N" + at, {x, 150.0}, 0.0);
    maker.one_way("S" + at, at);
    maker.one_way(at, "N" + at);
    maker.connect("S" + at + "-" + at + "_0", at + "-N" + at + "_0");
  }
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

INSTANTIATE_TEST_SUITE_P(Offsets, HandBackBeside,
                         testing::Values(-1.0, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.2,
                                         2.6, 3.0));

}  // namespace
}  // namespace mvtp
