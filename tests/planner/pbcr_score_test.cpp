// PBCR as its paper ranks robots and motions, beside ours.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/escot/escot.hpp"
#include "planner/problem/validate.hpp"
#include "planner/solve.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

Plan with(PbcrScore score, const Instance& instance, const std::string& algorithm = "pbcr") {
  return solve(instance, {.algorithm = algorithm, .pbcr = score}, Deadline::in(60));
}

class PaperScores : public testing::TestWithParam<std::uint64_t> {};

TEST_P(PaperScores, MakePlansThatSatisfyTheReferee) {
  const Instance instance = random_instance(GetParam(), 4, 4, 30);
  const Plan escot = with(PbcrScore::kPaper, instance, "escot");
  EXPECT_EQ(escot.statistics.status, "solved") << escot.statistics.reason;
  for (const std::string algorithm : {"escot", "pbcr"}) {
    const Plan plan = with(PbcrScore::kPaper, instance, algorithm);
    EXPECT_EQ(plan.trajectories, with(PbcrScore::kPaper, instance, algorithm).trajectories);
    if (plan.statistics.status != "solved") continue;
    for (const Violation& v : find_violations(instance, plan, CollisionRule::kContinuous)) {
      ADD_FAILURE() << algorithm << ": " << v.message;
    }
  }
}

TEST(PaperScores, ArePartOfWhatThePlanSays) {
  const auto said_by = [](const char* algorithm, PbcrScore score) {
    return with(score, circle(2), algorithm).statistics.pbcr;
  };
  EXPECT_EQ(said_by("escot", PbcrScore::kPaper), "paper");
  EXPECT_EQ(said_by("pbcr", PbcrScore::kPaper), "paper");
  EXPECT_EQ(said_by("escot", PbcrScore::kStrengthened), "");
  EXPECT_EQ(said_by("eccr", PbcrScore::kPaper), "") << "it does not rank by them";
}

INSTANTIATE_TEST_SUITE_P(Seeds, PaperScores,
                         testing::Range(std::uint64_t{700}, std::uint64_t{708}));

// Nose to nose the one that is pushed goes back, step after step, to its start and beyond.
TEST(PaperScores, DoNotGiveWayInTime) {
  const Plan paper = with(PbcrScore::kPaper, circle(2));
  const Plan strengthened = with(PbcrScore::kStrengthened, circle(2));
  ASSERT_EQ(strengthened.statistics.status, "solved");
  const bool is_late = paper.statistics.status != "solved" ||
                       paper.statistics.makespan_steps > 2 * strengthened.statistics.makespan_steps;
  EXPECT_TRUE(is_late) << paper.statistics.makespan_steps;
}

// Of equal time under way the nearest comes first, ours lets those go first that have the longest
// path.
TEST(PaperScores, TheNearestOfThoseEquallyLateComesFirst) {
  Instance instance = circle(3);
  for (Agent& agent : instance.agents) agent.goal = agent.start;
  const double far[] = {6.0, 2.0, 4.0};
  for (std::size_t i = 0; i < 3; ++i) {
    instance.agents[i].goal = compose(instance.agents[i].start, {far[i], 0.0, 0.0});
  }
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  const Deadline never = Deadline::never();
  const auto order = [&](PbcrScore score) {
    SteppedWorld world(problem, {.score = score}, never);
    world.update_reference_paths(problem.starts());
    return world.order(problem.starts());
  };
  EXPECT_THAT(order(PbcrScore::kPaper), testing::ElementsAre(1, 2, 0));
  EXPECT_THAT(order(PbcrScore::kStrengthened), testing::ElementsAre(0, 2, 1));
}

}  // namespace
}  // namespace mvtp
