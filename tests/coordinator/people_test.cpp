#include "coordinator/people/people.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "coordinator/network/partition.hpp"
#include "planner/problem/draws.hpp"
#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

using testing::Combine;
using testing::IsEmpty;
using testing::Range;
using testing::Values;

NetworkShape under_lights() { return with_crossings(with_signals(crossroads_shape())); }
NetworkShape with_zebras() { return with_crossings(crossroads_shape()); }

CoordinatorOptions share(double penetration) {
  CoordinatorOptions options;
  options.share = {.penetration = penetration, .seed = 1};
  return options;
}

/// People at random moments over all crossings; some only pass by.
void send_people(ClosedLoop& run, int people, double duration, unsigned seed) {
  const LaneGraph graph(run.traffic.network());
  Draws draws(seed);
  for (int i = 0; i < people; ++i) {
    run.traffic.walkers().add({.id = fmt::format("p{:02}", i),
                               .depart = duration * draws.share(),
                               .crossing = draws.between(0, graph.crossings() - 1),
                               .forward = draws.share() < 0.5,
                               .aside = 3.0 * draws.share() - 1.5,
                               .speed = 1.0 + 0.6 * draws.share(),
                               .turns = draws.share() < 0.2,
                               .takes_any = i % 3 == 0});
  }
}

/// Penetration, seed.
using Mix = std::tuple<double, unsigned>;
class PeopleAmongVehicles : public testing::TestWithParam<Mix> {};

TEST_P(PeopleAmongVehicles, NobodyIsTouchedAndEverybodyArrives) {
  const auto& [penetration, seed] = GetParam();
  const NetworkShape shape = under_lights();
  ClosedLoop run(shape, random_trips(shape, {.duration = 80.0, .seed = seed}), 0.1,
                 share(penetration));
  send_people(run, 20, 80.0, seed);
  run.run_until(600.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.audit.figures().people_touched_all, 0);
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
  EXPECT_TRUE(run.traffic.walkers().all_arrived());
}

std::string name_of(const testing::TestParamInfo<Mix>& info) {
  return fmt::format("p{}_seed_{}", int(100 * std::get<0>(info.param)), std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Seeds, PeopleAmongVehicles, Combine(Values(0.0, 0.5, 1.0), Range(1U, 5U)),
                         name_of);

TEST(People, OneAloneHardlyWaits) {
  ClosedLoop run(under_lights(), {}, 0.1, share(1.0));
  run.traffic.walkers().add({.id = "p", .crossing = 2});
  run.run_until(60.0);
  EXPECT_TRUE(run.traffic.walkers().all_arrived());
  EXPECT_LT(run.traffic.walkers().longest_wait(), 1.0);
  EXPECT_EQ(run.coordinator.people()->greens(), 1);
}

TEST(People, WhoOnlyPassesByGetsNoGreen) {
  ClosedLoop run(under_lights(), {}, 0.1, share(1.0));
  run.traffic.walkers().add({.id = "p", .crossing = 2, .turns = true});
  run.run_until(60.0);
  EXPECT_TRUE(run.traffic.walkers().all_arrived());
  EXPECT_EQ(run.coordinator.people()->greens(), 0);
}

TEST(People, DoNotWaitForEverBesideAStreamOfVehicles) {
  std::vector<FakeTrip> trips;
  for (int i = 0; i < 60; ++i) {
    trips.push_back({fmt::format("w{}", i), 2.5 * i, "W-C", "C-E"});
    trips.push_back({fmt::format("e{}", i), 2.5 * i + 1.2, "E-C", "C-W"});
  }
  for (const double penetration : {1.0, 0.5}) {
    ClosedLoop run(under_lights(), trips, 0.1, share(penetration));
    const LaneGraph graph(run.traffic.network());
    for (int c = 0; c < graph.crossings(); ++c) {
      run.traffic.walkers().add({.id = fmt::format("p{}", c), .depart = 20.0, .crossing = c});
    }
    run.run_until(110.0);
    EXPECT_THAT(run.broken, IsEmpty());
    EXPECT_EQ(run.audit.figures().people_touched_all, 0);
    EXPECT_TRUE(run.traffic.walkers().all_arrived()) << penetration;
  }
}

/// When the only car arrives [s], with or without somebody who comes to a zebra before it.
double arrival(bool with_person) {
  ClosedLoop run(with_zebras(), {{"a", 4.0, "W-C", "C-E"}}, 0.1, share(1.0));
  if (with_person) {
    for (int c = 0; c < 4; ++c) {
      run.traffic.walkers().add(
          {.id = fmt::format("p{}", c), .depart = 0.0, .crossing = c, .speed = 1.4});
    }
  }
  while (run.traffic.arrived() == 0 && run.traffic.time() < 100.0) run.step();
  EXPECT_EQ(run.audit.figures().people_touched_all, 0);
  return run.traffic.time();
}

TEST(People, HaveRightOfWayOnAZebra) { EXPECT_GT(arrival(true), arrival(false) + 1.0); }

/// Notes what lights show.
class WatchedTraffic : public FakeTraffic {
 public:
  WatchedTraffic(const NetworkShape& shape, std::vector<FakeTrip> trips)
      : FakeTraffic(shape.network, std::move(trips)) {}
  void show(const std::string& signal, int index, Light light) override {
    FakeTraffic::show(signal, index, light);
    if (lights[index] != light) since[index] = time();
    lights[index] = light;
  }
  std::map<int, Light> lights;
  std::map<int, double> since;
};

TEST(People, NobodyHasGreenAcrossTheirs) {
  const NetworkShape shape = under_lights();
  WatchedTraffic traffic(shape, random_trips(shape, {.duration = 60.0, .seed = 5}));
  const DrivableArea area(traffic.network());
  Coordinator coordinator(traffic, area, share(0.3));
  Simulation simulation(traffic);
  simulation.add(coordinator);
  const LaneGraph graph(traffic.network());
  for (int c = 0; c < graph.crossings(); ++c) {
    traffic.walkers().add({.id = fmt::format("p{}", c), .depart = 15.0 * c, .crossing = c});
  }
  const SignalHeads heads(traffic, graph, select_junctions(graph, {}, 50.0), SignalTiming::real());
  int crossed = 0;
  while (traffic.running() && traffic.time() < 400.0) {
    std::map<int, bool> was_occupied;
    for (const Pedestrian& p : traffic.pedestrians()) {
      for (int c = 0; c < graph.crossings(); ++c) {
        if (p.edge == graph.crossing(c).crossing->id) was_occupied[c] = true;
      }
    }
    simulation.step();
    for (int c = 0; c < graph.crossings(); ++c) {
      const Light theirs = traffic.lights[graph.crossing(c).crossing->lights.front()];
      for (int k = 0; k < graph.links(); ++k) {
        if (!heads.cross(k, heads.light_of_crossing(c))) continue;
        ++crossed;
        const int index = graph.link(k).signal_index;
        const bool green = traffic.lights[index] != Light::kRed;
        EXPECT_FALSE(green && theirs == Light::kGreen) << traffic.time();
        if (!green || traffic.since[index] != traffic.time() || traffic.time() < 10.0) continue;
        EXPECT_FALSE(was_occupied[c]) << "somebody is on it as it turns green";
        const double red = traffic.time() - traffic.since[graph.crossing(c).crossing->lights[0]];
        EXPECT_GE(red, SignalTiming::real().all_red - 1e-6);
      }
    }
  }
  EXPECT_GT(crossed, 0);
  EXPECT_FALSE(traffic.running());
}

}  // namespace
}  // namespace mvtp
