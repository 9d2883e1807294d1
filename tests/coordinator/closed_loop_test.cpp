#include "tests/coordinator/closed_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace mvtp {
namespace {

using testing::Combine;
using testing::IsEmpty;
using testing::Range;
using testing::Values;

/// Shape, seed, step length [s].
using Run = std::tuple<std::size_t, unsigned, double>;

std::string name_of(const std::vector<NamedShape>& shapes, const Run& run) {
  const auto& [shape, seed, step_length] = run;
  return shapes[shape].name + "_seed_" + std::to_string(seed) + "_step_" +
         std::to_string(int(100.0 * step_length)) + "cs";
}

/// Everything that holds in every run, whoever drives.
void expect_laws(ClosedLoop& run) {
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.audit.figures().overlap_pairs_coordinated, 0);
  EXPECT_LE(run.audit.figures().max_curvature_ratio, 1.0);
  if (run.traffic.step_length() > 0.25) return;  // there speeds say little about places
  EXPECT_EQ(run.audit.figures().accel_violations, 0);
  EXPECT_LE(run.audit.figures().max_jump, 0.05);
  if (!testing::Test::HasFailure()) return;
  for (const AuditEvent& e : run.audit.events()) ADD_FAILURE() << e.time << " s: " << e.what;
}

/// Where plans reach to the hand-back, nobody has to brake hard behind it.
void expect_gentle_handbacks(const ClosedLoop& run) {
  if (run.traffic.step_length() > 0.25) return;
  EXPECT_EQ(run.audit.figures().hard_brakings_after_handback, 0);
}

class CarsOnly : public testing::TestWithParam<Run> {};

TEST_P(CarsOnly, ArriveWithoutContact) {
  const auto& [number, seed, step_length] = GetParam();
  const NetworkShape shape = all_shapes()[number].make();
  ClosedLoop run(shape, random_trips(shape, {.seed = seed}), step_length);
  run.run_until(300.0);
  expect_laws(run);
  expect_gentle_handbacks(run);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
  EXPECT_GT(run.taken_over, run.number_of_trips / 2);
}

INSTANTIATE_TEST_SUITE_P(Shapes, CarsOnly,
                         Combine(Range(std::size_t{0}, all_shapes().size()), Values(1U, 2U),
                                 Values(0.1, 0.25, 1.0)),
                         [](const auto& run) { return name_of(all_shapes(), run.param); });

std::size_t number_of(const std::string& shape) {
  return std::size_t(std::ranges::find(all_shapes(), shape, &NamedShape::name) -
                     all_shapes().begin());
}

// Some leave the network within the metres that they would brake in.
INSTANTIATE_TEST_SUITE_P(ShortArms, CarsOnly,
                         Combine(Values(number_of("short_arms")), Values(4U, 7U, 18U),
                                 Values(0.25)),
                         [](const auto& run) { return name_of(all_shapes(), run.param); });

class CarsBusesAndTrucks : public testing::TestWithParam<Run> {};

TEST_P(CarsBusesAndTrucks, ArriveWithoutContact) {
  const auto& [number, seed, step_length] = GetParam();
  const NetworkShape shape = roomy_shapes()[number].make();
  const Demand demand{.types = {"car", "car", "bus", "truck"}, .guests = false, .seed = seed};
  ClosedLoop run(shape, random_trips(shape, demand), step_length);
  run.run_until(300.0);
  expect_laws(run);
  expect_gentle_handbacks(run);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

INSTANTIATE_TEST_SUITE_P(ShortSteps, CarsBusesAndTrucks,
                         Combine(Range(std::size_t{0}, roomy_shapes().size()), Values(3U),
                                 Values(0.1)),
                         [](const auto& run) { return name_of(roomy_shapes(), run.param); });
INSTANTIATE_TEST_SUITE_P(LongSteps, CarsBusesAndTrucks,
                         Combine(Range(std::size_t{0}, roomy_shapes().size()), Values(4U, 5U),
                                 Values(0.25)),
                         [](const auto& run) { return name_of(roomy_shapes(), run.param); });

/// PBCR alone is safe in whatever traffic; so few vehicles also arrive.
class PbcrAlone : public testing::TestWithParam<unsigned> {};

TEST_P(PbcrAlone, TouchesNobody) {
  const NetworkShape shape = crossroads_shape();
  CoordinatorOptions options;
  options.escot.plans_groups = false;
  const unsigned seed = GetParam();
  ClosedLoop sparse(shape, random_trips(shape, {.vehicles = 8, .seed = seed}), 0.1, options);
  sparse.run_until(200.0);
  expect_laws(sparse);
  EXPECT_EQ(sparse.traffic.arrived(), sparse.number_of_trips);
  EXPECT_TRUE(std::ranges::none_of(sparse.coordinator.replans(), [](const Replan& r) {
    return r.stepped < r.vehicles - r.newcomers;
  })) << "nobody has a complete plan";

  const Demand dense{.vehicles = 40, .duration = 30.0, .seed = seed};
  ClosedLoop crowd(shape, random_trips(shape, dense), 0.1, options);
  crowd.run_until(120.0);
  expect_laws(crowd);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PbcrAlone, Range(1U, 7U));

TEST(Takeover, BeginsWhereTheVehicleIs) {
  const NetworkShape shape = crossroads_shape();
  std::vector<FakeTrip> trips = random_trips(shape, {.vehicles = 12, .seed = 9});
  for (std::size_t i = 0; i < trips.size(); ++i) trips[i].aside = 0.1 * double(i % 7) - 0.3;
  ClosedLoop run(shape, trips);
  run.run_until(200.0);
  expect_laws(run);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
  EXPECT_EQ(run.taken_over, run.number_of_trips);
}

}  // namespace
}  // namespace mvtp
