#include "planner/geometry/sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/planner/fcl_reference.hpp"

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;
const Vehicle kCar;  // 2.5 m ahead, 0.5 m behind the axle, 2 m wide

class Random {
 public:
  explicit Random(unsigned seed) : rng_(seed) {}
  double in(double low, double high) {
    return low + (high - low) * double(rng_() >> 11U) * 0x1p-53;
  }
  Pose pose(double range) { return {in(-range, range), in(-range, range), in(-kPi, kPi)}; }
  Arc arc() { return {in(-2.2, 2.2), in(-0.42, 0.42)}; }

 private:
  std::mt19937_64 rng_;
};

TEST(Separation, AgreesWithFclOnWhetherBoxesOverlap) {
  Random random(1);
  int overlapping = 0;
  for (int k = 0; k < 4000; ++k) {
    const OrientedBox a = footprint(kCar, random.pose(2.0));
    const OrientedBox b = footprint(kCar, random.pose(2.0));
    const double gap = separation(a, b);
    if (std::abs(gap) < 1e-6) continue;  // FCL decides touching boxes by its own rounding
    EXPECT_EQ(gap < 0.0, fcl_overlap(a, b));
    overlapping += gap < 0.0 ? 1 : 0;
  }
  EXPECT_GT(overlapping, 1000);
  EXPECT_LT(overlapping, 3000);
}

TEST(Separation, IsAtMostTheDistanceAndAtLeastItByTheRootOfTwo) {
  Random random(2);
  for (int k = 0; k < 1000; ++k) {
    const OrientedBox a = footprint(kCar, random.pose(4.0));
    const OrientedBox b = footprint(kCar, random.pose(4.0));
    const double distance = fcl_distance(a, b);
    if (distance == 0.0) continue;
    EXPECT_LE(separation(a, b), distance + 1e-5);
    EXPECT_GE(separation(a, b), distance / std::numbers::sqrt2 - 1e-5);
  }
}

TEST(Separation, OfAPointAgreesWithFclOnDiscs) {
  Random random(3);
  for (int k = 0; k < 2000; ++k) {
    const OrientedBox box = footprint(kCar, random.pose(2.0));
    const Point centre{random.in(-3, 3), random.in(-3, 3)};
    const double gap = separation(box, centre) - 0.8;
    if (std::abs(gap) > 1e-3) {
      EXPECT_EQ(gap < 0.0, fcl_overlap(box, centre, 0.8));
    }
  }
}

//   Boxes 3 x 2 m side by side: 2 m between the axles is touching, 2.5 m leaves half a metre.
TEST(Separation, KnowsTwoCarsSideBySide) {
  EXPECT_NEAR(separation(footprint(kCar, {0, 0, 0}), footprint(kCar, {0, 2.5, 0})), 0.5, 1e-12);
  EXPECT_NEAR(separation(footprint(kCar, {0, 0, 0}), footprint(kCar, {0, 1.9, kPi / 6 * 0})), -0.1,
              1e-12);
}

TEST(Sweep, PassesThroughThePosesOfTheArc) {
  Random random(4);
  for (int k = 0; k < 500; ++k) {
    const Pose from = random.pose(10.0);
    // Arcs of up to 15 rad: beyond the reach of the series, too.
    const Arc arc{random.in(-6, 6), random.in(-2.5, 2.5)};
    const Sweep sweep(kCar, from, arc);
    for (const double s : {0.0, 0.3, 0.5, 1.0}) {
      const OrientedBox expected = footprint(kCar, drive(from, {arc.length * s, arc.curvature}));
      const OrientedBox box = sweep.at(s);
      EXPECT_NEAR(box.x, expected.x, 1e-9);
      EXPECT_NEAR(box.y, expected.y, 1e-9);
      EXPECT_NEAR(box.ux, expected.ux, 1e-9);
      EXPECT_NEAR(box.uy, expected.uy, 1e-9);
    }
  }
}

TEST(Sweep, StaysInItsCircleAndMovesNoFasterThanItSays) {
  Random random(5);
  for (int k = 0; k < 300; ++k) {
    const Pose from = random.pose(10.0);
    const Arc arc = random.arc();
    const Sweep sweep(kCar, from, arc);
    for (const Point corner : {Point{kCar.front, kCar.width / 2},
                               {kCar.front, -kCar.width / 2},
                               {-kCar.rear, kCar.width / 2},
                               {-kCar.rear, -kCar.width / 2}}) {
      const auto at = [&](double s) {
        return compose(drive(from, {arc.length * s, arc.curvature}), {corner.x, corner.y, 0.0});
      };
      for (double s = 0.0; s < 0.999; s += 0.1) {
        EXPECT_LE(distance(at(s), at(s + 0.1)), 0.1 * sweep.travel() + 1e-9);
        EXPECT_LE(std::hypot(at(s).x - sweep.centre().x, at(s).y - sweep.centre().y),
                  sweep.radius() + 1e-9);
      }
    }
  }
}

/// The least separation over 2001 time steps.
double least_gap(const Sweep& a, const Sweep& b) {
  double gap = separation(a.at(0), b.at(0));
  for (int k = 1; k <= 2000; ++k) gap = std::min(gap, separation(a.at(k / 2e3), b.at(k / 2e3)));
  return gap;
}

TEST(Sweep, StaysInTheBoxAroundIt) {
  Random random(11);
  double spare = 0.0;  // of the box over the body, the smallest over all sweeps of one kind
  for (int k = 0; k < 2000; ++k) {
    const Pose from = random.pose(20.0);
    const Arc arc = k % 10 == 0 ? Arc{random.in(-9, 9), random.in(-0.4, 0.4)} : random.arc();
    const Sweep sweep(kCar, from, arc);
    const OrientedBox around = sweep.around();
    double most = -1.0;  // how close the body comes to the box's sides, from within
    for (int t = 0; t <= 64; ++t) {
      const OrientedBox body = sweep.at(t / 64.0);
      for (const double along : {body.half_length, -body.half_length}) {
        for (const double across : {body.half_width, -body.half_width}) {
          const Point corner{body.x + along * body.ux - across * body.uy,
                             body.y + along * body.uy + across * body.ux};
          most = std::max(most, separation(around, corner));
        }
      }
    }
    EXPECT_LE(most, 1e-9) << arc.length << " m at " << arc.curvature << " 1/m";
    const bool is_short = std::abs(arc.length * arc.curvature) < 0.5;
    if (is_short) spare = std::max(spare, -most);
  }
  EXPECT_LT(spare, 0.1);  // the box is hardly larger than it must be
}

TEST(Collide, AgreesWithDenseSamplingOfBothMotions) {
  Random random(6);
  int collisions = 0;
  int close_calls = 0;
  for (int k = 0; k < 2000; ++k) {
    const Sweep a(kCar, random.pose(2.5), random.arc());
    const Sweep b(kCar, random.pose(2.5), random.arc());
    const double gap = least_gap(a, b);
    close_calls += gap > 0.0 && gap < 0.2 ? 1 : 0;
    // Samples are up to 2 mm of motion apart, so the true minimum is that much lower.
    if (gap < -1.5 * kTouch) {
      EXPECT_TRUE(collide(a, b)) << gap;
    }
    if (gap > 2.5e-3) {
      EXPECT_FALSE(collide(a, b)) << gap;
    }
    EXPECT_EQ(collide(a, b), collide(b, a));
    collisions += collide(a, b) ? 1 : 0;
  }
  EXPECT_GT(collisions, 400);
  EXPECT_GT(close_calls, 50);
}

//   Two cars pass through each other between the steps: neither end shows it.
TEST(Collide, SeesWhatHappensBetweenTheSteps) {
  const Sweep right(kCar, {0, 0, 0}, {12, 0});
  const Sweep left(kCar, {12, 0.5, kPi}, {12, 0});
  ASSERT_GT(separation(right.at(0), left.at(0)), 0.0);
  ASSERT_GT(separation(right.at(1), left.at(1)), 0.0);
  EXPECT_TRUE(collide(right, left));
}

//   A queue that moves as one never collides, however close: 1 cm between the bumpers.
TEST(Collide, LetsACloseQueueMove) {
  EXPECT_FALSE(collide(Sweep(kCar, {0, 0, 0}, {1, 0}), Sweep(kCar, {3.01, 0, 0}, {1, 0})));
}

TEST(Collide, AllowsTouchingButNotMore) {
  EXPECT_FALSE(collide(Sweep(kCar, {0, 0, 0}, {}), Sweep(kCar, {3.0 - 0.8 * kTouch, 0, 0}, {})));
  EXPECT_TRUE(collide(Sweep(kCar, {0, 0, 0}, {}), Sweep(kCar, {3.0 - 1.2 * kTouch, 0, 0}, {})));
}

TEST(Collide, AgreesWithDenseSamplingOfDiscs) {
  Random random(7);
  int collisions = 0;
  for (int k = 0; k < 2000; ++k) {
    const Sweep sweep(kCar, random.pose(3.0), random.arc());
    const Point centre{random.in(-3, 3), random.in(-3, 3)};
    double gap = 1e9;
    for (int s = 0; s <= 1000; ++s) {
      gap = std::min(gap, separation(sweep.at(s / 1e3), centre) - 0.8);
    }
    if (gap < -1.5 * kTouch) {
      EXPECT_TRUE(collide(sweep, centre, 0.8));
    }
    if (gap > 2.5e-3) {
      EXPECT_FALSE(collide(sweep, centre, 0.8));
    }
    collisions += gap < 0 ? 1 : 0;
  }
  EXPECT_GT(collisions, 300);
}

TEST(Extents, AreThoseOfDenselySampledMotions) {
  Random random(8);
  for (int k = 0; k < 300; ++k) {
    const Pose from = random.pose(5.0);
    const Arc arc{random.in(-8, 8), random.in(-0.42, 0.42)};
    Extent axle{1e9, 1e9, -1e9, -1e9};
    Extent body = axle;
    const auto widen = [](Extent& extent, double x, double y) {
      extent = {std::min(extent.min_x, x), std::min(extent.min_y, y), std::max(extent.max_x, x),
                std::max(extent.max_y, y)};
    };
    for (int s = 0; s <= 1000; ++s) {
      const Pose at = drive(from, {arc.length * s / 1e3, arc.curvature});
      widen(axle, at.x, at.y);
      for (const double ahead : {kCar.front, -kCar.rear}) {
        for (const double left : {1.0, -1.0}) {
          const Pose corner = compose(at, {ahead, left, 0});
          widen(body, corner.x, corner.y);
        }
      }
    }
    const auto expect_near = [](const Extent& a, const Extent& b) {
      EXPECT_NEAR(a.min_x, b.min_x, 1e-4);
      EXPECT_NEAR(a.min_y, b.min_y, 1e-4);
      EXPECT_NEAR(a.max_x, b.max_x, 1e-4);
      EXPECT_NEAR(a.max_y, b.max_y, 1e-4);
    };
    expect_near(axle_extent(from, arc), axle);
    expect_near(body_extent(kCar, from, arc), body);
  }
}

TEST(Sweep, MovedToAPoseIsTheSweepFromThere) {
  Random random(40);
  for (int k = 0; k < 500; ++k) {
    const Pose first = random.pose(3.0);
    const Pose pose = random.pose(20.0);
    const Arc arc = random.arc();
    const Sweep moved = Sweep(kCar, first, arc).moved_to(Frame(pose));
    const Sweep expected(kCar, compose(pose, first), arc);
    EXPECT_NEAR(moved.centre().x, expected.centre().x, 1e-12);
    EXPECT_NEAR(moved.centre().y, expected.centre().y, 1e-12);
    EXPECT_EQ(moved.radius(), expected.radius());
    EXPECT_EQ(moved.travel(), expected.travel());
    for (const double s : {0.0, 0.3, 1.0}) {
      EXPECT_NEAR(moved.at(s).x, expected.at(s).x, 1e-12);
      EXPECT_NEAR(moved.at(s).y, expected.at(s).y, 1e-12);
      EXPECT_NEAR(moved.at(s).ux, expected.at(s).ux, 1e-12);
      EXPECT_NEAR(moved.at(s).uy, expected.at(s).uy, 1e-12);
    }
  }
}

//   Round a circle of 3 m, and back to its begin.
TEST(Extents, OfAWholeCircleAreThoseOfTheCircle) {
  constexpr double kRadius = 3.0;
  const Pose from{10.0, 20.0, 0.8};
  const Pose middle = compose(from, {0.0, kRadius, 0.0});
  const Extent extent = axle_extent(from, {2.0 * std::numbers::pi * kRadius, 1.0 / kRadius});
  EXPECT_NEAR(extent.min_x, middle.x - kRadius, 1e-9);
  EXPECT_NEAR(extent.min_y, middle.y - kRadius, 1e-9);
  EXPECT_NEAR(extent.max_x, middle.x + kRadius, 1e-9);
  EXPECT_NEAR(extent.max_y, middle.y + kRadius, 1e-9);
}

TEST(Segment, OfNoLengthIsItsPoint) {
  const OrientedBox box = footprint(kCar, {0.0, 0.0, 0.4});
  const Point p{6.0, 2.0};
  EXPECT_EQ(separation(segment(p, p), box), separation(box, OrientedBox{p.x, p.y, 1.0, 0.0}));
  EXPECT_DOUBLE_EQ(segment({1.0, 2.0}, {1.0, 3.0}).half_length, 0.5);
}

}  // namespace
}  // namespace mvtp
