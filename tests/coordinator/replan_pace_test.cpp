#include "coordinator/replan_pace.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/coordinator/closed_loop.hpp"
#include "tests/coordinator/shapes.hpp"

namespace mvtp {
namespace {

const RoadEscotOptions kFull{.crossing = {.tries = 30}, .work = 4'000'000};

TEST(ReplanPace, DoesAllTheWorkAsLongAsNobodyIsLate) {
  ReplanPace pace(500.0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(pace.note(500.0));
    EXPECT_EQ(pace.for_next(kFull).work, kFull.work);
    EXPECT_EQ(pace.for_next(kFull).crossing.tries, kFull.crossing.tries);
  }
}

TEST(ReplanPace, DoesLessAfterEachLatePlanAndStillPlans) {
  ReplanPace pace(500.0);
  RoadEscotOptions before = kFull;
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(pace.note(500.1));
    const RoadEscotOptions next = pace.for_next(kFull);
    EXPECT_LT(next.work, before.work);
    EXPECT_LT(next.crossing.tries, before.crossing.tries);
    before = next;
  }
  EXPECT_EQ(before.crossing.tries, 0);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(pace.note(1e6));
  EXPECT_GT(pace.for_next(kFull).work, 0);
}

TEST(ReplanPace, DoesAllTheWorkAgainOnceItHasBeenEasyForAWhile) {
  ReplanPace pace(500.0);
  pace.note(600.0);
  for (int i = 0; i < 5; ++i) pace.note(10.0);
  EXPECT_LT(pace.for_next(kFull).work, kFull.work);
  for (int i = 0; i < 20; ++i) pace.note(10.0);
  EXPECT_EQ(pace.for_next(kFull).work, kFull.work);
  pace.note(600.0);
  for (int i = 0; i < 100; ++i) pace.note(400.0);  // in time, but not by much
  EXPECT_LT(pace.for_next(kFull).work, kFull.work);
}

// One plan in three is late, and all of one stretch of twenty.
TEST(ReplanPace, LatePlansDelayVehiclesAndLoseNobody) {
  const NetworkShape shape = crossroads_shape();
  double now = 0.0;
  int calls = 0;
  CoordinatorOptions options;
  options.replan_budget_ms = 500.0;
  options.clock = [&] {
    const int plan = calls++ / 2;
    const bool is_late = plan % 3 == 0 || (plan > 40 && plan < 60);
    return now += is_late ? 600.0 : 1.0;
  };
  ClosedLoop run(shape, random_trips(shape, {.vehicles = 30, .seed = 3}), 0.1, options);
  run.run_until(300.0);
  EXPECT_GT(std::ranges::count_if(run.coordinator.replans(), &Replan::fallback), 20);
  EXPECT_TRUE(run.broken.empty()) << run.broken.front();
  EXPECT_EQ(run.audit.figures().overlap_pairs_coordinated, 0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

}  // namespace
}  // namespace mvtp
