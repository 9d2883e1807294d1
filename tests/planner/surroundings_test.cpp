#include "planner/road/surroundings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

//   At 12 m/s, 15 m before the other path: however hard it brakes it comes onto it, where a driver
//   may be from half a second to two seconds from now.
class BeforeADriver : public Crossing {
 protected:
  [[nodiscard]] bool may_brake_fully(bool relies) {
    const RoadVehicle vehicle = add(0, 85.0, 12.0);
    Forecast driver{.vehicle = add(1, 88.0, 12.0), .earliest = {}, .yields = false};
    scene.vehicles.pop_back();
    driver.vehicle.key = -1;
    driver.relies = relies;
    const auto drive = [](double v) {
      SpeedProfile t{.states = {}};
      for (int k = 0; k < 100; ++k) t.states.push_back({88.0 + v * 0.1 * k, v});
      return t;
    };
    driver.earliest = drive(12.0);
    driver.latest = drive(4.0);
    scene.forecasts = {driver};
    const RoadPairs pairs(scene);
    const ProfileOptions options;
    const Surroundings around(pairs, scene.vehicles.front(), {}, options);
    const double b = kCar.max_decel;
    return around.step_is_clear(0, vehicle.now, -b, advance(vehicle.now, -b, 0.5));
  }
};

TEST_F(BeforeADriver, BrakingIsSafeIfHeBrakesToo) { EXPECT_TRUE(may_brake_fully(false)); }

TEST_F(BeforeADriver, BrakingIsNoneIfHeReliesOnHisSignal) { EXPECT_FALSE(may_brake_fully(true)); }

//   It could still come to rest before the other path, but not after the decision; a driver comes
//   there who is to wait before it.
class BeforeWhoWaits : public Crossing {
 protected:
  /// May it go on at the same speed while he, so far before the crossing, brakes gently?
  [[nodiscard]] bool may_go_on(double before, Told told = Told::kNothing) {
    scene.vehicles.clear();
    const RoadVehicle vehicle = add(0, 91.4, 5.2);
    Forecast driver{.vehicle = add(1, 100.0 - before, 12.0), .earliest = {}};
    driver.told = told;
    scene.vehicles.pop_back();
    driver.vehicle.key = -1;
    driver.earliest.states = {driver.vehicle.now};
    while (driver.earliest.states.size() < 300) {
      driver.earliest.states.push_back(advance(driver.earliest.states.back(), -3.0, 0.1));
    }
    scene.forecasts = {driver};
    const RoadPairs pairs(scene);
    const ProfileOptions options;
    const Surroundings around(pairs, scene.vehicles.front(), {}, options);
    return around.step_is_clear(0, vehicle.now, 0.0, advance(vehicle.now, 0.0, 0.5));
  }
};

// Told to brake half a second later he stops 22 m on; if he does brake gently meanwhile, 18 m on.
TEST_F(BeforeWhoWaits, HeNeedNotBrakeBeforeHeIsToldTo) {
  EXPECT_TRUE(may_go_on(30.0));
  EXPECT_FALSE(may_go_on(25.0));
}

TEST_F(BeforeWhoWaits, HeIsNotLateWhoHasBeenTold) {
  EXPECT_TRUE(may_go_on(25.0, Told::kToWait));
  EXPECT_FALSE(may_go_on(15.0, Told::kToWait)) << "he gets there all the same";
}

//   Two seconds from now it is so far behind a driver who has been let pass, both at 10 m/s.
class BehindWhoPasses : public Crossing {
 protected:
  [[nodiscard]] bool may_go_on(double gap, Surroundings::Forecasts forecasts,
                               Told told = Told::kToPass, bool is_told_now = false) {
    scene.vehicles.clear();
    const RoadVehicle vehicle = add(0, 50.0, 10.0);
    const double ahead = gap + scene.body(vehicle).length();
    Forecast driver{.vehicle = add(0, vehicle.now.s + ahead, 10.0), .earliest = {}};
    scene.vehicles.pop_back();
    driver.vehicle.key = -1;
    driver.yields = false;
    driver.told = told;
    driver.is_new = is_told_now;
    driver.earliest.states = {driver.vehicle.now};
    while (driver.earliest.states.size() < 300) {
      driver.earliest.states.push_back(advance(driver.earliest.states.back(), 0.0, 0.1));
    }
    driver.latest = driver.earliest;
    scene.forecasts = {driver};
    const RoadPairs pairs(scene);
    const ProfileOptions options;
    const Surroundings around(pairs, scene.vehicles.front(), {}, options, forecasts);
    const InertialState then = advance(vehicle.now, 0.0, 2.0);
    return around.step_is_clear(20, then, 0.0, advance(then, 0.0, 0.5));
  }
};

// Half a second later, when it answers to his braking, it has driven 5 m more.
TEST_F(BehindWhoPasses, NewPlansStayAsFarBehindAsItTakesToStopIfHeBrakes) {
  EXPECT_TRUE(may_go_on(12.0, Surroundings::Forecasts::kWithSlack));
  EXPECT_FALSE(may_go_on(3.0, Surroundings::Forecasts::kWithSlack));
}

TEST_F(BehindWhoPasses, PlansThatAreKeptNeedNotBeforeTheyAreThere) {
  EXPECT_TRUE(may_go_on(3.0, Surroundings::Forecasts::kCount));
}

// He would not be told to go if that left it without a plan a moment later.
TEST_F(BehindWhoPasses, PlansThatAreKeptDoBehindWhoIsToldToGoNow) {
  EXPECT_TRUE(may_go_on(12.0, Surroundings::Forecasts::kCount, Told::kToPass, true));
  EXPECT_FALSE(may_go_on(3.0, Surroundings::Forecasts::kCount, Told::kToPass, true));
}

// He goes when his light says so, again and again: they would wait for ever on the junction.
TEST_F(BehindWhoPasses, NewPlansNeedNotBehindWhoPassesByHimself) {
  EXPECT_TRUE(may_go_on(3.0, Surroundings::Forecasts::kWithSlack, Told::kNothing));
}

//   It is on the crossing already, where it would come to rest; a driver who does not yield is
//   `before` metres away. Where it brakes he meets it: only driving on may avoid him.
class OnTheCrossing : public Crossing {
 protected:
  [[nodiscard]] bool may_drive_on(double before) {
    scene.vehicles.clear();
    const RoadVehicle vehicle = add(0, 100.0, 2.0);
    Forecast driver{.vehicle = add(1, 100.0 - before, 12.0), .earliest = {}, .yields = false};
    scene.vehicles.pop_back();
    driver.vehicle.key = -1;
    for (int k = 0; k < 60; ++k) driver.earliest.states.push_back({100 - before + 1.2 * k, 12.0});
    driver.latest = driver.earliest;
    scene.forecasts = {driver};
    const RoadPairs pairs(scene);
    const ProfileOptions options;
    const Surroundings around(pairs, scene.vehicles.front(), {}, options);
    const double a = kCar.max_accel;
    return around.step_is_clear(0, vehicle.now, a, advance(vehicle.now, a, 0.5));
  }
};

TEST_F(OnTheCrossing, WhereBrakingIsNotSafeDrivingOnIs) {
  for (const double before : {13.0, 14.0, 15.0, 30.0}) EXPECT_TRUE(may_drive_on(before)) << before;
}

TEST_F(OnTheCrossing, DrivingOnIsNoneIfItIsMetMeanwhile) { EXPECT_FALSE(may_drive_on(9.0)); }

class NoWaiting : public Crossing {
 protected:
  /// It stands on the crossing for so many seconds, and drives on.
  static SpeedProfile standing(double seconds) {
    SpeedProfile stands{.states =
                            std::vector<InertialState>(std::size_t(10.0 * seconds), {100.0, 0.0})};
    while (stands.states.back().s < 190.0) {
      const InertialState last = stands.states.back();
      stands.states.push_back(advance(last, last.v < 13.0 ? 2.0 : 0.0, 0.1));
    }
    return stands;
  }
};

// Another one stands on the crossing for 20 s, and drives on. Who waits for it does so right before
// the crossing, or as far away as it has to.
TEST_F(NoWaiting, KeepsAStretchFree) {
  add(0, 40.0, 10.0);
  add(1, 100.0, 0.0);
  const std::vector<JointPlan::Entry> before = {
      {1, std::make_shared<SpeedProfile>(standing(20.0))}};
  const auto rests_within = [&](double from, double to) {
    const RoadPairs pairs(scene);
    const auto plan = plan_vehicle(pairs, scene.vehicles[0], before, {});
    if (!plan) throw std::runtime_error("no plan");
    return std::ranges::any_of(
        plan->states, [&](const InertialState& x) { return x.v == 0.0 && x.s > from && x.s < to; });
  };
  EXPECT_TRUE(rests_within(80.0, 100.0)) << "where it may wait anywhere";
  scene.vehicles[0].no_waiting = {{80.0, 110.0}};
  EXPECT_FALSE(rests_within(80.0, 110.0));
}

TEST_F(NoWaiting, KeepsTheRunUpFreeForWhoIsNotOnItYet) {
  add(0, 40.0, 10.0);
  add(1, 100.0, 0.0);
  const std::vector<JointPlan::Entry> before = {
      {1, std::make_shared<SpeedProfile>(standing(20.0))}};
  const auto rest_from = [&](const InertialState& now) {
    scene.vehicles[0].now = now;
    scene.vehicles[0].run_ups = {{70.0, 85.0}};
    scene.vehicles[0].no_waiting = {{85.0, 110.0}};
    const RoadPairs pairs(scene);
    const auto plan = plan_vehicle(pairs, scene.vehicles[0], before, {});
    if (!plan) throw std::runtime_error("no plan");
    const auto rest = std::ranges::find(plan->states, 0.0, &InertialState::v);
    return rest == plan->states.end() ? 1e9 : rest->s;
  };
  EXPECT_LE(rest_from({40.0, 10.0}), 70.0);
  EXPECT_EQ(rest_from({75.0, 0.0}), 75.0) << "it may stay where it is";
  const double rest = rest_from({65.0, 10.0});  // it would have to brake hard
  EXPECT_GT(rest, 70.0);
  EXPECT_LE(rest, 85.0);
}

//   4 ----.        Path 4 comes over into the lane of path 0 from 60 m to 40 m before the origin,
//   0 -----`---->  where a driver comes from behind at 13 m/s.
class BesideADriver : public Crossing {
 protected:
  BesideADriver() {
    library.add(
        ReferencePath(smooth(
            resample(std::vector<Point>{{-100, 3.4}, {-60, 3.4}, {-40, 0}, {100, 0}}, 0.25), 3.0)),
        kCar);
  }

  /// May the vehicle come over with full braking, one decision from now, `ahead` of the driver?
  [[nodiscard]] bool may_cut_in(double ahead) {
    const RoadVehicle vehicle = add(4, 30.0, 10.0);
    RoadVehicle driver = add(0, 0.0, 13.0);
    scene.vehicles.pop_back();
    driver.key = -1;
    const double b = kCar.max_decel;
    // The last decision after which it would still be beside his lane, and half a metre on.
    const RoadContact contact(scene, vehicle, driver, 0.0);
    InertialState from{30.0, 10.0};
    while (!contact.is_ahead(advance(from, -b, 0.5), {0.0, 13.0})) from.s += 0.25;
    from.s += 0.25;
    SpeedProfile t{.states = {}};
    const double place = from.s - ahead;
    for (int k = 0; k < 100; ++k) t.states.push_back({place + 1.3 * (k - 5), 13.0});
    driver.now = t.states.front();
    scene.forecasts = {{.vehicle = driver, .earliest = t}};
    const RoadPairs pairs(scene);
    const ProfileOptions options;
    const Surroundings around(pairs, scene.vehicles.front(), {}, options);
    return around.step_is_clear(5, from, -b, advance(from, -b, 0.5));
  }
};

TEST_F(BesideADriver, BrakingDoesNotMakeItRightToCutIn) { EXPECT_FALSE(may_cut_in(12.0)); }

TEST_F(BesideADriver, FarBeforeHimItMayComeOverAndBrake) { EXPECT_TRUE(may_cut_in(55.0)); }

// He drives on at the same speed beside it, somewhere along its side: whatever it does, it does not
// come over onto him on the assumption that he makes room.
TEST_F(BesideADriver, ANewPlanDoesNotComeOverOntoHim) {
  int plans = 0;
  for (double ahead = -6.0; ahead <= 6.0; ahead += 0.5) {
    scene.vehicles.clear();
    const RoadVehicle vehicle = add(4, 30.0, 10.0);
    RoadVehicle driver = add(0, 30.0 - ahead, 10.0);
    scene.vehicles.pop_back();
    driver.key = -1;
    SpeedProfile t{.states = {}};
    for (double s = driver.now.s; s < 190.0; s += 1.0) t.states.push_back({s, 10.0});
    scene.forecasts = {{.vehicle = driver, .earliest = t}};
    const RoadPairs pairs(scene);
    const auto plan = plan_vehicle(pairs, scene.vehicles.front(), {}, {});
    if (!plan) continue;
    ++plans;
    EXPECT_FALSE(ever_touch(vehicle, *plan, driver, t)) << ahead << " m ahead of him";
  }
  EXPECT_GT(plans, 10);
}

// Nor onto his lane where it could only brake, which he would not see: he drives on meanwhile.
TEST_F(BesideADriver, ANewPlanDoesNotBrakeOntoHisLane) {
  int plans = 0;
  for (double ahead = -4.0; ahead <= 4.0; ahead += 1.0) {
    for (double s = 16.0; s <= 46.0; s += 1.0) {
      scene.vehicles.clear();
      const RoadVehicle vehicle = add(4, s, 13.0);
      RoadVehicle driver = add(0, s - ahead, 8.0);
      scene.vehicles.pop_back();
      driver.key = -1;
      SpeedProfile t{.states = {}};
      for (double there = driver.now.s; there < 190.0; there += 0.8) {
        t.states.push_back({there, 8.0});
      }
      scene.forecasts = {{.vehicle = driver, .earliest = t}};
      const RoadPairs pairs(scene);
      const auto plan = plan_vehicle(pairs, scene.vehicles.front(), {}, {});
      if (!plan || pairs.follows(0, 0)) continue;
      ++plans;
      const auto braking_after = [&](std::ptrdiff_t steps) {
        SpeedProfile braking{.states = {plan->states.begin(), plan->states.begin() + 1 + steps}};
        while (braking.states.size() < 60) {
          braking.states.push_back(advance(braking.states.back(), -kCar.max_decel, 0.1));
        }
        return braking;
      };
      if (ever_touch(vehicle, braking_after(0), driver, t)) continue;  // too late
      EXPECT_FALSE(ever_touch(vehicle, braking_after(5), driver, t)) << s << " m, " << ahead;
    }
  }
  EXPECT_GT(plans, 10);
}

//   Another one stands somewhere on path 1: a driver who keeps clear of others or does not, or a
//   CAV without a plan. If it stands across path 0 for ever, nobody searches for a plan.
class Barred : public Crossing {
 protected:
  enum class Kind { kYields, kDoesNot, kCav };

  struct Result {
    bool barred;
    bool plan;
    std::int64_t work;
  };

  /// @param creeps  it will have moved on by a millionth of a metre, so that nobody can tell that
  ///                it stands for ever
  [[nodiscard]] Result look(double s, double v, double other, Kind kind, bool creeps) {
    scene.vehicles.clear();
    scene.forecasts.clear();
    add(0, s, v);
    SpeedProfile stands{.states = {{other, 0.0}, {other, 0.0}}, .complete = false};
    if (creeps) stands.states.back().s += 1e-6;
    std::vector<JointPlan::Entry> before;
    if (kind == Kind::kCav) {
      add(1, other, 0.0);
      before.push_back({1, std::make_shared<SpeedProfile>(stands)});
    } else {
      add_standing_forecast(1, other);
      scene.forecasts.back().earliest = stands;
      scene.forecasts.back().yields = kind == Kind::kYields;
    }
    const RoadPairs pairs(scene);
    const ProfileOptions options;
    const Surroundings around(pairs, scene.vehicles.front(), before, options);
    WorkBudget work{1'000'000};
    const auto plan = plan_vehicle(pairs, scene.vehicles.front(), before, options, {.work = &work});
    return {around.is_barred(190.0), plan.has_value(), 1'000'000 - work.left};
  }
};

TEST_F(Barred, OnlyWhereNoPlanIsFoundAndThenAtOnce) {
  int barred = 0;
  for (const Kind kind : {Kind::kYields, Kind::kDoesNot, Kind::kCav}) {
    for (double other = 85.0; other <= 110.0; other += 0.5) {
      for (double s = 20.0; s <= 120.0; s += 4.0) {
        for (const double v : {0.0, 5.0, 12.0}) {
          const Result known = look(s, v, other, kind, /*creeps=*/false);
          if (!known.barred) continue;
          ++barred;
          EXPECT_FALSE(known.plan) << s << ' ' << v << ' ' << other;
          EXPECT_LT(known.work, 100) << s << ' ' << v << ' ' << other;
          EXPECT_FALSE(look(s, v, other, kind, /*creeps=*/true).plan)
              << int(kind) << ' ' << s << ' ' << v << ' ' << other;
        }
      }
    }
  }
  EXPECT_GT(barred, 500);
}

TEST_F(Barred, FromAfarByWhoeverStandsOnTheCrossing) {
  for (const Kind kind : {Kind::kYields, Kind::kDoesNot, Kind::kCav}) {
    for (double other = 97.0; other <= 100.0; other += 0.5) {
      EXPECT_TRUE(look(40.0, 0.0, other, kind, false).barred) << other;
      EXPECT_FALSE(look(115.0, 0.0, other, kind, false).barred) << "it is past " << other;
    }
    EXPECT_FALSE(look(40.0, 0.0, 80.0, kind, false).barred) << "it waits before the crossing";
  }
}

//   A driver stands on the crossing, as if for 10 s. He is held there until others have passed.
class HeldDriver : public Crossing {
 protected:
  [[nodiscard]] bool has_plan(int path, double s, bool is_held) {
    const RoadVehicle vehicle = add(path, s, 8.0);
    RoadVehicle driver = add(1, 98.0, 0.0);
    scene.vehicles.pop_back();
    driver.key = -1;
    SpeedProfile t{.states = std::vector<InertialState>(100, {98.0, 0.0})};
    while (t.states.back().s < 190.0) t.states.push_back(advance(t.states.back(), 1.0, 0.1));
    Forecast forecast{.vehicle = driver, .earliest = t};
    if (is_held) forecast.held = SpeedProfile{.states = {{98.0, 0.0}}, .complete = false};
    scene.forecasts = {forecast};
    const RoadPairs pairs(scene);
    return plan_vehicle(pairs, vehicle, {}, {}).has_value();
  }
};

TEST_F(HeldDriver, WhoComesAcrossDoesNotCountOnHimToLeave) {
  EXPECT_FALSE(has_plan(0, 60.0, /*is_held=*/true));
}
TEST_F(HeldDriver, WhoIsBehindHimWaitsForHim) { EXPECT_TRUE(has_plan(1, 60.0, /*is_held=*/true)); }
TEST_F(HeldDriver, WhoIsNotHeldLeaves) { EXPECT_TRUE(has_plan(0, 60.0, /*is_held=*/false)); }

//   A driver comes to where he is held, on the crossing: who is to pass there has to be before him.
class ComesToBeHeld : public Crossing {
 protected:
  void let_come() {
    scene.vehicles.clear();
    RoadVehicle driver = add(1, 30.0, 10.0);
    scene.vehicles.clear();
    driver.key = -1;
    SpeedProfile t{.states = {driver.now}, .complete = false};
    while (t.states.back().v > 0.0) {
      const InertialState last = t.states.back();
      const bool brakes = last.s >= 98.0 - stopping_distance(last.v, 4.5);
      t.states.push_back(advance(last, brakes ? -4.5 : 0.0, 0.1));
    }
    scene.forecasts = {{.vehicle = driver, .earliest = t, .told = Told::kToWait, .held = t}};
  }
  [[nodiscard]] std::optional<SpeedProfile> plan_from(double s) {
    let_come();
    scene.forecasts.front().slack_before = slack;
    add(0, s, 10.0);
    return plan_vehicle(RoadPairs(scene), scene.vehicles.front(), {}, {});
  }
  /// How far back [m] it may be at 10 m/s.
  [[nodiscard]] double furthest() {
    double s = 90.0;
    while (s > 0.0 && plan_from(s)) s -= 0.5;
    return s;
  }
  int slack = 0;
};

TEST_F(ComesToBeHeld, NewPlansAreClearBeforeHimEvenIfHeIsEarly) {
  const double tight = furthest();
  slack = 10;
  EXPECT_NEAR(furthest() - tight, 10.0, 6.0) << "a second";
}

TEST_F(ComesToBeHeld, PlansThatAreKeptNeedNot) {
  const double tight = furthest() + 1.0;
  const auto plan = plan_from(tight);
  ASSERT_TRUE(plan);
  slack = 10;
  EXPECT_FALSE(plan_from(tight));
  EXPECT_TRUE(still_fits(RoadPairs(scene), scene.vehicles.front(), *plan, {}, {}));
}

//   From the south it turns, slowly, into the lane of a driver who comes from the west.
class TurnsIn : public Crossing {
 protected:
  TurnsIn() {
    std::vector<Point> turn = {{0, -100}, {0, -6}};
    for (double a = 0.1; a < 1.5; a += 0.1) {
      turn.push_back({6 - 6 * std::cos(a), 6 * std::sin(a) - 6});
    }
    turn.push_back({100, 0});
    path_ = library.add(ReferencePath(turn), kCar);
  }

  /// The step in which it is in his lane; he is at `driver_from` now, and drives 10 m/s.
  [[nodiscard]] std::int64_t turned(double driver_from) {
    scene.vehicles.clear();
    Forecast driver{.vehicle = add(0, driver_from, 10.0), .earliest = {.states = {}}};
    scene.vehicles.clear();
    driver.vehicle.key = -1;
    for (double s = driver_from; s < 190.0; s += 1.0) driver.earliest.states.push_back({s, 10.0});
    scene.forecasts = {driver};
    RoadVehicle& slow = add(path_, 84.0, 5.0);
    slow.cruise_speed = 5.0;
    slow.envelope = std::make_shared<SpeedEnvelope>(std::vector<double>(801, 5.0), 3.5);
    const auto plan = plan_vehicle(RoadPairs(scene), slow, {}, {});
    if (!plan) throw std::runtime_error("no plan");
    return arrival_step(*plan, 110.0);
  }

  int path_ = 0;
};

// He would run into it if he went on at his speed, but sees it in his lane in time.
TEST_F(TurnsIn, ADriverWhoIsFarFollowsIt) {
  const std::int64_t at_once = 60;  // 26 m at 5 m/s, in steps of 0.1 s
  EXPECT_LE(turned(30.0), at_once);
  EXPECT_GT(turned(60.0), at_once) << "one who is near has to be let through";
}

}  // namespace
}  // namespace mvtp
