// How fast a vehicle under control may be along its corridor.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coordinator/corridor/corridor.hpp"
#include "tests/coordinator/fake_traffic.hpp"
#include "tests/coordinator/walk.hpp"

namespace mvtp {
namespace {

// Who is not admitted through the next line stops before it, wherever on its corridor it learns so.
TEST(Corridor, LeavesRoomToStopBeforeTheNextLine) {
  for (const double apart : {70.0, 75.0, 90.0, 120.0}) {
    const NetworkShape chain = chain_shape(7.2, apart);
    Walk walk(chain.network);
    const DrivableArea area(chain.network);
    CorridorMap map(walk.graph, area, {});
    const auto course = walk.finder.find(walk.at("W-A_0", 60.0, {"W-A", "A-B", "B-E"}));
    ASSERT_TRUE(course);
    ASSERT_EQ(course->lines.size(), 1U) << "the second line is another corridor's";
    const double edge = walk.graph.lane(walk.graph.find_lane("A-B_0")).length;
    EXPECT_TRUE(std::ranges::count(course->slow_places, SlowPlace{edge, 0.0}));
    const Vehicle car = fake_type("car").body;
    const Corridor& c = map[map.corridor_for(*course, car)];
    for (std::size_t i = 0; i < c.lateral_limits.size(); ++i) {
      const double s = double(i) * ReferencePath::kSpacing;
      const double v = std::min(c.lateral_limits[i], c.lane_limits[i]);
      const double room = c.s_exit + edge - s;
      EXPECT_TRUE(v <= 2.0 || v * v / (2.0 * comfortable_braking(car)) < room)
          << apart << ": " << s;
    }
    EXPECT_GT(std::min(c.lateral_limits.front(), c.lane_limits.front()), 13.0);
  }
}

// A lane whose limit is lowered for its bend: its drivers keep to that, vehicles under control to
// their lateral acceleration at each place; without one, to the lowered limit, too.
TEST(Corridor, KeepsToLateralAccelerationInPlaceOfALowerLimitForIt) {
  NetworkShape cross = crossroads_shape();
  for (auto& [id, lane] : cross.network.lanes) {
    if (lane.internal) lane.lower_limit(2.0);
  }
  Walk walk(cross.network);
  const DrivableArea area(cross.network);
  const Vehicle car = fake_type("car").body;
  const auto query = walk.at("W-C_0", 60.0, shortest_route(cross.network, "W-C", "C-N"));
  const auto limit_inside = [&](double lateral, bool human_driven) {
    CorridorMap map(walk.graph, area, {.max_lateral_accel = lateral, .margins = {}});
    const CorridorCourse course =
        human_driven ? walk.finder.follow(query, 100.0) : walk.finder.find(query).value();
    const Corridor& c = map[map.corridor_for(course, car)];
    return *std::ranges::min_element(c.lane_limits);
  };
  EXPECT_NEAR(limit_inside(3.0, false), 6.5, 0.1);
  EXPECT_NEAR(limit_inside(3.0, true), 2.0, 0.1);
  EXPECT_NEAR(limit_inside(0.0, false), 2.0, 0.1);
}

TEST(Corridor, IsSlowEnoughForItsDriversNextBend) {
  for (double behind = 60.0; behind < 150.0; behind += 5.0) {
    const NetworkShape shape = bend_behind_shape(behind);
    Walk walk(shape.network);
    const DrivableArea area(shape.network);
    CorridorMap map(walk.graph, area, {});
    const auto course = walk.finder.find(walk.at("W-A_0", 100.0, {"W-A", "A-B", "B-E"}));
    ASSERT_TRUE(course);
    if (course->handback > behind) continue;  // it is driven through the bend
    EXPECT_TRUE(std::ranges::any_of(course->slow_places, [&](const SlowPlace& place) {
      return std::abs(place.at - behind) < 1e-9 && place.speed == 5.0;
    })) << behind;
    const Vehicle car = fake_type("car").body;
    const Corridor& c = map[map.corridor_for(*course, car)];
    for (double s = c.s_exit; s <= c.s_end; s += ReferencePath::kSpacing) {
      const double v = c.lateral_limits[std::size_t(s / ReferencePath::kSpacing)];
      const double room = c.s_exit + behind - s;
      EXPECT_LE(v * v - 25.0, 2.0 * comfortable_braking(car) * room) << behind << ": " << s;
    }
  }
}

}  // namespace
}  // namespace mvtp
