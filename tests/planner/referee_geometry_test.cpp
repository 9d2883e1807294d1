#include "planner/problem/referee_geometry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/planner/exact_separation.hpp"

namespace mvtp::referee {
namespace {

constexpr int kPairs = 20'000;
constexpr double kPi = std::numbers::pi;

class Draws {
 public:
  explicit Draws(unsigned seed) : engine_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  /// Of any order of magnitude.
  double magnitude(double low_exponent, double high_exponent) {
    return std::pow(10.0, between(low_exponent, high_exponent));
  }
  Point direction() {
    const double angle = between(-kPi, kPi);
    return {std::cos(angle), std::sin(angle)};
  }
  /// Half sides of some metres, times `scale`.
  Box box(double scale) {
    return {{between(-50, 50), between(-50, 50)},
            direction(),
            scale * between(0.5, 3.0),
            scale * between(0.3, 1.5)};
  }

 private:
  std::mt19937_64 engine_;
};

double radius(const Box& box) { return std::hypot(box.half_length, box.half_width); }

/// Puts `b` at `away` [m] from `a` along `direction`, middle to middle.
void put(const Box& a, Box& b, double away, const Point& direction) {
  b.center = {a.center.x + away * direction.x, a.center.y + away * direction.y};
}

/// Moves `b` along `direction` until its exact separation from `a` is `wanted` [m].
void put_at_separation(const Box& a, Box& b, double wanted, const Point& direction) {
  double near = 0.0;
  double far = 2.0 * (radius(a) + radius(b) + std::abs(wanted));
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (near + far);
    put(a, b, middle, direction);
    (exact_separation(a, b) > wanted ? far : near) = middle;
  }
}

/// Equal to rounding; `size` [m] is that of the larger body.
void expect_same(double is, double exact, double size) {
  ASSERT_NEAR(is, exact, 1e-12 * std::max(1.0, size));
}

void expect_as_exact(const Box& a, const Box& b) {
  expect_same(separation(a, b), exact_separation(a, b), radius(a) + radius(b));
}

TEST(RefereeGeometry, SeparatesAnyTwoBoxes) {
  Draws draw(1);
  for (int k = 0; k < kPairs; ++k) {
    const Box a = draw.box(1.0);
    Box b = draw.box(1.0);
    put(a, b, draw.between(0.0, 1.6) * (radius(a) + radius(b)), draw.direction());
    expect_as_exact(a, b);
  }
}

TEST(RefereeGeometry, SeparatesTinyFromHugeBoxes) {
  Draws draw(2);
  for (int k = 0; k < kPairs; ++k) {
    const Box a = draw.box(draw.magnitude(-3, 3));
    Box b = draw.box(draw.magnitude(-3, 3));
    put(a, b, draw.between(0.0, 1.6) * (radius(a) + radius(b)), draw.direction());
    expect_as_exact(a, b);
  }
}

TEST(RefereeGeometry, SeparatesBoxesThatTouch) {
  Draws draw(3);
  for (int k = 0; k < kPairs; ++k) {
    const Box a = draw.box(1.0);
    Box b = draw.box(1.0);
    const double gap = (k % 2 == 0 ? 1.0 : -1.0) * draw.magnitude(-12, -2);
    put_at_separation(a, b, gap, draw.direction());
    expect_as_exact(a, b);
  }
}

TEST(RefereeGeometry, SeparatesParallelBoxes) {
  Draws draw(4);
  for (int k = 0; k < kPairs; ++k) {
    const Box a = draw.box(1.0);
    Box b = draw.box(1.0);
    const double turn = draw.magnitude(-17, -3);
    const double angle = std::atan2(a.heading.y, a.heading.x) + turn + (k % 4) * kPi / 2;
    b.heading = {std::cos(angle), std::sin(angle)};
    put_at_separation(a, b, draw.between(-0.2, 0.2), draw.direction());
    expect_as_exact(a, b);
  }
}

TEST(RefereeGeometry, KnowsTheDepthOfABoxInsideAnother) {
  Draws draw(5);
  for (int k = 0; k < kPairs; ++k) {
    const Box a = draw.box(draw.magnitude(0, 2));
    Box b = draw.box(0.1);
    put(a, b, draw.between(0.0, 0.2) * a.half_width, draw.direction());
    ASSERT_LT(separation(a, b), 0.0);
    expect_as_exact(a, b);
  }
}

TEST(RefereeGeometry, LosesNothingFarFromTheOrigin) {
  Box a{{1e6, -1e6}, {1.0, 0.0}, 1.5, 1.0};
  const Box b{{1e6 + 3.001, -1e6}, {1.0, 0.0}, 1.5, 1.0};
  EXPECT_NEAR(separation(a, b), 0.001, 1e-9);
  a.center.x += 0.002;
  EXPECT_NEAR(separation(a, b), -0.001, 1e-9);
}

TEST(RefereeGeometry, SeparatesABoxFromCircles) {
  Draws draw(6);
  for (int k = 0; k < kPairs; ++k) {
    const Box box = draw.box(1.0);
    Circle circle{0.0, 0.0, k % 10 == 0 ? 0.0 : draw.magnitude(-3, 2)};
    const double away = draw.between(0.0, 1.3) * (radius(box) + circle.radius);
    const Point direction = draw.direction();
    circle.x = box.center.x + away * direction.x;
    circle.y = box.center.y + away * direction.y;
    expect_same(separation(box, circle), exact_separation(box, circle), circle.radius);
  }
  const Box box = draw.box(1.0);
  const Circle in_the_middle{box.center.x, box.center.y, 0.0};
  EXPECT_NEAR(separation(box, in_the_middle), -std::min(box.half_length, box.half_width), 1e-12);
}

/// FCL sees the segment's ends too: with a gap it may know of a wider one, never with an overlap.
TEST(RefereeGeometry, SeparatesABoxFromEdges) {
  Draws draw(7);
  for (int k = 0; k < kPairs; ++k) {
    const Box box = draw.box(1.0);
    Box edge = draw.box(draw.magnitude(-3, 3));
    edge.half_width = 0.0;
    put(box, edge, draw.between(0.0, 1.3) * (radius(box) + radius(edge)), draw.direction());
    const double x = edge.half_length * edge.heading.x;
    const double y = edge.half_length * edge.heading.y;
    const Point p{edge.center.x - x, edge.center.y - y};
    const Point q{edge.center.x + x, edge.center.y + y};
    const double exact = exact_separation(box, p, q);
    const double is = separation(box, p, q);
    const double rounding = 1e-12 * std::max(1.0, edge.half_length);
    if (exact < 0.0) expect_same(is, exact, edge.half_length);
    ASSERT_GE(is, exact - rounding);
    ASSERT_LE(is, std::max(exact, exact_distance(box, edge)) + rounding);
  }
}

TEST(RefereeGeometry, StopsAtASeparationThatIsEnough) {
  Draws draw(8);
  for (int k = 0; k < kPairs; ++k) {
    const Box a = draw.box(1.0);
    Box b = draw.box(1.0);
    put(a, b, draw.between(0.0, 2.0) * (radius(a) + radius(b)), draw.direction());
    const double enough = draw.between(-0.5, 3.0);
    const double exact = exact_separation(a, b);
    const double is = separation(a, b, enough);
    ASSERT_LE(is, exact_distance(a, b) + std::min(exact, 0.0) + 1e-12);
    ASSERT_GE(is, std::min(exact, enough) - 1e-12);
    if (is < std::min(enough, 0.0)) expect_same(is, exact, 1.0);
  }
}

TEST(RefereeGeometry, CoversOfBoxesAreNoFartherApartThanThey) {
  Draws draw(11);
  for (int k = 0; k < kPairs; ++k) {
    Box a = draw.box(1.0);
    Box b = draw.box(1.0);
    a.half_length *= draw.between(0.1, 20.0);
    if (k % 10 == 0) b.half_width = 0.0;
    put(a, b, draw.between(0.0, 1.5) * (radius(a) + radius(b)), draw.direction());
    ASSERT_LE(distance_of_covers(a, b), exact_distance(a, b) + 1e-12);
  }
}

TEST(RefereeGeometry, CoversTellCarsInNeighbouringLanesApart) {
  const Box car{{0.0, 0.0}, {1.0, 0.0}, 2.25, 0.9};
  const Box oncoming{{0.5, 3.2}, {-1.0, 0.0}, 2.25, 0.9};
  EXPECT_GT(distance_of_covers(car, oncoming), 0.7);  // of 1.4
}

TEST(FirstBelow, LooksOnceWhereWhatItGetsIsJustEnough) {
  Draws draw(9);
  for (int k = 0; k < 1000; ++k) {
    int looks = 0;
    const auto far_apart = [&](double, double enough) {
      ++looks;
      return enough;
    };
    ASSERT_FALSE(first_below(far_apart, -draw.between(0.0, 1.0), draw.magnitude(-3, 2)));
    ASSERT_EQ(looks, 1);
  }
}

TEST(FirstBelow, FindsADipOfTheResolution) {
  Draws draw(10);
  for (int k = 0; k < 1000; ++k) {
    const double place = draw.between(0.0, 1.0);
    const double rate = draw.between(0.1, 20.0);
    const auto dip = [&](double s, double) { return rate * std::abs(s - place); };
    const auto found = first_below(dip, kResolution, rate);
    ASSERT_TRUE(found);
    ASSERT_LT(dip(*found, 0.0), kResolution);
    ASSERT_FALSE(first_below(dip, -1e-12, rate));
  }
}

}  // namespace
}  // namespace mvtp::referee
