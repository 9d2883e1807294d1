#include "coordinator/drivers/wrong_lanes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

/// Time passes, but nobody moves; notes who is told to leave lane or route.
class StandingTraffic : public FakeTraffic {
 public:
  using FakeTraffic::FakeTraffic;
  double time() const override { return now; }
  void swap_lanes(const std::string& id, const std::string& other) override {
    swaps.emplace_back(id, other);
  }
  bool detour(const std::string& id) override {
    detours.push_back(id);
    return has_path;
  }
  double now = 0.0;
  bool has_path = true;
  std::vector<std::pair<std::string, std::string>> swaps;
  std::vector<std::string> detours;
};

/// A car that stands so far before the end of a lane from the west: from the right one the junction
/// is crossed straight on or to the right (south), from the left one to the left (north).
FakeTrip car(const std::string& id, const std::string& to, int lane, double before_end = 0.5,
             const std::string& type = "car", double speed = 0.0) {
  FakeTrip trip{id, 0.0, "W-C", to, type};
  trip.lane = lane;
  trip.at = std::pair(two_lanes_shape().network.lanes.at("W-C_0").length - before_end, speed);
  return trip;
}

class WrongLanesTest : public testing::Test {
 protected:
  void set(std::vector<FakeTrip> trips) {
    traffic = std::make_unique<StandingTraffic>(two_lanes_shape().network, std::move(trips));
    traffic->insert_now();
    graph = std::make_unique<LaneGraph>(traffic->network());
    wrong_lanes = std::make_unique<WrongLanes>(
        *traffic, *graph, [this](const std::string& id) { return controlled.contains(id); });
  }
  void look_until(double end) {
    for (; traffic->now <= end; traffic->now += 0.5) wrong_lanes->look();
  }
  std::unique_ptr<StandingTraffic> traffic;
  std::unique_ptr<LaneGraph> graph;
  std::unique_ptr<WrongLanes> wrong_lanes;
  std::set<std::string> controlled;
};

TEST_F(WrongLanesTest, TwoWhoWaitForEachOthersLaneSwapOnceAfterAWhile) {
  set({car("a", "C-N", 0), car("b", "C-E", 1)});
  look_until(WrongLanes::kGivesUp - 0.5);
  EXPECT_THAT(traffic->swaps, IsEmpty());
  look_until(WrongLanes::kGivesUp + 20.0);
  EXPECT_THAT(traffic->swaps, ElementsAre(Pair("a", "b")));
  EXPECT_THAT(traffic->detours, IsEmpty());
  EXPECT_EQ(wrong_lanes->swaps(), 1);
}

TEST_F(WrongLanesTest, WhoHasNoPartnerTakesAnotherPath) {
  set({car("a", "C-N", 0), car("b", "C-N", 1)});
  look_until(WrongLanes::kGivesUp);
  EXPECT_THAT(traffic->swaps, IsEmpty());
  EXPECT_THAT(traffic->detours, ElementsAre("a"));
  EXPECT_EQ(wrong_lanes->detours(), 1);
}

TEST_F(WrongLanesTest, ALongerVehicleHasNoRoomInTheOthersPlace) {
  set({car("a", "C-N", 0, 0.5, "bus"), car("b", "C-E", 1)});
  look_until(WrongLanes::kGivesUp);
  EXPECT_THAT(traffic->swaps, IsEmpty());
  EXPECT_THAT(traffic->detours, ElementsAre("a", "b"));
}

TEST_F(WrongLanesTest, WithoutAPathItWaitsForAPartner) {
  set({car("a", "C-N", 0)});
  traffic->has_path = false;
  look_until(WrongLanes::kGivesUp + 5.0);
  EXPECT_EQ(wrong_lanes->detours(), 0);
  EXPECT_THAT(traffic->detours, ElementsAre("a"));  // asked once
  traffic->add(car("b", "C-E", 1));
  traffic->insert_now();
  wrong_lanes->look();
  EXPECT_THAT(traffic->swaps, ElementsAre(Pair("a", "b")));
}

TEST_F(WrongLanesTest, NobodyElseIsTouched) {
  set({car("right lane", "C-E", 0), car("behind it, in a wrong one", "C-N", 0, 8.0),
       car("far from the end", "C-E", 1, 40.0)});
  look_until(3.0 * WrongLanes::kGivesUp);
  EXPECT_THAT(traffic->detours, IsEmpty());
  set({car("moves", "C-E", 1, 5.0, "car", 1.0)});
  look_until(3.0 * WrongLanes::kGivesUp);
  EXPECT_THAT(traffic->detours, IsEmpty());
  set({car("controlled", "C-E", 1)});
  controlled = {"controlled"};
  look_until(3.0 * WrongLanes::kGivesUp);
  EXPECT_THAT(traffic->detours, IsEmpty());
}

}  // namespace
}  // namespace mvtp
