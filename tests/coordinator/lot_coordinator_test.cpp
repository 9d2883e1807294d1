#include "coordinator/lot/lot_coordinator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coordinator/audit/audit.hpp"
#include "coordinator/network/drivable_area.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "planner/problem/input_error.hpp"
#include "tests/coordinator/fake_lot.hpp"

namespace mvtp {
namespace {

/// A run on the small lot, watched at every step.
class LotRun {
 public:
  explicit LotRun(std::vector<FakeParkingEvent> cars, LotOptions options = {},
                  const ParkingLot& lot = make_lot())
      : traffic(lot, std::move(cars)),
        coordinator(traffic, lot, options),
        area_({}, std::array{lot}),
        audit(area_, 0.1) {
    simulation.add(coordinator);
  }

  void step() {
    simulation.step();
    std::vector<Observation> observations;
    for (const VehicleState& v : traffic.vehicles()) {
      // Before they are let in, cars stand where the ground has no room drawn for them.
      observations.push_back({&v, &type_, coordinator.drives(v.id)});
    }
    audit.observe(traffic.time(), observations, traffic.pedestrians());
    expect_that_braking_is_safe();
  }

  /// @return whether everyone has come and departed by `end` [s].
  bool finish(double end) {
    while (traffic.running() && traffic.time() < end) step();
    return !traffic.running();
  }

  /// The law of safety: if all brake now, nobody touches anybody on the way to rest.
  void expect_that_braking_is_safe() {
    const LotMotion& motion = coordinator.motion();
    for (double part = 0.0; part <= 1.0; part += 0.25) {
      std::vector<Pose> poses;
      for (const LotCar& car : motion.cars()) {
        const double braking = car.v * car.v / (2 * motion.limits().hardest);
        poses.push_back(car.path.at(std::min(car.s + part * braking, car.path.length())));
      }
      for (std::size_t i = 0; i < poses.size(); ++i) {
        for (std::size_t j = i + 1; j < poses.size(); ++j) {
          EXPECT_GT(clearance(poses[i], motion.cars()[i].body, poses[j], motion.cars()[j].body),
                    0.0)
              << "at " << traffic.time() << " s";
        }
      }
    }
  }

  FakeLotTraffic traffic;
  LotCoordinator coordinator;
  Simulation simulation{traffic};

 private:
  DrivableArea area_;
  VehicleType type_{.id = "car", .body = lot_car()};

 public:
  Audit audit;
};

std::vector<FakeParkingEvent> arrivals(int count, double every, double duration = 40.0) {
  std::vector<FakeParkingEvent> cars;
  for (int k = 0; k < count; ++k) cars.push_back({"c" + std::to_string(k), k * every, duration});
  return cars;
}

std::vector<FakeParkingEvent> busy() {
  std::vector<FakeParkingEvent> cars = arrivals(10, 9.0);
  for (int k = 0; k < 8; ++k) {
    cars.push_back({"p" + std::to_string(k), 0.0, 5.0 + 11.0 * k, 2 * k});
  }
  return cars;
}

void expect_clean(const Audit& audit) {
  const AuditFigures& f = audit.figures();
  EXPECT_EQ(f.overlap_pairs, 0);
  for (const AuditEvent& e : audit.events()) {
    if (e.what.find("off the road") != std::string::npos) continue;  // uncontrolled, outside
    ADD_FAILURE() << e.time << " s: " << e.what << " at " << e.where.x << ", " << e.where.y;
  }
  EXPECT_EQ(f.people_touched, 0);
  EXPECT_EQ(f.off_road_steps_coordinated, 0);
  EXPECT_LE(f.max_accel, 1.5);
  EXPECT_LE(f.max_decel, 1.5);
  EXPECT_LE(f.max_lateral_accel, 1.5);
  EXPECT_LE(f.max_curvature_ratio, 1.0);
}

TEST(LotCoordinator, ParksACarAndBringsItBack) {
  LotRun run(arrivals(1, 0.0));
  ASSERT_TRUE(run.finish(300.0));
  EXPECT_EQ(run.traffic.arrived(), 1);
  const ParkingEvent& event = run.coordinator.events().at("c0");
  ASSERT_TRUE(event.parked && event.handed_back);
  EXPECT_NEAR(*event.wished_out - *event.parked, 40.0, 0.6);
  // Alone on the lot it takes what the forecast said, but for the moment of the decision.
  EXPECT_NEAR(*event.parked - *event.admitted_in, event.alone_in, 1.0);
  EXPECT_GT(event.distance, 25.0);
  expect_clean(run.audit);
}

TEST(LotCoordinator, AParkedVehicleRestsUntilItWantsToLeave) {
  LotRun run(arrivals(1, 0.0));
  const auto& events = run.coordinator.events();
  EXPECT_FALSE(run.coordinator.rests("c0"));
  while (events.empty() || !events.at("c0").parked) run.step();
  EXPECT_TRUE(run.coordinator.rests("c0"));
  while (!events.at("c0").wished_out) run.step();
  EXPECT_FALSE(run.coordinator.rests("c0"));
}

class LotControllers : public testing::TestWithParam<LotController> {};

TEST_P(LotControllers, ServeABusyLotWithoutContact) {
  LotOptions options;
  options.controller = GetParam();
  LotRun run(busy(), options);
  ASSERT_TRUE(run.finish(2000.0));
  EXPECT_EQ(run.traffic.arrived(), 18);
  expect_clean(run.audit);
  EXPECT_LE(run.audit.figures().max_speed, 5.1);
  if (GetParam() != LotController::kOneAtATime) return;
  EXPECT_LE(int(run.coordinator.motion().cars().size()), 1);
}

INSTANTIATE_TEST_SUITE_P(All, LotControllers,
                         testing::Values(LotController::kEscot, LotController::kPrioritized,
                                         LotController::kPbcr, LotController::kOneAtATime));

// A car that has to leave its slot while another one passes waits for it, and drives then.
TEST(LotPbcr, LetsOneAfterTheOtherPass) {
  LotOptions options;
  options.controller = LotController::kPbcr;
  std::vector<FakeParkingEvent> cars;
  for (int k = 0; k < 4; ++k) cars.push_back({"p" + std::to_string(k), 0.0, 5.0, 2 * k});
  LotRun run(cars, options);
  EXPECT_TRUE(run.finish(400.0));
  EXPECT_EQ(run.traffic.arrived(), 4);
  expect_clean(run.audit);
}

double mean_time(const LotRun& run) {
  double sum = 0.0;
  int n = 0;
  for (const auto& [id, event] : run.coordinator.events()) {
    if (event.asked_in) sum += *event.parked - *event.asked_in, ++n;
    if (event.wished_out) sum += *event.handed_back - *event.wished_out, ++n;
  }
  return sum / n;
}

TEST(LotCoordinator, IsQuickerThanOneAtATime) {
  LotRun together(busy());
  LotOptions options;
  options.controller = LotController::kOneAtATime;
  LotRun alone(busy(), options);
  ASSERT_TRUE(together.finish(2000.0) && alone.finish(2000.0));
  EXPECT_LT(mean_time(together), 0.6 * mean_time(alone));
}

TEST(LotCoordinator, StandsAsAskedFor) {
  for (const ParkingDirection direction :
       {ParkingDirection::kForward, ParkingDirection::kReverse}) {
    LotOptions options;
    options.parking = direction;
    LotRun run(arrivals(3, 20.0, 1e6), options);
    while (run.traffic.time() < 200.0) run.step();
    const std::vector<LotObservation> parked = run.coordinator.parked();
    ASSERT_EQ(parked.size(), 3U);
    for (const LotObservation& car : parked) {
      const Pose middle = compose(car.pose, {1.35, 0.0, 0.0});
      const ParkingSlot* slot = nullptr;
      for (const ParkingSlot& s : run.coordinator.lot().slots) {
        if (distance(s.middle, middle) < 0.02) slot = &s;
      }
      ASSERT_NE(slot, nullptr);
      const double turned = std::abs(wrap_to_pi(car.pose.theta - slot->middle.theta));
      EXPECT_NEAR(turned, direction == ParkingDirection::kForward ? 0.0 : std::numbers::pi, 1e-3);
    }
  }
}

TEST(LotCoordinator, FullLotQueuesAndServesWhenASlotGetsFree) {
  std::vector<FakeParkingEvent> cars = arrivals(2, 5.0, 30.0);
  for (int s = 0; s < 16; ++s) {
    cars.push_back({"p" + std::to_string(s), 0.0, s == 3 ? 120.0 : s == 12 ? 200.0 : 400.0, s});
  }
  LotRun run(cars);
  while (run.traffic.time() < 100.0) run.step();
  EXPECT_EQ(run.coordinator.occupied(0.0).at_gate, 2);
  EXPECT_EQ(run.coordinator.occupied(0.0).parked, 16);
  ASSERT_TRUE(run.finish(2000.0));
  expect_clean(run.audit);
  const auto& events = run.coordinator.events();
  EXPECT_EQ(events.at("c0").slot, "s3");
  EXPECT_GT(*events.at("c0").admitted_in, 120.0);
}

TEST(LotCoordinator, DrivesAroundABreakdownWhereThereIsRoom) {
  LotOptions options;
  options.breakdowns["c1"] = 25.0;
  LotRun run(arrivals(6, 12.0, 30.0), options);
  EXPECT_FALSE(run.finish(120.0));  // the broken one stays; the others have left or wait
  EXPECT_TRUE(run.coordinator.events().at("c1").broken);
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_GE(run.traffic.arrived(), 1);
}

TEST(LotCoordinator, RefusesAVehicleThatFitsNoSlot) {
  ParkingLot lot = make_lot();
  for (ParkingSlot& slot : lot.slots) slot.length = 4.0;
  LotRun run(arrivals(1, 0.0), {}, lot);
  try {
    run.finish(60.0);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("vehicle c0: 4.50 x 1.80 m is too large"));
  }
}

TEST_P(LotControllers, BrakeForPeople) {
  LotOptions options;
  options.controller = GetParam();
  ParkingLot lot = make_lot();
  lot.footpaths.push_back({{{-6.0, 0.0}, {-6.0, 18.0}}, 2.0});
  LotRun run(arrivals(6, 11.0), options, lot);
  for (int k = 0; k < 20; ++k) {
    const bool up = k % 2 == 0;
    run.traffic.add_person({.id = "w" + std::to_string(k),
                            .position = {-6.0, up ? 4.0 - 14.0 * k : 14.0 + 14.0 * k},
                            .theta = (up ? 0.5 : -0.5) * std::numbers::pi,
                            .speed = 1.3});
  }
  ASSERT_TRUE(run.finish(900.0));
  EXPECT_EQ(run.traffic.arrived(), 6);
  EXPECT_EQ(run.audit.figures().people_touched, 0);
  EXPECT_LT(run.audit.figures().min_person_clearance, 6.0);  // they did meet
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
}

TEST(LotCoordinator, SameRunTwice) {
  LotRun first(busy());
  LotRun second(busy());
  ASSERT_TRUE(first.finish(2000.0) && second.finish(2000.0));
  EXPECT_EQ(first.traffic.time(), second.traffic.time());
  for (const auto& [id, event] : first.coordinator.events()) {
    EXPECT_EQ(event.distance, second.coordinator.events().at(id).distance) << id;
  }
}

TEST(LotCoordinator, ThePolicyChoosesTheSlot) {
  LotOptions options;
  options.slots_tried = 1;
  options.policy = [](std::vector<SlotOffer>& offers) { std::ranges::reverse(offers); };
  LotRun far(arrivals(1, 0.0), options);
  LotRun near(arrivals(1, 0.0));
  ASSERT_TRUE(far.finish(300.0) && near.finish(300.0));
  EXPECT_GT(far.coordinator.events().at("c0").distance,
            near.coordinator.events().at("c0").distance + 10.0);
}

/// The entry lane as the exit of a junction, whose controller still drives the cars there.
class DrivenByAnother : public FakeLotTraffic {
 public:
  using FakeLotTraffic::FakeLotTraffic;
  [[nodiscard]] bool is_taken_over(const std::string&) const override { return by_another; }
  void hold(const std::string& id, bool stop) override {
    EXPECT_FALSE(by_another) << id;
    FakeLotTraffic::hold(id, stop);
  }

  bool by_another = true;
};

TEST(LotCoordinator, LeavesAloneWhomAnotherControllerDrives) {
  DrivenByAnother traffic(make_lot(), {{.id = "v", .duration = 10.0}});
  LotCoordinator coordinator(traffic, make_lot(), {});
  Simulation simulation(traffic);
  simulation.add(coordinator);
  while (traffic.time() < 8.0) simulation.step();
  EXPECT_FALSE(coordinator.drives("v"));
  traffic.by_another = false;
  while (traffic.time() < 60.0 && !coordinator.drives("v")) simulation.step();
  EXPECT_TRUE(coordinator.drives("v"));
}

}  // namespace
}  // namespace mvtp
