#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "planner/geometry/sweep.hpp"
#include "planner/problem/instance.hpp"

namespace mvtp {

inline Map empty_map(double side) {
  return {.width = side, .height = side, .circles = {}, .polygons = {}};
}

inline Agent agent(const Pose& start, const Pose& goal, int number = 0) {
  return {"agent" + std::to_string(number), Vehicle{}, start, goal};
}

/// n robots on a circle in the middle of a 50 x 50 m map, each facing its goal straight across.
inline Instance circle(int n, double radius = 15.0) {
  Instance instance{.agents = {}, .map = empty_map(50), .dt = 1.0};
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    const double inwards = wrap_to_pi(angle + std::numbers::pi);
    instance.agents.push_back(
        agent({25 + radius * std::cos(angle), 25 + radius * std::sin(angle), inwards},
              {25 - radius * std::cos(angle), 25 - radius * std::sin(angle), inwards}, i));
  }
  return instance;
}

/// Random starts, goals and round obstacles on a square map; bodies at least 0.3 m apart.
inline Instance random_instance(std::uint64_t seed, int robots, int obstacles, double side) {
  std::mt19937_64 rng(seed);
  const auto in = [&rng](double low, double high) {
    return low + (high - low) * double(rng() >> 11U) * 0x1p-53;
  };
  Instance instance{.agents = {}, .map = empty_map(side), .dt = 1.0};
  const Vehicle wide{.front = 2.8, .rear = 0.8, .width = 2.6};
  std::vector<Sweep> starts;
  std::vector<Sweep> goals;
  const auto place = [&](std::vector<Sweep>& taken) {
    while (true) {
      const Pose pose{in(3, side - 3), in(3, side - 3), in(-3.1, 3.1)};
      const Sweep body(wide, pose, {});
      bool free = true;
      for (const Sweep& other : taken) free = free && !collide(body, other);
      if (!free) continue;
      taken.push_back(body);
      return pose;
    }
  };
  for (int i = 0; i < robots; ++i) {
    const Pose start = place(starts);
    instance.agents.push_back(agent(start, place(goals), i));
  }
  while (int(instance.map.circles.size()) < obstacles) {
    const Circle circle{in(0, side), in(0, side), 0.8};
    bool free = true;
    for (const auto* taken : {&starts, &goals}) {
      for (const Sweep& body : *taken) {
        free = free && !collide(body, {circle.x, circle.y}, circle.radius);
      }
    }
    if (free) instance.map.circles.push_back(circle);
  }
  return instance;
}

}  // namespace mvtp
