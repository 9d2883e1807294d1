#include "planner/search/occupancy.hpp"

#include <gtest/gtest.h>

#include <random>

namespace mvtp {
namespace {

const Vehicle kCar{.front = 2.0, .rear = 1.0, .min_turning_radius = 3.0};
constexpr TimeGrid kTime{0.1059, 14};

ArcTrajectory random_trajectory(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> place(5.0, 35.0);
  std::uniform_int_distribution<int> which(-1, 1);
  std::vector<Arc> steps;
  const int macro_steps = int(rng() % 20);
  for (int k = 0; k < macro_steps; ++k) {
    steps.insert(steps.end(), 14, Arc{0.1059 * which(rng), which(rng) / 3.0});
  }
  return {kCar, {place(rng), place(rng), place(rng)}, steps, kTime.macro_step};
}

class OccupancyOfMany : public testing::Test {
 protected:
  static constexpr int kRobots = 37;  // no multiple of any vector

  OccupancyOfMany() : occupancy(kRobots, kTime), found(kRobots + Occupancy::kPadding) {
    for (int i = 0; i < kRobots; ++i) {
      trajectories.push_back(random_trajectory(rng));
      occupancy.place(i, trajectories.back(), shape);
    }
  }

  std::mt19937_64 rng{5};
  BoxShape shape = box_shape(kCar, kTime.dt);
  Occupancy occupancy;
  std::vector<ArcTrajectory> trajectories;
  std::vector<int> found;
};

//   The circles contain the bodies: whoever comes close to a body during a macro step is near.
TEST_F(OccupancyOfMany, NobodyIsOverlooked) {
  std::uniform_real_distribution<float> place(0.0F, 40.0F);
  for (int n = 0; n < 2000; ++n) {
    const int macro_step = int(rng() % 25);  // beyond the horizon, too
    const BoxPose dot{place(rng), place(rng), 1.0F, 0.0F};
    const int count = occupancy.near(macro_step, dot.x, dot.y, 0.5F, found.data());
    EXPECT_TRUE(std::is_sorted(found.begin(), found.begin() + count));
    for (int i = 0; i < kRobots; ++i) {
      const bool listed = std::count(found.begin(), found.begin() + count, i) == 1;
      EXPECT_EQ(listed, occupancy.overlaps(macro_step, i, dot.x, dot.y, 0.5F));
      const BoxPose* boxes = trajectories[std::size_t(i)].boxes(macro_step * kTime.macro_step);
      for (int t = 0; t <= kTime.macro_step; ++t) {
        if (gap(boxes[t], shape, dot, {}) < 0.5F / std::sqrt(2.0F)) {
          EXPECT_TRUE(listed) << i;
        }
      }
    }
  }
}

TEST_F(OccupancyOfMany, TravelBoundsEveryCorner) {
  for (int i = 0; i < kRobots; ++i) {
    for (int k = 0; k < 22; ++k) {
      const BoxPose* boxes = trajectories[std::size_t(i)].boxes(k * kTime.macro_step);
      for (int t = 0; t < kTime.macro_step; ++t) {
        for (const float side : {-1.0F, 1.0F}) {
          const auto corner = [&](const BoxPose& b) {
            return std::pair(b.x + 1.5F * b.ux - side * b.uy, b.y + 1.5F * b.uy + side * b.ux);
          };
          const auto [ax, ay] = corner(boxes[t]);
          const auto [bx, by] = corner(boxes[t + 1]);
          EXPECT_LE(std::hypot(bx - ax, by - ay), occupancy.sweep(k, i).travel + 1e-5F);
        }
      }
    }
  }
}

TEST_F(OccupancyOfMany, RemovedRobotsAreNotFound) {
  occupancy.remove(7);
  for (int k = 0; k < 25; ++k) {
    const BoxPose& box = *trajectories[7].boxes(k * kTime.macro_step);
    const int count = occupancy.near(k, box.x, box.y, 1.0F, found.data());
    EXPECT_EQ(std::count(found.begin(), found.begin() + count, 7), 0);
  }
}

}  // namespace
}  // namespace mvtp
