#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "planner/problem/validate.hpp"
#include "tests/planner/validate_scene.hpp"

namespace mvtp {
namespace {

using namespace validate_scene;  // NOLINT(google-build-using-namespace)

// ---- laws

/// Three cars with random arcs in a narrow place; many such plans overlap, some barely.
Scene random_scene(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * double(random()) / double(std::mt19937::max());
  };
  Scene scene(16, 16);
  scene.instance.map.bounds = Bounds::kAxle;
  scene.instance.map.circles = {{uniform(0, 16), uniform(0, 16), 0.8}};
  scene.instance.map.polygons = {{{7, 0}, {9, 0}, {8, 2}}};
  for (const char* name : {"a", "b", "c"}) {
    std::vector<std::pair<double, double>> steps;
    for (int k = 0; k < 4; ++k) steps.emplace_back(uniform(-1, 1), uniform(-0.5, 0.5));
    scene.add(name, {uniform(2, 14), uniform(2, 14), uniform(-kPi, kPi)}, steps);
  }
  return scene;
}

std::array<Point, 4> corners(const Pose& pose) {
  std::array<Point, 4> result;
  const double half = 0.5 * kCar.width;
  const std::array<Point, 4> local = {
      {{kCar.front, half}, {-kCar.rear, half}, {-kCar.rear, -half}, {kCar.front, -half}}};
  for (std::size_t k = 0; k < 4; ++k) {
    const Pose p = compose(pose, {local[k].x, local[k].y, 0});
    result[k] = {p.x, p.y};
  }
  return result;
}

/// Depth of the overlap of two convex polygons from their corners alone: the least over all sides
/// of how far the other reaches behind the side. (Independent of the referee's half extents.)
template <class A, class B>
double depth(const A& a, const B& b) {
  const auto behind = [](const auto& p, const auto& q) {
    double least = std::numeric_limits<double>::infinity();
    double area = 0.0;
    for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
      area += p[j].x * p[i].y - p[i].x * p[j].y;
    }
    for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
      const double sign = area > 0 ? 1.0 : -1.0;
      const double nx = sign * (p[i].y - p[j].y);
      const double ny = -sign * (p[i].x - p[j].x);
      double farthest = -std::numeric_limits<double>::infinity();
      for (const Point& c : q) {
        farthest = std::max(farthest, -((c.x - p[i].x) * nx + (c.y - p[i].y) * ny));
      }
      least = std::min(least, farthest / std::hypot(nx, ny));
    }
    return least;
  };
  return std::min(behind(a, b), behind(b, a));
}

/// The deepest overlap of cars i and j at 2,000 moments per step.
double sampled_depth(const Plan& plan, std::size_t i, std::size_t j) {
  constexpr int kSamples = 2000;
  const auto at = [&](std::size_t car, std::size_t step, double s) {
    const Waypoint& w = plan.trajectories[car].at(step);
    return drive(plan.trajectories[car].at(step - 1).pose, s * w.v, std::tan(w.phi));
  };
  double deepest = -1e9;
  for (std::size_t step = 1; step <= 4; ++step) {
    for (int k = 0; k <= kSamples; ++k) {
      const double s = double(k) / kSamples;
      deepest = std::max(deepest, depth(corners(at(i, step, s)), corners(at(j, step, s))));
    }
  }
  return deepest;
}

TEST(ValidateLaws, AgreesWithDenseSampling) {
  int overlapping = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Scene scene = random_scene(seed);
    const std::vector<Violation> violations = scene.judge();
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i + 1; j < 3; ++j) {
        double found = 0.0;
        for (const Violation& v : violations) {
          if (v.rule == Rule::kRobotOverlap && v.agents[0] == scene.plan.names[i] &&
              v.agents[1] == scene.plan.names[j]) {
            found = std::max(found, v.amount);
          }
        }
        const double sampled = sampled_depth(scene.plan, i, j);
        overlapping += sampled > kTouchTolerance;
        // Two moments are 0.5 ms of a step apart: no point moves by more than 1.2 mm against
        // another.
        if (sampled > kTouchTolerance) {
          EXPECT_GT(found, kTouchTolerance) << "seed " << seed;
        }
        if (sampled < kTouchTolerance - 0.0025) {
          EXPECT_EQ(found, 0.0) << "seed " << seed;
        }
        if (found > 0.0) {
          EXPECT_NEAR(found, sampled, 0.05) << "seed " << seed;
        }
      }
    }
  }
  EXPECT_GT(overlapping, 30);
  EXPECT_LT(overlapping, 150);
}

Pose moved(const Pose& by, const Pose& pose) { return compose(by, pose); }

/// The scene without its map's border, shifted and turned.
Scene moved(const Pose& by, Scene scene) {
  for (Agent& agent : scene.instance.agents) {
    agent.start = moved(by, agent.start);
    agent.goal = moved(by, agent.goal);
  }
  for (Trajectory& trajectory : scene.plan.trajectories) {
    std::vector<Waypoint> waypoints = trajectory.waypoints();
    for (Waypoint& w : waypoints) w.pose = moved(by, w.pose);
    trajectory = Trajectory(waypoints);
  }
  for (Circle& c : scene.instance.map.circles) {
    const Pose p = moved(by, {c.x, c.y, 0});
    c = {p.x, p.y, c.radius};
  }
  for (Polygon& polygon : scene.instance.map.polygons) {
    for (Point& point : polygon) {
      const Pose p = moved(by, {point.x, point.y, 0});
      point = {p.x, p.y};
    }
  }
  return scene;
}

TEST(ValidateLaws, DoesNotDependOnWhereTheSceneLies) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Scene scene = moved({500, 500, 0}, random_scene(seed));
    scene.instance.map.width = scene.instance.map.height = 1000;
    const std::vector<Violation> here = scene.judge();
    const std::vector<Violation> there = moved({500, 100, 0.7}, scene).judge();
    ASSERT_EQ(here.size(), there.size()) << "seed " << seed;
    for (std::size_t k = 0; k < here.size(); ++k) {
      EXPECT_EQ(here[k].rule, there[k].rule);
      EXPECT_EQ(here[k].agents, there[k].agents);
      EXPECT_NEAR(here[k].amount, there[k].amount, 1e-3);
    }
  }
}

TEST(ValidateLaws, DoesNotDependOnTheOrderOfTheAgents) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Scene scene = random_scene(seed);
    Scene reversed = scene;
    std::reverse(reversed.instance.agents.begin(), reversed.instance.agents.end());
    const auto sorted = [](const Scene& s) {
      std::vector<std::pair<Rule, std::vector<std::string>>> result;
      for (const Violation& v : s.judge()) {
        result.emplace_back(v.rule, v.agents);
        std::sort(result.back().second.begin(), result.back().second.end());
      }
      std::sort(result.begin(), result.end());
      return result;
    };
    EXPECT_EQ(sorted(scene), sorted(reversed)) << "seed " << seed;
  }
}

TEST(ValidateLaws, TheContinuousRuleIncludesTheStepsRule) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Scene scene = random_scene(seed);
    if (!scene.judge(CollisionRule::kSteps).empty()) {
      EXPECT_FALSE(scene.judge().empty()) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace mvtp
