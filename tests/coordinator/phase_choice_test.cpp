#include "coordinator/signals/phase_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "coordinator/corridor/corridor_course.hpp"
#include "coordinator/network/partition.hpp"
#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

/// Crossroads whose signal has two phases; vehicles stand where they are put.
class Phases : public testing::Test {
 protected:
  /// @param protects_all  in its phase everybody is told that nobody who crosses has green.
  void open(std::vector<FakeTrip> trips, bool protects_all = false) {
    NetworkShape shape = crossroads_with_phases();
    for (SignalPhase& phase : shape.programs.at("C")) {
      if (protects_all) std::ranges::replace(phase.lights, 'g', 'G');
    }
    traffic = std::make_unique<FakeTraffic>(shape.network, std::move(trips), 0.1, shape.programs);
    graph = std::make_unique<LaneGraph>(traffic->network());
    heads = std::make_unique<SignalHeads>(*traffic, *graph, select_junctions(*graph, {}, 50.0),
                                          SignalTiming::real());
    heads->own();
    choice = std::make_unique<PhaseChoice>(
        *traffic, *graph, *heads, [](const std::string& id) { return id.starts_with("ours"); });
  }
  void wait(double seconds) {
    for (int i = 0; i < int(seconds * 10.0 + 0.5); ++i) {
      traffic->step();
      if (i % 5 == 0) choice->decide();
    }
  }
  [[nodiscard]] int link(const std::string& from, const std::string& to) const {
    for (int k = 0; k < graph->links(); ++k) {
      const LaneGraph::Link& l = graph->link(k);
      if (graph->lane(l.from).edge == from && graph->lane(l.to).edge == to) return k;
    }
    return LaneGraph::kNone;
  }

  std::unique_ptr<FakeTraffic> traffic;
  std::unique_ptr<LaneGraph> graph;
  std::unique_ptr<SignalHeads> heads;
  std::unique_ptr<PhaseChoice> choice;
};

TEST_F(Phases, MovementsGoTogetherThatDoInTheProgram) {
  open({});
  const SignalPhases& phases = choice->phases();
  ASSERT_EQ(phases.signals().size(), 1U);
  EXPECT_EQ(phases.signals().front().phases.size(), 2U);
  const int left = link("W-C", "C-N");
  const int oncoming = link("E-C", "C-W");
  EXPECT_TRUE(phases.yields_to(left, oncoming));
  EXPECT_FALSE(phases.yields_to(oncoming, left));
  EXPECT_TRUE(phases.permits(oncoming, left));
  EXPECT_FALSE(phases.permits(left, link("S-C", "C-N")));  // they merge, in different phases
}

// As where two turn side by side: their signal knows that there is room for both.
TEST_F(Phases, HaveAllTheirLightsGreenWhereNobodyYields) {
  FakeTrip left_turner{"b", 0.0, "W-C", "C-N"};
  left_turner.at = std::pair(90.0, 13.0);
  FakeTrip across{"a", 0.0, "S-C", "C-N"};
  across.at = std::pair(60.0, 13.0);
  open({across, left_turner}, /*protects_all=*/true);
  const int left = link("W-C", "C-N");
  const int oncoming = link("E-C", "C-W");
  EXPECT_TRUE(choice->phases().protects_both(left, oncoming));
  EXPECT_TRUE(choice->phases().protects_both(oncoming, left));
  EXPECT_FALSE(choice->phases().protects_both(left, link("S-C", "C-N")));
  EXPECT_FALSE(choice->phases().permits(left, oncoming));
  EXPECT_FALSE(choice->may_be_green_together(left, oncoming)) << "no phase is on";
  traffic->insert_now();
  choice->decide();
  ASSERT_TRUE(choice->is_on(left));
  EXPECT_TRUE(choice->may_be_green_together(left, oncoming));
  EXPECT_FALSE(choice->go_together(left, oncoming)) << "their drivers may meet";
  EXPECT_FALSE(choice->may_be_green_together(left, link("S-C", "C-N")));
}

FakeTrip near_its_line(const std::string& id, const std::string& from, const std::string& to) {
  FakeTrip trip{id, 0.0, from, to};
  trip.at = std::pair(90.0, 13.0);
  return trip;
}

TEST_F(Phases, BeginForTwoWhoNeedLightsThatCross) {
  open({near_its_line("a", "S-C", "C-N"), near_its_line("b", "W-C", "C-E")});
  traffic->insert_now();
  choice->decide();
  EXPECT_NE(choice->allows(link("S-C", "C-N")), choice->allows(link("W-C", "C-E")));
  EXPECT_EQ(choice->is_on(link("S-C", "C-N")), choice->is_on(link("N-C", "C-S")));
}

TEST_F(Phases, AreNotOnForOneAloneNorBesideAVehicleUnderControl) {
  open({near_its_line("a", "S-C", "C-N"), near_its_line("ours", "W-C", "C-E")});
  traffic->insert_now();
  choice->decide();
  EXPECT_TRUE(choice->allows(link("S-C", "C-N")));
  EXPECT_TRUE(choice->allows(link("W-C", "C-E")));
  EXPECT_FALSE(choice->is_on(link("S-C", "C-N")));
  EXPECT_FALSE(choice->go_together(link("W-C", "C-N"), link("E-C", "C-W")));
}

TEST_F(Phases, GiveNoGreenBesideOneWhoseLightDoesNotTellHimToYield) {
  open({near_its_line("a", "S-C", "C-N"), near_its_line("b", "W-C", "C-N"),
        near_its_line("c", "E-C", "C-W")});
  traffic->insert_now();
  const int left = link("W-C", "C-N");
  heads->turn_green(left);
  choice->decide();
  ASSERT_TRUE(choice->is_on(left));
  EXPECT_FALSE(choice->go_together(link("E-C", "C-W"), left));
  heads->end_green(left);
  EXPECT_TRUE(choice->go_together(link("E-C", "C-W"), left));
}

TEST_F(Phases, GoOnWhileAPlatoonComes) {
  std::vector<FakeTrip> trips = {{"waits", 0.0, "S-C", "C-N"}};
  for (int i = 0; i < 6; ++i) {
    FakeTrip trip{"w" + std::to_string(i), 0.0, "W-C", "C-E"};
    trip.at = std::pair(95.0 - 15.0 * i, 13.0);
    trips.push_back(trip);
  }
  trips.front().at = std::pair(100.0, 0.0);
  open(trips);
  traffic->insert_now();
  choice->decide();
  EXPECT_TRUE(choice->allows(link("W-C", "C-E")));
}

TEST_F(Phases, WhoHasStoodForLongWeighsMore) {
  FakeTrip waits{"waits", 0.0, "S-C", "C-N"};
  waits.at = std::pair(100.0, 0.0);
  open({waits});
  const int lane = graph->link(link("S-C", "C-N")).from;
  QueueDetector detector(*traffic, *graph, *heads, [](const std::string&) { return false; },
                         {lane});
  std::vector<double> weights;
  for (int i = 0; i < 300; ++i) {
    for (int k = 0; k < 5; ++k) traffic->step();
    detector.look();
    const Queues queues = detector.queues({lane});
    ASSERT_EQ(queues.front().size(), 1U) << "it has red";
    weights.push_back(queues.front().front().weight);
  }
  EXPECT_EQ(weights[0], 1.0);
  EXPECT_EQ(weights[100], 1.0) << "50 s";
  EXPECT_NEAR(weights[299] / weights[199], 1.5, 0.1) << "as it has stood so much longer";
  EXPECT_GT(weights[199], 1.3) << "100 s";
  EXPECT_TRUE(std::ranges::is_sorted(weights));
}

/// Two lanes that cross, a phase for each.
QueuePhases two_phases() {
  return {.phases = 2,
          .present = 0,
          .ready = -10.0,
          .least_end = -5.0,
          .has_green = [](int phase, int link) { return phase == link; },
          .yields_to = [](int, int) { return false; }};
}

TEST(QueueModel, CountsWhatThoseLoseWhoWaitForTheChange) {
  const Queues queues = {{}, {{.link = 1, .arrival = 0.0, .stands = true}}};
  EXPECT_NEAR(queue_delay(queues, two_phases(), 0.0, 1), 5.0, 0.6);  // 4 s of change, 1 s to start
  EXPECT_NEAR(queue_delay(queues, two_phases(), 6.0, 1), 11.0, 0.6);
}

TEST(QueueModel, ToCutAPlatoonCostsMoreThanToLetItPass) {
  Queues queues(2);
  for (int i = 0; i < 6; ++i) queues[0].push_back({.link = 0, .arrival = 1.0 + 2.0 * i});
  queues[1].push_back({.link = 1, .arrival = 0.0, .stands = true});
  EXPECT_GT(queue_delay(queues, two_phases(), 0.0, 1), queue_delay(queues, two_phases(), 12.0, 1));
}

TEST(QueueModel, WhoWeighsMoreThanAPlatoonGoesBeforeIt) {
  Queues queues(2);
  for (int i = 0; i < 6; ++i) queues[0].push_back({.link = 0, .arrival = 1.0 + 2.0 * i});
  queues[1].push_back({.link = 1, .arrival = 0.0, .stands = true, .weight = 10.0});
  EXPECT_LT(queue_delay(queues, two_phases(), 0.0, 1), queue_delay(queues, two_phases(), 12.0, 1));
  // And counts as so many, whether it goes or not, also where the next phase is chosen.
  for (const double end : {0.0, 7.0, 300.0}) {
    const double before = queue_delay(queues, two_phases(), end, 1);
    for (auto& queue : queues) {
      for (QueuedVehicle& v : queue) v.weight *= 2.0;
    }
    EXPECT_NEAR(queue_delay(queues, two_phases(), end, 1), 2.0 * before, 1e-9) << end;
  }
}

//   One of weight 10 in one lane, two of weight 1 in another: 5 s and 14 s if it goes first.
TEST(QueueModel, TheNextPhaseIsThatOfThoseWhoWeighMost) {
  QueuePhases phases = two_phases();
  phases.phases = 3;
  Queues queues(3);
  for (int i = 0; i < 2; ++i) queues[1].push_back({.link = 1, .arrival = 0.0, .stands = true});
  queues[2].push_back({.link = 2, .arrival = 0.0, .stands = true, .weight = 10.0});
  EXPECT_LT(queue_delay(queues, phases), 10.0 * 6.0 + 2.0 * 20.0);
}

TEST(QueueModel, ALightThatPeopleKeepRedLetsNobodyPass) {
  const Queues queues = {{{.link = 0, .arrival = 0.0, .stands = true}},
                         {{.link = 1, .arrival = 0.0, .stands = true}}};
  QueuePhases phases = two_phases();
  EXPECT_GT(queue_delay(queues, phases, 0.0, 1), queue_delay(queues, phases, 3.0, 1));
  phases.free_in = [](int link) { return link == 0 ? 10.0 : 0.0; };
  EXPECT_LT(queue_delay(queues, phases, 0.0, 1), queue_delay(queues, phases, 3.0, 1));
}

TEST(QueueModel, AChangeFromAPhaseWithoutAnyGreenTakesNoTime) {
  const Queues queues = {{}, {{.link = 1, .arrival = 0.0, .stands = true}}};
  QueuePhases phases = two_phases();
  phases.first_change = 0.0;
  EXPECT_NEAR(queue_delay(queues, phases, 0.0, 1), 1.0, 0.6);
}

TEST(QueueModel, WhoYieldsPassesInAGapOrAtTheEnd) {
  QueuePhases phases = two_phases();
  phases.has_green = [](int phase, int) { return phase == 0; };
  phases.yields_to = [](int link, int other) { return link == 1 && other == 0; };
  Queues queues = {{{.link = 0, .arrival = 2.0}}, {{.link = 1, .arrival = 1.0}}};
  const double in_gap = queue_delay(queues, phases, 100.0, 1);
  EXPECT_GT(in_gap, 0.5);
  EXPECT_LT(in_gap, 3.0);
}

}  // namespace
}  // namespace mvtp
