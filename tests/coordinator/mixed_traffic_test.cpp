// Human drivers and vehicles under control together: laws over penetration and seed.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "coordinator/drivers/human_drivers.hpp"
#include "tests/coordinator/closed_loop.hpp"
#include "tests/coordinator/mixed_loop.hpp"

namespace mvtp {
namespace {

using testing::Combine;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Range;
using testing::Values;

/// Penetration, instant lights, seed.
using Mix = std::tuple<double, bool, unsigned>;
class MixedTraffic : public testing::TestWithParam<Mix> {};

TEST_P(MixedTraffic, ArrivesWithoutContact) {
  const auto& [penetration, instant, seed] = GetParam();
  const SignalTiming timing = instant ? SignalTiming::instant() : SignalTiming::real();
  ClosedLoop run = loop(cars(seed), share(penetration, timing));
  run.run_until(600.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
  EXPECT_GT(run.coordinator.humans()->greens(), 0);
  EXPECT_EQ(run.coordinator.humans()->unplanned_passages(), 0);
}

/// The same at a signal whose program is known: its phases are shown.
class PhasedTraffic : public testing::TestWithParam<std::tuple<double, unsigned>> {};

TEST_P(PhasedTraffic, ArrivesWithoutContact) {
  const auto& [penetration, seed] = GetParam();
  ClosedLoop run(crossroads_with_phases(), cars(seed), 0.1, share(penetration));
  run.run_until(600.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
  EXPECT_EQ(run.coordinator.humans()->unplanned_passages(), 0);
}

/// Vehicles under control that stand on the junction, and for how many steps they have.
void count_standing_inside(const ClosedLoop& run, std::map<std::string, int>& steps) {
  std::map<std::string, int> now;
  for (const VehicleState& v : run.traffic.vehicles()) {
    const bool stands = run.traffic.is_taken_over(v.id) && v.speed == 0.0 && v.lane.front() == ':';
    if (stands) now[v.id] = steps[v.id] + 1;
  }
  steps = std::move(now);
}

/// More than the junction lets through as they come: queues with left-turners on a single lane.
class QueuedTraffic : public testing::TestWithParam<std::tuple<double, unsigned>> {};

TEST_P(QueuedTraffic, NeverWaitsInsideAndFlows) {
  const auto& [penetration, seed] = GetParam();
  const NetworkShape shape = crossroads_with_phases();
  std::vector<FakeTrip> trips =
      random_trips(shape, {.vehicles = 60, .duration = 90.0, .seed = seed});
  ClosedLoop run(shape, std::move(trips), 0.1, share(penetration));
  std::map<std::string, int> standing;
  int longest = 0;
  while (run.traffic.time() < 180.0 && run.traffic.arrived() < run.number_of_trips) {
    run.step();
    count_standing_inside(run, standing);
    for (const auto& [id, steps] : standing) longest = std::max(longest, steps);
  }
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
  EXPECT_LE(longest, 5);  // one decision
}

INSTANTIATE_TEST_SUITE_P(Seeds, QueuedTraffic, Combine(Values(0.3, 0.5, 0.7), Range(1U, 4U)));

INSTANTIATE_TEST_SUITE_P(Seeds, PhasedTraffic, Combine(Values(0.0, 0.3, 0.7), Range(1U, 4U)));

std::string name_of(const testing::TestParamInfo<Mix>& info) {
  const bool instant = std::get<1>(info.param);
  return fmt::format("p{}_{}_seed_{}", int(100 * std::get<0>(info.param)),
                     instant ? "instant" : "real", std::get<2>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Seeds, MixedTraffic,
                         Combine(Values(0.0, 0.3, 0.7), Values(false, true), Range(1U, 5U)),
                         name_of);

/// Penetration, seed.
class BlackOut : public testing::TestWithParam<std::tuple<double, unsigned>> {};

TEST_P(BlackOut, LeavesNoContactAndTrafficFlowsAgain) {
  const auto& [penetration, seed] = GetParam();
  CoordinatorOptions options = share(penetration);
  options.replan_budget_ms = 0.0;
  options.budget_from = 20.0;
  ClosedLoop run = loop(cars(seed), options);
  run.run_until(600.0);
  // Who has come to rest inside the junction is handed back there.
  EXPECT_THAT(run.broken, Each(HasSubstr("is handed back")));
  EXPECT_EQ(run.audit.figures().overlap_pairs_coordinated, 0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

INSTANTIATE_TEST_SUITE_P(Seeds, BlackOut, Combine(Values(0.3, 0.7), Range(1U, 7U)));

}  // namespace
}  // namespace mvtp
