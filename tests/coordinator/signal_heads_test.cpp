#include "coordinator/signals/signal_heads.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/corridor/corridor_course.hpp"
#include "coordinator/network/partition.hpp"
#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

/// Notes what is shown.
class NotedTraffic : public FakeTraffic {
 public:
  explicit NotedTraffic(const RoadNetwork& network) : FakeTraffic(network, {}) {}
  void show(const std::string& /*signal*/, int index, Light light) override {
    lights[index] = light;
  }
  void free_signal(const std::string& signal) override { freed.push_back(signal); }
  std::map<int, Light> lights;
  std::vector<std::string> freed;
};

class SignalHeadsTest : public testing::Test {
 protected:
  explicit SignalHeadsTest(const SignalTiming& timing = SignalTiming::real())
      : heads(traffic, graph, coordinated, timing) {
    heads.own();
  }
  void wait(double seconds) {
    for (int i = 0; i < int(seconds * 10.0 + 0.5); ++i) {
      traffic.step();
      heads.advance();
    }
  }
  [[nodiscard]] int link(const std::string& from, const std::string& to) const {
    for (int k = 0; k < graph.links(); ++k) {
      const LaneGraph::Link& l = graph.link(k);
      if (graph.lane(l.from).edge == from && graph.lane(l.to).edge == to) return k;
    }
    return LaneGraph::kNone;
  }

  NetworkShape shape = with_signals(crossroads_shape());
  NotedTraffic traffic{shape.network};
  LaneGraph graph{traffic.network()};
  std::vector<bool> coordinated = select_junctions(graph, {}, 50.0);
  SignalHeads heads;
};

class InstantHeads : public SignalHeadsTest {
 protected:
  InstantHeads() : SignalHeadsTest(SignalTiming::instant()) {}
};

TEST(SignalTiming, YellowIsLongerOnFasterRoads) {
  const SignalTiming real = SignalTiming::real();
  EXPECT_EQ(real.yellow(30.0 / 3.6), 3.0);
  EXPECT_EQ(real.yellow(13.9), 3.0);
  EXPECT_EQ(real.yellow(60.0 / 3.6), 4.0);
  EXPECT_EQ(real.yellow(70.0 / 3.6), 5.0);
  EXPECT_EQ(SignalTiming::instant().yellow(13.9), 0.0);
}

TEST_F(SignalHeadsTest, EveryLightIsRedAtFirst) {
  EXPECT_EQ(traffic.lights.size(), 12U);
  for (const auto& [index, light] : traffic.lights) EXPECT_EQ(light, Light::kRed) << index;
  EXPECT_FALSE(heads.is_free());
}

TEST_F(SignalHeadsTest, ConnectionsThatCrossOrMergeExcludeEachOther) {
  const int east = link("W-C", "C-E");
  EXPECT_TRUE(heads.cross(east, link("S-C", "C-N")));
  EXPECT_TRUE(heads.cross(east, link("S-C", "C-E")));
  EXPECT_FALSE(heads.cross(east, link("E-C", "C-W")));
  EXPECT_FALSE(heads.cross(east, link("W-C", "C-N")));  // from the same lane
}

TEST_F(SignalHeadsTest, AfterAGreenComeYellowAndAllRed) {
  const int east = link("W-C", "C-E");
  const int north = link("S-C", "C-N");
  EXPECT_FALSE(heads.may_turn_green(north));  // not before all have been red for a while
  wait(1.0);
  EXPECT_TRUE(heads.may_turn_green(north));
  heads.turn_green(east);
  EXPECT_FALSE(heads.may_turn_green(north));
  EXPECT_TRUE(heads.may_turn_green(link("E-C", "C-W")));
  wait(6.0);
  heads.end_green(east);
  EXPECT_EQ(traffic.lights.at(graph.link(east).signal_index), Light::kYellow);
  wait(2.9);
  EXPECT_EQ(heads.light(east), Light::kYellow);
  wait(0.1);
  EXPECT_EQ(heads.light(east), Light::kRed);
  EXPECT_FALSE(heads.may_turn_green(north));
  wait(0.9);
  EXPECT_FALSE(heads.may_turn_green(north));
  wait(0.1);
  EXPECT_TRUE(heads.may_turn_green(north));
  EXPECT_EQ(heads.greens(), 1);
}

TEST_F(InstantHeads, TurnAtOnce) {
  const int east = link("W-C", "C-E");
  heads.turn_green(east);
  heads.end_green(east);
  EXPECT_EQ(heads.light(east), Light::kRed);
  EXPECT_TRUE(heads.may_turn_green(link("S-C", "C-N")));
}

TEST_F(SignalHeadsTest, FreedSignalsRunTheirProgramsUntilOwnedAgain) {
  heads.turn_green(link("W-C", "C-E"));
  heads.free();
  EXPECT_THAT(traffic.freed, testing::ElementsAre("C"));
  traffic.lights.clear();
  heads.own();
  EXPECT_EQ(traffic.lights.size(), 12U);
  EXPECT_EQ(heads.light(link("W-C", "C-E")), Light::kRed);
}

class HeadsOfCrossings : public testing::TestWithParam<bool> {};

TEST_P(HeadsOfCrossings, StayRedWhileSomebodyIsOnTheCrossing) {
  const bool is_real = GetParam();
  const NetworkShape shape = with_crossings(with_signals(crossroads_shape()));
  NotedTraffic traffic(shape.network);
  const LaneGraph graph(traffic.network());
  SignalHeads heads(traffic, graph, select_junctions(graph, {}, 50.0),
                    is_real ? SignalTiming::real() : SignalTiming::instant());
  heads.own();
  for (int i = 0; i < 20; ++i) {
    traffic.step();
    heads.advance();
  }
  ASSERT_GT(graph.crossings(), 0);
  for (int c = 0; c < graph.crossings(); ++c) {
    heads.occupy(c, true);
    for (int k = 0; k < graph.links(); ++k) {
      const bool crosses = heads.cross(k, heads.light_of_crossing(c));
      EXPECT_EQ(heads.may_turn_green(k), !(crosses && is_real)) << k << " and crossing " << c;
    }
    heads.occupy(c, false);
    for (int k = 0; k < graph.links(); ++k) EXPECT_TRUE(heads.may_turn_green(k)) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Timings, HeadsOfCrossings, testing::Bool());

TEST(SignalHeads, DoNotOwnASignalThatIsNotTheirsAlone) {
  NetworkShape shape = with_signals(crossroads_shape());
  ++shape.network.signals.at("C");  // a light of people on foot
  FakeTraffic traffic(shape.network, {});
  const LaneGraph graph(traffic.network());
  const SignalHeads heads(traffic, graph, select_junctions(graph, {}, 50.0), SignalTiming::real());
  EXPECT_FALSE(heads.owns_any());
  for (int k = 0; k < graph.links(); ++k) EXPECT_FALSE(heads.owns(k));
}

}  // namespace
}  // namespace mvtp
