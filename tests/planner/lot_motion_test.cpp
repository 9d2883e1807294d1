#include "planner/lot/lot_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/planner/small_instances.hpp"

namespace mvtp {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kGap = 0.04;  // [m]
const Vehicle kCar{.front = 3.6, .rear = 0.9, .width = 1.8, .min_turning_radius = 4.0};

LotCar make_car(std::int64_t key, const Pose& start, const std::vector<Arc>& arcs) {
  LotCar car;
  car.key = key;
  car.body = kCar;
  car.path = ArcPath(start);
  car.path.append(arcs);
  car.cells = PathCells(car.path, kCar, kGap);
  car.goal = car.path.at(car.path.length());
  return car;
}

/// When a car that starts at `start` [s] and drives 2 m/s is in the middle of its cells.
std::vector<float> times_of(const LotCar& car, double start) {
  std::vector<float> times;
  for (int cell = 0; cell < car.cells.size(); ++cell) {
    times.push_back(float(start + (cell + 0.5) * PathCells::kLength / 2.0));
  }
  times.front() = -1.0F;
  return times;
}

/// Orders two cars of the motion as if they started at these times.
void set_orders(LotMotion& motion, std::size_t i, double start_i, std::size_t j, double start_j) {
  const LotCar& a = motion.cars()[i];
  const LotCar& b = motion.cars()[j];
  const std::vector<float> times_a = times_of(a, start_i);
  const std::vector<float> times_b = times_of(b, start_j);
  auto [first, second] = precedence({&a.cells, 0, times_a}, {&b.cells, 0, times_b});
  motion.set_order(a.key, b.key, std::move(first));
  motion.set_order(b.key, a.key, std::move(second));
}

/// True bodies, nothing grown. [m]; below 0 where they overlap.
float gap_between(const LotCar& a, double s_a, const LotCar& b, double s_b) {
  const BoxShape body{float(kCar.length() / 2), float(kCar.width / 2), 0.0F};
  return gap(box_pose(kCar, a.path.at(s_a)), body, box_pose(kCar, b.path.at(s_b)), body);
}

double braking_distance(const LotMotion& motion, const LotCar& car) {
  return car.v * car.v / (2 * motion.limits().hardest);
}

bool any_overlap(const LotMotion& motion, double part_of_braking) {
  const std::vector<LotCar>& cars = motion.cars();
  for (std::size_t i = 0; i < cars.size(); ++i) {
    for (std::size_t j = i + 1; j < cars.size(); ++j) {
      const double s_i = cars[i].s + part_of_braking * braking_distance(motion, cars[i]);
      const double s_j = cars[j].s + part_of_braking * braking_distance(motion, cars[j]);
      if (gap_between(cars[i], s_i, cars[j], s_j) < 0.0F) return true;
    }
  }
  return false;
}

std::vector<Arc> random_arcs(Dice& dice) {
  std::vector<Arc> arcs;
  for (int k = 0; k < 4; ++k) {
    const double length = dice.in(1.0, 8.0) * (dice.below(4) == 0 ? -1.0 : 1.0);
    arcs.push_back({length, dice.in(-1.0, 1.0) / kCar.min_turning_radius});
  }
  return arcs;
}

/// Up to five cars on paths through each other, ordered by chance.
LotMotion random_motion(Dice& dice) {
  LotMotion motion;
  for (int k = 0; k < 5; ++k) {
    const Pose start{dice.in(0.0, 18.0), dice.in(0.0, 18.0), dice.in(-3.1, 3.1)};
    const LotCar car = make_car(k, start, random_arcs(dice));
    const bool free = std::ranges::all_of(motion.cars(), [&](const LotCar& other) {
      return gap(car.cells.box(0), car.cells.shape(0), other.cells.box(0), other.cells.shape(0)) >
             0.0F;
    });
    if (free) motion.put(car);
  }
  std::vector<double> starts;
  for (std::size_t i = 0; i < motion.cars().size(); ++i) starts.push_back(dice.in(0.0, 20.0));
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (std::size_t j = i + 1; j < starts.size(); ++j) {
      set_orders(motion, i, starts[i], j, starts[j]);
    }
  }
  return motion;
}

//   Whatever the order, and whoever is held up: nobody touches, and all could brake now.
TEST(LotMotion, KeepsCarsApartInAnyOrder) {
  Dice dice(7);
  int arrived = 0;
  int blocked = 0;
  for (int scene = 0; scene < 150; ++scene) {
    LotMotion motion = random_motion(dice);
    std::vector<double> stopping_points(motion.cars().size(), kInfinity);
    for (int step = 0; step < 500; ++step) {
      if (step % 40 == 0) {
        for (std::size_t i = 0; i < stopping_points.size(); ++i) {
          const LotCar& car = motion.cars()[i];
          const double stop = car.s + braking_distance(motion, car) + dice.in(0.5, 3.0);
          stopping_points[i] = step < 300 && dice.below(3) == 0 ? stop : kInfinity;
        }
      }
      motion.step(0.1, stopping_points);
      for (const double part : {0.0, 0.5, 1.0}) {
        ASSERT_FALSE(any_overlap(motion, part)) << "scene " << scene << ", step " << step;
      }
    }
    for (const LotCar& car : motion.cars()) ++(car.at_end() ? arrived : blocked);
  }
  EXPECT_GT(arrived, 200);  // they did move
  EXPECT_GT(blocked, 10);   // and did wait for each other
}

//   One car crosses the path of the other at a right angle, 10 m ahead of both.
LotMotion crossing() {
  LotMotion motion;
  motion.put(make_car(0, {0, 10, 0}, {{20.0, 0.0}}));
  motion.put(make_car(1, {10, 0, std::numbers::pi / 2}, {{20.0, 0.0}}));
  set_orders(motion, 0, 0.0, 1, 6.0);
  return motion;
}

TEST(LotMotion, TheSecondWaitsUntilTheFirstHasPassed) {
  LotMotion motion = crossing();
  EXPECT_EQ(motion.turns()[0], kInfinity);
  // The first one's body is 1.8 m wide: 10 - 0.9 - 0.04 - 3.6 (front) - 0.04, in whole cells.
  EXPECT_NEAR(motion.turns()[1], 5.4, 0.21);
  for (int step = 0; step < 300; ++step) motion.step(0.1, std::array{kInfinity, 0.0});
  EXPECT_TRUE(motion.cars()[0].at_end());
  EXPECT_EQ(motion.cars()[1].s, 0.0);
  EXPECT_EQ(motion.turns()[1], kInfinity);
}

TEST(LotMotion, ForecastIsWhatHappens) {
  LotMotion motion = crossing();
  const LotForecast forecast = motion.forecast(0.1);
  ASSERT_TRUE(forecast.complete);
  EXPECT_TRUE(forecast.gentle);
  for (int step = 1; step < 300; ++step) {
    motion.step(0.1, std::array{kInfinity, kInfinity});
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(forecast.driven_at(i, 0.1 * step), motion.cars()[i].s, 0.02) << step;
    }
  }
}

TEST(LotMotion, ACycleOfWaitsIsNotComplete) {
  LotMotion motion = crossing();
  Precedence never;
  never.add(5.0, 30.0);
  never.finish();
  motion.set_order(0, 1, never);
  EXPECT_FALSE(motion.forecast().complete);
  EXPECT_THAT(motion.stop_the_blocked_permanently(), ElementsAre(0, 1));
  EXPECT_TRUE(motion.forecast().complete);
}

//   Half an hour at walking speed: late, but nothing is blocking.
TEST(LotMotion, WhosePathIsLongIsNotBlocked) {
  LotMotion motion;
  motion.put(make_car(0, {0, 0, 0}, {{5000.0, 0.0}}));
  const LotForecast forecast = motion.forecast();
  EXPECT_TRUE(forecast.complete);
  EXPECT_NEAR(forecast.arrival(0), 1800.0, 5.0);
  EXPECT_THAT(motion.stop_the_blocked_permanently(), IsEmpty());
}

TEST(LotMotion, StopsWhereItChangesDirection) {
  LotMotion motion;
  motion.put(make_car(0, {0, 0, 0}, {{5.0, 0.0}, {-5.0, 0.2}}));
  bool stood = false;
  for (int step = 0; step < 200 && !motion.cars()[0].at_end(); ++step) {
    motion.step(0.1, std::array{kInfinity});
    stood = stood || (motion.cars()[0].s == 5.0 && motion.cars()[0].v == 0.0);
  }
  EXPECT_TRUE(stood);
  EXPECT_TRUE(motion.cars()[0].at_end());
}

TEST(LotMotion, TimeUntilAPlaceIsThatOfTheForecast) {
  const LotMotion motion = crossing();
  const LotCar& car = motion.cars()[0];
  EXPECT_THAT(motion.time_until(car, 20.0, kInfinity),
              DoubleNear(motion.forecast().arrival(0), 0.2));
  EXPECT_EQ(motion.time_until(car, 20.0, 12.0), kInfinity);
  EXPECT_EQ(motion.time_until(car, 0.0, 12.0), 0.0);
}

TEST(PathCells, ContainTheBodyWhereverItIs) {
  Dice dice(3);
  for (int k = 0; k < 50; ++k) {
    const LotCar car = make_car(0, {0, 0, dice.in(-3.0, 3.0)}, random_arcs(dice));
    for (double s = 0.0; s <= car.path.length(); s += 0.037) {
      const int cell = car.cells.cell_at(s);
      const BoxPose& box = car.cells.box(cell);
      for (const double x : {kCar.front, -kCar.rear}) {
        for (const double y : {kCar.width / 2, -kCar.width / 2}) {
          const Pose corner = compose(car.path.at(s), {x, y, 0.0});
          const double dx = corner.x - double(box.x);
          const double dy = corner.y - double(box.y);
          const double along = dx * double(box.ux) + dy * double(box.uy);
          const double across = dy * double(box.ux) - dx * double(box.uy);
          ASSERT_LE(std::abs(along), double(car.cells.shape(cell).half_length)) << s;
          ASSERT_LE(std::abs(across), double(car.cells.shape(cell).half_width)) << s;
        }
      }
    }
  }
}

//   A footpath 2 m wide across the path, its middle at x = 10.
const Footpath kFootpath{{{10, -5}, {10, 5}}, 2.0};

TEST(PathCells, WaitsBeforeAFootpathAndNotOnIt) {
  LotCar car = make_car(0, {0, 0, 0}, {{30.0, 0.0}});
  EXPECT_THAT(car.cells.kept_clear(), IsEmpty());
  EXPECT_EQ(car.cells.waits_before(40, 0), 40);
  car.cells.keep_clear(KeepClear(std::array{kFootpath}));
  ASSERT_EQ(car.cells.kept_clear().size(), 1u);
  const auto [first, last] = car.cells.kept_clear().front();
  EXPECT_NEAR(first * PathCells::kLength, 9.0 - kCar.front, 0.3);
  EXPECT_NEAR(last * PathCells::kLength, 11.0 + kCar.rear, 0.3);
  EXPECT_EQ(car.cells.waits_before(first - 1, 0), first - 1);
  EXPECT_EQ(car.cells.waits_before(first, 0), first);
  EXPECT_EQ(car.cells.waits_before(first + 1, 0), first);
  EXPECT_EQ(car.cells.waits_before(last + 1, 0), first);  // else it would stand in `last`
  EXPECT_EQ(car.cells.waits_before(last + 2, 0), last + 2);
  EXPECT_EQ(car.cells.waits_before(first + 5, first + 2), first + 2);  // it is there already
  EXPECT_EQ(car.cells.waits_before(last + 2, first + 2), last + 2);
}

TEST(PathCells, AGoalOnAFootpathIsNotRefused) {
  LotCar car = make_car(0, {0, 0, 0}, {{10.0, 0.0}});
  car.cells.keep_clear(KeepClear(std::array{kFootpath}));
  EXPECT_THAT(car.cells.kept_clear(), IsEmpty());
}

//   The other stands 2 m beyond the footpath: there is no room to wait in between.
TEST(LotMotion, WaitsBeforeAFootpathWhereItCouldNotLeaveIt) {
  LotMotion motion;
  LotCar through = make_car(0, {0, 0, 0}, {{30.0, 0.0}});
  through.cells.keep_clear(KeepClear(std::array{kFootpath}));
  motion.put(through);
  motion.put(make_car(1, {14, 0, 0}, {{25.0, 0.0}}));
  set_orders(motion, 0, 5.0, 1, 0.0);
  EXPECT_NEAR(motion.turns()[0], 9.0 - kCar.front, 0.3);
}

}  // namespace
}  // namespace mvtp
