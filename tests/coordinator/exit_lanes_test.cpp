#include "coordinator/drivers/exit_lanes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

/// On two lanes that lead away from a junction, "slow" stands on the right one, its tail 8 m behind
/// the junction, "near" likewise on another road, 6.5 m behind it, and "quick" drives 10 m/s on a
/// third one; "leaves" is under control and comes onto the left one.
class ExitLanesTest : public testing::Test {
 protected:
  ExitLanesTest()
      : traffic(two_lanes_shape().network,
                {car("slow", "C-E", 12.5, 0.0), car("near", "C-S", 11.0, 0.0),
                 car("quick", "C-N", 12.5, 10.0), car("leaves", "W-C", 50.0, 10.0)}),
        graph(traffic.network()),
        exits(
            traffic, keeping, graph,
            [this](const std::string& id) { return id == "leaves" ? leaving : std::nullopt; },
            [](const std::string& type) -> const VehicleType& {
              static const VehicleType kCar = fake_type("car");
              EXPECT_EQ(type, "car");
              return kCar;
            }) {
    traffic.insert_now();
  }
  static FakeTrip car(const std::string& id, const std::string& edge, double place, double speed) {
    FakeTrip trip{id, 0.0, edge, edge == "W-C" ? "C-E" : edge};
    trip.at = std::pair(place, speed);
    return trip;
  }
  void leave_onto(const std::string& lane, double front, double needs) {
    leaving = {graph.find_lane(lane), front, needs};
    exits.show();
  }

  FakeTraffic traffic;
  std::optional<ExitLanes::Leaving> leaving;
  LaneKeeping keeping{traffic};
  LaneGraph graph;
  ExitLanes exits;
};

TEST_F(ExitLanesTest, DriversBesideStayWhereTheyAreWhileItCouldNotStopBehindThem) {
  leave_onto("C-E_1", -10.0, 15.0);  // rests at 5 m, 2.5 m are left to "slow"
  EXPECT_FALSE(traffic.is_kept_in_lane("slow"));
  leave_onto("C-E_1", -10.0, 16.0);
  EXPECT_TRUE(traffic.is_kept_in_lane("slow"));
}

// Its 4.5 m and 2.5 m more have to be free.
TEST_F(ExitLanesTest, SoTheyDoWhileItCouldNotStopClearOfTheJunction) {
  leave_onto("C-E_1", -1.0, 0.0);
  EXPECT_FALSE(traffic.is_kept_in_lane("slow"));
  leave_onto("C-S_1", -1.0, 0.0);
  EXPECT_TRUE(traffic.is_kept_in_lane("near"));
}

TEST_F(ExitLanesTest, WhoDrivesOnMayChange) {
  leave_onto("C-N_1", -10.0, 25.0);  // rests at 15 m, "quick" no sooner than at 19 m
  EXPECT_FALSE(traffic.is_kept_in_lane("quick"));
  leave_onto("C-N_1", -10.0, 28.0);
  EXPECT_TRUE(traffic.is_kept_in_lane("quick"));
}

TEST_F(ExitLanesTest, WhoIsOnThatLaneOrAnotherRoadMayChange) {
  leave_onto("C-E_0", -10.0, 30.0);
  EXPECT_FALSE(traffic.is_kept_in_lane("slow"));
  leave_onto("C-E_1", -10.0, 30.0);
  EXPECT_FALSE(traffic.is_kept_in_lane("quick"));
}

TEST_F(ExitLanesTest, TheyMayAgainOnceItHasLeft) {
  leave_onto("C-E_1", -10.0, 30.0);
  ASSERT_TRUE(traffic.is_kept_in_lane("slow"));
  leaving.reset();
  exits.show();
  EXPECT_FALSE(traffic.is_kept_in_lane("slow"));
}

// A car that is driven over a junction, from where it cannot stop before it any more until its tail
// is behind it; no longer.
TEST(ExitLanesOfPlans, AreKeptFreeFromTheLineToTheTailsLeaving) {
  const NetworkShape shape = two_lanes_shape();
  FakeTrip drives{"drives", 0.0, "W-C", "C-N"};
  drives.lane = 1;
  drives.at = std::pair(60.0, 13.0);
  FakeTrip stands{"stands", 0.0, "C-N", "C-N", "bike"};
  stands.at = std::pair(6.0, 0.0);
  ClosedLoop run(shape, {drives, stands});
  run.traffic.freeze("stands");
  const double length = shape.network.lanes.at("W-C_1").length;
  int kept = 0;
  while (run.traffic.time() < 20.0) {
    const auto vehicles = run.traffic.vehicles();
    const auto v = std::ranges::find(vehicles, "drives", &VehicleState::id);
    const bool is_driven = run.coordinator.drives("drives");
    const bool is_far = v != vehicles.end() && v->lane == "W-C_1" && length - v->lane_position > 30;
    const bool has_left = v != vehicles.end() && v->lane == "C-N_1" && v->lane_position > 7.0;
    run.step();
    if (!is_driven) continue;
    kept += int(run.traffic.is_kept_in_lane("stands"));
    EXPECT_FALSE((is_far || has_left) && run.traffic.is_kept_in_lane("stands"))
        << run.traffic.time();
  }
  EXPECT_GT(kept, 10);
}

}  // namespace
}  // namespace mvtp
