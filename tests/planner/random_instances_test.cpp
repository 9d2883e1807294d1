#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "planner/problem/check_instance.hpp"
#include "planner/problem/validate.hpp"
#include "planner/solve.hpp"
#include "tests/planner/plan_properties.hpp"
#include "tests/planner/small_instances.hpp"

namespace mvtp {
namespace {

constexpr int kShards = 8;

/// The clock only guards against a search that does not end; what is solved must be right anyway.
Deadline safety_net(const SolveOptions& options) {
  return Deadline::in(options.algorithm == "escot-star" ? 0.1 : 0.3);
}

/// `MVTP_LONG_TESTS=10000` in the environment asks for so many instances in all.
int instances_per_shard() {
  const char* wanted = std::getenv("MVTP_LONG_TESTS");
  return wanted == nullptr ? 34 : std::max(1, std::atoi(wanted) / kShards);
}

SolveOptions options_for(int seed, const std::string& algorithm) {
  constexpr double kGaps[] = {0.01, 0.1, 0.5};
  return {.algorithm = algorithm,
          .collision = seed % 5 == 4 ? CollisionRule::kSteps : CollisionRule::kContinuous,
          .seed = std::uint64_t(seed % 7),
          .runs = seed % 11 == 0 ? 2 : 1,
          .run_time_limit = seed % 11 == 0 ? 0.05 : 1e9,
          .gap = kGaps[seed % 3],
          .threads = seed % 4 == 3 ? 2 : 1};
}

/// The instance without what does not matter for the failure, and what fails then.
std::string smallest_failure(const Instance& instance, const SolveOptions& options) {
  const auto broken = [&options](const Instance& candidate) {
    return broken_properties(candidate, options, solve(candidate, options, safety_net(options)));
  };
  const Instance small =
      shrunk(instance, [&broken](const Instance& i) { return !broken(i).empty(); });
  return fmt::format("{}, seed {}, gap {}, {} threads, {} run(s), {}: {}\n{}", options.algorithm,
                     options.seed, options.gap, options.threads, options.runs,
                     options.collision == CollisionRule::kSteps ? "steps" : "continuous",
                     fmt::join(broken(small), "; "), yaml_of(small));
}

/// Every instance goes to escot-star and to one of the other algorithms in turn.
class RandomInstances : public testing::TestWithParam<int> {
 protected:
  /// The status, after all properties have been looked at.
  std::string judged_status(int seed, const Instance& instance, const std::string& algorithm) {
    const SolveOptions options = options_for(seed, algorithm);
    const Plan plan = solve(instance, options, safety_net(options));
    const std::vector<std::string> broken = broken_properties(instance, options, plan);
    if (!broken.empty()) {
      ADD_FAILURE() << algorithm << ": " << fmt::format("{}", fmt::join(broken, "; ")) << '\n'
                    << smallest_failure(instance, options);
    }
    ++answers_[algorithm][plan.statistics.status];
    return plan.statistics.status;
  }

  std::map<std::string, std::map<std::string, int>> answers_;
};

TEST_P(RandomInstances, EveryAnswerIsRight) {
  const std::vector<std::string>& names = algorithm_names();
  const int count = instances_per_shard();
  for (int seed = count * GetParam(); seed < count * (GetParam() + 1); ++seed) {
    SCOPED_TRACE(seed);
    const Instance instance = small_instance(std::uint64_t(seed));
    ASSERT_TRUE(check_instance(instance, "instance").empty());
    const std::string other = names[std::size_t(seed) % names.size()];
    const std::string a = judged_status(seed, instance, "escot-star");
    const std::string b = judged_status(seed, instance, other);
    EXPECT_FALSE((a == "solved" && b == "infeasible") || (a == "infeasible" && b == "solved"))
        << "escot-star: " << a << ", " << other << ": " << b << '\n'
        << yaml_of(instance);
  }
  for (const auto& [name, statuses] : answers_) {
    for (const auto& [status, number] : statuses) {
      RecordProperty(name + " " + status, number);
    }
  }
  EXPECT_GT(answers_["escot-star"]["solved"], 0);
}

INSTANTIATE_TEST_SUITE_P(Shards, RandomInstances, testing::Range(0, kShards));

//   Its steps are shorter than those that the instance allows to look at. In these instances a
//   robot finds its single-agent path by full steps only.
TEST(EscotStarUnderSteps, IsFreeBetweenThem) {
  for (const int seed : {384, 414, 439, 664, 724, 869, 974}) {
    SCOPED_TRACE(seed);
    const Instance instance = small_instance(std::uint64_t(seed));
    const SolveOptions options = options_for(seed, "escot-star");
    ASSERT_EQ(options.collision, CollisionRule::kSteps);
    const Plan plan = solve(instance, options, safety_net(options));
    EXPECT_TRUE(broken_properties(instance, options, plan).empty());
    if (plan.statistics.status != "solved") continue;
    for (const Violation& v : find_violations(instance, plan, CollisionRule::kContinuous)) {
      ADD_FAILURE() << v.message;
    }
  }
}

class NoRobots : public testing::TestWithParam<std::string> {};

TEST_P(NoRobots, AreAtTheirGoals) {
  const Instance nobody{.agents = {}, .map = {.width = 20, .height = 20}, .dt = 1.0};
  const SolveOptions options{.algorithm = GetParam()};
  const Plan plan = solve(nobody, options, Deadline::in(20));
  EXPECT_EQ(plan.statistics.status, "solved");
  EXPECT_TRUE(broken_properties(nobody, options, plan).empty());
  EXPECT_EQ(plan.statistics.makespan_steps, 0U);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, NoRobots, testing::ValuesIn(algorithm_names()),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace mvtp
