#include "planner/problem/draws.hpp"

#include <gtest/gtest.h>

#include <array>

namespace mvtp {
namespace {

constexpr int kDraws = 4000;

TEST(Draws, AWeightIsAShareOfTheDraws) {
  Draws draws(7);
  const std::array<double, 4> weights = {1.0, 0.0, 2.0, 1.0};
  std::array<int, 4> drawn = {};
  for (int k = 0; k < kDraws; ++k) ++drawn[draws.weighted(weights)];
  EXPECT_NEAR(drawn[0], kDraws / 4, 150);
  EXPECT_EQ(drawn[1], 0);
  EXPECT_NEAR(drawn[2], kDraws / 2, 150);
  EXPECT_NEAR(drawn[3], kDraws / 4, 150);
}

TEST(Draws, BothEndsOfARangeAreDrawn) {
  Draws draws(8);
  std::array<int, 3> drawn = {};
  for (int k = 0; k < kDraws; ++k) ++drawn.at(std::size_t(draws.between(-1, 1) + 1));
  for (const int count : drawn) EXPECT_NEAR(count, kDraws / 3, 150);
}

}  // namespace
}  // namespace mvtp
