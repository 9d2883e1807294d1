#include "coordinator/corridor/drivers_path.hpp"

#include <gtest/gtest.h>

#include <map>

#include "coordinator/network/polyline.hpp"
#include "tests/coordinator/fake_traffic.hpp"
#include "tests/coordinator/network_maker.hpp"
#include "tests/coordinator/predictions.hpp"
#include "tests/coordinator/shapes.hpp"

namespace mvtp {
namespace {

NetworkShape crossroads_of_one_speed() {
  NetworkShape shape{.name = "one_speed"};
  NetworkMaker maker;
  add_crossroads(maker, shape);
  maker.limit_bends(13.89);
  shape.network = maker.make();
  return shape;
}

// However sharp the corner is.
TEST(DriversPath, HasTheFrontOnTheLineAsFarAsItHasDriven) {
  const std::vector<Point> line = {{0, 0}, {30, 0}, {31, 2}, {31, 20}, {20, 24}};
  const Vehicle body = fake_type("car").body;
  const ReferencePath path = drivers_path(line, body);
  EXPECT_NEAR(path.length(), length_of(line) - body.length(), ReferencePath::kSpacing);
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const double s = double(i) * ReferencePath::kSpacing;
    const Pose front = compose(path.sample(i), {body.front, 0.0, 0.0});
    EXPECT_LT(distance(point_at(line, s + body.length()), {front.x, front.y}), 1e-9) << s;
  }
}

TEST(DriversPath, KnowsItsLongestStep) {
  const std::vector<Point> line = {{0, 0}, {30, 0}, {30, 40}};
  const ReferencePath path = drivers_path(line, fake_type("truck").body);
  double longest = 0.0;
  for (std::size_t i = 1; i < path.samples(); ++i) {
    const Pose& a = path.sample(i - 1);
    const Pose& b = path.sample(i);
    longest = std::max(longest, std::hypot(a.x - b.x, a.y - b.y));
  }
  EXPECT_GT(longest, 1.2 * ReferencePath::kSpacing);
  EXPECT_EQ(path.longest_step(), longest);
}

// Drivers move both bumpers along their lanes, at the speed of the front one: so does the traffic.
TEST(DriversPath, IsWhereADriverIsWhoTurns) {
  constexpr int kAhead = 15;  // steps
  for (const std::string to : {"C-E", "C-S", "C-N"}) {
    for (const std::string type : {"car", "bus", "truck"}) {
      Prediction p(crossroads_of_one_speed());
      const Vehicle body = fake_type(type).body;
      FakeTraffic traffic(p.shape.network,
                          {{.id = "v", .depart = 0.0, .from = "W-C", .to = to, .type = type}});
      std::map<int, Pose> expected;
      int compared = 0;
      for (int k = 0; traffic.running(); ++k) {
        traffic.step();
        if (traffic.vehicles().empty()) continue;
        const VehicleState& v = traffic.vehicles().front();
        if (const auto then = expected.find(k); then != expected.end()) {
          EXPECT_LT(distance(then->second, v.pose), 0.2) << type << " " << to << " " << k;
          EXPECT_NEAR(wrap_to_pi(then->second.theta - v.pose.theta), 0.0, 0.03);
          ++compared;
        }
        const bool is_there = v.pose.x > -25.0 && std::hypot(v.pose.x, v.pose.y) < 40.0;
        if (!is_there || v.speed < 13.89) continue;
        const CourseQuery query = p.walk.at(v.lane, v.lane_position, traffic.route("v"));
        for (const Forecast& f :
             p.predictor.predict(v, query, body, Intent::kPasses, {}, p.grid, k)) {
          expected[k + kAhead] =
              p.map.library().path(f.vehicle.path).at(f.earliest.at(k + kAhead).s);
        }
      }
      EXPECT_GT(compared, 10) << type << " " << to;
    }
  }
}

}  // namespace
}  // namespace mvtp
