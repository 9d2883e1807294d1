#include "planner/road/known_plans.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "planner/problem/draws.hpp"
#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

using Entry = JointPlan::Entry;

constexpr double kAnyCost = std::numeric_limits<double>::infinity();

class KnownPlansTest : public Crossing {
 protected:
  /// Cars on all paths at random.
  void fill(Draws& draws) {
    scene.vehicles.clear();
    for (int i = 0; i < 6; ++i) {
      add(draws.between(0, 3), 5.0 + 12.0 * i + 5.0 * draws.share(), 3.0 + 9.0 * draws.share());
    }
  }

  /// Of the scene as it is.
  struct Asked {
    Asked(const RoadScene& scene, const ProfileOptions& options)
        : pairs(scene), cost(pairs, options, 3.0), plans(pairs, cost, options) {}
    RoadPairs pairs;
    JointCost cost;
    KnownPlans plans;
  };

  ProfileOptions options;
};

// Whoever is asked for, and in whatever order those before it were planned.
TEST_F(KnownPlansTest, AreThoseThatAreFoundAnew) {
  Draws draws(5);
  int known_before = 0;
  for (int round = 0; round < 20; ++round) {
    fill(draws);
    Asked asked(scene, options);
    for (int order = 0; order < 30; ++order) {
      std::vector<std::int64_t> keys = KnownPlansTest::keys();
      for (std::size_t i = keys.size(); i > 1; --i) {
        std::swap(keys[i - 1], keys[std::size_t(draws.between(0, int(i) - 1))]);
      }
      std::vector<Entry> before;
      for (const std::int64_t key : keys) {
        const double limit = draws.share() < 0.5 ? kAnyCost : 5.0 + 25.0 * draws.share();
        WorkBudget work{1'000'000};
        const auto plan =
            asked.plans.plan(scene.vehicle(key), before, {.work = &work, .cost = limit});
        known_before += int(work.left == 1'000'000);
        const auto anew =
            plan_vehicle(asked.pairs, scene.vehicle(key), before, options, {.cost = limit});
        ASSERT_EQ(plan != nullptr, anew.has_value());
        if (!plan) break;
        ASSERT_EQ(plan->states, anew->states);
        before.push_back({key, plan});
      }
    }
  }
  EXPECT_GT(known_before, 200);
}

TEST_F(KnownPlansTest, NothingIsKnownOfASearchThatRanOutOfWork) {
  add(0, 60.0, 8.0);
  add(1, 60.0, 8.0);
  Asked asked(scene, options);
  WorkBudget little{10};
  EXPECT_EQ(asked.plans.plan(scene.vehicles[0], {}, {.work = &little}), nullptr);
  WorkBudget enough{1'000'000};
  EXPECT_NE(asked.plans.plan(scene.vehicles[0], {}, {.work = &enough}), nullptr);
}

// Another plan for who is met is another question, also if it is at the address of an old one.
TEST_F(KnownPlansTest, PlansThatAreForgottenAreNotMistaken) {
  add(0, 60.0, 8.0);
  add(1, 60.0, 8.0);
  Asked asked(scene, options);
  for (double v = 2.0; v < 12.0; v += 0.5) {
    SpeedProfile other{.states = {scene.vehicles[1].now}};
    while (other.states.back().s < 190.0) {
      other.states.push_back({other.states.back().s + 0.1 * v, v});
    }
    const std::vector<Entry> before = {{1, std::make_shared<SpeedProfile>(other)}};
    WorkBudget work{1'000'000};
    const auto plan = asked.plans.plan(scene.vehicles[0], before, {.work = &work});
    const auto anew = plan_vehicle(asked.pairs, scene.vehicles[0], before, options);
    ASSERT_EQ(plan != nullptr, anew.has_value());
    if (!plan) continue;
    EXPECT_EQ(plan->states, anew->states) << v;
  }
}

}  // namespace
}  // namespace mvtp
