#include "planner/escot/neighbours.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace mvtp {
namespace {

TEST(Neighbours, AreThoseWithinTheRadiusAndNobodyElse) {
  std::mt19937_64 rng(1);
  const auto random = [&] { return double(rng() >> 11U) * 0x1p-53 * 50.0; };
  std::vector<Pose> q;
  for (int i = 0; i < 200; ++i) q.push_back({random(), random(), 0.0});
  q.push_back(q.front());  // two at one place
  const Neighbours neighbours(q);
  std::vector<int> found = {-1};
  for (const double radius : {0.0, 3.0, 20.0, 100.0}) {
    for (const Pose& place : q) {
      std::vector<int> expected;
      for (int i = 0; i < int(q.size()); ++i) {
        const Pose& other = q[std::size_t(i)];
        if (std::hypot(other.x - place.x, other.y - place.y) <= radius) expected.push_back(i);
      }
      neighbours.within(radius, place, found);
      std::ranges::sort(found);
      ASSERT_EQ(found, expected) << radius;
    }
  }
}

TEST(Neighbours, OfNobodyAreNone) {
  std::vector<int> found = {7};
  Neighbours(std::vector<Pose>{}).within(10.0, {}, found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace mvtp
