#include "coordinator/drivers/straddling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Key;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A car that appears on a lane, so far from its start, at 10 m/s.
FakeTrip car(const std::string& id, const std::string& to, int lane, double place) {
  FakeTrip trip{id, 0.0, "W-C", to};
  trip.lane = lane;
  trip.at = std::pair(place, 10.0);
  return trip;
}

/// Notes how fast drivers may be, and who is kept in his lane.
class CappedTraffic : public FakeTraffic {
 public:
  using FakeTraffic::FakeTraffic;
  void cap_speed(const std::string& id, double speed) override {
    caps.erase(id);
    if (speed < kInfinity) caps[id] = speed;
  }
  void keep_lane(const std::string& id, bool keep) override {
    if (keep) {
      kept.insert(id);
    } else {
      EXPECT_EQ(kept.erase(id), 1U) << id;
    }
  }
  std::span<const VehicleState> vehicles() const override {
    const auto states = FakeTraffic::vehicles();
    if (off_lanes.empty()) return states;
    shown_.assign(states.begin(), states.end());
    for (VehicleState& v : shown_) {
      if (v.id == off_lanes) v.lane.clear();
    }
    return shown_;
  }
  std::map<std::string, double> caps;
  std::set<std::string> kept;
  std::string off_lanes;  ///< a vehicle whose nose is on no lane

 private:
  mutable std::vector<VehicleState> shown_;
};

/// Two lanes from west to east: on the right one "behind", at 30 m, and "ahead", at 100 m; on the
/// left one "left", at 30 m; and "across" is under control.
class StraddlingTest : public testing::Test {
 protected:
  StraddlingTest()
      : traffic(two_lanes_shape().network,
                {car("behind", "C-E", 0, 30.0), car("ahead", "C-E", 0, 100.0),
                 car("left", "C-N", 1, 30.0), car("across", "C-N", 1, 60.0)}),
        graph(traffic.network()),
        straddling(
            traffic, keeping, graph,
            [this](const std::string& id) {
              std::vector<PlannedPose> poses;
              if (id != "across") return poses;
              for (const Pose& p : soon) poses.push_back({compose(at(id).pose, p), at(id).speed});
              return poses;
            },
            [this](const VehicleState&) { return reaction; },
            [this](const std::string& type) -> const VehicleType& {
              return types.try_emplace(type, fake_type(type)).first->second;
            },
            [this](const std::string&) { return graph.find_lane("W-C_1"); }) {
    traffic.insert_now();
    traffic.take_over("across");
    middle = at("across").pose;
  }
  /// Its rear axle so far to the right of the middle of the left lane, its nose on that.
  void put_aside(double aside) {
    const double turned = std::asin(aside / 3.6);
    const Pose pose = compose(middle, {0.0, -aside, turned});
    traffic.place("across", pose, 0.0);
    traffic.step();
    ASSERT_EQ(at("across").lane, "W-C_1");
  }
  const VehicleState& at(const std::string& id) const {
    return *std::ranges::find(traffic.vehicles(), id, &VehicleState::id);
  }

  CappedTraffic traffic;
  double reaction = fake_type("car").tau;  ///< [s] of all drivers
  Pose middle;                             ///< of "across" in its lane
  std::vector<Pose> soon = {Pose{}};       ///< of "across" later, seen from where it is
  std::map<std::string, VehicleType> types;
  LaneKeeping keeping{traffic};
  LaneGraph graph;
  Straddling straddling;
};

TEST_F(StraddlingTest, WhoIsWithinItsLaneConcernsNobodyElse) {
  put_aside(0.0);
  straddling.show();
  EXPECT_THAT(traffic.caps, IsEmpty());
}

TEST_F(StraddlingTest, DriversBehindATailOnTheirLaneCanStopBehindIt) {
  put_aside(1.6);
  straddling.show();
  ASSERT_THAT(traffic.caps, ElementsAre(Key("behind")));
  const VehicleType type = fake_type("car");
  const double v = traffic.caps.at("behind");
  const double tail = at("across").lane_position - type.body.length();
  const double gap = tail - at("behind").lane_position - type.min_gap;
  EXPECT_NEAR(v * type.tau + v * v / (2.0 * type.body.max_decel), gap, 1.5);
  EXPECT_GT(v, 5.0);
}

// Its side is 1.4 m from the middle of their lane.
TEST_F(StraddlingTest, WideVehiclesStopWhereNarrowOnesPassBeside) {
  FakeTrip bus = car("bus", "C-E", 0, 15.0);
  bus.type = "bus";
  traffic.add(bus);
  traffic.insert_now();
  put_aside(0.7);
  straddling.show();
  EXPECT_THAT(traffic.caps, ElementsAre(Key("bus")));
  EXPECT_TRUE(straddling.stop_position(at("bus")).has_value());
  EXPECT_FALSE(straddling.stop_position(at("behind")).has_value());
}

// Else it could not move on for them, nor they for it.
TEST_F(StraddlingTest, WhoIsBesideItAlreadyGoesOnIfItCan) {
  put_aside(0.7);
  const double tail = at("across").lane_position - fake_type("car").body.length();
  FakeTrip bus = car("bus behind", "C-E", 0, tail - 2.0);
  bus.type = "bus";
  traffic.add(bus);
  bus.id = "bus beside";
  bus.at->first = tail + 1.0;
  traffic.add(bus);
  traffic.insert_now();
  straddling.show();
  EXPECT_TRUE(traffic.caps.contains("bus behind"));
  EXPECT_FALSE(traffic.caps.contains("bus beside"));
}

// Else they come level with it while it moves over, and neither can stop in time.
TEST_F(StraddlingTest, DriversSeeWhoIsAboutToMoveIntoTheirLane) {
  put_aside(0.2);
  straddling.show();
  ASSERT_THAT(traffic.caps, IsEmpty());
  soon = {{3.0, -1.6, 0.0}};
  straddling.show();
  ASSERT_THAT(traffic.caps, ElementsAre(Key("behind")));
  const double v = traffic.caps.at("behind");
  const VehicleType type = fake_type("car");
  const double rear = at("across").lane_position - type.body.length() + soon.front().x;
  const double gap = rear - at("behind").lane_position - type.min_gap;
  EXPECT_NEAR(v * reaction + v * v / (2.0 * type.body.max_decel), gap, 1.0);
}

// Where it brakes it may not have a part in their lane before it comes to rest.
TEST_F(StraddlingTest, DriversSeeWhereItComesToRestLater) {
  put_aside(0.2);
  soon = {{0.5, -0.1, 0.0}, {9.0, -1.6, 0.0}};
  straddling.show();
  ASSERT_THAT(traffic.caps, ElementsAre(Key("behind")));
  soon.pop_back();
  straddling.show();
  EXPECT_THAT(traffic.caps, IsEmpty()) << "it is not there yet";
}

// Beside it they would keep it from moving on, and it them.
TEST_F(StraddlingTest, DriversStopBehindAllOfWhoHasItsNoseInTheirLane) {
  traffic.place("across", compose(middle, {0.0, -0.5, -0.27}), 0.0);
  traffic.step();
  ASSERT_EQ(at("across").lane, "W-C_1");
  straddling.show();
  ASSERT_THAT(traffic.caps, ElementsAre(Key("behind")));
  const double v = traffic.caps.at("behind");
  const VehicleType type = fake_type("car");
  const double rear = at("across").lane_position - type.body.length();
  const double gap = rear - at("behind").lane_position - type.min_gap;
  EXPECT_NEAR(v * reaction + v * v / (2.0 * type.body.max_decel), gap, 1.0);
}

TEST_F(StraddlingTest, DriversStopBehindATailThatStands) {
  put_aside(1.6);
  straddling.show();
  const double tail = at("across").lane_position - fake_type("car").body.length();
  const std::optional<double> stops = straddling.stop_position(at("behind"));
  ASSERT_TRUE(stops.has_value());
  EXPECT_NEAR(*stops, tail - fake_type("car").min_gap, 1.0);
  EXPECT_FALSE(straddling.stop_position(at("ahead")).has_value());
  EXPECT_FALSE(straddling.stop_position(at("left")).has_value());
  traffic.place("across", at("across").pose, 3.0);
  traffic.step();
  straddling.show();
  EXPECT_FALSE(straddling.stop_position(at("behind")).has_value());
}

// Its nose is ahead of them, and its tail behind their front bumpers.
TEST_F(StraddlingTest, WhoIsLevelWithItStaysWhereItIs) {
  traffic.place("across", compose(middle, {0.0, -0.5, -0.27}), 0.0);
  traffic.add(car("level", "C-E", 0, at("across").lane_position - 2.0));
  traffic.step();
  straddling.show();
  const VehicleState& level = at("level");
  EXPECT_EQ(straddling.stop_position(level), level.lane_position);
}

TEST_F(StraddlingTest, WhoReactsSoonerMayDriveFasterAndCanStillStop) {
  put_aside(1.6);
  straddling.show();
  const double early = traffic.caps.at("behind");
  reaction = 0.1;
  straddling.show();
  ASSERT_THAT(traffic.caps, ElementsAre(Key("behind")));
  const double late = traffic.caps.at("behind");
  EXPECT_GT(late, early + 1.0);
  const VehicleType type = fake_type("car");
  const double gap =
      at("across").lane_position - type.body.length() - at("behind").lane_position - type.min_gap;
  EXPECT_NEAR(late * reaction + late * late / (2.0 * type.body.max_decel), gap, 1.5);
}

// Else they would change to the right, into its tail.
TEST_F(StraddlingTest, DriversNearItStayInTheirLanes) {
  for (const double place : {20.0, 45.0, 53.0, 62.0, 75.0}) {
    traffic.add(car("near", "C-N", 1, place));
    traffic.insert_now();
    put_aside(1.3);
    straddling.show();
    EXPECT_EQ(traffic.kept.contains("near"), place > 50.0 && place < 70.0) << place;
    EXPECT_FALSE(traffic.kept.contains("across"));
    put_aside(0.0);
    straddling.show();
    EXPECT_THAT(traffic.kept, IsEmpty()) << place;
    traffic.remove("near");
  }
}

// Lanes side by side inside a junction may lead apart.
TEST_F(StraddlingTest, WhoEntersAJunctionNearOneKeepsItsLane) {
  const double length = traffic.network().lanes.at("W-C_1").length;
  traffic.add(car("enters", "C-N", 1, length - 1.5));
  FakeTrip waits = car("waits in a wrong lane", "C-N", 0, length);
  waits.at->second = 0.0;
  traffic.add(waits);
  traffic.insert_now();
  straddling.show();
  EXPECT_THAT(traffic.kept, IsEmpty());
  Pose near_line = middle;
  near_line.x = at("enters").pose.x - 10.0;
  traffic.place("across", near_line, 0.0);
  traffic.step();
  straddling.show();
  EXPECT_THAT(traffic.kept, ElementsAre("enters"));
}

// As a lorry does that swings out over a line, to turn.
TEST_F(StraddlingTest, SoCanThoseBehindOneWhoseNoseIsOnNoLane) {
  put_aside(1.6);
  Pose at_line = at("across").pose;
  at_line.x += 80.0;
  traffic.place("across", at_line, 0.0);
  traffic.step();
  traffic.off_lanes = "across";
  straddling.show();
  EXPECT_THAT(traffic.caps, ElementsAre(Key("ahead")));
}

TEST_F(StraddlingTest, TheyDriveAsTheyLikeOnceItHasLeftTheirLane) {
  put_aside(1.6);
  straddling.show();
  put_aside(0.0);
  straddling.show();
  EXPECT_THAT(traffic.caps, IsEmpty());
}

}  // namespace
}  // namespace mvtp
