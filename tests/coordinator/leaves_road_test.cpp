#include <gtest/gtest.h>

#include "coordinator/audit/audit.hpp"
#include "coordinator/corridor/reference_path.hpp"
#include "tests/coordinator/fake_traffic.hpp"
#include "tests/coordinator/shapes.hpp"

namespace mvtp {
namespace {

/// A right turn over a crossroads, `inwards` metres nearer to the corner than the lanes' middle.
ReferencePath right_turn(double inwards) {
  const double y = -1.6 - inwards;
  const double x = -1.6 - inwards;
  const std::vector<Point> corner = {{-60.0, y}, {x - 4.0, y}, {x, y - 4.0}, {x, -60.0}};
  return ReferencePath(smooth(corner, 2.0));
}

//   A body that grazes the kerb may do so between two places of its path only.
TEST(LeavesRoad, SeesWhatLiesBetweenThePlacesThatAreJudged) {
  const NetworkShape shape = crossroads_shape();
  const DrivableArea area(shape.network);
  int off = 0;
  int only_between = 0;
  for (const std::string type : {"car", "bus", "truck"}) {
    const Vehicle body = fake_type(type).body;
    for (double inwards = -2.0; inwards < 2.0; inwards += 0.06) {
      const ReferencePath path = right_turn(inwards);
      const auto is_off = [&](double s, double tolerance) {
        return area.share_outside(path.at(s), body, tolerance) > 0.0;
      };
      constexpr double kLetPass = Audit::kRoadTolerance;
      for (double s = 10.0; s < path.length() - 10.0; s += kJudgedEvery) {
        bool clearly = false;
        bool nearly = false;
        for (double d = -0.25; d < 0.255; d += 0.01) {
          clearly = clearly || is_off(s + d, kLetPass + 0.01);
          nearly = nearly || is_off(s + d, kLetPass - 0.001);
        }
        const bool leaves = leaves_road(path, s, body, area);
        EXPECT_LE(clearly, leaves) << type << ' ' << inwards << ' ' << s;
        EXPECT_LE(leaves, nearly) << type << ' ' << inwards << ' ' << s;
        off += clearly ? 1 : 0;
        only_between += clearly && !is_off(s, kLetPass) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(off, 300);
  EXPECT_GT(only_between, 5);
}

}  // namespace
}  // namespace mvtp
