// What goes wrong around the coordinator: a dead planner, vehicles that vanish, plans refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;

std::vector<FakeTrip> cars(const NetworkShape& shape, unsigned seed, int vehicles = 24) {
  return random_trips(shape, {.vehicles = vehicles, .seed = seed});
}

/// The first vehicle under control; empty if there is none.
std::string somebody_driven(const ClosedLoop& run) {
  return run.coordinator.driven().empty() ? "" : run.coordinator.driven().begin()->first;
}

TEST(Threads, DoNotChangeWhereAnybodyIs) {
  const NetworkShape shape = grid_shape();
  CoordinatorOptions one;
  one.escot.threads = 1;
  CoordinatorOptions four;
  four.escot.threads = 4;
  four.escot.pairs_for_threads = 0;
  ClosedLoop a(shape, cars(shape, 7, 40), 0.1, one);
  ClosedLoop b(shape, cars(shape, 7, 40), 0.1, four);
  while (a.traffic.running() && a.traffic.time() < 60.0) {
    a.step();
    b.step();
    ASSERT_EQ(a.traffic.vehicles().size(), b.traffic.vehicles().size());
    for (std::size_t i = 0; i < a.traffic.vehicles().size(); ++i) {
      ASSERT_EQ(a.traffic.vehicles()[i].pose, b.traffic.vehicles()[i].pose);
      ASSERT_EQ(a.traffic.vehicles()[i].speed, b.traffic.vehicles()[i].speed);
    }
  }
  const auto groups = [](const ClosedLoop& run) {
    return std::ranges::count_if(run.coordinator.replans(),
                                 [](const Replan& r) { return r.groups > 1; });
  };
  EXPECT_GT(groups(a), 10) << "there has to be something to do for more than one thread";
}

/// Shape, and when the planner dies [s].
class DeadPlanner : public testing::TestWithParam<double> {};

TEST_P(DeadPlanner, LeavesAChainOfJunctionsToTheDriversAndTrafficFlowsOn) {
  CoordinatorOptions options;
  options.replan_budget_ms = 0.0;
  options.budget_from = GetParam();
  const NetworkShape shape = chain_shape();
  ClosedLoop run(shape, cars(shape, 3), 0.1, options);
  run.run_until(options.budget_from);
  const std::size_t driven = run.coordinator.driven().size();
  ASSERT_GT(driven, 0U);
  run.run_until(options.budget_from + 60.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_THAT(run.coordinator.driven(), IsEmpty()) << "each has finished its corridor";
  for (const VehicleState& v : run.traffic.vehicles()) EXPECT_FALSE(run.traffic.is_held(v.id));
  run.run_until(options.budget_from + 300.0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

INSTANTIATE_TEST_SUITE_P(At, DeadPlanner, testing::Values(12.0, 20.0, 28.0));

class VanishingVehicles : public testing::TestWithParam<std::size_t> {};

TEST_P(VanishingVehicles, AreForgottenAndTheOthersArrive) {
  const NetworkShape shape = all_shapes()[GetParam()].make();
  ClosedLoop run(shape, cars(shape, 5));
  int vanished = 0;
  for (int step = 0; run.traffic.running() && run.traffic.time() < 250.0; ++step) {
    run.step();
    const std::string id = somebody_driven(run);
    if (step % 37 != 0 || id.empty()) continue;
    run.traffic.remove(id);
    ++vanished;
    run.step();
    EXPECT_FALSE(run.coordinator.drives(id));
  }
  EXPECT_GT(vanished, 3);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived() + vanished, run.number_of_trips);
}

INSTANTIATE_TEST_SUITE_P(Shapes, VanishingVehicles, testing::Values(0, 1, 4, 5),
                         [](const auto& shape) { return all_shapes()[shape.param].name; });

// The traffic takes a vehicle off the road for one step and puts it at the begin of its route.
TEST(VanishingVehicle, IsANewcomerWhenItComesBack) {
  const NetworkShape shape = crossroads_shape();
  std::vector<FakeTrip> trips = {{"a", 0.0, "W-C", "C-N"}, {"b", 0.5, "S-C", "C-W"}};
  ClosedLoop run(shape, trips);
  while (!run.coordinator.drives("a")) run.step();
  for (int i = 0; i < 20; ++i) run.step();
  ASSERT_TRUE(run.coordinator.drives("a"));
  run.traffic.remove("a");
  run.step();
  EXPECT_FALSE(run.coordinator.drives("a"));
  trips[0].depart = 0.0;
  run.traffic.add(trips[0]);
  run.run_until(120.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 2);
  EXPECT_EQ(run.taken_over, 3);
}

// Between two steps another vehicle takes the place of one under control, and its name.
TEST(VanishingVehicle, MayBeReplacedWithinAStep) {
  const NetworkShape shape = crossroads_shape();
  std::vector<FakeTrip> trips = {{"a", 0.0, "W-C", "C-N"}, {"b", 0.5, "S-C", "C-W"}};
  ClosedLoop run(shape, trips);
  while (!run.coordinator.drives("a")) run.step();
  for (int i = 0; i < 20; ++i) run.step();
  run.traffic.remove("a");
  trips[0].depart = 0.0;
  run.traffic.add(trips[0]);
  run.traffic.insert_now();
  ASSERT_FALSE(run.traffic.is_taken_over("a"));
  run.step();
  EXPECT_FALSE(run.coordinator.drives("a"));
  run.run_until(120.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 2);
}

// A vehicle that breaks down behind its hand-back blocks one exit; everybody else gets on.
TEST(BrokenDownVehicle, BlocksItsOwnExitOnly) {
  const NetworkShape shape = chain_shape();
  std::vector<FakeTrip> trips;
  for (int i = 0; i < 6; ++i) {
    const std::string n(1, char('0' + i));
    trips.push_back({"w" + n, 3.0 * i, "W-A", "B-E"});
    trips.push_back({"n" + n, 3.0 * i + 1.0, "NA-A", "A-W"});
  }
  ClosedLoop run(shape, trips);
  while (run.traffic.running() && run.traffic.time() < 90.0) {
    run.step();
    for (const std::string& id : run.coordinator.handed_back()) {
      if (id == "w0") run.traffic.freeze("w0");
    }
  }
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 6) << "those from the north";
}

TEST(ScheduledStops, AreMadeBeforeTheLineAndBehindIt) {
  const NetworkShape shape = crossroads_shape();
  std::vector<FakeTrip> trips = {{"before", 0.0, "W-C", "C-E"},
                                 {"behind", 0.0, "S-C", "C-N"},
                                 {"other", 2.0, "E-C", "C-S"},
                                 {"follows", 4.0, "S-C", "C-N"}};
  trips[0].stop = FakeStop{"W-C_0", 70.0, 20.0};
  trips[1].stop = FakeStop{"C-N_0", 70.0, 20.0};
  ClosedLoop run(shape, trips);
  bool stood_before = false;
  bool stood_behind = false;
  while (run.traffic.running() && run.traffic.time() < 150.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      if (!v.halted_by_stop) continue;
      EXPECT_FALSE(run.coordinator.drives(v.id));
      stood_before = stood_before || v.id == "before";
      stood_behind = stood_behind || v.id == "behind";
    }
  }
  EXPECT_TRUE(stood_before);
  EXPECT_TRUE(stood_behind);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 4);
}

/// Does not say where vehicles stop, only that they stand there: as for a stop that has lasted
/// longer than was planned.
class SilentTraffic : public FakeTraffic {
 public:
  using FakeTraffic::FakeTraffic;
  [[nodiscard]] std::optional<Stop> next_stop(const std::string& /*id*/) const override {
    return std::nullopt;
  }
};

TEST(ScheduledStops, AreNotCutShort) {
  FakeTrip trip{.id = "bus", .from = "W-C", .to = "C-E"};
  trip.stop = FakeStop{"W-C_0", 60.0, 15.0};
  trip.at = std::pair{60.0, 0.0};
  SilentTraffic traffic(crossroads_shape().network, {trip});
  const DrivableArea area(traffic.network());
  Coordinator coordinator(traffic, area, {});
  Simulation simulation(traffic);
  simulation.add(coordinator);
  int stood = 0;
  bool driven = false;
  while (traffic.running() && traffic.time() < 100.0) {
    const bool stands = !traffic.vehicles().empty() && traffic.vehicles()[0].halted_by_stop;
    simulation.step();
    driven = driven || coordinator.drives("bus");
    if (!stands) continue;
    ++stood;
    EXPECT_FALSE(coordinator.drives("bus"));
  }
  EXPECT_GE(stood, 149);
  EXPECT_TRUE(driven);
  EXPECT_EQ(traffic.arrived(), 1);
}

// Too fast and too near behind a bus that turns: in every plan for both they touch. The newcomer
// keeps its driver, who brakes harder than a plan may, and is taken over when there is a plan.
TEST(RefusedNewcomer, KeepsItsDriverAndIsTakenOverLater) {
  const NetworkShape shape = crossroads_shape(120.0, 13.0);
  ClosedLoop run(shape, {{"bus", 0.0, "W-C", "C-S", "bus"}});
  const auto front_of = [&](const std::string& id) {
    const auto v = std::ranges::find(run.traffic.vehicles(), id, &VehicleState::id);
    return v == run.traffic.vehicles().end() ? 0.0 : v->lane_position;
  };
  while (front_of("bus") < 88.0) run.step();
  ASSERT_TRUE(run.coordinator.drives("bus"));
  FakeTrip late{.id = "late", .depart = 0.0, .from = "W-C", .to = "C-E"};
  late.at = std::pair{front_of("bus") - 12.0 - 1.0, 13.89};
  run.traffic.add(late);
  run.traffic.insert_now();
  const std::size_t decisions = run.coordinator.replans().size();
  while (run.coordinator.replans().size() == decisions) run.step();
  EXPECT_FALSE(run.coordinator.drives("late"));
  EXPECT_TRUE(run.coordinator.drives("bus")) << "it goes on with its plan";
  while (run.traffic.time() < 60.0 && !run.coordinator.drives("late")) run.step();
  EXPECT_TRUE(run.coordinator.drives("late"));
  run.run_until(120.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 2);
}

//   =============== car -->            The car has to change to the right lane, where a bus stands.
//   =============== [ bus ] =====|     Braking at once on the path of the change it would hit it.
TEST(LateNewcomer, StaysInItsLaneBesideWhoStandsInTheOther) {
  FakeTrip bus{.id = "bus", .from = "W-C", .to = "C-E", .type = "bus"};
  bus.stop = FakeStop{"W-C_0", 92.0, 20.0};
  bus.at = std::pair{92.0, 0.0};
  FakeTrip car{.id = "car", .depart = 1.0, .from = "W-C", .to = "C-E", .lane = 1};
  car.at = std::pair{66.0, 13.0};
  ClosedLoop run(two_lanes_shape(), {bus, car});
  run.run_until(1.6);
  EXPECT_FALSE(run.coordinator.drives("car"));
  run.run_until(120.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 2);
}

/// What a driver who gets his vehicle back sees ahead.
struct HandBack {
  double time = 0.0;
  double position = 0.0;  ///< [m] on its lane
  double missing = 0.0;   ///< [m] of room to the one ahead
};

/// The first hand-back of "car".
HandBack first_hand_back(const std::vector<FakeTrip>& trips) {
  ClosedLoop run(crossroads_shape(), trips);
  while (run.traffic.running() && run.traffic.time() < 60.0) {
    run.step();
    if (std::ranges::count(run.coordinator.handed_back(), "car") == 0) continue;
    const auto state = [&](const std::string& id) {
      return std::ranges::find(run.traffic.vehicles(), id, &VehicleState::id);
    };
    const auto car = state("car");
    HandBack seen{.time = run.traffic.time(), .position = car->lane_position};
    const auto other = state("other");
    if (other == run.traffic.vehicles().end() || other->lane != car->lane) return seen;
    const VehicleType type = fake_type("car");
    const double gap = other->lane_position - car->lane_position - fake_type("bike").body.length();
    const double braking = stopping_distance(car->speed, type.body.max_decel) -
                           stopping_distance(other->speed, fake_type("bike").body.max_decel);
    seen.missing = type.min_gap + type.tau * car->speed + std::max(0.0, braking) - gap;
    return seen;
  }
  return {};
}

// A slow one turns up ahead just before the hand-back: the car is driven on until there is room.
TEST(HandBacks, WaitUntilTheDriverHasRoom) {
  const FakeTrip car{"car", 0.0, "W-C", "C-E"};
  const HandBack alone = first_hand_back({car});
  ASSERT_GT(alone.time, 1.0);
  FakeTrip slow{"other", alone.time - 0.3, "C-E", "C-E", "bike"};
  slow.at = {alone.position + 16.0, 4.0};
  const HandBack behind = first_hand_back({car, slow});
  ASSERT_GT(behind.time, 1.0);
  EXPECT_GT(behind.time, alone.time + 0.25);
  EXPECT_LT(behind.missing, 1.0);
}

}  // namespace
}  // namespace mvtp
