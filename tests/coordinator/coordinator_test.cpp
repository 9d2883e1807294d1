#include "coordinator/junctions/coordinator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "coordinator/audit/audit.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "planner/problem/input_error.hpp"
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
  explicit ClosedLoop(std::vector<FakeTrip> trips, const CoordinatorOptions& options = {})
      : number_of_trips(int(trips.size())),
        traffic(make_crossroads(), std::move(trips)),
        area(traffic.network()),
        coordinator(traffic, area, options),
        audit(area, traffic.step_length()),
        car(traffic.type("car")) {
    simulation.add(coordinator);
  }

  void step() {
    simulation.step();
    std::vector<Observation> observations;
    for (const VehicleState& v : traffic.vehicles()) {
      observations.push_back({&v, &car, coordinator.drives(v.id)});
    }
    audit.observe(traffic.time(), observations);
  }

  /// A step after which this vehicle, once its driver has it again, stands still.
  void step_freezing(const std::string& id) {
    step();
    if (std::ranges::count(coordinator.handed_back(), id) > 0) traffic.freeze(id);
  }

  void run_until(double end) {
    while (traffic.running() && traffic.time() < end) step();
  }

  int number_of_trips;
  FakeTraffic traffic;
  DrivableArea area;
  Coordinator coordinator;
  Simulation simulation{traffic};
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

/// The true bodies of all vehicles under control, `tau` seconds after everyone began to brake.
double least_clearance_while_braking(const ClosedLoop& run, double tau) {
  const RoadScene scene = run.coordinator.scene();
  std::vector<Pose> poses;
  for (const RoadVehicle& v : scene.vehicles) {
    const double s = braked_position(v.now, scene.body(v).max_decel, tau);
    poses.push_back(scene.library->path(v.path).at(s));
  }
  double least = 1e9;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      least = std::min(least, clearance(poses[i], run.car.body, poses[j], run.car.body));
    }
  }
  return least;
}

TEST(Coordinator, EverybodyBrakesNowIsSafeAtEveryDecision) {
  ClosedLoop run(random_trips(600.0, 100.0, 2));
  for (int step = 0; run.traffic.running() && run.traffic.time() < 300.0; ++step) {
    run.step();
    if (step % 5 != 0) continue;  // a decision was taken before this step
    for (double tau = 0.0; tau < 4.0; tau += 0.1) {
      ASSERT_GT(least_clearance_while_braking(run, tau), 0.0) << "at t = " << run.traffic.time();
    }
  }
}

TEST(Coordinator, WhatIsExecutedLeadsEverybodyOutOfTheZone) {
  ClosedLoop run(random_trips(600.0, 100.0, 3));
  while (run.traffic.running() && run.traffic.time() < 300.0) {
    run.step();
    const RoadScene scene = run.coordinator.scene();
    for (const RoadVehicle& v : scene.vehicles) {
      const SpeedProfile* t = run.coordinator.plan().find(v.key);
      ASSERT_NE(t, nullptr);
      ASSERT_TRUE(t->complete);
      ASSERT_GE(t->states.back().s, v.s_end);
    }
  }
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

TEST(Coordinator, WithADeadPlannerTheVehiclesUnderControlFinishAndOthersStayOut) {
  CoordinatorOptions options;
  options.replan_budget_ms = 0.0;
  options.budget_from = 60.0;
  ClosedLoop run(random_trips(400.0, 80.0, 4), options);
  run.run_until(60.0);
  ASSERT_FALSE(run.coordinator.driven().empty());
  while (!run.coordinator.driven().empty() && run.traffic.time() < 120.0) run.step();
  EXPECT_TRUE(run.coordinator.driven().empty());
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
}

TEST(Coordinator, ALatePlanIsDroppedAndTheOldOneGoesOn) {
  CoordinatorOptions options;
  options.replan_budget_ms = 1e-6;  // no plan is made within a nanosecond
  options.budget_from = 60.0;
  ClosedLoop run(random_trips(400.0, 80.0, 4), options);
  run.run_until(90.0);
  EXPECT_EQ(run.audit.figures().overlap_pairs_coordinated, 0);
  const auto late = std::ranges::count_if(run.coordinator.replans(), &Replan::fallback);
  EXPECT_GT(late, 0);
}

// Every third group is late, as if the machine had something else to do then.
TEST(Coordinator, PlansThatAreLateNowAndThenDelayVehiclesAndLoseNobody) {
  CoordinatorOptions options;
  options.replan_budget_ms = 500.0;
  options.escot.threads = 1;
  options.escot.crossing.tries = 0;  // two readings of the clock for each group
  options.escot.budget.clock = [now = 0.0, readings = 0]() mutable {
    return now += ++readings % 6 == 0 ? 600.0 : 1.0;
  };
  ClosedLoop run(random_trips(500.0, 80.0, 4), options);
  run.run_until(300.0);
  EXPECT_GT(std::ranges::count_if(run.coordinator.replans(), &Replan::fallback), 20);
  EXPECT_EQ(run.audit.figures().overlap_pairs_coordinated, 0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

TEST(Coordinator, StopsBehindACarThatBreaksDownAfterItsHandBack) {
  ClosedLoop run({{"a", 0.0, "W_in", "E_out"},
                  {"b", 3.0, "W_in", "E_out"},
                  {"c", 6.0, "S_in", "E_out"},
                  {"d", 6.0, "N_in", "S_out"}});
  while (run.traffic.running() && run.traffic.time() < 120.0) run.step_freezing("a");
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.traffic.arrived(), 1);  // d; b and c wait behind a
}

// Human drivers may touch each other, as long vehicles do where their tails swing out.
TEST(Coordinator, TakesNobodyOverWhileHeTouchesSomebody) {
  FakeTrip passes{"passes", 0.0, "W_in", "E_out"};
  passes.at = std::pair(90.0, 10.0);
  FakeTrip stands{"stands", 0.0, "W_out", "W_out"};  // towards the other lane, and partly on it
  stands.at = std::pair(85.0, 0.0);
  stands.aside = 2.0;
  ClosedLoop run({passes, stands});
  run.step();
  run.traffic.freeze("stands");
  run.run_until(60.0);
  EXPECT_EQ(run.audit.figures().overlap_pairs, 1);
  EXPECT_EQ(run.audit.figures().overlap_pairs_coordinated, 0);
  EXPECT_EQ(run.traffic.arrived(), 1);  // and nobody held it for good
}

/// A vehicle on the lane "W-D_0" is seen 9 degrees askew.
class AskewTraffic : public FakeTraffic {
 public:
  using FakeTraffic::FakeTraffic;
  std::span<const VehicleState> vehicles() const override {
    const auto states = FakeTraffic::vehicles();
    shown_.assign(states.begin(), states.end());
    for (VehicleState& v : shown_) {
      if (v.lane == "W-D_0") v.pose.theta += 0.16;
    }
    return shown_;
  }

 private:
  mutable std::vector<VehicleState> shown_;
};

// As SUMO's drivers are who change lanes where they are held, on a bend: from there he would swing
// far off his path, and he would be held until he did not.
TEST(Coordinator, WhoStandsAskewIsNotHeldThereForGood) {
  const NetworkShape shape = seam_shape({-130, 0});
  FakeTrip askew{"askew", 0.0, "W-D", "C-E"};
  askew.at = std::pair(shape.network.lanes.at("W-D_0").length - 1.5, 0.0);
  AskewTraffic traffic(shape.network, std::vector<FakeTrip>{askew});
  traffic.insert_now();
  traffic.hold("askew", true);
  const DrivableArea area(traffic.network());
  Coordinator coordinator(traffic, area, CoordinatorOptions{});
  Simulation simulation(traffic);
  simulation.add(coordinator);
  while (traffic.running() && traffic.time() < 4.0) simulation.step();
  EXPECT_FALSE(coordinator.drives("askew"));
  while (traffic.running() && traffic.time() < 60.0) simulation.step();
  EXPECT_EQ(traffic.arrived(), 1);
}

TEST(Coordinator, WhoStandsForNoReasonIsExpectedToStandAndNobodyToPassHim) {
  FakeTrip cyclist{"cyclist", 40.0, "E_out", "E_out", "bike"};
  cyclist.at = std::pair(4.0, 5.0);
  ClosedLoop run({{"stands", 0.0, "W_in", "E_out"}, cyclist, {"watches", 40.0, "W_in", "E_out"}});
  const auto x_of = [&](const std::string& id) {
    const auto v = std::ranges::find(run.traffic.vehicles(), id, &VehicleState::id);
    return v == run.traffic.vehicles().end() ? 1e9 : v->pose.x;
  };
  int seen = 0;
  while (run.traffic.time() < 60.0) {
    run.step_freezing("stands");
    if (run.traffic.time() < 41.0 || run.coordinator.driven().empty()) continue;
    const RoadScene scene = run.coordinator.scene();
    for (const Forecast& f : scene.forecasts) {
      const double later = f.earliest.at(std::min(scene.step + 150, f.earliest.end() - 1)).s;
      const double x = scene.library->path(f.vehicle.path).at(later).x;
      ASSERT_LT(x, x_of("stands") + 0.5) << run.traffic.time();
      ++seen;
    }
  }
  EXPECT_GT(seen, 100);
  EXPECT_GT(x_of("cyclist"), 30.0);
}

// Whoever would have to stop there for the queue behind it waits at its line, and the others cross.
TEST(Coordinator, NobodyStopsOnTheJunctionForAQueueBehindIt) {
  std::vector<FakeTrip> trips;
  constexpr int kEach = 24;
  for (int i = 0; i < kEach; ++i) {
    trips.push_back({"queues" + std::to_string(i), 3.0 * i, "W_in", "E_out"});
    trips.push_back({"crosses" + std::to_string(i), 3.0 * i, "S_in", "N_out"});
  }
  ClosedLoop run(trips);
  while (run.traffic.time() < 150.0) {
    run.step_freezing("queues0");
    for (const VehicleState& v : run.traffic.vehicles()) {
      const bool inside = std::abs(v.pose.x) < 6.0 && std::abs(v.pose.y) < 6.0;
      ASSERT_FALSE(inside && v.speed == 0.0) << v.id << " at " << run.traffic.time();
    }
  }
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.traffic.arrived(), kEach);  // those who cross
}

/// A car whose exit is closed by a cyclist waits at its line, turned away by every decision.
TEST(Coordinator, WhoWasTurnedAwayForLongIsNotExpectedToLeave) {
  FakeTrip cyclist{"cyclist", 0.0, "E_out", "E_out", "bike"};
  cyclist.at = std::pair(4.0, 0.0);
  cyclist.stop = FakeStop{"E_out_0", 6.0, 1000.0};
  std::vector<FakeTrip> trips = {cyclist, {"waits", 0.0, "W_in", "E_out"}};
  for (int i = 0; i < 20; ++i) {
    trips.push_back({"crosses" + std::to_string(i), 3.0 * i, "S_in", "N_out"});
  }
  ClosedLoop run(trips);
  int waits_long = 0;
  double stands_since = 1e9;
  while (run.traffic.time() < 60.0) {
    run.step();
    const auto car = std::ranges::find(run.traffic.vehicles(), "waits", &VehicleState::id);
    if (car == run.traffic.vehicles().end() || car->speed > 0.1) continue;
    stands_since = std::min(stands_since, run.traffic.time());
    ASSERT_FALSE(run.coordinator.drives("waits"));
    if (run.traffic.time() < stands_since + 6.0 || run.coordinator.driven().empty()) continue;
    ++waits_long;
    const RoadScene scene = run.coordinator.scene();
    const bool is_held =
        std::ranges::any_of(scene.forecasts, [](const Forecast& f) { return f.held.has_value(); });
    ASSERT_TRUE(is_held) << run.traffic.time();
  }
  EXPECT_GT(waits_long, 100);
}

/// Until `end` [s] everybody is at the same place in both runs.
void expect_same_poses(ClosedLoop& a, ClosedLoop& b, double end) {
  while (a.traffic.running() && a.traffic.time() < end) {
    a.step();
    b.step();
    ASSERT_EQ(a.traffic.vehicles().size(), b.traffic.vehicles().size());
    for (std::size_t i = 0; i < a.traffic.vehicles().size(); ++i) {
      ASSERT_EQ(a.traffic.vehicles()[i].pose, b.traffic.vehicles()[i].pose);
    }
  }
}

TEST(Coordinator, TheSameSeedGivesTheSameRun) {
  ClosedLoop a(random_trips(500.0, 60.0, 5));
  ClosedLoop b(random_trips(500.0, 60.0, 5));
  expect_same_poses(a, b, 150.0);
}

// Whoever keeps the number of a corridor has to say so: here all others are forgotten at once.
TEST(Coordinator, ForgettingCorridorsChangesNothing) {
  for (const double penetration : {1.0, 0.5}) {
    CoordinatorOptions options;
    options.share = {.penetration = penetration, .seed = 3};
    options.corridors_kept = 1e9;
    ClosedLoop keeping(random_trips(300.0, 60.0, 5), options);
    options.corridors_kept = 0.0;
    ClosedLoop forgetting(random_trips(300.0, 60.0, 5), options);
    expect_same_poses(keeping, forgetting, 120.0);
    EXPECT_TRUE(keeping.coordinator.corridors().holds(0));
    EXPECT_FALSE(forgetting.coordinator.corridors().holds(0));
  }
}

TEST(Coordinator, KeepsToALateralAccelerationLimit) {
  CoordinatorOptions options;
  options.limits.max_lateral_accel = 3.0;
  ClosedLoop run(random_trips(300.0, 100.0, 6), options);
  run.run_until(300.0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
  EXPECT_GT(run.audit.figures().max_lateral_accel, 2.0);
  EXPECT_LE(run.audit.figures().max_lateral_accel, 3.0);
}

TEST(Coordinator, NamesAJunctionThatIsNotThere) {
  FakeTraffic traffic(make_crossroads(), {});
  const DrivableArea area(traffic.network());
  CoordinatorOptions options;
  options.junctions = {"X"};
  EXPECT_THAT(
      [&] { Coordinator(traffic, area, options); },
      testing::ThrowsMessage<InputError>("--junction X: the network has no junction with this id"));
}

}  // namespace
}  // namespace mvtp
