#include "coordinator/corridor/corridor_course.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "coordinator/corridor/corridor.hpp"
#include "coordinator/corridor/no_waiting.hpp"
#include "coordinator/network/partition.hpp"
#include "tests/coordinator/fake_traffic.hpp"
#include "tests/coordinator/walk.hpp"

namespace mvtp {
namespace {

/// Every course of a shape from its sources to its sinks, and the corridor of a car along it.
class EveryCorridor : public testing::TestWithParam<std::size_t> {
 protected:
  EveryCorridor()
      : shape(all_shapes()[GetParam()].make()), walk(shape.network), area(shape.network) {}

  template <class Check>
  void for_each(const Check& check) {
    const Vehicle car = fake_type("car").body;
    for (const std::string& from : shape.sources) {
      for (const std::string& to : shape.sinks) {
        const std::vector<std::string> route = shortest_route(shape.network, from, to);
        if (route.empty()) continue;
        for (const std::string& lane : shape.network.edges.at(from)) {
          const double length = shape.network.lanes.at(lane).length;
          const double position = std::min(length, std::max(length - 30.0, 8.0));
          const auto course = walk.finder.find(walk.at(lane, position, route));
          ASSERT_TRUE(course) << lane << " to " << to;
          check(map[map.corridor_for(*course, car)], lane + " to " + to);
        }
      }
    }
  }

  NetworkShape shape;
  Walk walk;
  DrivableArea area;
  CorridorMap map{walk.graph, area, {}};
};

TEST_P(EveryCorridor, GrowsFromStationToStation) {
  for_each([&](const Corridor& c, const std::string& name) {
    ASSERT_EQ(c.stations.size(), c.course.pieces.size());
    for (std::size_t i = 1; i < c.stations.size(); ++i) {
      ASSERT_GT(c.stations[i], c.stations[i - 1]) << name << ", piece " << i;
    }
    for (const double scale : c.scales) {
      ASSERT_GT(scale, 0.2) << name;
      ASSERT_LT(scale, 5.0) << name;
    }
    for (const double ratio : c.ratios) ASSERT_NEAR(ratio, 1.0, 1e-6) << name;
    EXPECT_LE(c.s_handback, c.s_latest);
    EXPECT_LE(c.s_latest, c.s_end);
    EXPECT_LE(c.s_end, map.library().path(c.path).length()) << name;
    EXPECT_GT(c.s_handback, c.s_exit) << name;
  });
}

TEST_P(EveryCorridor, LeadsThroughOneZoneOnly) {
  const double chain = CorridorOptions{}.chain;
  std::map<int, std::size_t> zone_of;  // by junction
  const auto zones = partition(walk.graph, select_junctions(walk.graph, {}, chain), chain);
  for (std::size_t z = 0; z < zones.size(); ++z) {
    for (const int j : zones[z].junctions) zone_of[j] = z;
  }
  for_each([&](const Corridor& c, const std::string& name) {
    std::set<std::size_t> entered;
    for (const int piece : c.course.lines) {
      const int lane = c.course.pieces[std::size_t(piece)].lane;
      entered.insert(zone_of.at(walk.graph.junction_behind(walk.graph.edge_of(lane))));
    }
    EXPECT_EQ(entered.size(), 1U) << name;
  });
}

TEST_P(EveryCorridor, BringsTheBumperToEachLineWhereTheLaneEnds) {
  for_each([&](const Corridor& c, const std::string& name) {
    const Vehicle car = fake_type("car").body;
    ASSERT_EQ(c.lines.size(), c.course.lines.size());
    for (std::size_t i = 0; i < c.lines.size(); ++i) {
      const int lane = c.course.pieces[std::size_t(c.course.lines[i])].last_lane();
      const Point end = walk.graph.lane(lane).shape.back();
      const Pose front = compose(map.library().path(c.path).at(c.lines[i]), {car.front, 0.0, 0.0});
      EXPECT_LT(std::hypot(front.x - end.x, front.y - end.y), 1.6) << name << ", line " << i;
      EXPECT_LE(c.stops[i], c.lines[i] + 1e-9);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryCorridor, testing::Range(std::size_t{0}, all_shapes().size()),
                         [](const auto& shape) { return all_shapes()[shape.param].name; });

// Once round the block and over the first road again: one lane, two pieces of the corridor.
TEST(Corridor, PassesALaneTwiceAtTwoStations) {
  const NetworkShape grid = grid_shape();
  CorridorOptions options;
  options.longest = 1000.0;
  Walk walk(grid.network, options);
  const DrivableArea area(grid.network);
  CorridorMap map(walk.graph, area, {});
  const auto course = walk.finder.find(walk.at(
      "W0-A0_0", 70.0, {"W0-A0", "A0-B0", "B0-B1", "B1-A1", "A1-A0", "A0-B0", "B0-C0", "C0-E0"}));
  ASSERT_TRUE(course);
  EXPECT_EQ(std::ranges::count(walk.lanes(*course), "A0-B0_0"), 2);
  const Corridor& c = map[map.corridor_for(*course, fake_type("car").body)];
  const int lane = walk.graph.find_lane("A0-B0_0");
  const double around = 28.0 + 22.0 + 28.0 + 22.0;  // [m] at least
  const double first = c.station(lane, 5.0, 0.0).value();
  const double second = c.station(lane, 5.0, c.s_end).value();
  EXPECT_GT(second - first, around);
  EXPECT_EQ(walk.graph.lane(c.course.pieces[c.piece_at(first)].lane).id, "A0-B0_0");
  EXPECT_EQ(walk.graph.lane(c.course.pieces[c.piece_at(second)].lane).id, "A0-B0_0");
  EXPECT_LT(c.piece_at(first), c.piece_at(second));
  const ReferencePath& path = map.library().path(c.path);
  EXPECT_NEAR(path.at(first).x, path.at(second).x, 0.5);
  EXPECT_NEAR(path.at(first).y, path.at(second).y, 0.5);
}

TEST(CourseFinder, HandsBackBehindTheLastOfNearJunctions) {
  const NetworkShape chain = chain_shape();
  Walk walk(chain.network);
  const auto course = walk.finder.find(walk.at("W-A_0", 60.0, {"W-A", "A-B", "B-E"}));
  ASSERT_TRUE(course);
  EXPECT_EQ(course->lines.size(), 2U);
  EXPECT_EQ(walk.graph.lane(course->pieces[std::size_t(course->exit_piece)].lane).id, "B-E_0");
}

TEST(Corridor, KnowsItsLanesBetweenTwoJunctions) {
  const NetworkShape chain = chain_shape();
  Walk walk(chain.network);
  const DrivableArea area(chain.network);
  CorridorMap map(walk.graph, area, {});
  const auto course = walk.finder.find(walk.at("W-A_0", 60.0, {"W-A", "A-B", "B-E"}));
  ASSERT_TRUE(course);
  const Corridor& c = map[map.corridor_for(*course, fake_type("car").body)];
  const auto lanes = lanes_between(walk.graph, c);
  ASSERT_EQ(lanes.size(), 1U) << "neither the one before the first nor the one behind the last";
  EXPECT_EQ(lanes.front().second, c.lines.back());
  EXPECT_GT(lanes.front().first, c.lines.front());
  EXPECT_EQ(walk.graph.lane(c.course.pieces[c.piece_at(lanes.front().first + 0.1)].lane).id,
            "A-B_0");
}

// W ──A──────(B)──────C── E   Whether a road is one piece or two, where nobody meets anybody
//     │               │       between them: its vehicles are driven on up to the next takeover.
TEST(CourseFinder, ASeamInTheRoadDoesNotBringTheHandBackForward) {
  const auto handback = [](bool seam) {
    NetworkMaker maker;
    maker.node("W", {-150.0, 0.0}, 0.0);
    maker.node("A", {0.0, 0.0});
    maker.node("N", {0.0, 150.0}, 0.0);
    maker.node("S", {0.0, -150.0}, 0.0);
    maker.node("C", {236.0, 0.0});
    maker.node("T", {236.0, 150.0}, 0.0);
    maker.node("U", {236.0, -150.0}, 0.0);
    maker.node("E", {430.0, 0.0}, 0.0);
    maker.one_way("W", "A");
    maker.one_way("S", "A");
    maker.one_way("A", "N");
    if (seam) {
      maker.node("B", {200.0, 0.0}, 0.0);
      maker.one_way("A", "B");
      maker.one_way("B", "C");
    } else {
      maker.one_way("A", "C");
    }
    maker.one_way("U", "C");
    maker.one_way("C", "T");
    maker.one_way("C", "E");
    const NetworkShape shape{.name = "seam", .network = maker.make()};
    Walk walk(shape.network);
    const std::vector<std::string> route =
        seam ? std::vector<std::string>{"W-A", "A-B", "B-C", "C-E"}
             : std::vector<std::string>{"W-A", "A-C", "C-E"};
    const auto course = walk.finder.find(walk.at("W-A_0", 100.0, route));
    EXPECT_TRUE(course);
    return course ? course->handback : 0.0;
  };
  EXPECT_GT(handback(false), CorridorOptions{}.exit);
  EXPECT_NEAR(handback(true), handback(false), 2.0);
}

//   W ──A── behind ──╮ B      Its driver has to be slow in the bend.
TEST(CourseFinder, HandsNobodyBackRightBeforeABendOrInIt) {
  for (const bool marked : {true, false}) {
    for (double behind = 20.0; behind < 120.0; behind += 5.0) {
      const NetworkShape shape = bend_behind_shape(behind, marked);
      Walk walk(shape.network);
      const auto course = walk.finder.find(walk.at("W-A_0", 100.0, {"W-A", "A-B", "B-E"}));
      ASSERT_TRUE(course);
      const auto bend = std::size_t(course->exit_piece) + 1;
      const bool is_seen = bend < course->pieces.size();
      const double inside = is_seen ? walk.graph.lane(course->pieces[bend].lane).length : 0.0;
      const bool before = course->handback <= behind - 45.0 + 1e-6;
      const bool beyond = is_seen && course->handback >= behind + inside + 5.0;
      EXPECT_TRUE(before || beyond) << marked << ' ' << behind << ": " << course->handback;
    }
  }
}

//   W ──╮       A vehicle that comes round the bend B is not taken over before it lies straight
//       B       in its lane, as long as it can stop before the crossroads A then.
//       │
//   S ──A── E
TEST(CourseFinder, TakesNobodyOverInABendIfThereIsTime) {
  constexpr double kStops = 45.0;  // [m]
  for (const double apart : {40.0, 55.0, 70.0, 90.0}) {
    NetworkMaker maker;
    const double y = 7.2 + apart + 7.2;
    maker.node("W", {-200.0, y}, 0.0);
    maker.node("B", {0.0, y});
    maker.node("A", {0.0, 0.0});
    maker.node("S", {-150.0, 0.0}, 0.0);
    maker.node("E", {150.0, 0.0}, 0.0);
    maker.one_way("W", "B");
    maker.one_way("B", "A");
    maker.one_way("S", "A");
    maker.one_way("A", "E");
    Walk walk(maker.make());
    const int bend = walk.graph.links_from(walk.graph.find_lane("W-B_0")).front();
    const Lane& inside = walk.graph.lane(walk.graph.link(bend).via.front());
    for (double at = 0.0; at < inside.length; at += 1.0) {
      const auto course = walk.finder.find(walk.at(inside.id, at, {"W-B", "B-A", "A-E"}));
      EXPECT_EQ(course.has_value(), apart - 6.0 <= kStops) << apart << ": " << at;
    }
    for (double at = 0.0; at < apart; at += 1.0) {
      CourseQuery query = walk.at("B-A_0", at, {"B-A", "A-E"});
      const bool straight = at >= query.length + 1.0;
      const bool late = apart - query.length - 1.0 <= kStops;
      EXPECT_EQ(walk.finder.find(query).has_value(), apart - at <= 80.0 && (straight || late))
          << apart << ": " << at;
    }
  }
}

//   Where the next road is shorter than the body there is nowhere to hand it back.
TEST(Corridor, IsNotDrivenWhereNobodyCouldBeHandedBackBehindTheJunction) {
  for (const std::string type : {"car", "bus"}) {
    const Vehicle body = fake_type(type).body;
    for (const double apart : {16.0, 19.0, 40.0}) {
      NetworkShape chain = chain_shape(7.2, apart);
      Walk walk(chain.network);
      const DrivableArea area(chain.network);
      CorridorMap map(walk.graph, area, {});
      const double edge = walk.graph.lane(walk.graph.find_lane("A-B_0")).length;
      CourseQuery query = walk.at("W-A_0", 60.0, {"W-A", "A-B"});
      query.length = body.length();
      const auto course = walk.finder.find(query);
      ASSERT_TRUE(course);
      const bool cramped = edge < body.length() + 1.0;
      EXPECT_EQ(course->cramped, cramped) << type << ' ' << apart;
      EXPECT_EQ(map[map.corridor_for(*course, body)].undriven.empty(), !cramped)
          << type << ' ' << apart;
    }
  }
}

// At the end of its route a vehicle stays under control until it arrives: nobody is left to whom
// its driver would have to keep a headway.
TEST(CourseFinder, DrivesOnToAnEndOfTheRouteThatIsNear) {
  const NetworkShape chain = chain_shape(7.2, 70.0);
  Walk walk(chain.network);
  const double edge = walk.graph.lane(walk.graph.find_lane("A-B_0")).length;
  const auto course = walk.finder.find(walk.at("W-A_0", 60.0, {"W-A", "A-B"}));
  ASSERT_TRUE(course);
  ASSERT_LT(edge, 60.0);
  EXPECT_GT(course->handback, edge - 1.0);
  EXPECT_LT(course->handback, edge);
  EXPECT_GE(course->end, course->handback);
  EXPECT_LE(course->end, edge);
}

TEST(CourseFinder, HandsNobodyBackWithItsTailInTheJunction) {
  const NetworkShape shape = crossroads_shape();
  Walk walk(shape.network);
  for (const std::string type : {"car", "bus", "truck"}) {
    for (const double stop : {12.0, 25.0, 40.0, 80.0}) {
      CourseQuery query = walk.at("W-C_0", 60.0, {"W-C", "C-E"});
      query.length = fake_type(type).body.length();
      query.stop_edge = 1;
      query.stop_position = stop;
      const auto course = walk.finder.find(query);
      ASSERT_TRUE(course);
      EXPECT_GE(course->handback, std::min(query.length + 1.0, stop - 1.6)) << type << ", " << stop;
      EXPECT_LE(course->handback, stop);
      EXPECT_TRUE(std::ranges::count(course->slow_places, SlowPlace{stop, 0.0})) << "it stops";
    }
  }
}

//   Behind the crossroads a road of two lanes ends in a turn from its left lane, where nobody is
//   coordinated: on the right lane the driver still has to change.
TEST(CourseFinder, HandsBackEarlyWhereTheDriverHasToChangeLanes) {
  NetworkMaker maker;
  maker.node("C", {0, 0});
  for (const auto& [id, middle] : std::map<std::string, Point>{{"W", {-120, 0}},
                                                               {"S", {0, -120}},
                                                               {"N", {0, 120}},
                                                               {"E", {140, 0}},
                                                               {"F", {140, 90}}}) {
    maker.node(id, middle);
  }
  maker.road("W", "C");
  maker.road("S", "C");
  maker.road("N", "C");
  maker.one_way("C", "E", 2);
  maker.one_way("E", "F");
  maker.connect("W-C_0", "C-E_0");
  maker.connect("S-C_0", "C-E_1");
  maker.connect("N-C_0", "C-S_0");
  maker.connect("C-E_1", "E-F_0");
  Walk walk(maker.make());
  const auto ends = walk.finder.find(walk.at("W-C_0", 60.0, {"W-C", "C-E"}));
  const auto goes_on = walk.finder.find(walk.at("W-C_0", 60.0, {"W-C", "C-E", "E-F"}));
  ASSERT_TRUE(ends && goes_on);
  ASSERT_EQ(walk.graph.lane(goes_on->pieces.back().lane).id, "C-E_0");
  const double length = walk.graph.lane(walk.graph.find_lane("C-E_0")).length;
  EXPECT_GE(length - goes_on->handback, 80.0);
  EXPECT_GT(ends->handback, goes_on->handback + 10.0);
}

//   W leads into both lanes of E, from both of its own; a bus stop is on one lane or the other.
TEST(CourseFinder, LeadsIntoTheLaneOfTheNextStop) {
  NetworkMaker maker;
  maker.node("C", {0, 0});
  for (const auto& [id, middle] : std::map<std::string, Point>{
           {"W", {-120, 0}}, {"S", {0, -120}}, {"N", {0, 120}}, {"E", {200, 0}}}) {
    maker.node(id, middle);
  }
  maker.one_way("W", "C", 2);
  maker.one_way("C", "E", 2);
  maker.road("S", "C");
  maker.road("N", "C");
  maker.connect("W-C_0", "C-E_0");
  maker.connect("W-C_1", "C-E_1");
  maker.connect("S-C_0", "C-N_0");
  maker.connect("N-C_0", "C-S_0");
  Walk walk(maker.make());
  for (const std::string from : {"W-C_0", "W-C_1"}) {
    for (const std::string to : {"C-E_0", "C-E_1"}) {
      CourseQuery query = walk.at(from, 40.0, {"W-C", "C-E"});
      query.stop_edge = 1;
      query.stop_lane = walk.graph.find_lane(to);
      query.stop_position = 120.0;
      const auto course = walk.finder.find(query);
      ASSERT_TRUE(course);
      EXPECT_EQ(walk.graph.lane(course->pieces.back().lane).id, to) << "from " << from;
    }
  }
}

//   The road behind the crossroads is a dead end: vehicles turn round there, with their drivers.
TEST(CourseFinder, HandsBackBeforeTheRouteTurnsRound) {
  NetworkMaker maker;
  maker.node("C", {0, 0});
  for (const auto& [id, middle] : std::map<std::string, Point>{
           {"W", {-120, 0}}, {"S", {0, -120}}, {"N", {0, 120}}, {"E", {90, 0}}}) {
    maker.node(id, middle);
    maker.road(id, "C");
  }
  maker.connect("C-E_0", "E-C_0");
  Walk walk(maker.make());
  const auto course = walk.finder.find(walk.at("W-C_0", 60.0, {"W-C", "C-E", "E-C", "C-N"}));
  ASSERT_TRUE(course);
  const int lane = walk.graph.find_lane("C-E_0");
  EXPECT_EQ(course->pieces.back().lane, lane);
  EXPECT_LT(course->handback, 12.0);
}

TEST(CourseFinder, ChangesToTheLaneThatLeadsOn) {
  const NetworkShape shape = two_lanes_shape();
  Walk walk(shape.network);
  // Only the left lane leads from W to N.
  const auto course = walk.finder.find(walk.at("W-C_0", 60.0, {"W-C", "C-N"}));
  ASSERT_TRUE(course);
  EXPECT_EQ(walk.graph.lane(course->pieces[0].last_lane()).id, "W-C_1");
  EXPECT_GE(course->pieces[0].begin, 60.0);
  EXPECT_LE(course->pieces[0].end, walk.graph.lane(course->pieces[0].lane).length);
  const auto kept = walk.finder.find(walk.at("W-C_1", 60.0, {"W-C", "C-N"}));
  EXPECT_EQ(kept->pieces[0].target, LaneGraph::kNone);
}

TEST(Corridor, IsForgottenOnceNobodyUsesIt) {
  const NetworkShape shape = crossroads_shape();
  Walk walk(shape.network);
  const DrivableArea area(shape.network);
  CorridorMap map(walk.graph, area, {});
  const Vehicle car = fake_type("car").body;
  Vehicle weak = car;
  weak.max_accel *= 0.5;
  const auto course_to = [&](const std::string& exit) {
    return *walk.finder.find(walk.at("W-C_0", 60.0, {"W-C", exit}));
  };
  const int straight = map.corridor_for(course_to("C-E"), car);
  const int right = map.corridor_for(course_to("C-S"), car);
  const int weak_right = map.corridor_for(course_to("C-S"), weak);
  const double length = map.library().path(map[right].path).length();
  map.forget_unused();  // all have been asked for
  ASSERT_TRUE(map.holds(straight) && map.holds(right) && map.holds(weak_right));
  map.use(straight);
  EXPECT_EQ(map.corridor_for(course_to("C-S"), weak), weak_right);
  map.forget_unused();
  EXPECT_TRUE(map.holds(straight));
  EXPECT_FALSE(map.holds(right));
  ASSERT_TRUE(map.holds(weak_right)) << "though it shares the path of one that is forgotten";
  EXPECT_EQ(map.library().path(map[weak_right].path).length(), length);
  const int anew = map.corridor_for(course_to("C-S"), car);
  EXPECT_GT(anew, weak_right);
  EXPECT_EQ(&map.library().path(map[anew].path), &map.library().path(map[weak_right].path));
  map.forget_unused();
  map.forget_unused();
  EXPECT_FALSE(map.library().holds(map.size() - 1));
  const int once_more = map.corridor_for(course_to("C-S"), car);
  EXPECT_EQ(map.library().path(map[once_more].path).length(), length);
}

TEST(Corridor, TurnsRoundInARoadOnlyIfTheBodyCan) {
  const NetworkShape shape = u_turn_shape();
  Walk walk(shape.network);
  const DrivableArea area(shape.network);
  CorridorMap map(walk.graph, area, {});
  for (const std::string type : {"car", "bus", "truck"}) {
    const auto course = walk.finder.find(walk.at("W-C_0", 60.0, {"W-C", "C-W"}));
    ASSERT_TRUE(course);
    EXPECT_FALSE(map[map.corridor_for(*course, fake_type(type).body)].undriven.empty()) << type;
  }
}

}  // namespace
}  // namespace mvtp
