#include "planner/road/reservation.hpp"

#include <gtest/gtest.h>

#include "planner/road/profile_planner.hpp"
#include "planner/road/road_escot.hpp"
#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

// A junction from s = 92 to 113 on each path: 7.2 m on either side of the middle, and the body.
const JunctionStretch kFromWest{.junction = 0, .approach = 0, .from = 92.0, .to = 113.0};
const JunctionStretch kFromSouth{.junction = 0, .approach = 1, .from = 92.0, .to = 113.0};

class ReservedGround : public testing::Test {
 protected:
  ContactTable reserved(Reservation r, const JunctionStretch& on_a,
                        const JunctionStretch& on_b) const {
    return reserved_ground(r, {&east, std::span(&on_a, 1)}, {&north, std::span(&on_b, 1)}, bodies);
  }

  ReferencePath eastwards = straight({-100, 0}, {100, 0});
  ReferencePath northwards = straight({0, -100}, {0, 100});
  SweptPath east{eastwards, kCar, Margins{}};
  SweptPath north{northwards, kCar, Margins{}};
  ContactTable bodies{east, north};
};

TEST_F(ReservedGround, EachTakesMoreThanTheOneBefore) {
  const ContactTable area = reserved(Reservation::kConflictArea, kFromWest, kFromSouth);
  const ContactTable tiles = reserved(Reservation::kTiles, kFromWest, kFromSouth);
  const ContactTable junction = reserved(Reservation::kJunction, kFromWest, kFromSouth);
  int touching = 0, on_tiles = 0, in_area = 0, on_junction = 0;
  for (double a = 80.0; a < 130.0; a += 0.25) {
    for (double b = 80.0; b < 130.0; b += 0.25) {
      if (bodies.touches(a, b)) {
        EXPECT_TRUE(area.touches(a, b)) << a << ", " << b;
        EXPECT_TRUE(junction.touches(a, b)) << a << ", " << b;
        ++touching;
      }
      if (tiles.touches(a, b)) {
        EXPECT_TRUE(junction.touches(a, b)) << a << ", " << b;
      }
      on_tiles += tiles.touches(a, b) ? 1 : 0;
      in_area += area.touches(a, b) ? 1 : 0;
      on_junction += junction.touches(a, b) ? 1 : 0;
    }
  }
  EXPECT_EQ(touching, in_area);  // at right angles all positions of contact are a rectangle
  EXPECT_LT(touching, on_tiles);
  EXPECT_LT(on_tiles, on_junction);
  EXPECT_LT(in_area, on_junction);
}

TEST_F(ReservedGround, AConflictAreaIsTheLeastRectangleAroundTheContacts) {
  const ReferencePath slant = straight({-71, -71}, {71, 71});
  const SweptPath slanting(slant, kCar, Margins{});
  const ContactTable contacts(east, slanting);
  const ContactTable area =
      reserved_ground(Reservation::kConflictArea, {&east, std::span(&kFromWest, 1)},
                      {&slanting, std::span(&kFromSouth, 1)}, contacts);
  double a_low = 1e9, a_high = 0.0, b_low = 1e9, b_high = 0.0;
  int touching = 0, in_area = 0;
  for (double a = 92.0; a <= 113.0; a += 0.25) {
    for (double b = 92.0; b <= 113.0; b += 0.25) {
      in_area += area.touches(a, b) ? 1 : 0;
      if (!contacts.touches(a, b)) continue;
      ++touching;
      a_low = std::min(a_low, a);
      a_high = std::max(a_high, a);
      b_low = std::min(b_low, b);
      b_high = std::max(b_high, b);
    }
  }
  EXPECT_LT(touching, in_area);  // one has left a corner where the other comes
  EXPECT_TRUE(area.touches(a_low, b_low));
  EXPECT_TRUE(area.touches(a_high, b_low));
  EXPECT_FALSE(area.touches(a_low - 0.5, b_low));
  EXPECT_FALSE(area.touches(a_high, b_high + 0.5));
}

TEST_F(ReservedGround, ATileIsNeverSharedAndBodiesOnOneGroundShareOne) {
  const ContactTable tiles = reserved(Reservation::kTiles, kFromWest, kFromSouth);
  for (double a = 92.0; a <= 113.0; a += 0.25) {
    for (double b = 92.0; b <= 113.0; b += 0.25) {
      const OrientedBox on_a = east.box(std::size_t(a / ReferencePath::kSpacing + 0.5));
      const OrientedBox on_b = north.box(std::size_t(b / ReferencePath::kSpacing + 0.5));
      const double gap = separation(on_a, on_b);
      if (gap <= 0.0) {
        EXPECT_TRUE(tiles.touches(a, b)) << a << ", " << b;
      }
      if (gap > kTile * 1.42) {
        EXPECT_FALSE(tiles.touches(a, b)) << a << ", " << b;
      }
    }
  }
}

TEST_F(ReservedGround, WhoComesFromTheSameLaneFollows) {
  JunctionStretch same = kFromSouth;
  same.approach = kFromWest.approach;
  EXPECT_TRUE(reserved(Reservation::kJunction, kFromWest, same).empty());
  EXPECT_TRUE(reserved(Reservation::kConflictArea, kFromWest, same).empty());
}

TEST_F(ReservedGround, OtherJunctionsAndNothingReserveNothing) {
  JunctionStretch other = kFromSouth;
  other.junction = 1;
  for (const Reservation r :
       {Reservation::kTiles, Reservation::kConflictArea, Reservation::kJunction}) {
    EXPECT_TRUE(reserved(r, kFromWest, other).empty());
  }
  EXPECT_TRUE(reserved(Reservation::kNone, kFromWest, kFromSouth).empty());
}

/// Paths 0 east and 1 west beside it, which never touch, and 2 north.
class Reserving : public Crossing {
 protected:
  void build(Reservation reservation) {
    library = std::make_unique<PathLibrary>(Margins{}, reservation);
    library->add(straight({-100, -1.6}, {100, -1.6}), kCar, {kFromWest});
    JunctionStretch from_east = kFromWest;
    from_east.approach = 2;
    library->add(straight({100, 1.6}, {-100, 1.6}), kCar, {from_east});
    library->add(straight({1.6, -100}, {1.6, 100}), kCar, {kFromSouth});
    const std::vector<int> paths = {0, 1, 2};
    library->build_tables(paths);
    scene.library = library.get();
  }

  /// Plans all in turn; for how many steps are two of them on the junction.
  int together() {
    const RoadPairs pairs(scene);
    std::vector<JointPlan::Entry> entries;
    for (const RoadVehicle& v : scene.vehicles) {
      auto t = plan_vehicle(pairs, v, entries, {});
      EXPECT_TRUE(t.has_value()) << v.key;
      if (!t) return -1;
      entries.push_back({v.key, std::make_shared<SpeedProfile>(*std::move(t))});
    }
    int steps = 0;
    for (std::int64_t k = 0; k < 1000; ++k) {
      int inside = 0;
      for (const JointPlan::Entry& e : entries) {
        const double s = e.profile->at(k).s;
        inside += s > kFromWest.from + 0.2 && s < kFromWest.to - 0.2 ? 1 : 0;
      }
      steps += inside > 1 ? 1 : 0;
    }
    return steps;
  }

  std::unique_ptr<PathLibrary> library;
};

TEST_F(Reserving, OnlyTheWholeJunctionKeepsApartWhoNeverMeet) {
  for (const Reservation r : {Reservation::kNone, Reservation::kTiles, Reservation::kConflictArea,
                              Reservation::kJunction}) {
    build(r);
    scene.vehicles.clear();
    add(0, 60.0, 13.0);
    add(1, 60.0, 13.0);
    const int steps = together();
    if (r == Reservation::kJunction) {
      EXPECT_EQ(steps, 0);
    } else {
      EXPECT_GT(steps, 5) << int(r);
    }
  }
}

TEST_F(Reserving, WhoMayNotBeThereTogetherIsPlannedTogether) {
  build(Reservation::kNone);
  add(0, 60.0, 13.0).exit_lane = 0;
  add(1, 60.0, 13.0).exit_lane = 1;
  EXPECT_EQ(group_vehicles(scene).size(), 2U);
  build(Reservation::kJunction);
  EXPECT_EQ(group_vehicles(scene).size(), 1U);
}

TEST_F(Reserving, TheLongerGroundIsReservedTheLaterTheSecondLeaves) {
  std::vector<std::int64_t> leaves;
  for (const Reservation r :
       {Reservation::kNone, Reservation::kConflictArea, Reservation::kJunction}) {
    build(r);
    scene.vehicles.clear();
    add(0, 60.0, 13.0);
    add(2, 60.0, 13.0);
    const RoadPairs pairs(scene);
    std::vector<JointPlan::Entry> first;
    first.push_back(
        {0, std::make_shared<SpeedProfile>(*plan_vehicle(pairs, scene.vehicles[0], {}, {}))});
    const auto second = plan_vehicle(pairs, scene.vehicles[1], first, {});
    ASSERT_TRUE(second.has_value());
    leaves.push_back(arrival_step(*second, 170.0));
  }
  EXPECT_LE(leaves[0], leaves[1]);
  EXPECT_LT(leaves[1], leaves[2]);
}

}  // namespace
}  // namespace mvtp
