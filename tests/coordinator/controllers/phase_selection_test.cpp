#include "coordinator/controllers/phase_selection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "coordinator/controllers/registry.hpp"
#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

/// A signal with three links: from the lanes a and b to the edge out, which two lanes leave, and
/// from c to the end of the network. Vehicles stand where they are put.
class StillTraffic : public Traffic {
 public:
  explicit StillTraffic(std::vector<SignalPhase> phases) : phases_(std::move(phases)) {
    for (const char* edge : {"a", "b", "c", "out", "end", "x", "y"}) {
      const std::string lane = std::string(edge) + "_0";
      network_.lanes[lane] = {.id = lane, .edge = edge, .length = 300.0};
      network_.edges[edge] = {lane};
    }
    network_.junctions["J"] = {.id = "J",
                               .type = "traffic_light",
                               .connections = {{"a_0", {}, "out_0", "J", 0},
                                               {"b_0", {}, "out_0", "J", 1},
                                               {"c_0", {}, "end_0", "J", 2}}};
    network_.junctions["K"] = {
        .id = "K", .type = "priority", .connections = {{"out_0", {}, "x_0"}, {"out_0", {}, "y_0"}}};
    network_.signals["J"] = 3;
  }

  void put(int count, const std::string& edge, const std::string& next, double position = 250.0) {
    for (int i = 0; i < count; ++i) {
      const std::string id = "v" + std::to_string(states_.size());
      states_.push_back({.id = id, .lane = edge + "_0", .lane_position = position});
      routes_of_[id] = {edge, next};
    }
  }
  void clear() { states_.clear(); }

  const RoadNetwork& network() const override { return network_; }
  std::vector<std::string> types() const override { return {}; }
  VehicleType type(const std::string& id) const override { return {.id = id}; }
  double time() const override { return 0.1 * double(steps_); }
  double step_length() const override { return 0.1; }
  bool running() const override { return true; }
  std::span<const VehicleState> vehicles() const override { return states_; }
  std::vector<std::string> route(const std::string& id) const override { return routes_of_.at(id); }
  void take_over(const std::string& id) override { taken.insert(id); }
  void hand_back(const std::string&) override {}
  void place(const std::string& id, const Pose&, double) override { taken.insert(id); }
  void hold(const std::string& id, bool) override { taken.insert(id); }
  void limit_speed(const std::string&, double) override {}
  int collisions() const override { return 0; }
  void step() override { ++steps_; }
  std::vector<SignalPhase> signal_phases(const std::string&) const override { return phases_; }
  void show_all(const std::string& signal, const std::string& lights) override {
    EXPECT_EQ(signal, "J");
    shown = lights;
  }
  void control_signal(const std::string& signal, SignalControl c) override { control[signal] = c; }

  std::string shown;
  std::map<std::string, SignalControl> control;
  std::set<std::string> taken;

 private:
  RoadNetwork network_;
  std::vector<SignalPhase> phases_;
  std::vector<VehicleState> states_;
  std::map<std::string, std::vector<std::string>> routes_of_;
  int steps_ = 0;
};

const std::vector<SignalPhase> kPhases = {
    {.duration = 30, .lights = "Grr"}, {.duration = 4, .lights = "yrr"},
    {.duration = 2, .lights = "rrr"},  {.duration = 30, .lights = "rGG"},
    {.duration = 3, .lights = "ryG"},  {.duration = 20, .lights = "rrG"},
    {.duration = 3, .lights = "rry"}};

class PhaseSelectionTest : public testing::Test {
 protected:
  std::unique_ptr<Controller> make(const std::string& name) {
    CoordinatorOptions options;
    options.junctions = {"J", "K"};
    return find_controller(name)->make({traffic, area, options});
  }
  /// What is shown over so many seconds, one entry per change: lights, and for how long [steps].
  std::vector<std::pair<std::string, int>> watch(Controller& controller, double seconds) {
    std::vector<std::pair<std::string, int>> seen;
    for (int i = 0; i < int(seconds * 10 + 0.5); ++i) {
      controller.decide();
      controller.act();
      if (seen.empty() || seen.back().first != traffic.shown) seen.emplace_back(traffic.shown, 0);
      ++seen.back().second;
      traffic.step();
    }
    return seen;
  }

  StillTraffic traffic{kPhases};
  DrivableArea area{traffic.network(), {}};
};

using Seen = std::vector<std::pair<std::string, int>>;

TEST_F(PhaseSelectionTest, YellowAndRedForAllAreThoseOfTheProgram) {
  const auto controller = make("max-wave");
  traffic.put(2, "a", "out");
  EXPECT_EQ(watch(*controller, 10.0), (Seen{{"Grr", 100}}));
  traffic.put(3, "b", "out");
  EXPECT_EQ(watch(*controller, 10.0), (Seen{{"yrr", 40}, {"rrr", 20}, {"rGG", 40}}));
}

TEST_F(PhaseSelectionTest, ALightThatStaysGreenDoesNotChange) {
  const auto controller = make("max-pressure");
  traffic.put(1, "b", "out");
  traffic.put(1, "c", "end");
  (void)watch(*controller, 20.0);
  EXPECT_EQ(traffic.shown, "rGG");
  traffic.clear();
  traffic.put(5, "out", "x", 10.0);  // b's path on is full, c's is not
  traffic.put(1, "c", "end");
  EXPECT_EQ(watch(*controller, 10.0), (Seen{{"ryG", 30}, {"rrG", 70}}));
}

TEST_F(PhaseSelectionTest, PressureCountsTheLanesBehindAndAWaveDoesNot) {
  traffic.put(4, "a", "out");
  traffic.put(8, "out", "x", 10.0);  // two lanes behind: 4 each, no pressure left for a
  traffic.put(1, "c", "end");
  const auto pressure = make("max-pressure");
  (void)watch(*pressure, 20.0);
  EXPECT_EQ(traffic.shown, "rrG");
  const auto wave = make("max-wave");
  (void)watch(*wave, 20.0);
  EXPECT_EQ(traffic.shown, "Grr");
}

class OutOfReach : public PhaseSelectionTest,
                   public testing::WithParamInterface<std::pair<const char*, double>> {};

TEST_P(OutOfReach, NobodyIsSeen) {
  const auto [name, reach] = GetParam();
  const auto controller = make(name);
  traffic.put(9, "a", "out", 300.0 - reach - 1.0);
  traffic.put(1, "b", "out", 300.0 - reach + 1.0);
  (void)watch(*controller, 20.0);
  EXPECT_EQ(traffic.shown, "rGG");
}

INSTANTIATE_TEST_SUITE_P(Detectors, OutOfReach,
                         testing::Values(std::pair("max-wave", 50.0),
                                         std::pair("max-pressure", 200.0)),
                         [](const auto& test) { return test.index == 0 ? "wave" : "pressure"; });

TEST_F(PhaseSelectionTest, NobodyIsDriven) {
  traffic.put(3, "a", "out");
  for (const ControllerKind& kind : controller_kinds()) {
    if (kind.drives) continue;
    const auto controller = make(kind.name);
    (void)watch(*controller, 20.0);
    EXPECT_FALSE(controller->drives("v0")) << kind.name;
  }
  EXPECT_THAT(traffic.taken, testing::IsEmpty());
}

TEST_F(PhaseSelectionTest, OwnProgramsAreRunByTheTraffic) {
  for (const auto& [name, control] : {std::pair{"static", SignalControl::kFixed},
                                      {"actuated", SignalControl::kActuated},
                                      {"priority", SignalControl::kOff}}) {
    (void)make(name);
    EXPECT_EQ(traffic.control, (std::map<std::string, SignalControl>{{"J", control}})) << name;
  }
  traffic.control.clear();
  (void)make("sumo");
  EXPECT_THAT(traffic.control, testing::IsEmpty());
}

TEST_F(PhaseSelectionTest, WithoutSignalsThereIsNothingToRun) {
  CoordinatorOptions options;
  options.junctions = {"K"};
  for (const ControllerKind& kind : controller_kinds()) {
    if (kind.needs_signals) {
      EXPECT_THROW((void)kind.make({traffic, area, options}), InputError) << kind.name;
    }
  }
}

TEST(Registry, NamesAreUnique) {
  std::set<std::string> names;
  for (const ControllerKind& kind : controller_kinds()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_EQ(find_controller(kind.name), &kind);
    EXPECT_TRUE(kind.make != nullptr || kind.on_lots) << kind.name;
  }
  EXPECT_EQ(find_controller("magic"), nullptr);
  for (const char* name : {kUsualController, kSumosController}) {
    EXPECT_NE(find_controller(name), nullptr) << name;
  }
}

TEST(Registry, EveryControllerOfLotsHasOneName) {
  std::map<LotController, std::string> names;
  for (const ControllerKind& kind : controller_kinds()) {
    if (!kind.on_lots) continue;
    EXPECT_TRUE(kind.drives) << kind.name;
    EXPECT_TRUE(names.emplace(*kind.on_lots, kind.name).second) << kind.name;
    EXPECT_EQ(&controller_of_lots(*kind.on_lots), &kind);
  }
  EXPECT_EQ(names.size(), 4U);
}

}  // namespace
}  // namespace mvtp
