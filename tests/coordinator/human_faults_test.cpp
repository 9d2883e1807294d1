#include "coordinator/drivers/human_faults.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

/// Notes who is told to misbehave.
class ToldTraffic : public FakeTraffic, public HumanFaultPort {
 public:
  using FakeTraffic::FakeTraffic;
  void let_through(const std::string& id, Passage passage) override {
    FakeTraffic::let_through(id, passage);
    (passage != Passage::kNone ? told : told_off).insert(id);
  }
  void cap_speed(const std::string& id, double speed) override {
    (speed < 1.0 ? told : told_off).insert(id);
  }
  void swerve(const std::string& id) override { told.insert(id); }
  void react_late(const std::string& id, double seconds) override {
    (seconds > 0.0 ? told : told_off).insert(id);
  }
  std::set<std::string> told, told_off;
};

class Faults : public testing::Test {
 protected:
  static std::vector<FakeTrip> trips() {
    std::vector<FakeTrip> trips;
    for (int i = 0; i < 40; ++i) trips.push_back({fmt::format("v{}", i), 4.0 * i, "W-C", "C-E"});
    return trips;
  }
  const std::vector<HumanFault>& run(HumanFaultOptions options) {
    options.lanes = {"W-C_0"};
    traffic = std::make_unique<ToldTraffic>(crossroads_shape().network, trips());
    faults = std::make_unique<HumanFaults>(*traffic, *traffic, options);
    while (traffic->running() && traffic->time() < 300.0) {
      faults->decide();
      traffic->step();
    }
    return faults->faults();
  }
  std::unique_ptr<ToldTraffic> traffic;
  std::unique_ptr<HumanFaults> faults;
};

TEST_F(Faults, AShareOfTheHumanDriversMisbehaveOnceEach) {
  const auto& some = run({.rate = 0.5, .humans = {.penetration = 0.0}});
  EXPECT_GT(some.size(), 10U);
  EXPECT_LT(some.size(), 30U);
  std::set<std::string> who;
  std::set<HumanFaultKind> kinds;
  for (const HumanFault& fault : some) {
    who.insert(fault.vehicle);
    kinds.insert(fault.kind);
  }
  EXPECT_EQ(who.size(), some.size());
  EXPECT_EQ(traffic->told, who);
  EXPECT_EQ(kinds.size(), 4U);
}

TEST_F(Faults, AnotherSeedDrawsOthers) {
  std::vector<std::string> first;
  for (const HumanFault& f : run({.rate = 0.5, .seed = 1, .humans = {.penetration = 0.0}})) {
    first.push_back(f.vehicle);
  }
  std::vector<std::string> second;
  for (const HumanFault& f : run({.rate = 0.5, .seed = 2, .humans = {.penetration = 0.0}})) {
    second.push_back(f.vehicle);
  }
  EXPECT_NE(first, second);
}

TEST_F(Faults, NobodyWhoIsAutomatedMisbehaves) {
  EXPECT_THAT(run({.rate = 1.0, .humans = {.penetration = 1.0}}), testing::IsEmpty());
}

TEST_F(Faults, AreOverAfterAWhile) {
  const auto& all = run({.rate = 1.0, .humans = {.penetration = 0.0}});
  EXPECT_EQ(all.size(), 40U);
  // Those who swerve need not be told; some leave the road before it is over.
  EXPECT_GT(traffic->told_off.size(), 5U);
}

}  // namespace
}  // namespace mvtp
