#include "planner/geometry/moving_box.hpp"

#include <gtest/gtest.h>

#include <random>

#include "planner/geometry/frame.hpp"
#include "planner/geometry/oriented_box.hpp"
#include "planner/motion/arc_trajectory.hpp"

namespace mvtp {
namespace {

constexpr int kSteps = 14;
constexpr double kDt = 0.1059;
const Vehicle kCar{.front = 2.0, .rear = 1.0, .min_turning_radius = 3.0};

struct Drive {
  Pose from;
  Arc step;

  [[nodiscard]] Pose at(double s) const { return drive(from, {step.length * s, step.curvature}); }
  [[nodiscard]] std::vector<BoxPose> boxes() const {
    std::vector<BoxPose> result;
    for (int t = 0; t <= kSteps; ++t) result.push_back(box_pose(kCar, at(t)));
    return result;
  }
};

Drive random_drive(std::mt19937_64& rng, double spread) {
  std::uniform_real_distribution<double> place(-spread, spread);
  std::uniform_real_distribution<double> yaw(-3.14, 3.14);
  std::uniform_int_distribution<int> which(-1, 1);
  return {{50.0 + place(rng), 50.0 + place(rng), yaw(rng)},
          {kDt * which(rng), which(rng) / kCar.min_turning_radius}};
}

/// The least separation on the way, sampled a thousand times as finely, in double precision.
double least_gap(const Drive& a, const Drive& b) {
  double least = 1e9;
  for (int k = 0; k <= kSteps * 200; ++k) {
    const double s = k / 200.0;
    least = std::min(least, separation(footprint(kCar, a.at(s)), footprint(kCar, b.at(s))));
  }
  return least;
}

TEST(MovingBox, MeetAgreesWithDenseSampling) {
  std::mt19937_64 rng(3);
  const BoxShape shape = box_shape(kCar, kDt);
  int met = 0;
  int close = 0;
  for (int n = 0; n < 3000; ++n) {
    const Drive a = random_drive(rng, 3.0);
    const Drive b = random_drive(rng, 3.0);
    const double gap = least_gap(a, b);
    const bool meets = meet(a.boxes().data(), shape, b.boxes().data(), shape, kSteps);
    close += std::abs(gap) < 0.05 ? 1 : 0;
    met += meets ? 1 : 0;
    if (gap < -0.0009) {
      EXPECT_TRUE(meets) << "overlap of " << -gap << " m, pair " << n;
    }
    if (gap > 0.0001) {
      EXPECT_FALSE(meets) << "gap of " << gap << " m, pair " << n;
    }
  }
  EXPECT_GT(met, 500);  // the test means something
  EXPECT_GT(close, 20);
}

TEST(MovingBox, MeetIsSymmetric) {
  std::mt19937_64 rng(4);
  const BoxShape shape = box_shape(kCar, kDt);
  for (int n = 0; n < 1000; ++n) {
    const std::vector<BoxPose> a = random_drive(rng, 3.0).boxes();
    const std::vector<BoxPose> b = random_drive(rng, 3.0).boxes();
    EXPECT_EQ(meet(a.data(), shape, b.data(), shape, kSteps),
              meet(b.data(), shape, a.data(), shape, kSteps));
  }
}

//   Apart is a proof: nobody whose swept boxes are apart meets. And it is worth having.
TEST(MovingBox, WhoseSweptBoxesAreApartDoNotMeet) {
  std::mt19937_64 rng(6);
  const BoxShape shape = box_shape(kCar, kDt);
  int proven = 0;
  int free = 0;
  for (int n = 0; n < 3000; ++n) {
    const Drive a = random_drive(rng, 3.0);
    const Drive b = random_drive(rng, 3.0);
    const bool proof = apart(swept_box(a.boxes().data(), shape, kSteps),
                             swept_box(b.boxes().data(), shape, kSteps));
    const double gap = least_gap(a, b);
    if (proof) {
      EXPECT_GT(gap, -1e-5) << "pair " << n;
    }
    free += gap > 0.0 ? 1 : 0;
    proven += proof ? 1 : 0;
  }
  EXPECT_GT(proven, free / 2);
}

TEST(MovingBox, SweptBoxesContainTheMotion) {
  std::mt19937_64 rng(7);
  const BoxShape shape = box_shape(kCar, kDt);
  for (int n = 0; n < 300; ++n) {
    const Drive a = random_drive(rng, 3.0);
    const SweptBox swept = swept_box(a.boxes().data(), shape, kSteps);
    for (int k = 0; k <= kSteps * 10; ++k) {
      const Pose pose = a.at(k / 10.0);
      for (const double x : {-kCar.rear, kCar.front}) {
        for (const double y : {-kCar.width / 2, kCar.width / 2}) {
          const Pose corner = drive(pose, {x, 0.0});
          const BoxPose dot{float(corner.x - y * std::sin(pose.theta)),
                            float(corner.y + y * std::cos(pose.theta)), 1.0F, 0.0F};
          ASSERT_FALSE(apart(swept, {dot, 2e-5F, 2e-5F}));
        }
      }
    }
  }
}

//   Left, right, and straight on: seen along the middle, the first arc bulges beyond both its ends.
TEST(MovingBox, SweptBoxesContainTheBulgeOfAnArc) {
  const Vehicle dot{.front = 0.01, .rear = 0.01, .width = 0.02, .min_turning_radius = 2.5};
  const BoxShape shape = box_shape(dot, 1.0);
  const std::vector<Arc> arcs = {{1.0, 0.4}, {1.0, -0.2}, {1.0, 0.0}, {1.0, 0.0}};
  for (int k = 0; k < 32; ++k) {
    Pose pose{0.0, 0.0, -0.2 + k * 0.2};
    const BoxPose middle = box_pose(dot, drive(pose, {0.5, 0.4}));
    std::vector<BoxPose> boxes = {box_pose(dot, pose)};
    for (const Arc& arc : arcs) boxes.push_back(box_pose(dot, pose = drive(pose, arc)));
    const SweptBox swept = swept_box(boxes.data(), shape, int(arcs.size()));
    EXPECT_FALSE(apart(swept, {middle, 1e-4F, 1e-4F})) << k;
  }
}

//   Bumper to bumper: a touch is no overlap, three millimetres are one.
TEST(MovingBox, TouchingIsAllowed) {
  BoxShape shape = box_shape(kCar, kDt);
  shape.travel = 0.0F;
  const auto at = [](double x) {
    return std::vector<BoxPose>(kSteps + 1, box_pose(kCar, {x, 0.0, 0.0}));
  };
  EXPECT_FALSE(meet(at(0.0).data(), shape, at(3.0).data(), shape, kSteps));
  EXPECT_TRUE(meet(at(0.0).data(), shape, at(2.997).data(), shape, kSteps));
}

//   A crossing that takes place between two time steps only: two slabs that swap sides in one step.
TEST(MovingBox, FindsOverlapsBetweenTimeSteps) {
  const Vehicle slab{.front = 0.005, .rear = 0.005, .width = 2.0, .min_turning_radius = 3.0};
  BoxShape shape = box_shape(slab, kDt);
  const std::vector<BoxPose> right = {{0.0F, 0.0F, 1.0F, 0.0F}, {0.1F, 0.0F, 1.0F, 0.0F}};
  const std::vector<BoxPose> left = {{0.1F, 0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F, 0.0F}};
  EXPECT_GT(gap(right[0], shape, left[0], shape), 0.0F);
  EXPECT_GT(gap(right[1], shape, left[1], shape), 0.0F);
  EXPECT_TRUE(meet(right.data(), shape, left.data(), shape, 1));
}

TEST(ArcTrajectory, KnowsItsPosesAndRestsAtTheEnd) {
  std::vector<Arc> steps;
  for (int k = 0; k < 100; ++k) steps.push_back({k % 3 == 0 ? 0.0 : 0.1, k % 2 == 0 ? 0.3 : -0.2});
  steps.resize(120);  // waits at the end do not count
  const Pose start{3.0, 4.0, 0.5};
  const ArcTrajectory trajectory(kCar, start, steps, kSteps);
  EXPECT_EQ(trajectory.arrival(), 99 + 1 - 1);
  Pose pose = start;
  for (int t = 0; t < 130; ++t) {
    EXPECT_LT(distance(trajectory.pose(t), pose), 1e-9);
    const BoxPose box = box_pose(kCar, pose);
    EXPECT_NEAR(trajectory.boxes(t)->x, box.x, 1e-5);
    EXPECT_NEAR(trajectory.boxes(t)->uy, box.uy, 1e-5);
    EXPECT_EQ(trajectory.boxes(200)[kSteps].x, trajectory.boxes(trajectory.arrival())->x);
    if (t < 120) pose = drive(pose, steps[std::size_t(t)]);
  }
}

TEST(Frame, MovesAsPosesDo) {
  const Pose from{1.0, 2.0, 0.7};
  const Arc arc{-1.4, 0.33};
  const Frame end = Frame(from).then(arc_end(arc));
  const Pose expected = drive(from, arc);
  EXPECT_NEAR(end.x, expected.x, 1e-12);
  EXPECT_NEAR(end.y, expected.y, 1e-12);
  EXPECT_NEAR(end.ux, std::cos(expected.theta), 1e-12);
  EXPECT_NEAR(end.uy, std::sin(expected.theta), 1e-12);
}

}  // namespace
}  // namespace mvtp
