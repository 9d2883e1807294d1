#include "coordinator/drivers/controlled_share.hpp"

#include <gtest/gtest.h>

namespace mvtp {
namespace {

/// Vehicles "flow.0" ... of a type, as SUMO names those of a flow.
int count(const ControlledShare& share, int vehicles, const std::string& type = "car") {
  int controlled = 0;
  for (int i = 0; i < vehicles; ++i) {
    controlled += share.contains("flow." + std::to_string(i), type) ? 1 : 0;
  }
  return controlled;
}

TEST(ControlledShare, HoldsTheShareOfVehiclesThatItNames) {
  EXPECT_EQ(count({.penetration = 0.0}, 1000), 0);
  EXPECT_EQ(count({.penetration = 1.0}, 1000), 1000);
  // Five standard deviations of the binomial distribution.
  EXPECT_NEAR(count({.penetration = 0.3}, 10000), 3000, 230);
}

TEST(ControlledShare, IsTheSameOnEveryMachineAndAnotherForAnotherSeed) {
  EXPECT_DOUBLE_EQ(share_of_id("", 0), share_of_id("", 0));
  EXPECT_NE(share_of_id("flow.1", 1), share_of_id("flow.2", 1));
  EXPECT_NE(share_of_id("flow.1", 1), share_of_id("flow.1", 2));
  EXPECT_NEAR(share_of_id("flow.1", 1), 0.7657485804, 1e-9);
}

TEST(ControlledShare, GrowsWithoutLosingAnybody) {
  for (int i = 0; i < 500; ++i) {
    const std::string id = "v" + std::to_string(i);
    const ControlledShare few{.penetration = 0.2, .seed = 7};
    const ControlledShare many{.penetration = 0.6, .seed = 7};
    EXPECT_TRUE(!few.contains(id, "car") || many.contains(id, "car")) << id;
  }
}

TEST(ControlledShare, LeavesOutTypes) {
  EXPECT_EQ(count({.human_types = {"bus"}}, 10, "bus"), 0);
  EXPECT_EQ(count({.human_types = {"bus"}}, 10, "car"), 10);
  EXPECT_EQ(count({.coordinate_types = {"bus"}}, 10, "bus"), 10);
  EXPECT_EQ(count({.coordinate_types = {"bus"}}, 10, "car"), 0);
  EXPECT_FALSE((ControlledShare{.human_types = {"bus"}}.is_whole()));
  EXPECT_FALSE((ControlledShare{.coordinate_types = {"bus"}}.is_whole()));
  EXPECT_FALSE((ControlledShare{.penetration = 0.99}.is_whole()));
  EXPECT_TRUE(ControlledShare{}.is_whole());
}

}  // namespace
}  // namespace mvtp
