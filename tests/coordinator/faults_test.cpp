// Messages that are late or lost, noise, and vehicles that do not obey.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "coordinator/faults/faulty_traffic.hpp"
#include "coordinator/junctions/tolerate.hpp"
#include "planner/problem/input_error.hpp"
#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr double kStep = 0.1;
constexpr double kFront = 4.0;  ///< [m] of bodies ahead of the rear axle

CoordinatorOptions bearing(const FaultModel& declared, const RoadNetwork& network) {
  CoordinatorOptions options;
  tolerate(tolerance_of(declared, kStep, kFront), network, kStep, options);
  return options;
}

/// A run through the air.
struct FaultyRun {
  FaultyRun(const NetworkShape& shape, std::vector<FakeTrip> trips, const FaultPlan& plan,
            const FaultModel& declared)
      : world(shape.network, std::move(trips), kStep),
        air(world, plan),
        area(world.network()),
        coordinator(air, area, bearing(declared, shape.network)),
        audit(area, kStep) {
    simulation.add(coordinator);
    simulation.add(air.radio());
    simulation.add([this](const Snapshot& now) { audit.observe(now.time, now.vehicles); });
  }

  void run_until(double end) {
    while (world.running() && world.time() < end) simulation.step();
  }

  FakeTraffic world;
  FaultyTraffic air;
  DrivableArea area;
  Coordinator coordinator;
  Audit audit;
  Simulation simulation{world};
};

std::vector<FakeTrip> cars(const NetworkShape& shape, unsigned seed, int vehicles = 24) {
  return random_trips(shape, {.vehicles = vehicles, .guests = false, .seed = seed});
}

FaultModel messages(double delay, double loss) {
  return {.command = {delay, loss}, .report = {delay, loss}};
}

TEST(FaultTolerance, FollowsFromWhatIsDeclared) {
  const FaultTolerance none = tolerance_of({}, kStep, kFront);
  EXPECT_TRUE(none.exact);
  EXPECT_EQ(none.lead, 0);
  EXPECT_EQ(none.more.across, 0.0);

  EXPECT_EQ(tolerance_of(messages(0.5, 0.0), kStep, kFront).lead, 5);
  const FaultTolerance lossy = tolerance_of(messages(0.5, 0.3), kStep, kFront);
  EXPECT_EQ(lossy.lead, 5 + 11) << "0.3^12 < 1e-6";
  EXPECT_NEAR(lossy.age, 1.6, 1e-9);

  const FaultTolerance noisy = tolerance_of({.position = 0.2, .actuation = 0.1}, kStep, kFront);
  EXPECT_NEAR(noisy.more.along, 3 * (0.2 + 0.1), 1e-9) << "one drives, the other is seen";
  const FaultTolerance driven = tolerance_of({.actuation = 0.1}, kStep, kFront);
  EXPECT_NEAR(driven.more.along, 3 * (0.1 + 0.1), 1e-9) << "both drive";
}

TEST(Noise, HasTheDeviationAskedForAndABound) {
  Draws draws(5);
  Noise noise(0.98, 3.0, draws);
  double squares = 0.0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    noise.advance(draws);
    squares += noise.value() * noise.value();
    ASSERT_LE(std::abs(noise.value()), 3.0);
  }
  EXPECT_NEAR(std::sqrt(squares / kDraws), 1.0, 0.1);
}

// Few enough that rounding does not decide who goes first.
TEST(FaultyTraffic, WithoutFaultsIsTheTrafficItself) {
  const NetworkShape shape = crossroads_shape();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Demand demand{.vehicles = 8, .duration = 60.0, .seed = seed};
    FaultyRun through_air(shape, random_trips(shape, demand), {}, {});
    ClosedLoop direct(shape, random_trips(shape, demand));
    while (direct.traffic.running() && direct.traffic.time() < 90.0) {
      direct.step();
      through_air.simulation.step();
      const auto a = direct.traffic.vehicles();
      const auto b = through_air.world.vehicles();
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_LT(distance(a[i].pose, b[i].pose), 0.02)
            << a[i].id << " at " << direct.traffic.time() << ", seed " << seed;
      }
    }
  }
}

TEST(FaultyTraffic, RepeatsItselfForTheSameSeed) {
  const NetworkShape shape = crossroads_shape();
  const FaultModel model = {
      .command = {0.2, 0.3}, .report = {0.2, 0.3}, .position = 0.2, .actuation = 0.1};
  const auto poses = [&](std::uint64_t seed) {
    FaultyRun run(shape, cars(shape, 3), {.model = model, .seed = seed}, model);
    run.run_until(25.0);
    std::vector<Pose> all;
    for (const VehicleState& v : run.world.vehicles()) all.push_back(v.pose);
    return all;
  };
  EXPECT_EQ(poses(1), poses(1));
  EXPECT_NE(poses(1), poses(2));
}

class WithinWhatIsDeclared : public testing::TestWithParam<FaultModel> {};

TEST_P(WithinWhatIsDeclared, NobodyTouchesAndEverybodyArrives) {
  const NetworkShape shape = crossroads_shape(250.0);
  for (const unsigned seed : {1U, 2U}) {
    FaultyRun run(shape, cars(shape, seed), {.model = GetParam(), .seed = seed}, GetParam());
    run.run_until(300.0);
    EXPECT_EQ(run.audit.figures().overlap_pairs, 0) << "seed " << seed;
    EXPECT_EQ(run.world.arrived(), 24) << "seed " << seed;
    EXPECT_THAT(run.coordinator.losses(), IsEmpty());
  }
}

INSTANTIATE_TEST_SUITE_P(Models, WithinWhatIsDeclared,
                         testing::Values(messages(0.5, 0.0), messages(1.0, 0.0), messages(0.0, 0.3),
                                         messages(0.2, 0.1),
                                         FaultModel{.position = 0.2, .heading = 0.0175},
                                         FaultModel{.actuation = 0.1},
                                         FaultModel{.command = {0.3, 0.1},
                                                    .report = {0.3, 0.1},
                                                    .position = 0.2,
                                                    .heading = 0.0175,
                                                    .actuation = 0.1}));

// Plans that arrive later than was assumed are followed later.
TEST(UndeclaredLoss, IsNoticed) {
  const NetworkShape shape = crossroads_shape();
  FaultPlan plan{.model = messages(0.0, 0.0), .seed = 1};
  plan.model.command = {2.0, 0.0};
  FaultyRun run(shape, cars(shape, 3), plan, {});
  run.run_until(120.0);
  EXPECT_THAT(run.coordinator.losses(), Not(IsEmpty()));
}

class Disobedience : public testing::TestWithParam<VehicleFault::Kind> {};

// One of those who cross: the others notice that it is not where it should be, and keep clear.
TEST_P(Disobedience, IsNoticedAndKeptClearOf) {
  const NetworkShape shape = crossroads_shape();
  const std::vector<FakeTrip> trips = {{"a", 0.0, "W-C", "C-E"},
                                       {"b", 3.0, "W-C", "C-E"},
                                       {"c", 8.0, "S-C", "C-N"},
                                       {"d", 9.0, "E-C", "C-W"}};
  FaultPlan plan{.vehicles = {{.kind = GetParam(), .id = "b"}}, .stop_duration = 20.0, .seed = 1};
  FaultyRun run(shape, trips, plan, {});
  run.run_until(200.0);
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.world.arrived(), 4);
  ASSERT_THAT(run.air.figures().events, SizeIs(1));
  EXPECT_EQ(run.air.figures().events[0].vehicle, "b");
}

INSTANTIATE_TEST_SUITE_P(Kinds, Disobedience,
                         testing::Values(VehicleFault::Kind::kStops, VehicleFault::Kind::kIgnores));

TEST(StoppedVehicle, IsGivenUpAtOnceAndTakenBackByItsDriver) {
  const NetworkShape shape = crossroads_shape();
  FaultPlan plan{.vehicles = {{.kind = VehicleFault::Kind::kStops, .id = "a"}},
                 .stop_duration = 20.0};
  FaultyRun run(shape, {{"a", 0.0, "W-C", "C-E"}, {"b", 2.0, "S-C", "C-N"}}, plan, {});
  run.run_until(200.0);
  ASSERT_THAT(run.coordinator.losses(), SizeIs(1));
  const FaultEvent& lost = run.coordinator.losses()[0];
  const FaultEvent& stopped = run.air.figures().events[0];
  EXPECT_EQ(lost.vehicle, "a");
  EXPECT_LT(lost.time - stopped.time, 2.0);
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.world.arrived(), 2);
}

TEST(LateDecisions, CostTimeAndTouchNobody) {
  const NetworkShape shape = crossroads_shape();
  CoordinatorOptions options;
  options.late_share = 0.5;
  ClosedLoop run(shape, cars(shape, 4), kStep, options);
  run.run_until(300.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 24);
  const auto& replans = run.coordinator.replans();
  const auto late = std::ranges::count_if(replans, [](const Replan& r) { return r.fallback; });
  EXPECT_GT(double(late), 0.3 * double(replans.size()));
}

TEST(FaultyTraffic, EndsWhenItIsToldTo) {
  const NetworkShape shape = crossroads_shape();
  FaultyRun run(shape, cars(shape, 4), {.sumo_ends = 5.0}, {});
  run.run_until(4.9);
  EXPECT_THROW(run.run_until(6.0), InputError);
  EXPECT_NEAR(run.world.time(), 5.0, 0.11);
}

}  // namespace
}  // namespace mvtp
