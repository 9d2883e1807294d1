#include "coordinator/drivers/human_drivers.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "coordinator/network/partition.hpp"
#include "tests/coordinator/closed_loop.hpp"
#include "tests/coordinator/mixed_loop.hpp"

namespace mvtp {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;

TEST(HumanDrivers, AreNeverTakenOverNorHeld) {
  ClosedLoop run = loop(cars(1), share(0.0));
  while (run.traffic.running() && run.traffic.time() < 400.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      EXPECT_FALSE(run.traffic.is_held(v.id)) << v.id;
      EXPECT_FALSE(run.traffic.passes(v.id)) << v.id;
    }
  }
  EXPECT_EQ(run.taken_over, 0);
}

TEST(HumanDrivers, OneAloneHardlySlowsDown) {
  ClosedLoop run = loop({{"a", 0.0, "W-C", "C-E"}}, share(0.0));
  double least = 1e9;
  while (run.traffic.running() && run.traffic.time() < 60.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) least = std::min(least, v.speed);
  }
  EXPECT_GT(least, 12.0);
  EXPECT_EQ(run.coordinator.humans()->greens(), 1);
  EXPECT_EQ(run.coordinator.humans()->unplanned_passages(), 0);
}

// At red he is expected to drive over his line, for he cannot stop; but he brakes for one who
// stands there, harder than he should be able to, and waits for green as everybody does.
TEST(HumanDrivers, WhoStoppedAfterAllWaitsForGreen) {
  const NetworkShape shape = with_signals(crossroads_shape());
  const double length = shape.network.lanes.at("W-C_0").length;
  FakeTrip stands{"stands", 0.0, "W-C", "C-S", "bike"};
  stands.at = std::pair(length - 0.5, 0.0);
  FakeTrip fast{"fast", 0.4, "W-C", "C-E"};  // right before a decision
  fast.at = std::pair(length - 13.0, 12.0);
  FakeTrip across{"across", 0.0, "S-C", "C-N"};  // has green meanwhile
  across.at = std::pair(length - 45.0, 10.0);
  ClosedLoop run(shape, {stands, fast, across}, 0.1, share(0.0));
  run.traffic.freeze("stands");
  bool could_not_stop = false;
  bool waits_again = false;
  while (run.traffic.time() < 10.0) {
    run.step();
    const bool passes = run.coordinator.humans()->passes("fast");
    could_not_stop |= passes;
    waits_again |= could_not_stop && !passes;
  }
  EXPECT_TRUE(could_not_stop);
  EXPECT_TRUE(waits_again);
}

// Braked steadily he would come to rest right behind his line; a driver of SUMO does so before it.
TEST(HumanDrivers, WhoCanJustStopForRedIsNotExpectedToPass) {
  constexpr double kStep = 0.2, kDecel = 4.5, kSpeed = 13.34;
  for (const double share_of_gap : {0.1, 0.9}) {
    const double room = std::lerp(braking_gap(kSpeed, kDecel, kStep),
                                  stopping_distance(kSpeed, kDecel), share_of_gap);
    const NetworkShape shape = with_signals(crossroads_shape());
    FakeTrip fast{"fast", 0.0, "W-C", "C-E"};
    fast.at = std::pair(shape.network.lanes.at("W-C_0").length - room, kSpeed);
    ClosedLoop run(shape, {fast}, kStep, share(0.0));
    run.traffic.insert_now();
    run.step();
    EXPECT_TRUE(run.coordinator.humans()->knows("fast"));
    EXPECT_EQ(run.coordinator.humans()->unplanned_passages(), 0) << share_of_gap;
  }
}

// Others count on his braking for red from now on, however late, and not only once he is told to.
TEST(HumanDrivers, AreExpectedToBrakeForRedAtOnce) {
  CoordinatorOptions options;
  options.share = {.human_types = {"bike"}};
  ClosedLoop run(with_signals(crossroads_shape()),
                 {{"turns", 0.0, "N-C", "C-E"}, {"human", 0.0, "S-C", "C-N", "bike"}}, 0.1,
                 options);
  const HumanDrivers& humans = *run.coordinator.humans();
  int at_red = 0;
  while (run.traffic.running() && run.traffic.time() < 60.0) {
    const bool was_red = humans.has_to_wait("human");
    const std::size_t decisions = run.coordinator.replans().size();
    run.step();
    const bool is_new = run.coordinator.replans().size() > decisions;
    if (!is_new || !was_red || !humans.has_to_wait("human")) continue;
    for (const Forecast& f : run.coordinator.forecasts()) {
      ++at_red;
      EXPECT_EQ(f.told, Told::kToWait) << "at t = " << run.traffic.time();
    }
  }
  EXPECT_GT(at_red, 0);
}

// Lights of a phase turn green together. One ends before a driver whose passage is not planned
// could not stop any more.
TEST(HumanDrivers, AreExpectedToWaitAtAGreenThatIsNotMeantForThem) {
  const NetworkShape shape = crossroads_with_phases();
  ClosedLoop run(shape, random_trips(shape, {.vehicles = 24, .seed = 3}), 0.1, share(0.5));
  const auto& connections = shape.network.junctions.at("C").connections;
  const auto is_at_green = [&](const VehicleState& v) {
    return std::ranges::any_of(connections, [&](const Connection& c) {
      return c.from_lane == v.lane && run.traffic.light("C", c.signal_index) == Light::kGreen;
    });
  };
  int at_green = 0;
  while (run.traffic.running() && run.traffic.time() < 200.0) {
    std::vector<VehicleState> before;
    for (const VehicleState& v : run.traffic.vehicles()) {
      if (is_at_green(v)) before.push_back(v);
    }
    const std::size_t decisions = run.coordinator.replans().size();
    run.step();
    if (run.coordinator.replans().size() == decisions) continue;
    const RoadScene scene = run.coordinator.scene();
    for (const VehicleState& v : before) {
      const HumanDrivers& humans = *run.coordinator.humans();
      if (!humans.knows(v.id) || humans.passes(v.id)) continue;
      for (const Forecast& f : scene.forecasts) {
        const Pose pose = scene.library->path(f.vehicle.path).at(f.vehicle.now.s);
        if (distance(pose, v.pose) > 1.0) continue;
        ++at_green;
        EXPECT_EQ(f.told, Told::kToWait) << v.id << " at t = " << run.traffic.time();
      }
    }
  }
  EXPECT_GT(at_green, 0);
}

// He is too fast to stop before the end of his lane, from which no connection leads where he goes:
// a follower must not count on his driving on.
TEST(HumanDrivers, NeverPassTheEndOfALaneThatDoesNotLeadOn) {
  const NetworkShape shape = with_signals(two_lanes_shape());
  FakeTrip fast{"fast", 0.4, "W-C", "C-E"};
  fast.lane = 1;
  fast.at = std::pair(shape.network.lanes.at("W-C_1").length - 8.0, 12.0);
  FakeTrip beside{"beside", 0.0, "W-C", "C-E"};  // so he cannot change lanes
  beside.at = std::pair(shape.network.lanes.at("W-C_0").length - 8.0, 0.0);
  ClosedLoop run(shape, {beside, fast}, 0.1, share(0.0));
  run.traffic.freeze("beside");
  int known = 0;
  while (run.traffic.time() < 1.0) {
    run.step();
    known += int(run.coordinator.humans()->knows("fast"));
    EXPECT_FALSE(run.coordinator.humans()->passes("fast")) << run.traffic.time();
  }
  EXPECT_GT(known, 0);
  EXPECT_EQ(run.coordinator.humans()->unplanned_passages(), 0);
}

// They stand further from their lines than they would from a leader.
TEST(HumanDrivers, WhoStandAtTheirLinesGetGreen) {
  const NetworkShape shape = crossroads_with_phases();
  ClosedLoop run(shape, random_trips(shape, {.types = {"close"}}), 0.1, share(0.0));
  run.run_until(300.0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

// The car ahead in his lane is his leader; crossing traffic is not.
TEST(HumanDrivers, MayGetGreenBehindAControlledCarButNotBeforeOne) {
  CoordinatorOptions options = share(1.0);
  options.share.human_types = {"bus"};
  ClosedLoop run =
      loop({{"a", 0.0, "W-C", "C-E"}, {"b", 1.5, "W-C", "C-E", "bus"}, {"c", 0.0, "S-C", "C-N"}},
           options);
  while (run.coordinator.drives("a") + run.coordinator.drives("c") < 2 ||
         !run.coordinator.humans()->knows("b")) {
    ASSERT_LT(run.traffic.time(), 30.0);
    run.step();
  }
  const RoadScene scene = run.coordinator.scene();
  ASSERT_EQ(scene.vehicles.size(), 2U);
  const auto may_meet_at = [&](const RoadVehicle& v, double speed) {
    SpeedProfile plan{.begin = scene.step, .states = {v.now}};
    while (plan.states.size() < 600) {
      plan.states.push_back({plan.states.back().s + speed * scene.grid.dt, speed});
    }
    return run.coordinator.humans()->may_meet({"b"}, v.path, plan);
  };
  int meeting = 0;
  for (const RoadVehicle& v : scene.vehicles) {
    bool meets = false;
    for (double speed = 2.0; speed < 14.0; speed += 1.0) meets |= may_meet_at(v, speed);
    meeting += int(meets);
  }
  EXPECT_EQ(meeting, 1);
}

// Each of the two would wait for the other: the car for whom turns left before it, the driver who
// turns left for those who come to a green behind the car.
TEST(HumanDrivers, TurnLeftBeforeThoseBehindAControlledCarThatWaits) {
  CoordinatorOptions options = share(1.0);
  options.share.human_types = {"bus", "bike"};
  const auto at = [](const std::string& id, const std::string& from, const std::string& to,
                     const std::string& type, double place) {
    FakeTrip trip{id, 0.0, from, to, type};
    trip.at = std::pair(place, 8.0);
    return trip;
  };
  std::vector<FakeTrip> trips = {
      at("first", "W-C", "C-E", "bike", 95.0), at("waits", "W-C", "C-E", "car", 75.0),
      at("behind", "W-C", "C-E", "bus", 50.0), at("left", "E-C", "C-S", "bus", 50.0),
      at("across", "S-C", "C-N", "bus", 50.0)};
  trips[0].stop = FakeStop{"C-E_0", 8.0, 60.0};
  ClosedLoop run(crossroads_with_phases(), trips, 0.1, options);
  const HumanDrivers& humans = *run.coordinator.humans();
  int inside = 0;
  while (run.traffic.time() < 60.0) {
    run.step();
    if (!humans.passes("left")) continue;
    for (const Forecast& f : humans.passages("left")) {
      EXPECT_LT(double(f.latest->states.size()) * 0.1, 50.0) << run.traffic.time();
    }
    const auto left = std::ranges::find(run.traffic.vehicles(), "left", &VehicleState::id);
    if (left->lane.front() != ':') continue;
    if (++inside <= 5) continue;  // until the next decision
    EXPECT_EQ(run.traffic.goes_before("left").count("behind"), 1U) << run.traffic.time();
  }
  EXPECT_GT(inside, 5);
}

// A light that stays green as long as its phase does must not keep the others of it red.
TEST(HumanDrivers, AllGoInAPhaseInWhichNobodyYields) {
  NetworkShape shape = crossroads_with_phases();
  for (SignalPhase& phase : shape.programs.at("C")) std::ranges::replace(phase.lights, 'g', 'G');
  const double line = shape.network.lanes.at("W-C_0").length - 1.0;
  std::vector<FakeTrip> trips = {
      {"left", 0.0, "W-C", "C-N"}, {"oncoming", 0.0, "E-C", "C-W"}, {"across", 0.0, "S-C", "C-N"}};
  for (FakeTrip& trip : trips) trip.at = std::pair(line, 0.0);
  ClosedLoop run(shape, trips, 0.1, share(0.0));
  run.run_until(50.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 3);
}

// It stands within the margins behind him, and can go only after him.
TEST(HumanDrivers, GetGreenBeforeAControlledCarThatStandsCloseBehind) {
  CoordinatorOptions options = share(1.0);
  options.share.human_types = {"bike"};
  const NetworkShape shape = crossroads_with_phases();
  const double line = shape.network.lanes.at("W-C_0").length - 0.5;
  FakeTrip human{"human", 0.0, "W-C", "C-E", "bike"};
  human.at = std::pair(line, 0.0);
  FakeTrip car{"car", 0.0, "W-C", "C-E"};
  car.at = std::pair(line - fake_type("bike").body.length() - 0.15, 0.0);
  ClosedLoop run(shape, {human, car}, 0.1, options);
  run.run_until(120.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 2);
}

TEST(HumanDrivers, StayBeforeTheirLineUntilTheyHaveGreen) {
  ClosedLoop run = loop(cars(2), share(0.3));
  const std::vector<int> later = {20};
  std::map<std::string, Pose> lines;  // where the rear axle comes to at most, straight ahead
  int seen = 0;
  while (run.traffic.running() && run.traffic.time() < 200.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      const auto ground =
          run.coordinator.humans()->ground_of(v.id, v.pose, run.coordinator.steps(), later);
      if (!ground || ground->passes) {
        lines.erase(v.id);
        continue;
      }
      EXPECT_EQ(ground->reaches[0].least, 0.0);
      const Pose line = compose(v.pose, {ground->reaches[0].most, 0.0, 0.0});
      const auto [known, is_new] = lines.try_emplace(v.id, line);
      if (is_new) continue;
      EXPECT_LT(distance(known->second, line), 0.3) << v.id << ": the line does not move";
      ++seen;
    }
  }
  EXPECT_GT(seen, 100);
}

/// Where the paths lead on which a driver from the west is expected behind his line, as heights.
std::set<double> expected_exits(const std::string& onto, KnownIntent intent) {
  CoordinatorOptions options = share(0.0);
  options.intent = intent;
  ClosedLoop run{with_signals(fan_out_shape()),
                 {{.id = "a", .from = "W-C", .to = "C-E", .onto = onto}},
                 0.1,
                 options};
  std::set<double> heights;
  while (run.traffic.running() && run.traffic.time() < 30.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      if (v.lane != "W-C_0") continue;
      const auto ground =
          run.coordinator.humans()->ground_of(v.id, v.pose, run.coordinator.steps(), {});
      if (!ground) continue;
      for (const int path : ground->paths) {
        const ReferencePath& line = run.coordinator.corridors().library().path(path);
        heights.insert(std::round(line.at(line.length()).y * 10.0) / 10.0);
      }
    }
  }
  return heights;
}

TEST(HumanDrivers, GoOntoTheirLaneOfSeveral) {
  const RoadNetwork network = fan_out_shape().network;
  const auto height = [&](const std::string& lane) {
    return network.lanes.at(lane).shape.back().y;
  };
  for (const std::string lane : {"C-E_0", "C-E_1"}) {
    EXPECT_THAT(expected_exits(lane, KnownIntent::kRoute),
                ElementsAre(DoubleNear(height(lane), 0.1)))
        << lane;
  }
  EXPECT_THAT(expected_exits("C-E_0", KnownIntent::kLane),
              IsSupersetOf({DoubleNear(height("C-E_0"), 0.1), DoubleNear(height("C-E_1"), 0.1)}));
}

// Beside them, a lorry that swings out before its turn would wait for those who wait for it.
TEST(HumanDrivers, HaveTheLaneBesideALorryThatTurnsForThemselves) {
  const auto why_left = [](double penetration, const std::string& to) {
    const FakeTrip lorry{
        .id = "lorry", .from = "W-C", .to = to, .type = "truck", .lane = to == "C-N" ? 1 : 0};
    ClosedLoop run{with_signals(two_lanes_shape()), {lorry}, 0.1, share(penetration)};
    run.run_until(60.0);
    EXPECT_EQ(run.traffic.arrived(), 1);
    std::string why;
    for (const LeftToTraffic& left : run.coordinator.left_to_sumo()) why += left.why;
    return why;
  };
  EXPECT_THAT(why_left(0.999, "C-N"), HasSubstr("human drivers wait"));
  EXPECT_EQ(why_left(1.0, "C-N"), "");
  EXPECT_EQ(why_left(0.999, "C-E"), "");
}

TEST(HumanDrivers, DoNotWaitForEverBesideAStreamOfControlledCars) {
  std::vector<FakeTrip> trips = {{"bike", 0.0, "S-C", "C-N", "bike"}};
  for (int i = 0; i < 60; ++i) {
    trips.push_back({fmt::format("w{}", i), 3.0 * i, "W-C", "C-E"});
    trips.push_back({fmt::format("e{}", i), 3.0 * i + 1.5, "E-C", "C-W"});
  }
  CoordinatorOptions options;
  options.share.human_types = {"bike"};
  ClosedLoop run = loop(trips, options);
  run.run_until(90.0);
  EXPECT_THAT(run.broken, IsEmpty());
  const auto still_there =
      std::ranges::any_of(run.traffic.vehicles(), [](const auto& v) { return v.id == "bike"; });
  EXPECT_FALSE(still_there);
}

// The driver stands on a lane that no controlled vehicle uses, its tail on one that they do.
TEST(HumanDrivers, AreSeenUntilTheirTailsHaveLeftTheLane) {
  FakeTrip truck{.id = "truck", .from = "E-C", .to = "D-Y", .type = "truck"};
  truck.stop = FakeStop{"D-Y_0", 4.0, 30.0};
  std::vector<FakeTrip> trips = {truck};
  for (int i = 0; i < 6; ++i) trips.push_back({fmt::format("s{}", i), 4.0 + 2.0 * i, "S-C", "D-X"});
  CoordinatorOptions options;
  options.share.human_types = {"truck"};
  ClosedLoop run(fork_shape(), trips, 0.1, options);
  bool stood = false;
  while (run.traffic.running() && run.traffic.time() < 150.0) {
    run.step();
    const auto v = std::ranges::find(run.traffic.vehicles(), "truck", &VehicleState::id);
    stood = stood || (v != run.traffic.vehicles().end() && v->lane == "D-Y_0" && v->halted_by_stop);
  }
  EXPECT_TRUE(stood);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.traffic.arrived(), 7);
}

/// Who sees at each step what the lights show.
class WatchedTraffic : public FakeTraffic {
 public:
  explicit WatchedTraffic(std::vector<FakeTrip> trips)
      : FakeTraffic(with_signals(crossroads_shape()).network, std::move(trips)) {}
  void show(const std::string& signal, int index, Light light) override {
    FakeTraffic::show(signal, index, light);
    lights[index] = light;
  }
  std::map<int, Light> lights;
};

TEST(HumanDrivers, GreensProtectAndNobodyDrivesAtRed) {
  WatchedTraffic traffic(cars(3, 40));
  const DrivableArea area(traffic.network());
  Coordinator coordinator(traffic, area, share(0.4));
  Simulation simulation(traffic);
  simulation.add(coordinator);
  const LaneGraph graph(traffic.network());
  const SignalHeads heads(traffic, graph, select_junctions(graph, {}, 50.0), SignalTiming::real());
  std::map<std::string, std::string> last;
  while (traffic.running() && traffic.time() < 400.0) {
    simulation.step();
    for (int a = 0; a < graph.links(); ++a) {
      for (int b = 0; b < graph.links(); ++b) {
        if (!heads.owns(a) || !heads.owns(b) || !heads.cross(a, b)) continue;
        const Light first = traffic.lights[graph.link(a).signal_index];
        const Light second = traffic.lights[graph.link(b).signal_index];
        EXPECT_FALSE(first != Light::kRed && second != Light::kRed) << traffic.time() << " s";
      }
    }
    for (const VehicleState& v : traffic.vehicles()) {
      const int lane = graph.find_lane(v.lane);
      const bool enters = graph.edge_of(lane) == LaneGraph::kNone && last[v.id] != v.lane;
      last[v.id] = v.lane;
      if (!enters || coordinator.drives(v.id)) continue;
      const int index = graph.link(graph.links_over(lane).front()).signal_index;
      EXPECT_NE(traffic.lights[index], Light::kRed) << v.id << " at " << traffic.time() << " s";
    }
  }
  EXPECT_FALSE(traffic.running());
}

}  // namespace
}  // namespace mvtp
