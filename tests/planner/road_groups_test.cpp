#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/info.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "planner/road/road_escot.hpp"
#include "planner/road/road_world.hpp"
#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;

// Crossing number n lies 1000 n metres to the east; its paths are 2 n and 2 n + 1.
class ManyCrossings : public testing::Test {
 protected:
  static constexpr int kCrossings = 4;

  ManyCrossings() : library(Margins{}) {
    for (int n = 0; n < kCrossings; ++n) {
      const double x = 1000.0 * n;
      library.add(straight({x - 100, 0}, {x + 100, 0}), kCar);
      library.add(straight({x, -100}, {x, 100}), kCar);
    }
    scene.library = &library;
  }

  void add(int path, double s, double v) {
    RoadVehicle vehicle{.key = std::int64_t(scene.vehicles.size()), .path = path, .now = {s, v}};
    vehicle.envelope = std::make_shared<SpeedEnvelope>(std::vector<double>(801, 13.9), 3.5);
    vehicle.exit_lane = path;
    vehicle.s_exit_lane = 110.0;
    vehicle.s_handback = 170.0;
    vehicle.s_end = 190.0;
    scene.vehicles.push_back(vehicle);
  }

  /// Eight vehicles at each of the crossings named.
  void fill(const std::vector<int>& crossings) {
    for (int i = 0; i < 4; ++i) {
      for (const int n : crossings) {
        add(2 * n, 70.0 - 14.0 * i, 12.0);
        add(2 * n + 1, 66.0 - 14.0 * i - n, 12.0);
      }
    }
  }

  std::vector<std::int64_t> keys() const {
    std::vector<std::int64_t> all;
    for (const RoadVehicle& v : scene.vehicles) all.push_back(v.key);
    return all;
  }

  static void expect_same(const RoadDecision& a, const RoadDecision& b) {
    ASSERT_EQ(a.plan.entries.size(), b.plan.entries.size());
    EXPECT_EQ(a.cost, b.cost);
    for (std::size_t i = 0; i < a.plan.entries.size(); ++i) {
      ASSERT_EQ(a.plan.entries[i].key, b.plan.entries[i].key);
      ASSERT_EQ(a.plan.entries[i].profile->states, b.plan.entries[i].profile->states);
    }
  }

  PathLibrary library;
  RoadScene scene;
};

using Groups = Crossing;
using WithoutAPlan = Crossing;
using Work = Crossing;

TEST_F(ManyCrossings, PlansAnswerToOthersAsLateAsTheScene) {
  add(0, 60.0, 8.0);
  Forecast slower{.vehicle = scene.vehicles.front(), .earliest = {.states = {}}};
  for (int k = 0; k < 300; ++k) slower.earliest.states.push_back({60.0 + 0.8 * k, 8.0});
  slower.vehicle.key = -1;
  scene.vehicles.clear();
  add(0, 20.0, 12.0);
  scene.forecasts = {slower};
  const auto place = [&](double reaction) {
    scene.reaction = reaction;
    return decide_on_road(scene, {}, keys(), {}).plan.entries.front().profile->at(60).s;
  };
  EXPECT_GT(place(0.5), place(1.5) + 2.0);
}

TEST_F(ManyCrossings, EachIsAGroup) {
  fill({0, 1, 2, 3});
  const RoadDecision decision = decide_on_road(scene, {}, keys(), {});
  EXPECT_EQ(decision.groups, kCrossings);
  ASSERT_EQ(decision.members.size(), 4U);
  EXPECT_THAT(decision.members[1], testing::Contains(2));
  EXPECT_EQ(decision.stepped, 0);
}

TEST_F(ManyCrossings, AnyNumberOfThreadsGivesTheSame) {
  fill({0, 1, 2, 3});
  RoadEscotOptions options;
  options.threads = 1;
  const RoadDecision one = decide_on_road(scene, {}, keys(), options);
  options.pairs_for_threads = 0;
  for (const int threads : {0, 2, 3, 8}) {
    options.threads = threads;
    expect_same(decide_on_road(scene, {}, keys(), options), one);
  }
}

// Each group waits until a second thread has begun another one, or for long.
TEST_F(ManyCrossings, GroupsAreDividedAmongThreads) {
  if (tbb::info::default_concurrency() < 2) GTEST_SKIP() << "there is one core only";
  fill({0, 1, 2, 3});
  std::mutex mutex;
  std::condition_variable begun;
  std::set<std::thread::id> threads;
  RoadEscotOptions options;
  options.threads = 2;
  options.pairs_for_threads = 0;
  options.budget.clock = [&] {
    std::unique_lock lock(mutex);
    threads.insert(std::this_thread::get_id());
    begun.notify_all();
    begun.wait_for(lock, std::chrono::seconds(60), [&] { return threads.size() > 1; });
    return 0.0;
  };
  (void)decide_on_road(scene, {}, keys(), options);
  EXPECT_EQ(threads.size(), 2U);
}

TEST_F(ManyCrossings, AGroupIsPlannedAsIfItWereAlone) {
  fill({0, 1, 2, 3});
  const RoadDecision all = decide_on_road(scene, {}, keys(), {});
  std::erase_if(scene.vehicles, [](const RoadVehicle& v) { return v.path / 2 != 1; });
  const RoadDecision alone = decide_on_road(scene, {}, keys(), {});
  for (const JointPlan::Entry& e : alone.plan.entries) {
    EXPECT_EQ(e.profile->states, all.plan.find(e.key)->states);
  }
}

TEST_F(ManyCrossings, EachHasItsOwnCost) {
  fill({0, 1, 2});
  const RoadDecision all = decide_on_road(scene, {}, keys(), {});
  ASSERT_EQ(all.costs.size(), all.members.size());
  double sum = 0.0;
  for (const double cost : all.costs) sum += cost;
  EXPECT_NEAR(all.cost, sum, 1e-9);
  std::erase_if(scene.vehicles, [](const RoadVehicle& v) { return v.path / 2 != 1; });
  EXPECT_EQ(decide_on_road(scene, {}, keys(), {}).cost, all.costs[1]);
}

TEST_F(Groups, VehiclesOfOneExitLaneBelongTogether) {
  add(0, 150.0, 10.0);
  add(3, 150.0, 10.0);
  EXPECT_THAT(group_vehicles(scene), ElementsAre(ElementsAre(0), ElementsAre(1)));
  scene.vehicles[1].exit_lane = 0;
  EXPECT_THAT(group_vehicles(scene), ElementsAre(ElementsAre(0, 1)));
}

TEST_F(Groups, WhoIsThroughHasNothingToDoWithThoseBeforeTheCrossing) {
  add(0, 130.0, 10.0);
  add(1, 60.0, 10.0);
  EXPECT_THAT(group_vehicles(scene), ElementsAre(ElementsAre(0), ElementsAre(1)));
  scene.vehicles[0].now.s = 60.0;
  EXPECT_THAT(group_vehicles(scene), ElementsAre(ElementsAre(0, 1)));
}

//          | 1     Vehicle 0 cannot leave: somebody stands behind the crossing for ever. Whoever
//   0 -----+[ ]    drives through where it comes to rest has no plan.
TEST_F(WithoutAPlan, NobodyIsPlannedThroughTheBodyOfOneThatBrakes) {
  add(0, 96.0, 4.0);  // comes to rest in the middle of the crossing
  add(1, 60.0, 10.0);
  add(1, 40.0, 10.0);
  add_standing_forecast(2, 107.5);
  const RoadDecision decision = decide_on_road(scene, {}, {0, 1, 2}, {});
  EXPECT_EQ(decision.plan.entries.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const RoadVehicle& a = scene.vehicles[i];
      const RoadVehicle& b = scene.vehicles[j];
      EXPECT_FALSE(ever_touch(a, *decision.plan.find(a.key), b, *decision.plan.find(b.key)))
          << i << " and " << j;
    }
  }
}

//   Two who have lost their plans, where nobody is to come to rest. Were the first to creep on, the
//   two would stand nose to nose; at their lines long lorries block each other, too.
TEST_F(WithoutAPlan, NobodyCreepsOnBeforeOneWhoHasNoneEither) {
  add(0, 94.5, 1.5);
  add(1, 94.0, 0.0);
  for (RoadVehicle& v : scene.vehicles) v.no_waiting = {{80.0, 115.0}};
  const auto first_choice = [&](double line, bool has_plan) {
    scene.vehicles[1].stop_lines = {line};
    const RoadPairs pairs(scene);
    JointPlan complete;
    if (has_plan) {
      complete.entries.push_back(
          {1, std::make_shared<SpeedProfile>(*plan_vehicle(pairs, scene.vehicles[1], {}, {}))});
    }
    const ProfileOptions options;
    return RoadStepWorld(pairs, complete, options)
        .candidates(0, scene.vehicles[0].now)
        .front()
        .acceleration;
  };
  EXPECT_LT(first_choice(80.0, /*has_plan=*/false), 0.0);
  EXPECT_LT(first_choice(80.0, /*has_plan=*/true), 0.0);
  EXPECT_LT(first_choice(99.0, /*has_plan=*/false), 0.0) << "it waits at its line";
  scene.vehicles[1].now.s = 120.0;
  EXPECT_GT(first_choice(80.0, /*has_plan=*/false), 0.0) << "it is out";
}

//          | 1     A driver who does not yield goes over the crossing, perhaps at a crawl.
//   0 -----+-----  A car that cannot stop before his passage brakes, unless it is over it first.
TEST_F(WithoutAPlan, NobodyDrivesOnIntoADriverWhoBlocksIt) {
  const RoadVehicle driver = add(1, 90.0, 8.0);
  scene.vehicles.clear();
  const auto passing = [&](double speed) {
    SpeedProfile t{.states = {driver.now}};
    for (int k = 0; k < 300; ++k) t.states.push_back({t.states.back().s + speed / 10.0, speed});
    return t;
  };
  scene.forecasts = {
      {.vehicle = driver, .earliest = passing(8.0), .latest = passing(1.0), .yields = false}};
  add(0, 0.0, 6.0);
  const ContactTable& passage = library.contacts(0, 1);
  const auto rest = [&](const RoadStepWorld::Motion& m) {
    return m.to.s + stopping_distance(m.to.v, kCar.max_decel);
  };
  int inside = 0;
  for (double s = 80.0; s < 104.0; s += 0.5) {
    scene.vehicles[0].now.s = s;
    const RoadPairs pairs(scene);
    const JointPlan nobody;
    const RoadStepWorld world(pairs, nobody, {});
    const double stop = rest(world.safe_stop(0, scene.vehicles[0].now));
    if (!passage.blocks(stop, 90.0, 200.0) || passage.touches(s, 100.0)) continue;
    ++inside;
    for (const RoadStepWorld::Motion& m : world.candidates(0, scene.vehicles[0].now)) {
      EXPECT_TRUE(m.acceleration <= -kCar.max_decel || !passage.blocks(rest(m), 90.0, 200.0))
          << s << ": " << m.acceleration;
    }
  }
  EXPECT_GT(inside, 3);
}

SpeedProfile at_acceleration(const RoadScene& scene, InertialState now, double acceleration) {
  SpeedProfile t{.begin = scene.step, .states = {now}};
  while (t.states.back().s < 200.0 && t.states.size() < 300) {
    t.states.push_back(advance(t.states.back(), acceleration, scene.grid.dt));
  }
  return t;
}

/// Within ten seconds, by one who may be anywhere between two motions?
bool is_met(const ContactTable& contacts, const SpeedProfile& own, const Forecast& driver) {
  for (std::int64_t k = 0; k < 100 && own.at(k).s < SpeedProfile::kDeparted; ++k) {
    const double next = std::min(own.at(k + 1).s, 300.0);
    const double foremost = std::min(driver.earliest.at(k + 1).s, 1000.0);
    const double hindmost = std::min(driver.latest->at(k).s, foremost);
    if (contacts.meets(own.at(k).s, next, hindmost, foremost)) return true;
  }
  return false;
}

//          | 1     A car on the crossing has a plan that is off it before the driver comes.
//   0 -----+-----  Were it to brake now, it would still be on it: it keeps its plan.
TEST_F(WithoutAPlan, WhoWouldBeMetByBrakingKeepsThePlanThatGetsAway) {
  const ContactTable& contacts = library.contacts(0, 1);
  int met = 0;
  for (double from = 60.0; from < 96.0; from += 1.0) {
    const RoadVehicle driver = add(1, from, 5.0);
    const Forecast passes{.vehicle = driver,
                          .earliest = at_acceleration(scene, driver.now, kCar.max_accel),
                          .latest = at_acceleration(scene, driver.now, 0.0),
                          .yields = false};
    for (double s = 88.0; s < 104.0; s += 0.5) {
      scene.vehicles.clear();
      add(0, s, 8.0);
      RoadVehicle& car = scene.vehicles.back();
      car.cruise_speed = 8.0;  // it cannot get away sooner
      car.envelope = std::make_shared<SpeedEnvelope>(std::vector<double>(2000, 8.0), 3.0);
      scene.forecasts = {passes};
      SpeedProfile braking = at_acceleration(scene, car.now, -kCar.max_decel);
      braking.complete = false;
      const auto plan = std::make_shared<SpeedProfile>(at_acceleration(scene, car.now, 0.0));
      if (is_met(contacts, *plan, passes) || !is_met(contacts, braking, passes)) continue;
      ++met;
      JointPlan incumbent;
      incumbent.entries.push_back({car.key, plan});
      EXPECT_EQ(decide_on_road(scene, incumbent, {}, {}).stepped, 0) << s << ", driver " << from;
    }
  }
  EXPECT_GT(met, 20);
}

// It gets away from a driver only if it does so on its way, too, not only where it would come to
// rest far behind the crossing; the driver may go at once, or stand for good.
TEST_F(WithoutAPlan, WhoDrivesOnBeforeADriverIsNotMetOnItsWay) {
  const ContactTable& contacts = library.contacts(0, 1);
  int driven_on = 0;
  for (const double from : {86.0, 90.0, 94.0}) {
    const RoadVehicle driver = add(1, from, 2.0);
    const Forecast passes{.vehicle = driver,
                          .earliest = at_acceleration(scene, driver.now, kCar.max_accel),
                          .latest = at_acceleration(scene, driver.now, -kCar.max_decel),
                          .yields = false};
    for (double s = 78.0; s < 104.0; s += 0.5) {
      scene.vehicles.clear();
      add(0, s, 10.0);
      scene.forecasts = {passes};
      const InertialState now = scene.vehicles[0].now;
      if (contacts.touches(now.s, driver.now.s)) continue;
      const RoadPairs pairs(scene);
      const JointPlan nobody;
      const ProfileOptions options;
      const RoadStepWorld world(pairs, nobody, options);
      for (const RoadStepWorld::Motion& m : world.candidates(0, now)) {
        if (m.acceleration <= -kCar.max_decel) continue;
        ++driven_on;
        bool is_safe = false;
        for (int more = 0; more < 40 && !is_safe; ++more) {  // steps until it brakes
          SpeedProfile t{.begin = scene.step, .states = {now}, .complete = false};
          for (int k = 0; k < 250; ++k) {
            const double a = k < scene.grid.steps_per_decision          ? m.acceleration
                             : k < scene.grid.steps_per_decision + more ? kCar.max_accel
                                                                        : -kCar.max_decel;
            t.states.push_back(advance(t.states.back(), a, scene.grid.dt));
          }
          is_safe = !is_met(contacts, t, passes);
        }
        EXPECT_TRUE(is_safe) << "at " << s << " by " << m.acceleration << ", driver at " << from;
      }
    }
  }
  EXPECT_GT(driven_on, 50);
}

//   From the south it turns into the lane of a driver from the west, who does not yield.
TEST_F(WithoutAPlan, WhoCannotStopBeforeAPassageLeavesIt) {
  std::vector<Point> turn = {{0, -100}, {0, -6}};
  for (double a = 0.1; a < 1.5; a += 0.1)
    turn.push_back({6 - 6 * std::cos(a), 6 * std::sin(a) - 6});
  turn.push_back({60, 0});
  const int path = library.add(ReferencePath(turn), kCar);
  const RoadVehicle driver = add(0, 30.0, 8.0);
  scene.vehicles.clear();
  const auto passing = [&](double acceleration) {
    SpeedProfile t{.states = {driver.now}};
    for (int k = 0; k < 150; ++k) {
      t.states.push_back(advance(t.states.back(), acceleration, scene.grid.dt));
    }
    return t;
  };
  scene.forecasts = {
      {.vehicle = driver, .earliest = passing(0.5), .latest = passing(0.0), .yields = false}};
  add(path, 0.0, 2.0);
  int before = 0;
  int beyond = 0;
  for (double s = 80.0; s < 104.0; s += 0.5) {
    scene.vehicles[0].now.s = s;
    const RoadPairs pairs(scene);
    const JointPlan nobody;
    const ProfileOptions options;
    const RoadStepWorld world(pairs, nobody, options);
    const ContactTable& passage = library.contacts(path, 0);
    const auto rests_there = [&](const RoadStepWorld::Motion& m) {
      const double rest = m.to.s + stopping_distance(m.to.v, kCar.max_decel);
      return passage.blocks(rest, driver.now.s, 200.0);
    };
    const auto candidates = world.candidates(0, scene.vehicles[0].now);
    if (rests_there(world.safe_stop(0, scene.vehicles[0].now))) {
      ++beyond;
      EXPECT_GT(candidates.front().acceleration, 0.0) << s;
    } else {
      ++before;
      EXPECT_TRUE(std::ranges::none_of(candidates, rests_there)) << s;
    }
  }
  EXPECT_GT(before, 10);
  EXPECT_GT(beyond, 10);
}

TEST_F(WithoutAPlan, OthersOfItsGroupKeepTheirPlans) {
  add(0, 40.0, 4.0);    // cannot leave
  add(1, 100.0, 10.0);  // is in the crossing, and out of it before anyone comes
  add_standing_forecast(2, 107.5);
  const RoadDecision decision = decide_on_road(scene, {}, {0, 1}, {});
  EXPECT_EQ(decision.groups, 1);
  EXPECT_EQ(decision.stepped, 1);
  EXPECT_FALSE(decision.plan.find(0)->complete);
  EXPECT_TRUE(decision.plan.find(1)->complete);
}

TEST_F(WithoutAPlan, AnOldPlanStandsUnlessABrakingVehicleBlocksIt) {
  add(1, 60.0, 10.0);
  const RoadDecision before = decide_on_road(scene, {}, {0}, {});
  add(0, 40.0, 4.0);  // a newcomer that cannot leave, and stops before the crossing
  add_standing_forecast(2, 107.5);
  const RoadDecision after = decide_on_road(scene, before.plan, {1}, {});
  EXPECT_EQ(after.plan.find(0), before.plan.find(0));
  EXPECT_FALSE(after.plan.find(1)->complete);
}

TEST_F(Work, WithoutAnyLeftNewcomersArePlannedStill) {
  for (int i = 0; i < 4; ++i) {
    add(0, 70.0 - 14.0 * i, 12.0);
    add(1, 66.0 - 14.0 * i, 12.0);
  }
  RoadEscotOptions options;
  options.work = 1;
  const RoadDecision decision = decide_on_road(scene, {}, keys(), options);
  EXPECT_EQ(decision.stepped, 0);
  for (const JointPlan::Entry& e : decision.plan.entries) EXPECT_TRUE(e.profile->complete);
}

TEST_F(Work, EndsTheSearchForABetterOrder) {
  for (int i = 0; i < 5; ++i) {
    add(0, 70.0 - 14.0 * i, 13.0);
    add(1, 64.0 - 14.0 * i, 13.0);
  }
  CrossingOptions options;
  options.tries = 60;
  const double long_searched = plan_crossing(scene, keys(), {}, options, 1).cost;
  const double not_searched = plan_crossing(scene, keys(), {}, options, 1, WorkBudget{1}).cost;
  options.tries = 0;
  EXPECT_EQ(not_searched, plan_crossing(scene, keys(), {}, options, 1).cost);
  EXPECT_LT(long_searched, not_searched);
}

// With a budget of 500 ms and a clock that goes on by `ms` whenever it is read.
RoadEscotOptions read_every(double ms) {
  RoadEscotOptions options;
  options.crossing.tries = 60;
  options.budget = {.ms = 500.0, .clock = [ms, now = 0.0]() mutable { return now += ms; }};
  return options;
}

TEST_F(Work, TimeEndsTheSearchBeforeAGroupIsLate) {
  for (int i = 0; i < 5; ++i) {
    add(0, 70.0 - 14.0 * i, 13.0);
    add(1, 64.0 - 14.0 * i, 13.0);
  }
  const RoadDecision calm = decide_on_road(scene, {}, keys(), read_every(1e-6));
  const RoadDecision hurried = decide_on_road(scene, {}, keys(), read_every(130.0));
  EXPECT_TRUE(calm.late.empty());
  EXPECT_TRUE(hurried.late.empty());
  EXPECT_LT(calm.cost, hurried.cost);
  for (const JointPlan::Entry& e : hurried.plan.entries) EXPECT_TRUE(e.profile->complete);
}

TEST_F(Work, AGroupThatTakesLongerThanItsBudgetIsLate) {
  add(0, 70.0, 13.0);
  EXPECT_EQ(decide_on_road(scene, {}, keys(), read_every(501.0)).late, std::vector<std::size_t>{0});
}

//   With no other clock it is the processor's.
TEST_F(Work, NoGroupIsPlannedInNoTime) {
  add(0, 70.0, 13.0);
  add(1, 70.0, 13.0);
  RoadEscotOptions options;
  options.budget.ms = 0.0;
  EXPECT_EQ(decide_on_road(scene, {}, keys(), options).late, std::vector<std::size_t>{0});
  options.budget.ms = 1e6;
  EXPECT_TRUE(decide_on_road(scene, {}, keys(), options).late.empty());
}

}  // namespace
}  // namespace mvtp
