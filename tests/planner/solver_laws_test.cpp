#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "planner/problem/validate.hpp"
#include "planner/solve.hpp"
#include "tests/planner/plan_properties.hpp"
#include "tests/planner/scenes.hpp"
#include "tests/planner/small_instances.hpp"

namespace mvtp {
namespace {

constexpr double kLimit = 20.0;  // [s]; a safety net

/// Solves what is easy and has every property looked at.
Plan judged(const Instance& instance, const SolveOptions& options) {
  Plan plan = solve(instance, options, Deadline::in(kLimit));
  EXPECT_EQ(plan.statistics.status, "solved") << plan.statistics.reason << yaml_of(instance);
  for (const std::string& broken : broken_properties(instance, options, plan)) {
    ADD_FAILURE() << broken << '\n' << yaml_of(instance);
  }
  return plan;
}

SolveOptions star(double gap, int threads = 1) {
  return {.algorithm = "escot-star", .gap = gap, .threads = threads};
}

/// 2 to 5 robots with 0 to 4 obstacles on 30 x 30 m.
class EasyInstance : public testing::TestWithParam<std::uint64_t> {
 protected:
  [[nodiscard]] static Instance instance() {
    return random_instance(2000 + GetParam(), 2 + int(GetParam() % 4), int(GetParam() % 5), 30);
  }
};

TEST_P(EasyInstance, StaysSolvableInTheMirror) {
  for (const char* algorithm : {"escot-star", "escot"}) {
    const SolveOptions options{.algorithm = algorithm, .gap = 0.5};
    (void)judged(instance(), options);
    (void)judged(mirrored(instance()), options);
  }
}

template <class List>
void reorder(List& list) {
  std::ranges::rotate(list, list.begin() + 1);
  std::swap(list.front(), list[list.size() / 2]);
}

TEST_P(EasyInstance, StaysSolvableWithItsRobotsInAnotherOrder) {
  Instance permuted = instance();
  reorder(permuted.agents);
  (void)judged(permuted, star(0.5));

  Plan plan = judged(instance(), star(0.5));
  reorder(plan.names);
  reorder(plan.trajectories);
  EXPECT_TRUE(find_violations(permuted, plan, CollisionRule::kContinuous).empty());
}

//   The wide gap ends the very same search earlier, so that more of it can only do better.
TEST_P(EasyInstance, AWiderGapEndsTheSameSearchEarlier) {
  const Plan loose = judged(instance(), star(0.5));
  const Plan tight = judged(instance(), star(0.01));
  EXPECT_LE(tight.statistics.makespan, loose.statistics.makespan + 1e-9);
}

/// Whether the search ended by itself, so that its plan is due again.
bool ended_by_itself(const Plan& plan) { return plan.statistics.runtime < 0.9 * kLimit; }

TEST_P(EasyInstance, GivesTheSamePlanForTheSameSeedAndThreads) {
  for (const int threads : {1, 2}) {
    const Plan first = judged(instance(), star(0.1, threads));
    const Plan second = judged(instance(), star(0.1, threads));
    if (!ended_by_itself(first) || !ended_by_itself(second)) continue;
    EXPECT_EQ(first.trajectories, second.trajectories) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, EasyInstance, testing::Range(std::uint64_t{0}, std::uint64_t{24}));

TEST(PlanProperties, NoticeEveryWrongFigureAndPose) {
  const Instance instance = random_instance(2001, 3, 1, 30);
  const SolveOptions options = star(0.5);
  const Plan good = judged(instance, options);
  const std::vector<std::function<void(Plan&)>> mistakes = {
      [](Plan& p) { p.statistics.status = "done"; },
      [](Plan& p) { p.statistics.algorithm = "escot"; },
      [](Plan& p) { p.statistics.reason = "none"; },
      [](Plan& p) { p.statistics.runtime = -1; },
      [](Plan& p) { p.statistics.cost += 1; },
      [](Plan& p) { p.statistics.makespan += 1; },
      [](Plan& p) { p.statistics.makespan_steps += 1; },
      [](Plan& p) { p.statistics.lower_bound = p.statistics.makespan + 1; },
      [](Plan& p) { p.statistics.solo_makespan = p.statistics.makespan + 1; },
      [](Plan& p) { p.statistics.solo_makespan = p.statistics.lower_bound - 1; },
      [](Plan& p) { p.statistics.first_solution = p.statistics.runtime + 1; },
      [](Plan& p) { std::swap(p.names[0], p.names[1]); },
      [](Plan& p) { p.trajectories.pop_back(); },
      [](Plan& p) { std::swap(p.trajectories[0], p.trajectories[1]); },
      [](Plan& p) { p.trajectories[0].truncate(p.trajectories[0].makespan() - 1); }};
  for (std::size_t i = 0; i < mistakes.size(); ++i) {
    Plan bad = good;
    mistakes[i](bad);
    EXPECT_FALSE(broken_properties(instance, options, bad).empty()) << "mistake " << i;
  }
}

TEST(SmallInstances, HoldWhatTheyPromise) {
  int touching_or_on_goals = 0;
  int at_goal = 0;
  int empty = 0;
  int mixed = 0;
  int crowded = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Instance instance = small_instance(seed);
    const std::vector<Agent>& agents = instance.agents;
    empty += agents.empty() ? 1 : 0;
    crowded += agents.size() >= 6 ? 1 : 0;
    for (const Agent& agent : agents) {
      at_goal += agent.start == agent.goal ? 1 : 0;
      mixed += agent.vehicle != agents[0].vehicle ? 1 : 0;
      touching_or_on_goals += std::ranges::any_of(agents, [&](const Agent& other) {
        return other.name != agent.name && other.goal == agent.start;
      });
    }
  }
  EXPECT_GT(empty, 0);
  EXPECT_GT(at_goal, 10);
  EXPECT_GT(mixed, 30);
  EXPECT_GT(crowded, 10);
  EXPECT_GT(touching_or_on_goals, 20);
}

}  // namespace
}  // namespace mvtp
