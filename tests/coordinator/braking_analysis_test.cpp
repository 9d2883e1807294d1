#include "coordinator/drivers/braking_analysis.hpp"

#include <gtest/gtest.h>

#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

constexpr double kStep = 0.1;  ///< [s]

///  ours ---->        | where a human driver stands across its path from `human_comes` [s] on
class OursAndAHuman : public testing::Test {
 protected:
  /// Drives ours at `speed` towards x = 60 m until the two overlap.
  HumanOverlap drive(double speed, double human_comes, const std::vector<HumanFault>& faults) {
    VehicleType type;
    type.body.max_decel = 4.5;
    const FakeTraffic traffic(crossroads_shape().network, {});
    const DrivableArea area(traffic.network());
    Audit audit(area, kStep);
    BrakingAnalysis analysis(kStep);
    for (int k = 0; analysis.overlaps().empty() && k < 200; ++k) {
      const double t = kStep * k;
      VehicleState ours{.id = "ours", .pose = {speed * t, 0.0, 0.0}, .speed = speed};
      VehicleState human{.id = "human", .pose = {60.0, t < human_comes ? -50.0 : 0.0, 1.57}};
      const std::vector<Observation> observations = {{&human, &type, false}, {&ours, &type, true}};
      audit.observe(t, observations);
      analysis.observe(t, observations, faults, audit.events());
    }
    EXPECT_EQ(analysis.overlaps().size(), 1U);
    return analysis.overlaps().empty() ? HumanOverlap{} : analysis.overlaps().front();
  }
};

TEST_F(OursAndAHuman, WhoCouldHaveStoppedCouldHaveAvoidedIt) {
  const HumanOverlap overlap = drive(10.0, 0.0, {{"human", HumanFaultKind::kDeadStop, 1.0}});
  EXPECT_EQ(overlap.controlled, "ours");
  EXPECT_EQ(overlap.human, "human");
  EXPECT_EQ(overlap.fault, "dead stop");
  EXPECT_NEAR(overlap.seen_since, 1.1, 1e-9);
  EXPECT_NEAR(overlap.time, 5.6, 0.3);
  EXPECT_TRUE(overlap.avoidable);
}

TEST_F(OursAndAHuman, WhoWasTooNearWhenTheFaultShowedCouldNot) {
  const HumanOverlap overlap = drive(10.0, 5.4, {{"human", HumanFaultKind::kRedRunner, 5.3}});
  EXPECT_EQ(overlap.fault, "red-runner");
  EXPECT_FALSE(overlap.avoidable);
}

/// A human who crosses the path at 60 m/s is across it at no step.
TEST(TwoThatMeet, BetweenTheStepsAreJudgedToo) {
  VehicleType type;
  type.body.max_decel = 4.5;
  const FakeTraffic traffic(crossroads_shape().network, {});
  const DrivableArea area(traffic.network());
  Audit audit(area, kStep);
  BrakingAnalysis analysis(kStep);
  for (int k = 0; k < 3; ++k) {
    const VehicleState ours{.id = "ours", .pose = {k * 0.1, 0.0, 0.0}, .speed = 1.0};
    const VehicleState human{.id = "human", .pose = {3.5, -10.0 + 6.0 * k, 1.57}, .speed = 60.0};
    const std::vector<Observation> observations = {{&human, &type, false}, {&ours, &type, true}};
    audit.observe(kStep * k, observations);
    analysis.observe(kStep * k, observations, {}, audit.events());
  }
  EXPECT_EQ(analysis.overlaps().size(), std::size_t(audit.figures().overlap_pairs_coordinated));
  ASSERT_EQ(analysis.overlaps().size(), 1U);
  EXPECT_FALSE(analysis.overlaps().front().avoidable);
}

TEST_F(OursAndAHuman, AFaultThatBeganLaterIsNotTheCause) {
  const HumanOverlap overlap = drive(10.0, 0.0, {{"human", HumanFaultKind::kSwerve, 100.0}});
  EXPECT_EQ(overlap.fault, "");
  EXPECT_TRUE(overlap.avoidable);
}

}  // namespace
}  // namespace mvtp
