#include "planner/motion/exemptions.hpp"

#include <gtest/gtest.h>

namespace mvtp {
namespace {

const Vehicle kCar{.front = 2.5, .rear = 0.5, .width = 2.0, .min_turning_radius = 3.0};

//   o[  0>   o     Two circles overlap the car's tail where it starts; a third one is ahead of it.
//   o[___>
class Overlapped : public testing::Test {
 protected:
  [[nodiscard]] bool may_drive(double length) const {
    const Arc arc{length, 0.0};
    return exemptions_.allow(obstacles_, Sweep(kCar, start_, arc), start_, arc);
  }

  Map map_{
      .width = 40, .height = 40, .circles = {{9.0, 9.4, 0.8}, {9.0, 10.6, 0.8}, {16.0, 10.0, 0.5}}};
  Obstacles obstacles_{map_, 4.0};
  Pose start_{10.0, 10.0, 0.0};
  Exemptions exemptions_{kCar, map_, obstacles_, start_, {30.0, 30.0, 0.0}};
};

TEST_F(Overlapped, ACarMayLeaveAllThatItOverlapsAtItsStart) { EXPECT_TRUE(may_drive(1.0)); }

TEST_F(Overlapped, ACarMayNotOverlapItMoreDeeply) { EXPECT_FALSE(may_drive(-1.0)); }

TEST_F(Overlapped, ACarMayHitNothingElse) { EXPECT_FALSE(may_drive(4.0)); }

}  // namespace
}  // namespace mvtp
