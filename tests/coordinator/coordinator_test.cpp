#include "coordinator/coordinator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "coordinator/audit.hpp"
#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

const std::vector<std::string> kArms = {"W", "S", "E", "N"};

/// Poisson arrivals on every arm: 30 / 50 / 20 % left / straight on / right.
std::vector<FakeTrip> random_trips(double per_hour_and_arm, double duration, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<FakeTrip> trips;
  for (std::size_t k = 0; k < 4; ++k) {
    std::exponential_distribution<double> gap(per_hour_and_arm / 3600.0);
    std::discrete_distribution<std::size_t> turn({0.2, 0.5, 0.3});
    for (double t = gap(random); t < duration; t += gap(random)) {
      const std::size_t to = (k + 1 + turn(random)) % 4;
      trips.push_back(
          {kArms[k] + std::to_string(trips.size()), t, kArms[k] + "_in", kArms[to] + "_out"});
    }
  }
  return trips;
}

/// A whole run of the closed loop on the fake crossroads, audited at every step.
struct ClosedLoop {
  explicit ClosedLoop(std::vector<FakeTrip> trips, const CoordinatorOptions& options = {},
                      const ZoneOptions& zone_options = {})
      : number_of_trips(int(trips.size())),
        traffic(make_crossroads(), std::move(trips)),
        area(traffic.network()),
        zone(traffic.network(), area, {"C"}, zone_options),
        coordinator(traffic, zone, options),
        audit(area, traffic.step_length()),
        car(traffic.type("car")) {
    coordinator.prepare();
  }

  void step() {
    coordinator.step();
    std::vector<Sighting> sightings;
    for (const VehicleState& v : traffic.vehicles()) {
      sightings.push_back({&v, &car, coordinator.drives(v.id)});
    }
    audit.observe(traffic.time(), sightings);
  }

  void run_until(double end) {
    while (traffic.running() && traffic.time() < end) step();
  }

  int number_of_trips;
  FakeTraffic traffic;
  DrivableArea area;
  Zone zone;
  Coordinator coordinator;
  Audit audit;
  VehicleType car;
};

TEST(Coordinator, EverybodyCrossesWithoutTouching) {
  ClosedLoop run(random_trips(400.0, 300.0, 1));
  run.run_until(600.0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.audit.figures().off_road_steps, 0);
  EXPECT_EQ(run.audit.figures().accel_violations, 0);
  EXPECT_LE(run.audit.figures().max_curvature_ratio, 1.0);
  EXPECT_LE(run.audit.figures().max_jump, 0.05);
}

}  // namespace
}  // namespace mvtp
