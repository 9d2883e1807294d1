#include "coordinator/corridor/corridor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "coordinator/audit/footprint_motion.hpp"
#include "coordinator/corridor/no_waiting.hpp"
#include "tests/coordinator/closed_loop.hpp"
#include "tests/coordinator/fake_traffic.hpp"
#include "tests/coordinator/shapes.hpp"
#include "tests/coordinator/walk.hpp"

namespace mvtp {
namespace {

TEST(CourseFinder, TakesVehiclesOverWithinTheDistanceOnly) {
  Walk walk(make_crossroads());  // the approach is 192.8 m long
  EXPECT_FALSE(walk.finder.find(walk.at("W_in_0", 112.0, {"W_in", "E_out"})));
  const auto course = walk.finder.find(walk.at("W_in_0", 113.0, {"W_in", "E_out"}));
  ASSERT_TRUE(course);
  EXPECT_EQ(walk.lanes(*course), (std::vector<std::string>{"W_in_0", ":C_WE_0", "E_out_0"}));
  EXPECT_DOUBLE_EQ(course->handback, 60.0);
  EXPECT_DOUBLE_EQ(course->end, 85.0);
}

TEST(CourseFinder, KnowsNoCourseWhereNoLaneLeads) {
  Walk walk(make_crossroads());
  EXPECT_FALSE(walk.finder.find(walk.at("W_in_0", 150.0, {"W_in", "W_out"})));
  EXPECT_FALSE(walk.finder.find(walk.at("W_in_0", 150.0, {"W_in"})));
}

TEST(CourseFinder, GoesOnFromInsideAJunction) {
  Walk walk(make_crossroads());
  // The junction itself is behind: nothing ahead is coordinated.
  EXPECT_FALSE(walk.finder.find(walk.at(":C_WE_0", 2.0, {"W_in", "E_out"})));
}

TEST(CourseFinder, HandsBackOnTheExitLaneHoweverShortItIs) {
  for (const double arm : {16.3, 20.0, 30.0, 60.0, 120.0}) {  // exits of 9.1 m and more
    Walk walk(make_crossroads(arm));
    const auto course =
        walk.finder.find(walk.at("W_in_0", std::max(1.0, arm - 80.0), {"W_in", "E_out"}));
    ASSERT_TRUE(course) << arm;
    const double exit = arm - 7.2;
    EXPECT_GT(course->handback, 4.5) << "the tail is out of the junction";
    EXPECT_LE(course->handback, exit - 0.5) << arm;
    EXPECT_GE(course->end, course->handback);
    EXPECT_LE(course->end, exit) << arm;
  }
}

TEST(CourseFinder, EndsBeforeAScheduledStop) {
  Walk walk(make_crossroads());
  CourseQuery query = walk.at("W_in_0", 150.0, {"W_in", "E_out"});
  query.stop_edge = 1;
  query.stop_position = 70.0;
  const auto course = walk.finder.find(query);
  ASSERT_TRUE(course);
  EXPECT_LE(course->handback, 25.0);
  query.stop_edge = 0;  // before the line: its driver stops there first
  EXPECT_FALSE(walk.finder.find(query));
}

TEST(Corridor, ItsStationsGrowAndItsLimitsCoverThePath) {
  Walk walk(make_crossroads());
  const DrivableArea area(walk.network);
  CorridorMap map(walk.graph, area, {});
  const VehicleType car = FakeTraffic(walk.network, {}).type("car");
  for (const std::string to : {"S_out", "E_out", "N_out"}) {
    const auto course = walk.finder.find(walk.at("W_in_0", 150.0, {"W_in", to}));
    ASSERT_TRUE(course);
    const Corridor& c = map[map.corridor_for(*course, car.body)];
    EXPECT_TRUE(c.undriven.empty()) << c.undriven;
    EXPECT_TRUE(std::ranges::is_sorted(c.stations));
    EXPECT_EQ(c.lane_limits.size(), map.library().path(c.path).samples());
    EXPECT_LT(c.lines.front(), c.s_exit);
    EXPECT_LT(c.s_exit, c.s_handback);
    EXPECT_LE(c.s_handback, c.s_end);
    EXPECT_LE(c.s_end, map.library().path(c.path).length());
    // A place on a lane and its station lead to each other.
    const auto s = c.station(course->pieces[0].lane, 150.0, 0.0);
    ASSERT_TRUE(s);
    EXPECT_EQ(c.piece_at(*s), 0U);
    EXPECT_NEAR(map.library().path(c.path).at(*s + car.body.front).x, -50.0, 0.05);
  }
}

// Lanes side by side, arms straight: whatever is beside the middle of them has been straightened.
TEST(Corridor, PathsAreOffTheMiddleOfTheirLanesOnlyWhereNobodyChangesHands) {
  Walk walk(make_crossroads());
  const DrivableArea area(walk.network);
  CorridorMap map(walk.graph, area, {});
  const Vehicle body = fake_type("car").body;
  for (const std::string to : {"S_out", "N_out"}) {
    const auto course = walk.finder.find(walk.at("W_in_0", 150.0, {"W_in", to}));
    const Corridor& c = map[map.corridor_for(*course, body)];
    const ReferencePath& path = map.library().path(c.path);
    const auto aside = [&](double s) {
      const Pose p = path.at(s);
      return s < c.s_exit ? std::abs(p.y - path.at(0.0).y)
                          : std::abs(p.x - path.at(path.length() - 1.0).x);
    };
    double most = 0.0;
    for (double s = body.rear; s < c.lines.front(); s += 0.5) {
      if (s < c.lines.front() + body.front - 12.0) {
        EXPECT_LT(aside(s), 1e-6) << s;
      }
      most = std::max(most, aside(s));
    }
    EXPECT_GT(most, 0.02) << to;
    EXPECT_EQ(c.stops, c.lines) << "they wait at their lines";
    for (double s = c.s_exit + body.length() + 5.0; s < path.length() - 2.0; s += 0.5) {
      EXPECT_LT(aside(s), 0.01) << s;
    }
  }
}

/// A car that turns left at the crossroads, and its path.
class JoinedCorridor : public testing::Test {
 protected:
  Walk walk{make_crossroads()};
  DrivableArea area{walk.network};
  CorridorMap map{walk.graph, area, {}};
  Vehicle body = fake_type("car").body;
  CorridorCourse course = walk.finder.find(walk.at("W_in_0", 150.0, {"W_in", "N_out"})).value();
  int plain = map.corridor_for(course, body);
  ReferencePath path = map.library().path(map[plain].path);
};

// Else the rear axle swings off it at once, over more metres than the plan counts.
TEST_F(JoinedCorridor, KeepsWhoJoinsItInABend) {
  double s = map[plain].lines.front();
  while (path.curvature(s) < 0.9 * path.max_abs_curvature()) s += 0.25;
  for (const double aside : {-0.2, 0.2}) {
    const Pose pose = compose(path.at(s), {0.0, aside, 0.0});
    const Corridor& c = map[map.joined(plain, PathApproach(path, pose, s))];
    const ReferencePath& joined = map.library().path(c.path);
    const PathApproach onto(joined, pose, s);
    EXPECT_NEAR(wrap_to_pi(joined.at(onto.begin()).theta - pose.theta), 0.0, 0.004);
    for (double on = onto.begin(); on < onto.begin() + 15.0; on += 0.5) {
      const double ground = distance(onto.pose(joined, on), onto.pose(joined, on + 0.5));
      EXPECT_NEAR(ground, 0.5, 0.5 * 0.003) << aside << ' ' << on;
    }
  }
}

TEST_F(JoinedCorridor, HasTheApproachAsPartOfItsPath) {
  for (const double aside : {-0.5, 0.3}) {
    const double s = map[plain].lines.front() - 12.0;
    const Pose pose = compose(path.at(s), {0.0, aside, 0.03});
    const int number = map.joined(plain, PathApproach(path, pose, s));
    const Corridor& c = map[number];
    const ReferencePath& joined = map.library().path(c.path);
    const Pose first = joined.at(s);
    EXPECT_NEAR(first.x, pose.x, 0.05);
    EXPECT_NEAR(first.y, pose.y, 0.01);
    EXPECT_NEAR(first.theta, pose.theta, 0.01);
    EXPECT_LT(PathApproach(joined, pose, s).aside(), 0.01);
    EXPECT_LT(joined.max_abs_curvature(), body.max_curvature());
    for (double on = s + 21.0; on < path.length() - 1.0; on += 1.0) {
      EXPECT_LT(distance(joined.at(on), path.at(on)), 0.06) << on;
    }
    EXPECT_EQ(c.stations, map[plain].stations);
    EXPECT_EQ(c.lane_limits.size(), joined.samples());
    EXPECT_EQ(c.lateral_limits.size(), joined.samples());
    // It is one vehicle's: nobody else gets it, and it is forgotten.
    EXPECT_EQ(map.corridor_for(course, body), plain);
    map.forget_unused();
    map.use(plain);
    map.forget_unused();
    EXPECT_FALSE(map.holds(number));
    EXPECT_TRUE(map.holds(plain));
  }
}

TEST(Corridor, ARunUpLeavesMostOfTheRoadBeforeTheLine) {
  const Vehicle body = fake_type("car").body;
  for (const NetworkShape& shape : {crossroads_shape(), chain_shape(), short_arms_shape()}) {
    Walk walk(shape.network);
    const DrivableArea area(walk.network);
    CorridorMap map(walk.graph, area, {});
    int lines = 0;
    for (const FakeTrip& trip : random_trips(shape, {.vehicles = 20})) {
      const std::vector<std::string> route = shortest_route(shape.network, trip.from, trip.to);
      const double length = shape.network.lanes.at(trip.from + "_0").length;
      const auto course =
          walk.finder.find(walk.at(trip.from + "_0", std::max(1.0, length - 60.0), route));
      if (!course) continue;
      const Corridor& c = map[map.corridor_for(*course, body)];
      double out = 0.0;
      for (const auto& [from, to] : run_ups(c, body.length())) {
        const double line = *std::ranges::lower_bound(c.stops, to);
        EXPECT_EQ(to, line);
        EXPECT_GE(from, out + 0.5 * (line - out));
        EXPECT_LE(to - from, 20.0);
        out = to;
        ++lines;
      }
    }
    EXPECT_GT(lines, 0) << shape.name;
  }
}

/// How far a point is off a polyline [m].
double off(const std::vector<Point>& line, const Point& p) {
  double least = 1e9;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Point d{line[i].x - line[i - 1].x, line[i].y - line[i - 1].y};
    const double share =
        ((p.x - line[i - 1].x) * d.x + (p.y - line[i - 1].y) * d.y) / (d.x * d.x + d.y * d.y);
    const double t = std::clamp(share, 0.0, 1.0);
    least =
        std::min(least, std::hypot(p.x - line[i - 1].x - t * d.x, p.y - line[i - 1].y - t * d.y));
  }
  return least;
}

//   Straight for 50 m behind the junction, then zigzag: a driver is put onto the middle of the
//   lane.
TEST(Corridor, HandsBackWhereTheBodyLiesAlongItsLane) {
  NetworkMaker maker;
  maker.node("C", {0, 0});
  maker.node("W", {-150, 0});
  maker.node("S", {0, -150});
  maker.node("E", {160, 0});
  maker.one_way("W", "C");
  maker.one_way("S", "C");
  std::vector<Point> zigzag;
  for (int i = 0; i < 9; ++i) zigzag.push_back({57.2 + 9.0 * i, i % 2 == 0 ? 0.0 : 5.0});
  maker.one_way("C", "E", 1, zigzag);
  Walk walk(maker.make());
  const DrivableArea area(walk.network);
  CorridorMap map(walk.graph, area, {});
  const Vehicle car = FakeTraffic(walk.network, {}).type("car").body;
  const auto course = walk.finder.find(walk.at("W-C_0", 100.0, {"W-C", "C-E"}));
  ASSERT_TRUE(course);
  const Corridor& c = map[map.corridor_for(*course, car)];
  const Pose pose = map.library().path(c.path).at(c.s_handback);
  const std::vector<Point>& lane = walk.network.lanes.at("C-E_0").shape;
  EXPECT_LT(off(lane, {pose.x, pose.y}), 0.05);
  const Pose nose = compose(pose, {car.front, 0.0, 0.0});
  EXPECT_LT(off(lane, {nose.x, nose.y}), 0.05);
  EXPECT_GT(c.s_handback, c.s_exit + car.length()) << "the tail is out of the junction";
}

//   Behind the crossroads the lane turns to the left, and soon there is a stop. Who does not lie
//   along the lane before that is not driven: its driver would take it back with a jerk.
TEST(Corridor, HandsNobodyBackAslant) {
  int driven = 0;
  int undriven = 0;
  for (double turn = 8.0; turn < 60.0; turn += 4.0) {
    NetworkMaker maker;
    maker.node("C", {0, 0});
    maker.node("W", {-150, 0});
    maker.node("S", {0, -150});
    maker.node("E", {7.2 + turn + 20.0, 60.0}, 0.0);
    maker.one_way("W", "C");
    maker.one_way("S", "C");
    maker.one_way("C", "E", 1, {{7.2 + turn, 0.0}});
    Walk walk(maker.make());
    const DrivableArea area(walk.network);
    CorridorMap map(walk.graph, area, {});
    const std::vector<Point>& lane = walk.network.lanes.at("C-E_0").shape;
    for (const std::string type : {"car", "bus", "truck"}) {
      const Vehicle body = fake_type(type).body;
      CourseQuery query = walk.at("W-C_0", 100.0, {"W-C", "C-E"});
      query.length = body.length();
      query.stop_edge = 1;
      query.stop_position = turn + 8.0;
      const auto course = walk.finder.find(query);
      ASSERT_TRUE(course);
      const Corridor& c = map[map.corridor_for(*course, body)];
      (c.undriven.empty() ? driven : undriven) += 1;
      if (!c.undriven.empty()) continue;
      const Pose pose = map.library().path(c.path).at(c.s_handback);
      for (const double end : {body.front, -body.rear}) {
        const Pose there = compose(pose, {end, 0.0, 0.0});
        EXPECT_LT(off(lane, {there.x, there.y}), 0.1 + 1e-9) << type << ' ' << turn << ' ' << end;
      }
    }
  }
  EXPECT_GT(driven, 10);
  EXPECT_GT(undriven, 2);
}

TEST(CorridorMap, BodiesOfOneShapeShareACorridor) {
  Walk walk(make_crossroads());
  const DrivableArea area(walk.network);
  CorridorMap map(walk.graph, area, {});
  Vehicle body = FakeTraffic(walk.network, {}).type("car").body;
  const auto course = walk.finder.find(walk.at("W_in_0", 150.0, {"W_in", "N_out"}));
  const int first = map.corridor_for(*course, body);
  EXPECT_EQ(map.corridor_for(*course, body), first);
  body.max_speed += 1.0;
  EXPECT_EQ(map.corridor_for(*course, body), first);
  // One that is weaker drives the same path in its own path.
  Vehicle weak = body;
  weak.max_accel *= 0.5;
  const int slow = map.corridor_for(*course, weak);
  EXPECT_NE(slow, first);
  EXPECT_EQ(map.corridor_for(*course, weak), slow);
  EXPECT_EQ(map.library().body(map[slow].path).max_accel, weak.max_accel);
  EXPECT_EQ(&map.library().path(map[slow].path), &map.library().path(map[first].path));
  body.width += 0.1;
  EXPECT_NE(map.corridor_for(*course, body), first);
}

// A bus of 12 m turns on a radius of 6 m: only a path of its own keeps it on the road.
TEST(Corridor, ALongBusStaysOnTheRoadInTheTightestTurn) {
  Walk walk(make_crossroads());
  const DrivableArea area(walk.network);
  CorridorMap map(walk.graph, area, {});
  const Vehicle bus{.front = 8.64,
                    .rear = 3.36,
                    .width = 2.5,
                    .wheelbase = 6.0,
                    .min_turning_radius = 6.0,
                    .max_speed = 20.0,
                    .max_accel = 1.2,
                    .max_decel = 4.0};
  for (const std::string to : {"S_out", "E_out", "N_out"}) {
    CourseQuery query = walk.at("W_in_0", 150.0, {"W_in", to});
    query.length = bus.length();
    const Corridor& c = map[map.corridor_for(*walk.finder.find(query), bus)];
    EXPECT_TRUE(c.undriven.empty()) << to << ": " << c.undriven;
    const ReferencePath& path = map.library().path(c.path);
    EXPECT_LE(path.max_abs_curvature() * bus.min_turning_radius, 1.0) << to;
    for (double s = 30.0; s < c.s_handback; s += 0.5) {
      EXPECT_EQ(area.share_outside(path.at(s), bus, 0.05), 0.0) << to << " at s = " << s;
    }
  }
}

//      N     W has two lanes. The car turns sharply to the right, round a corner that is not
//   W ─A─ E  rounded off: it swings into the lane beside, and wide behind the corner.
//     X
TEST(Corridor, ACarGetsRoundASharpCorner) {
  struct Corner {
    double radius;  ///< [m] of the junction
    double degrees;
  };
  for (const Corner& corner : {Corner{5, 100}, {5, 115}, {5, 120}, {6, 125}, {7.2, 130}}) {
    const double heading = -corner.degrees * std::numbers::pi / 180.0;
    NetworkMaker maker;
    maker.node("W", {-150.0, 0.0}, 0.0);
    maker.node("A", {0.0, 0.0}, corner.radius);
    maker.node("E", {150.0, 0.0}, 0.0);
    maker.node("X", {150.0 * std::cos(heading), 150.0 * std::sin(heading)}, 0.0);
    maker.node("N", {0.0, 150.0}, 0.0);
    maker.one_way("W", "A", 2);
    maker.one_way("A", "E");
    maker.one_way("A", "X");
    maker.one_way("N", "A");
    const RoadNetwork network = maker.make();
    Walk walk(network);
    const DrivableArea area(network);
    CorridorMap map(walk.graph, area, {});
    const auto course = walk.finder.find(walk.at("W-A_0", 100.0, {"W-A", "A-X"}));
    ASSERT_TRUE(course);
    const Corridor& c = map[map.corridor_for(*course, fake_type("car").body)];
    EXPECT_EQ(c.undriven, "") << corner.radius << " m, " << corner.degrees << " degrees";
  }
}

// The kerb is not rounded off: a turn on the middles of the lanes would touch who waits there.
TEST(Corridor, TurnsClearOfPeopleWhoWaitAtTheKerb) {
  const NetworkShape shape = with_crossings(crossroads_shape(120.0, 9.2));
  Walk walk(shape.network);
  const DrivableArea area(walk.network);
  CorridorMap map(walk.graph, area, {});
  const Vehicle car = fake_type("car").body;
  const Vehicle person{.front = 0.25, .rear = 0.25, .width = 0.5};
  for (const std::string to : {"C-S", "C-E", "C-N"}) {
    const auto course = walk.finder.find(walk.at("W-C_0", 100.0, {"W-C", to}));
    ASSERT_TRUE(course);
    const Corridor& c = map[map.corridor_for(*course, car)];
    EXPECT_EQ(c.undriven, "");
    const ReferencePath& path = map.library().path(c.path);
    for (const PedestrianCrossing& crossing : walk.network.junctions.at("C").crossings) {
      const Point& a = crossing.shape.front();
      const Point& b = crossing.shape.back();
      const double theta = std::atan2(b.y - a.y, b.x - a.x);
      for (double aside = -1.75; aside <= 1.75; aside += 0.5) {
        const Pose waits{a.x - aside * std::sin(theta), a.y + aside * std::cos(theta), theta};
        const Pose waits_there{b.x - aside * std::sin(theta), b.y + aside * std::cos(theta), theta};
        for (double s = 0.0; s < c.s_handback; s += 0.25) {
          EXPECT_GT(clearance(path.at(s), car, waits, person), 0.0) << to << " at s = " << s;
          EXPECT_GT(clearance(path.at(s), car, waits_there, person), 0.0) << to << " at s = " << s;
        }
      }
    }
  }
}

TEST(Corridor, SaysWhyABodyCannotDriveIt) {
  Walk walk(make_crossroads());
  const DrivableArea area(walk.network);
  CorridorMap map(walk.graph, area, {});
  const Vehicle crane{.front = 14.0,
                      .rear = 4.0,
                      .width = 3.1,
                      .wheelbase = 10.0,
                      .min_turning_radius = 14.0,
                      .max_accel = 1.0,
                      .max_decel = 3.0};
  CourseQuery query = walk.at("W_in_0", 150.0, {"W_in", "S_out"});
  query.length = crane.length();
  EXPECT_FALSE(map[map.corridor_for(*walk.finder.find(query), crane)].undriven.empty());
}

}  // namespace
}  // namespace mvtp
