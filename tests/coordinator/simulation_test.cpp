#include "coordinator/simulation/simulation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "coordinator/report/trip_log.hpp"
#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;

/// A clock, and vehicles that stand.
class StandingTraffic : public Traffic {
 public:
  explicit StandingTraffic(double begin) : time_(begin) {
    network_.lanes["a_0"] = {.id = "a_0", .edge = "a", .speed_limit = 10.0, .length = 100.0};
    network_.edges["a"] = {"a_0"};
  }

  [[nodiscard]] const RoadNetwork& network() const override { return network_; }
  [[nodiscard]] std::vector<std::string> types() const override { return {"car"}; }
  [[nodiscard]] VehicleType type(const std::string& id) const override { return {.id = id}; }
  [[nodiscard]] double time() const override { return time_; }
  [[nodiscard]] double step_length() const override { return 1.0; }
  [[nodiscard]] bool running() const override { return true; }
  [[nodiscard]] std::vector<std::string> pending() const override { return waiting; }
  [[nodiscard]] std::span<const VehicleState> vehicles() const override { return states; }
  [[nodiscard]] std::vector<std::string> route(const std::string&) const override { return {"a"}; }
  void take_over(const std::string&) override {}
  void hand_back(const std::string&) override {}
  void place(const std::string&, const Pose&, double) override {}
  void hold(const std::string&, bool) override {}
  void limit_speed(const std::string&, double) override {}
  void step() override { time_ += 1.0; }
  [[nodiscard]] int collisions() const override { return 0; }

  std::vector<VehicleState> states;
  std::vector<std::string> waiting;

 private:
  RoadNetwork network_;
  double time_;
};

VehicleState standing(const std::string& id) {
  return {.id = id, .type = "car", .lane = "a_0", .lane_position = 20.0};
}

RunStatus run(Traffic& traffic, double end) {
  return Simulation(traffic).run({.end = end, .stuck_after = 300.0});
}

TEST(Simulation, ALateBeginIsNoTimeWithoutMotion) {
  StandingTraffic traffic(25200.0);
  traffic.states = {standing("v")};
  EXPECT_EQ(run(traffic, 25400.0), RunStatus::kEndReached);
}

TEST(Simulation, NobodyMovingForLongIsStuck) {
  StandingTraffic traffic(0.0);
  traffic.states = {standing("v"), standing("w")};
  EXPECT_EQ(run(traffic, 1e6), RunStatus::kStuck);
  EXPECT_NEAR(traffic.time(), 301.0, 1.1);
}

TEST(Simulation, WaitingBehindAScheduledStopIsNotStuck) {
  StandingTraffic traffic(0.0);
  traffic.states = {standing("v"), standing("w")};
  traffic.states[0].halted_by_stop = true;
  EXPECT_EQ(run(traffic, 1000.0), RunStatus::kEndReached);
}

TEST(Simulation, AnEmptyRoadIsStuckOnlyIfSomebodyCannotEnterIt) {
  StandingTraffic gap(0.0);
  EXPECT_EQ(run(gap, 1000.0), RunStatus::kEndReached);
  StandingTraffic blocked(0.0);
  blocked.waiting = {"v"};
  EXPECT_EQ(run(blocked, 1000.0), RunStatus::kStuck);
}

TEST(Simulation, AnInterruptEndsItBeforeTheNextStep) {
  StandingTraffic traffic(0.0);
  Simulation simulation(traffic);
  int steps = 0;
  simulation.add([&](const Snapshot&) { ++steps; });
  EXPECT_EQ(simulation.run({.interrupted = [&] { return steps == 3; }}), RunStatus::kInterrupted);
  EXPECT_EQ(steps, 3);
}

TEST(TripLog, KnowsWhenVehiclesCameWentAndStood) {
  StandingTraffic traffic(10.0);
  Simulation simulation(traffic);
  TripLog log(traffic);
  simulation.add([&](const Snapshot& now) { log.observe(now); });
  traffic.waiting = {"w"};
  simulation.step();  // to 11 s
  traffic.waiting = {};
  traffic.states = {standing("v"), standing("w")};
  traffic.states[0].halted_by_stop = true;
  for (int i = 0; i < 5; ++i) simulation.step();  // to 16 s
  traffic.states.erase(traffic.states.begin());
  for (int i = 0; i < 4; ++i) simulation.step();  // to 20 s

  const std::vector<Trip> trips = log.trips();
  ASSERT_EQ(trips.size(), 2U);
  EXPECT_EQ(trips[0].depart, 11.0);
  EXPECT_EQ(trips[0].arrival, 16.0);
  EXPECT_EQ(trips[0].depart_delay, 0.0);
  EXPECT_EQ(trips[1].depart_delay, 1.0);
  EXPECT_FALSE(trips[1].arrival.has_value());

  const FreeFlow free_flow(traffic.network());
  const auto records =
      log.records(trips, free_flow, 20.0, [](const std::string&) { return 50.0; }, {});
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].stopped, 5.0);
  EXPECT_NEAR(delay_of(records[0], 20.0), 16.0 - 11.0 - 0.0 - 5.0, 1e-9);
  EXPECT_NEAR(delay_of(records[1], 20.0), 20.0 - 10.0 - 8.0, 1e-9);
}

// Else a bicycle that nobody holds up would be late.
TEST(TripLog, FreeFlowIsNoFasterThanTheDriverWants) {
  const auto free_flow_at = [](double top_speed) {
    StandingTraffic traffic(0.0);
    TripLog log(traffic);
    Simulation simulation(traffic);
    simulation.add([&](const Snapshot& now) { log.observe(now); });
    traffic.states = {standing("v")};
    traffic.states[0].top_speed = top_speed;
    simulation.step();
    const FreeFlow free_flow(traffic.network());
    const auto max_speed = [](const std::string&) { return 50.0; };
    return log.records(log.trips(), free_flow, 1.0, max_speed, {}).at(0).free_flow;
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_GT(free_flow_at(kInfinity), 0.0);
  EXPECT_NEAR(free_flow_at(1.0), free_flow_at(2.0) * 2.0, 1e-9);
  EXPECT_EQ(free_flow_at(100.0), free_flow_at(kInfinity));
}

/// Drives one vehicle.
class OneDriver : public Controller {
 public:
  explicit OneDriver(std::string id) : id_(std::move(id)) {}
  void decide() override { said.push_back("decide " + id_); }
  void act() override { said.push_back("act " + id_); }
  [[nodiscard]] bool drives(const std::string& id) const override { return id == id_; }
  [[nodiscard]] const std::vector<Replan>& replans() const override { return replans_; }

  static inline std::vector<std::string> said;

 private:
  std::string id_;
  std::vector<Replan> replans_;
};

TEST(Simulation, SeveralControllersDecideBeforeAnyActs) {
  StandingTraffic traffic(0.0);
  traffic.states = {standing("a"), standing("b"), standing("c")};
  OneDriver a("a");
  OneDriver b("b");
  Simulation simulation(traffic);
  simulation.add(a);
  simulation.add(b);
  std::vector<bool> ours;
  simulation.add([&](const Snapshot& now) {
    for (const Observation& s : now.vehicles) ours.push_back(s.coordinated);
  });
  OneDriver::said.clear();
  simulation.step();
  EXPECT_THAT(OneDriver::said, ElementsAre("decide a", "decide b", "act a", "act b"));
  EXPECT_THAT(ours, ElementsAre(true, true, false));
}

TEST(FreeFlow, TakesTheConnectionOfTheLaneWhereThereAreSeveral) {
  RoadNetwork network;
  const auto add = [&](const std::string& edge, int index, double speed) {
    const std::string id = edge + '_' + std::to_string(index);
    network.lanes[id] = {
        .id = id, .edge = edge, .index = index, .speed_limit = speed, .length = 100.0};
    network.edges[edge].push_back(id);
  };
  add("a", 0, 10.0);
  add("a", 1, 10.0);
  add("b", 0, 10.0);
  add("b", 1, 20.0);
  network.junctions["J"].connections = {{"a_0", {}, "b_0"}, {"a_1", {}, "b_1"}};
  const FreeFlow free_flow(network);
  const std::vector<std::string> route = {"a", "b"};
  EXPECT_NEAR(free_flow.duration(route, "a_0", 50.0, 100.0, 1.0, 50.0), 5.0 + 10.0, 1e-9);
  EXPECT_NEAR(free_flow.duration(route, "a_1", 50.0, 100.0, 1.0, 50.0), 5.0 + 5.0, 1e-9);
}

}  // namespace
}  // namespace mvtp
