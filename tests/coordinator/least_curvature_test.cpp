#include "coordinator/corridor/least_curvature.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

const FreeCourse kEverywhere{{-1000.0, 1000.0}, {}};

/// The middle of lanes of 40 m, each turned from the one before by so much [rad].
std::vector<Point> lanes(const std::vector<double>& turns) {
  std::vector<Point> points = {{0.0, 0.0}, {40.0, 0.0}};
  double heading = 0.0;
  for (const double turn : turns) {
    heading += turn;
    const Point& last = points.back();
    points.push_back({last.x + 40.0 * std::cos(heading), last.y + 40.0 * std::sin(heading)});
  }
  return points;
}

ReferencePath path_along(const std::vector<double>& turns) {
  return ReferencePath(smooth(lanes(turns), 2.5));
}

double sum_of_squares(const ReferencePath& path) {
  double sum = 0.0;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const double kappa = path.curvature(double(i) * ReferencePath::kSpacing);
    sum += kappa * kappa * ReferencePath::kSpacing;
  }
  return sum;
}

/// How far its samples are beside the other path, at most [m].
double farthest(const ReferencePath& path, const ReferencePath& from) {
  double most = 0.0;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const Pose& p = path.sample(i);
    const Pose near = from.at(from.project({p.x, p.y}, 0.0, from.length()));
    most = std::max(most, std::hypot(p.x - near.x, p.y - near.y));
  }
  return most;
}

TEST(LeastCurvature, AStraightPathStaysAsItIs) {
  const ReferencePath path = path_along({});
  const ReferencePath same = least_curved(path, kEverywhere, 0.5);
  ASSERT_EQ(same.samples(), path.samples());
  for (std::size_t i = 0; i < path.samples(); ++i) EXPECT_EQ(same.sample(i), path.sample(i)) << i;
}

// A kink of 10 degrees that is smoothed over 2.5 m has a radius of 36 m. Half a metre of room
// within 15 m of it carries an arc of more than 70 m.
TEST(LeastCurvature, AKinkBecomesALongBend) {
  const ReferencePath path = path_along({0.1745});
  EXPECT_NEAR(1.0 / path.max_abs_curvature(), 36.0, 1.0);
  EXPECT_GT(1.0 / least_curved(path, kEverywhere, 0.5).max_abs_curvature(), 70.0);
}

TEST(LeastCurvature, BendsAreWiderTheMoreRoomThereIs) {
  for (const double turn : {0.1, -0.3, 0.8}) {
    const ReferencePath path = path_along({turn});
    double before = path.max_abs_curvature();
    for (const double room : {0.1, 0.3, 0.5}) {
      const double now = least_curved(path, kEverywhere, room).max_abs_curvature();
      EXPECT_LT(now, before) << turn << ' ' << room;
      before = now;
    }
  }
}

// The optimum over more offsets is no worse.
TEST(LeastCurvature, MoreRoomNeverCurvesMore) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> turn(-0.8, 0.8);
  for (int round = 0; round < 30; ++round) {
    const ReferencePath path = path_along({turn(random), turn(random)});
    double before = sum_of_squares(path);
    for (const double room : {0.1, 0.2, 0.3, 0.4, 0.5}) {
      const double now = sum_of_squares(least_curved(path, kEverywhere, room));
      EXPECT_LT(now, 1.0001 * before) << round << ' ' << room;
      before = now;
    }
  }
}

TEST(LeastCurvature, KeepsWithinItsRoomAndNeverCurvesMore) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> turn(-1.0, 1.0);
  for (int round = 0; round < 40; ++round) {
    const ReferencePath path = path_along({turn(random), turn(random), turn(random)});
    const double room = 0.1 + 0.01 * round;
    const ReferencePath less = least_curved(path, kEverywhere, room);
    EXPECT_LE(farthest(less, path), room + 0.02) << round;
    EXPECT_LT(sum_of_squares(less), sum_of_squares(path)) << round;
    EXPECT_NEAR(less.sample(0).x, path.sample(0).x, 1e-9);
    EXPECT_NEAR(less.sample(0).y, path.sample(0).y, 1e-9);
    EXPECT_NEAR(less.at(less.length()).theta, path.at(path.length()).theta, 1e-3);
  }
}

TEST(LeastCurvature, IsAsItIsOutsideOfTheFreeStretch) {
  const ReferencePath path = path_along({0.2, -0.4, 0.3});
  const ReferencePath less = least_curved(path, {{60.0, 100.0}, {}}, 0.5);
  EXPECT_GT(farthest(less, path), 0.1);
  for (double s = 0.0; s < 58.0; s += 1.0) {
    EXPECT_NEAR(distance(less.at(s), path.at(s)), 0.0, 1e-6) << s;
  }
  // The bend at 120 m is as it was; that at 80 m is not.
  EXPECT_NEAR(std::abs(less.curvature(less.length() - path.length() + 120.0)),
              std::abs(path.curvature(120.0)), 0.01 * std::abs(path.curvature(120.0)));
  EXPECT_LT(less.curvature(80.0), 0.0);
  EXPECT_LT(std::abs(less.curvature(80.0)), 0.6 * std::abs(path.curvature(80.0)));
}

// Before a line they wait, perhaps beside others in the next lane.
TEST(LeastCurvature, KeepsNearerToTheMiddleBeforeLines) {
  const ReferencePath path = path_along({0.4, 0.4});
  for (const double line : {45.0, 85.0}) {
    const ReferencePath less = least_curved(path, {{-1000.0, 1000.0}, {line}}, 0.5);
    double before = 0.0;
    double behind = 0.0;
    for (double s = 0.0; s < path.length(); s += 0.5) {
      const Pose p = path.at(s);
      const Pose near = less.at(less.project({p.x, p.y}, 0.0, less.length()));
      double& most = s > line - 19.0 && s <= line ? before : behind;
      most = std::max(most, distance(p, near));
    }
    EXPECT_LE(before, 0.26) << line;
    EXPECT_GT(behind, 0.4) << line;
  }
}

TEST(LeastCurvature, OfTheMirrorImageIsTheMirrorImage) {
  const ReferencePath left = least_curved(path_along({0.3, -0.2, 0.8}), kEverywhere, 0.4);
  const ReferencePath right = least_curved(path_along({-0.3, 0.2, -0.8}), kEverywhere, 0.4);
  ASSERT_EQ(left.samples(), right.samples());
  for (std::size_t i = 0; i < left.samples(); ++i) {
    EXPECT_NEAR(left.sample(i).x, right.sample(i).x, 1e-6) << i;
    EXPECT_NEAR(left.sample(i).y, -right.sample(i).y, 1e-6) << i;
  }
}

/// A road of one lane along these turns, and what is made of its path for a body so wide.
struct Straightening {
  Straightening(const std::vector<double>& turns, double lane_width, double body_width) {
    Lane lane;
    lane.id = "E_0";
    lane.edge = "E";
    lane.width = lane_width;
    lane.shape = lanes(turns);
    network.lanes.emplace(lane.id, lane);
    area.emplace(network);
    body = fake_type("car").body;
    body.width = body_width;
    before.emplace(path_along(turns));
    const Stretch driven{body.rear, before->length() - body.front};
    after.emplace(straightened(*before, driven, kEverywhere, lane_width, body, *area, *area));
  }
  double outside(const ReferencePath& path) const {
    double sum = 0.0;
    for (double s = body.rear; s <= path.length() - body.front; s += 0.25) {
      sum += area->share_outside(path.at(s), body, 0.0);
    }
    return sum;
  }
  RoadNetwork network;
  std::optional<DrivableArea> area;
  Vehicle body;
  std::optional<ReferencePath> before;
  std::optional<ReferencePath> after;
};

TEST(LeastCurvature, ACarHasRoomInItsLane) {
  const Straightening car({0.15, -0.2}, 3.2, 1.8);
  EXPECT_EQ(car.outside(*car.after), 0.0);
  EXPECT_LT(car.after->max_abs_curvature(), 0.6 * car.before->max_abs_curvature());
  EXPECT_LE(farthest(*car.after, *car.before), 0.5 + 0.01);
}

TEST(LeastCurvature, WhoFillsItsLaneHasNone) {
  const Straightening lorry({0.15, -0.2}, 3.0, 2.6);
  EXPECT_EQ(farthest(*lorry.after, *lorry.before), 0.0);
}

// Where the room is no longer small against the radius, the offsets do not do what is expected.
TEST(LeastCurvature, NoBendBecomesSharper) {
  for (double turn = 0.1; turn < 2.3; turn += 0.1) {
    const Straightening car({turn, -turn}, 4.5, 1.8);
    EXPECT_LE(car.after->max_abs_curvature(), car.before->max_abs_curvature()) << turn;
  }
}

// Whatever the bends: never more of the body beside the lane than on the path that was given.
TEST(LeastCurvature, NobodyIsMoreOffTheRoad) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turn(-0.9, 0.9);
  int straighter = 0;
  for (int round = 0; round < 20; ++round) {
    const Straightening car({turn(random), turn(random)}, 3.2, 1.8);
    EXPECT_LE(car.outside(*car.after), car.outside(*car.before) + 0.1) << round;
    straighter += farthest(*car.after, *car.before) > 0.05 ? 1 : 0;
  }
  EXPECT_GE(straighter, 10);
}

}  // namespace
}  // namespace mvtp
