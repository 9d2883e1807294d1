// Whose time counts for more.
#include "coordinator/junctions/priority.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

VehicleType type(const std::string& id, const std::string& vehicle_class) {
  VehicleType type = fake_type("car");
  type.id = id;
  type.vehicle_class = vehicle_class;
  return type;
}

TEST(Priority, IsThatOfEmergencyVehiclesAndBusesAndOfWhoIsNamed) {
  const Priority priority{.types = {"taxi"}};
  EXPECT_EQ(priority.kind_of(type("x", "emergency")), Priority::Kind::kEmergency);
  EXPECT_EQ(priority.kind_of(type("taxi", "passenger")), Priority::Kind::kEmergency);
  EXPECT_EQ(priority.kind_of(type("x", "bus")), Priority::Kind::kBus);
  EXPECT_EQ(priority.weight_of(type("x", "passenger")), 1.0);
  EXPECT_GT(priority.weight_of(type("x", "emergency")), priority.weight_of(type("x", "bus")));
}

/// The sum of the times at which trucks arrive [s].
double arrivals_of_trucks(unsigned seed, const std::set<std::string>& named) {
  const NetworkShape shape = crossroads_shape();
  CoordinatorOptions options;
  options.priority.types = named;
  ClosedLoop run(shape,
                 random_trips(shape, {.vehicles = 30,
                                      .duration = 30.0,
                                      .types = {"car", "car", "car", "truck"},
                                      .guests = false,
                                      .seed = seed}),
                 0.1, options);
  std::map<std::string, double> last_seen;
  while (run.traffic.running() && run.traffic.time() < 200.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      if (v.type == "truck") last_seen[v.id] = run.traffic.time();
    }
  }
  EXPECT_THAT(run.broken, testing::IsEmpty());
  double sum = 0.0;
  for (const auto& [id, time] : last_seen) sum += time;
  return sum;
}

TEST(Priority, LetsTrucksThroughEarlierWhenTheyHaveIt) {
  double without = 0.0;
  double with = 0.0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    without += arrivals_of_trucks(seed, {});
    with += arrivals_of_trucks(seed, {"truck"});
  }
  EXPECT_LT(with, without - 3.0);
}

}  // namespace
}  // namespace mvtp
