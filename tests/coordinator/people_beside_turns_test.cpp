// People on crossings that have green together with those who turn over them.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "coordinator/network/partition.hpp"
#include "coordinator/signals/phase_choice.hpp"
#include "tests/coordinator/mixed_loop.hpp"
#include "tests/coordinator/placed_people.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;

/// Does a connection of the crossroads go straight on?
bool goes_straight(const LaneGraph& graph, int link) {
  const std::string& from = graph.lane(graph.link(link).from).id;
  const std::string& to = graph.lane(graph.link(link).to).id;
  const std::string ends = {from.front(), to[to.find('-') + 1]};
  return ends == "WE" || ends == "EW" || ends == "NS" || ends == "SN";
}

/// Crossroads whose signal has two phases, in which people walk beside those who go straight on;
/// vehicles that turn over their crossing give way.
NetworkShape crossroads_with_people() {
  NetworkShape shape = with_crossings(crossroads_with_phases());
  FakeTraffic traffic(shape.network, std::vector<FakeTrip>{});
  const LaneGraph graph(traffic.network());
  const SignalHeads heads(traffic, graph, select_junctions(graph, {}, 50.0), SignalTiming::real());
  for (SignalPhase& phase : shape.programs.at("C")) {
    std::string& lights = phase.lights;
    const auto light_of = [&](int k) -> char& {
      return lights[std::size_t(graph.link(k).signal_index)];
    };
    const std::size_t links = lights.size();
    lights.resize(links + std::size_t(graph.crossings()), 'r');
    for (int c = 0; c < graph.crossings(); ++c) {
      std::vector<int> over;
      for (int k = 0; k < graph.links(); ++k) {
        if (heads.cross(k, heads.light_of_crossing(c)) && light_of(k) != 'r') over.push_back(k);
      }
      if (std::ranges::any_of(over, [&](int k) { return goes_straight(graph, k); })) continue;
      lights[std::size_t(graph.crossing(c).crossing->lights.front())] = 'G';
      for (const int k : over) light_of(k) = 'g';
    }
  }
  return shape;
}

TEST(PeopleBesideTurns, DoNotBarThoseWhoGiveWayToThem) {
  const NetworkShape shape = crossroads_with_people();
  FakeTraffic traffic(shape.network, std::vector<FakeTrip>{}, 0.1, shape.programs);
  const LaneGraph graph(traffic.network());
  SignalHeads heads(traffic, graph, select_junctions(graph, {}, 50.0), SignalTiming::real());
  heads.own();
  const PhaseChoice choice(traffic, graph, heads, [](const std::string&) { return false; });
  int give_way = 0;
  for (int c = 0; c < graph.crossings(); ++c) {
    heads.expect_people(c, traffic.time() + 20.0);
    const int light = heads.light_of_crossing(c);
    for (int k = 0; k < graph.links(); ++k) {
      if (!heads.cross(k, light)) continue;
      EXPECT_GT(heads.barred_until(k), traffic.time());
      const bool yields = choice.phases().yields_to(k, light);
      // Those who come from the arm of the crossing, or go straight on into it, have red meanwhile.
      if (goes_straight(graph, k)) EXPECT_FALSE(yields) << k;
      give_way += yields ? 1 : 0;
      EXPECT_EQ(choice.barred_until(k) > traffic.time(), !yields) << k << " over " << c;
    }
    heads.expect_people(c, -1e300);
  }
  EXPECT_EQ(give_way, 8) << "who turns right or left, from each arm";
}

/// Does a driver get over the crossing of the arm to the east, with somebody on its far half?
bool gets_by(const NetworkShape& shape, const std::string& from) {
  const PedestrianCrossing& crossing = east_crossing(shape.network);
  const Point far_half{crossing.shape.front().x, 2.4};  // the lane to the east is on the other
  PlacedPeople traffic(shape.network, {{"a", 0.0, from, "C-E"}}, 0.1, shape.programs);
  traffic.people = {{.id = "p", .position = far_half, .edge = crossing.id}};
  const DrivableArea area(traffic.network());
  Coordinator coordinator(traffic, area, share(0.0));
  Simulation simulation(traffic);
  simulation.add(coordinator);
  while (traffic.running() && traffic.time() < 90.0) simulation.step();
  return traffic.arrived() == 1;
}

TEST(PeopleBesideTurns, ArePassedOnTheFarHalfOfTheirCrossing) {
  EXPECT_TRUE(gets_by(crossroads_with_people(), "S-C"));
  EXPECT_FALSE(gets_by(crossroads_with_people(), "W-C")) << "he has green in another phase";
}

/// Turning vehicles among those who go straight on, and people over all crossings all the time:
/// penetration, rounds.
class TurnsAmongPeople : public testing::TestWithParam<std::tuple<double, int>> {};

TEST_P(TurnsAmongPeople, TouchNobody) {
  const auto& [penetration, rounds] = GetParam();
  std::vector<FakeTrip> trips;
  for (int i = 0; i < rounds; ++i) {
    trips.push_back({fmt::format("right{}", i), 9.0 * i, "S-C", "C-E"});
    trips.push_back({fmt::format("we{}", i), 9.0 * i, "W-C", "C-E"});
    trips.push_back({fmt::format("ns{}", i), 9.0 * i + 3.0, "N-C", "C-S"});
  }
  ClosedLoop run(crossroads_with_people(), trips, 0.1, share(penetration));
  const LaneGraph graph(run.traffic.network());
  for (int i = 0; i < 5 * rounds; ++i) {
    run.traffic.walkers().add({.id = fmt::format("p{}", i),
                               .depart = 2.0 * i,
                               .crossing = i % graph.crossings(),
                               .forward = i % 3 == 0});
  }
  run.run_until(600.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.audit.figures().people_touched_all, 0);
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

INSTANTIATE_TEST_SUITE_P(Penetrations, TurnsAmongPeople,
                         testing::Values(std::tuple(0.0, 12), std::tuple(0.5, 6)));

}  // namespace
}  // namespace mvtp
