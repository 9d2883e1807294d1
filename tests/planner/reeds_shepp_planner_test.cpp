#include "planner/search/reeds_shepp_planner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/motion/obstacles.hpp"

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;
const Vehicle kCar{.front = 3.9, .rear = 1.1, .width = 1.9, .min_turning_radius = 4.5};

/// A car that leaves a slot between two others, onto an aisle with a row of cars across.
///
/// Boxes [m], as a car that stands at x in slots of 2.5 m sees them; a wall at both ends.
class Aisle {
 public:
  explicit Aisle(double width) {
    map_.width = 40.0;
    map_.height = 30.0;
    add({0, 0}, {40, 1});
    add({0, 0}, {1, 30});
    add({39, 0}, {40, 30});
    add({1, 1}, {19.2, 6.5});   // beside the slot,
    add({21.8, 1}, {39, 6.5});  // which is 2.6 m wide
    add({1, 6.5 + width}, {39, 13 + width});
    obstacles_.emplace(map_, 4.0);
  }

  [[nodiscard]] Pose slot() const { return {20.5, 2.3, kPi / 2}; }  // beside the middle
  [[nodiscard]] Pose exit() const { return {8.0, 9.0, kPi}; }

  [[nodiscard]] ArcCheck check() const {
    return [this](const Pose& from, const Arc& arc) {
      return std::abs(arc.length) <= kLongestPiece && !obstacles_->hit(Sweep(kCar, from, arc));
    };
  }

  [[nodiscard]] auto plan(const Pose& to, const SamplingOptions& options = {}) const {
    return plan_by_sampling(slot(), to, kCar.min_turning_radius, {40, 30}, options, check());
  }

 private:
  void add(const Point& low, const Point& high) {
    map_.polygons.push_back({low, {high.x, low.y}, high, {low.x, high.y}});
  }

  Map map_;
  std::optional<Obstacles> obstacles_;
};

void expect_drives(const std::vector<Arc>& arcs, Pose from, const Pose& to, const ArcCheck& free) {
  for (const Arc& arc : arcs) {
    EXPECT_TRUE(free(from, arc)) << from.x << ' ' << from.y << ' ' << from.theta;
    EXPECT_LE(std::abs(arc.curvature) * kCar.min_turning_radius, 1.0 + 1e-12);
    from = drive(from, arc);
  }
  EXPECT_LT(distance(from, to), 1e-8);
  EXPECT_LT(std::abs(wrap_to_pi(from.theta - to.theta)), 1e-8);
}

TEST(PlanBySampling, LeavesATightSlot) {
  const Aisle aisle(5.2);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const auto path = aisle.plan(aisle.exit(), {.seed = seed});
    ASSERT_TRUE(path) << seed;
    expect_drives(*path, aisle.slot(), aisle.exit(), aisle.check());
  }
}

TEST(PlanBySampling, EntersIt) {
  const Aisle aisle(5.2);
  const auto path = plan_by_sampling(aisle.exit(), aisle.slot(), kCar.min_turning_radius, {40, 30},
                                     {}, aisle.check());
  ASSERT_TRUE(path);
  expect_drives(*path, aisle.exit(), aisle.slot(), aisle.check());
}

//   Whatever else has drawn random numbers from OMPL meanwhile.
TEST(PlanBySampling, GivesTheSamePathForTheSameSeed) {
  const Aisle aisle(5.2);
  const auto first = aisle.plan(aisle.exit(), {.seed = 7});
  (void)aisle.plan({30.0, 9.0, 0.0}, {.seed = 8});
  ASSERT_TRUE(first);
  EXPECT_EQ(aisle.plan(aisle.exit(), {.seed = 7}), first);
  EXPECT_NE(aisle.plan(aisle.exit(), {.seed = 9}), first);
}

TEST(PlanBySampling, GivesUpAfterItsIterationsAndSaysNothing) {
  const Aisle aisle(2.0);  // as wide as the car: nobody turns here
  int checks = 0;
  const auto count = [&](const Pose& from, const Arc& arc) {
    ++checks;
    return aisle.check()(from, arc);
  };
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const auto with = [&](int iterations) {
    checks = 0;
    const auto path = plan_by_sampling(aisle.slot(), {8.0, 7.5, kPi}, kCar.min_turning_radius,
                                       {40, 30}, {.iterations = iterations}, count);
    EXPECT_FALSE(path);
    return checks;
  };
  const int few = with(50);
  EXPECT_GT(with(500), few);
  EXPECT_EQ(with(50), few);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

//   OMPL waits for another goal, 5 ms per iteration: with so many the test would not end.
TEST(PlanBySampling, HasNoPathFromOrToAPlaceThatIsTaken) {
  const Aisle aisle(5.2);
  const SamplingOptions options{.iterations = 1'000'000'000};
  EXPECT_FALSE(aisle.plan({10.0, 3.0, 0.0}, options));
  EXPECT_FALSE(aisle.plan({-5.0, 9.0, 0.0}, options));
  EXPECT_FALSE(plan_by_sampling({10.0, 3.0, 0.0}, aisle.exit(), kCar.min_turning_radius, {40, 30},
                                options, aisle.check()));
}

TEST(PlanBySampling, IsTheReedsSheppPathWhereNothingBlocksIt) {
  const Pose from{20, 15, 0.3};
  const Pose to{24, 18, -kPi};
  const auto free = [](const Pose&, const Arc&) { return true; };
  const auto path = plan_by_sampling(from, to, 3.0, {40, 30}, {.cusp = 0.0}, free);
  ASSERT_TRUE(path);
  double length = 0.0;
  for (const Arc& arc : *path) length += std::abs(arc.length);
  EXPECT_NEAR(length, shortest_length(from, to, 3.0), 1e-6);
}

//   What the trees find is the same, whatever a cusp counts; of the paths over its vertices the
//   best is taken.
TEST(PlanBySampling, NoPathIsBetterThanTheOneThatCountsItsCusps) {
  const Aisle aisle(7.0);
  const auto cost = [](const std::vector<Arc>& arcs, double cusp) {
    double sum = 0.0;
    for (std::size_t k = 0; k < arcs.size(); ++k) {
      sum += std::abs(arcs[k].length);
      if (k > 0 && arcs[k].length * arcs[k - 1].length < 0.0) sum += cusp;
    }
    return sum;
  };
  double saved = 0.0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    for (const Pose& to : {Pose{8.0, 9.0, kPi}, Pose{8.0, 9.0, 0.0}}) {
      const auto shortest = aisle.plan(to, {.cusp = 0.0, .seed = seed});
      const auto plain = aisle.plan(to, {.cusp = 6.0, .seed = seed});
      ASSERT_TRUE(shortest && plain) << seed;
      EXPECT_LE(cost(*shortest, 0.0), cost(*plain, 0.0) + 1e-6) << seed;
      EXPECT_LE(cost(*plain, 6.0), cost(*shortest, 6.0) + 1e-6) << seed;
      saved += cost(*shortest, 6.0) - cost(*plain, 6.0);
    }
  }
  EXPECT_GT(saved, 1.0);
}

TEST(PlanBySampling, NeedsNoPathToWhereItStands) {
  const auto free = [](const Pose&, const Arc&) { return true; };
  const auto path = plan_by_sampling({3, 4, kPi}, {3, 4, -kPi}, 3.0, {40, 30}, {}, free);
  ASSERT_TRUE(path);
  EXPECT_TRUE(path->empty());
}

//   A wall that only the motion across it meets, with a gap at its upper end.
TEST(PlanBySampling, AsksForArcsAndNotOnlyForPlaces) {
  const Pose start{10.0, 5.0, 0.0};
  const Pose goal{30.0, 5.0, 0.0};
  const ArcCheck free = [](const Pose& from, const Arc& arc) {
    const Pose to = drive(from, arc);
    const bool crosses = (from.x < 20.0) != (to.x < 20.0);
    return std::abs(arc.length) <= kLongestPiece && (!crosses || std::min(from.y, to.y) > 8.0);
  };
  const auto path = plan_by_sampling(start, goal, kCar.min_turning_radius, {40, 30}, {}, free);
  ASSERT_TRUE(path);
  expect_drives(*path, start, goal, free);
}

TEST(PlanBySampling, TheGroundBeginsAtItsBorder) {
  const ArcCheck free = [](const Pose&, const Arc& arc) {
    return std::abs(arc.length) <= kLongestPiece;
  };
  const Pose start{0.5, 0.5, 0.0};
  EXPECT_TRUE(plan_by_sampling(start, {20, 5, 0}, kCar.min_turning_radius, {40, 30}, {}, free));
}

}  // namespace
}  // namespace mvtp
