#include "planner/problem/referee_protocol.hpp"

#include <gtest/gtest.h>

namespace mvtp::referee {
namespace {

TEST(Protocol, WhatLastsIsOneEntryOfItsWorstValues) {
  Protocol protocol;
  protocol.add(Rule::kArc, 1, 0, 3, 2.5, 0.2, 0.1);
  protocol.add(Rule::kArc, 1, 0, 4, 3.5, 0.1, 0.3);
  protocol.add(Rule::kArc, 2, 0, 4, 3.5, 0.1, 0.1);
  ASSERT_EQ(protocol.entries().size(), 2U);
  const Protocol::Entry entry = protocol.entries().front();
  EXPECT_EQ(entry.when, 2.5);
  EXPECT_EQ(entry.amount, 0.2);
  EXPECT_EQ(entry.turn, 0.3);
}

TEST(Protocol, APauseBeginsAnotherEntry) {
  Protocol protocol;
  protocol.add(Rule::kBounds, 0, 0, 1, 1.0, 0.1);
  protocol.add(Rule::kBounds, 0, 0, 3, 3.0, 0.1);
  EXPECT_EQ(protocol.entries().size(), 2U);
}

TEST(Protocol, WhoStandsStillGoesOnBreakingARule) {
  Protocol protocol;
  protocol.add(Rule::kBounds, 0, 0, 1, 1.0, 0.1);
  protocol.prolong(Rule::kBounds, 0, 0, 2);
  protocol.add(Rule::kBounds, 0, 0, 3, 3.0, 0.1);
  EXPECT_EQ(protocol.entries().size(), 1U);
}

}  // namespace
}  // namespace mvtp::referee
