#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "planner/problem/plan_file.hpp"
#include "planner/solve.hpp"
#include "tests/planner/scenes.hpp"
#include "tests/temporary_directory.hpp"

namespace mvtp {
namespace {

/// Reads a plan as CL-CBS's visualize.py does: by name, between two states along a straight line,
/// before the first and after the last at rest. Yaw as it stands in the file.
class Player {
 public:
  explicit Player(const std::string& path) : file_(YAML::LoadFile(path)) {}

  [[nodiscard]] double statistic(const std::string& key) const {
    return file_["statistics"][key].as<double>();
  }
  [[nodiscard]] YAML::Node states(const std::string& agent) const {
    return file_["schedule"][agent];
  }
  [[nodiscard]] std::size_t agents() const { return file_["schedule"].size(); }

  static Pose pose(const YAML::Node& state) {
    return {state["x"].as<double>(), state["y"].as<double>(), state["yaw"].as<double>()};
  }
  [[nodiscard]] Pose state(const std::string& agent, double t) const {
    const YAML::Node list = states(agent);
    std::size_t next = 0;
    while (next < list.size() && list[next]["t"].as<double>() < t) ++next;
    if (next == 0) return pose(list[0]);
    if (next == list.size()) return pose(list[next - 1]);
    const double since = list[next - 1]["t"].as<double>();
    const double share = (t - since) / (list[next]["t"].as<double>() - since);
    const Pose a = pose(list[next - 1]);
    const Pose b = pose(list[next]);
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
            a.theta + share * (b.theta - a.theta)};
  }

 private:
  YAML::Node file_;
};

class ClCbsFormat : public testing::TestWithParam<std::string> {
 protected:
  ClCbsFormat() { write_plan(plan_, path_); }

  const Instance instance_ = random_instance(11, 4, 4, 30);
  const Plan plan_ = solve(instance_, {.algorithm = GetParam(), .gap = 0.5}, Deadline::in(20));
  TemporaryDirectory directory_;
  const std::string path_ = directory_.path("plan.yaml");
};

TEST_P(ClCbsFormat, HasTheStatisticsWithTheirMeaning) {
  ASSERT_EQ(plan_.statistics.status, "solved");
  const Player player(path_);
  const double dt = player.statistic("dt");
  double last = 0;
  double sum = 0;
  for (const Agent& agent : instance_.agents) {
    const YAML::Node states = player.states(agent.name);
    std::size_t arrival = states.size() - 1;
    while (arrival > 0 && Player::pose(states[arrival - 1]) == Player::pose(states[arrival])) {
      --arrival;
    }
    last = std::max(last, double(arrival) * dt);
    sum += double(arrival) * dt;
  }
  EXPECT_NEAR(player.statistic("makespan"), last, 1e-9);
  EXPECT_NEAR(player.statistic("flowtime"), sum, 1e-6);
  EXPECT_NEAR(player.statistic("cost"), sum, 1e-6);
  EXPECT_GE(player.statistic("runtime"), 0.0);
}

TEST_P(ClCbsFormat, ListsTheStatesOfEveryAgentByStep) {
  ASSERT_EQ(plan_.statistics.status, "solved");
  const Player player(path_);
  ASSERT_EQ(player.agents(), instance_.agents.size());
  for (std::size_t i = 0; i < instance_.agents.size(); ++i) {
    const YAML::Node states = player.states(instance_.agents[i].name);
    ASSERT_TRUE(states.IsSequence());
    ASSERT_EQ(states.size(), plan_.trajectories[i].waypoints().size());
    for (std::size_t t = 0; t < states.size(); ++t) {
      EXPECT_EQ(states[t]["t"].as<std::size_t>(), t);
      EXPECT_EQ(Player::pose(states[t]), plan_.trajectories[i].at(t).pose);
    }
  }
}

TEST_P(ClCbsFormat, PlaysFromTheStartsToTheGoalsWithoutJumps) {
  ASSERT_EQ(plan_.statistics.status, "solved");
  const Player player(path_);
  const double dt = player.statistic("dt");
  for (const Agent& agent : instance_.agents) {
    EXPECT_EQ(player.state(agent.name, 0.0), agent.start);
    EXPECT_EQ(player.state(agent.name, 1e6), agent.goal);
    const double end = double(player.states(agent.name).size()) - 1;
    for (double t = 0; t < end; t += 0.5) {
      const double driven =
          distance(player.state(agent.name, t), player.state(agent.name, t + 0.5));
      EXPECT_LE(driven, 0.5 * dt * agent.vehicle.max_speed + 1e-6) << agent.name << " at " << t;
    }
  }
}

//   The bicycle model by hand: turning about the point at wheelbase / tan(phi) to the left.
TEST_P(ClCbsFormat, TheControlsLeadFromStateToState) {
  ASSERT_EQ(plan_.statistics.status, "solved");
  const Player player(path_);
  const double dt = player.statistic("dt");
  for (const Agent& agent : instance_.agents) {
    const YAML::Node states = player.states(agent.name);
    for (std::size_t t = 1; t < states.size(); ++t) {
      const Pose from = player.state(agent.name, double(t - 1));
      const double length = states[t]["v"].as<double>() * dt;
      const double curvature = std::tan(states[t]["phi"].as<double>()) / agent.vehicle.wheelbase;
      const double yaw = from.theta + length * curvature;
      const bool straight = std::abs(curvature) < 1e-9;
      const double x = straight ? from.x + length * std::cos(from.theta)
                                : from.x + (std::sin(yaw) - std::sin(from.theta)) / curvature;
      const double y = straight ? from.y + length * std::sin(from.theta)
                                : from.y - (std::cos(yaw) - std::cos(from.theta)) / curvature;
      const Pose to = player.state(agent.name, double(t));
      EXPECT_NEAR(to.x, x, 1e-6);
      EXPECT_NEAR(to.y, y, 1e-6);
      EXPECT_NEAR(wrap_to_pi(to.theta - yaw), 0.0, 1e-6);
    }
  }
}

//   CL-CBS's own solver turns clockwise.
TEST_P(ClCbsFormat, AClockwiseFileHasTheOppositeYaw) {
  ASSERT_EQ(plan_.statistics.status, "solved");
  write_plan(plan_, path_, YawSense::kClockwise);
  const Player player(path_);
  for (const Agent& agent : instance_.agents) {
    EXPECT_EQ(player.state(agent.name, 0.0).theta, -agent.start.theta);
  }
}

INSTANTIATE_TEST_SUITE_P(Algorithms, ClCbsFormat, testing::Values("escot", "escot-star"),
                         [](const auto& test) {
                           return test.param == "escot" ? "Escot" : "EscotStar";
                         });

}  // namespace
}  // namespace mvtp
