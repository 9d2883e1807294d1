// Whoever is not taken over, at junctions without a light.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;

/// Bicycles keep human drivers everywhere.
std::vector<FakeTrip> cars_and_bikes(unsigned seed) {
  return random_trips(crossroads_shape(),
                      {.vehicles = 20, .types = {"car", "car", "bike"}, .seed = seed});
}

/// Nobody is under control.
CoordinatorOptions all_guests() {
  CoordinatorOptions options;
  options.share = {.penetration = 0.0, .seed = 1};
  return options;
}

/// W ---- C ====== E ---- F, and a road to the south at C. At E the right lane ends.
NetworkShape with_end_of_right_lane() {
  NetworkMaker maker;
  maker.node("W", {-120, 0}, 0.0);
  maker.node("C", {0, 0});
  maker.node("E", {60, 0});
  maker.node("F", {180, 0}, 0.0);
  maker.node("S", {0, -120}, 0.0);
  maker.road("C", "W");
  maker.one_way("C", "E", 2);
  maker.one_way("E", "F");
  maker.road("C", "S");
  maker.connect("W-C_0", "C-E_0");
  maker.connect("W-C_0", "C-E_1");
  maker.connect("S-C_0", "C-W_0");
  maker.connect("S-C_0", "C-E_0");
  maker.connect("C-E_1", "E-F_0");
  return {.name = "end_of_right_lane", .network = maker.make()};
}

class Guests : public testing::TestWithParam<unsigned> {};

TEST_P(Guests, CrossAmongCarsWithoutContact) {
  ClosedLoop run(crossroads_shape(), cars_and_bikes(GetParam()));
  run.run_until(400.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

TEST_P(Guests, AloneCrossWithoutContact) {
  const NetworkShape shape = crossroads_shape();
  ClosedLoop run(shape, random_trips(shape, {.vehicles = 40, .duration = 60.0, .seed = GetParam()}),
                 0.1, all_guests());
  run.run_until(300.0);
  EXPECT_EQ(run.taken_over, 0);
  EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
  EXPECT_EQ(run.traffic.arrived(), run.number_of_trips);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Guests, testing::Values(1U, 2U, 3U, 4U));

// Nobody has planned around him before.
TEST(GuestAtItsLine, IsNewToAllPlansWhenHeIsToldToPassAndNotAfterThat) {
  std::vector<FakeTrip> trips = {{"guest", 0.0, "W-C", "C-E", "bike"}};
  for (int i = 0; i < 20; ++i) trips.push_back({fmt::format("car{}", i), 3.0 * i, "S-C", "C-N"});
  ClosedLoop run(crossroads_shape(), trips);
  std::vector<bool> is_new;
  std::int64_t looked_at = -1;
  while (run.traffic.running() && run.traffic.time() < 60.0) {
    run.step();
    const auto forecasts = run.coordinator.forecasts();
    const auto passes = std::ranges::find(forecasts, Told::kToPass, &Forecast::told);
    if (passes == forecasts.end() || passes->earliest.begin == looked_at) continue;
    looked_at = passes->earliest.begin;
    is_new.push_back(passes->is_new);
  }
  ASSERT_GE(is_new.size(), 3U);
  EXPECT_TRUE(is_new.front());
  EXPECT_EQ(std::ranges::count(is_new, true), 1);
}

/// With seeds with which it happens that vehicles under control lose their plans.
class GuestsUnderWay : public Guests {};

// Somebody without a plan may come to rest where they have to pass.
TEST_P(GuestsUnderWay, AreLetThroughOnlyWhereEverybodyHasAPlan) {
  ClosedLoop run(crossroads_shape(),
                 random_trips(crossroads_shape(), {.vehicles = 34,
                                                   .duration = 34.0,
                                                   .types = {"car", "bike", "truck"},
                                                   .seed = GetParam()}));
  int let_through = 0;
  while (run.traffic.running() && run.traffic.time() < 36.0) {
    std::set<std::string> held;
    for (const VehicleState& v : run.traffic.vehicles()) {
      if (run.traffic.is_held(v.id) && v.speed > 1.0) held.insert(v.id);
    }
    run.step();
    const auto now =
        std::ranges::count_if(held, [&](const std::string& id) { return run.traffic.passes(id); });
    let_through += int(now);
    if (now == 0) continue;
    for (const JointPlan::Entry& e : run.coordinator.plan().entries) {
      EXPECT_TRUE(e.profile->complete) << "at t = " << run.traffic.time();
    }
  }
  EXPECT_GT(let_through, 0);
  EXPECT_THAT(run.broken, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Seeds, GuestsUnderWay, testing::Values(2U, 3U));

TEST(GuestsAtTheGate, AreHeldBeforeTheLineAndNeverTakenOver) {
  ClosedLoop run(crossroads_shape(), {{"bike", 0.0, "W-C", "C-E", "bike"},
                                      {"car", 14.0, "S-C", "C-N"},
                                      {"other", 15.0, "N-C", "C-S"}});
  bool was_held = false;
  while (run.traffic.running() && run.traffic.time() < 100.0) {
    run.step();
    if (run.traffic.time() > 50.0) continue;
    EXPECT_FALSE(run.coordinator.drives("bike"));
    was_held = was_held || run.traffic.is_held("bike");
  }
  EXPECT_TRUE(was_held);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 3);
  EXPECT_EQ(run.traffic.passages().at("bike"), 1);
}

TEST(GuestsAtTheGate, FromOppositeSidesBothCross) {
  ClosedLoop run(crossroads_shape(), {{"a", 0.0, "W-C", "C-E", "bike"},
                                      {"b", 0.0, "E-C", "C-S", "bike"},
                                      {"car", 16.0, "S-C", "C-N"}});
  run.run_until(150.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 3);
}

// Nobody crosses their paths while they pass, and they do not meet: why should they slow down?
TEST(GuestsAtTheGate, DoNotBrakeWhereEverybodyCanPlanAroundThem) {
  ClosedLoop run(crossroads_shape(), {{"a", 0.0, "W-C", "C-E", "bike"},
                                      {"b", 0.0, "E-C", "C-W", "bike"},
                                      {"car", 0.0, "S-C", "C-N"},
                                      {"later", 30.0, "S-C", "C-N"}});
  double slowest = 100.0;
  while (run.traffic.arrived() < run.number_of_trips && run.traffic.time() < 100.0) {
    run.step();
    if (run.traffic.time() < 6.0) continue;
    for (const VehicleState& v : run.traffic.vehicles()) {
      if (v.type == "bike") slowest = std::min(slowest, v.speed);
    }
  }
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_GT(slowest, 5.0);
}

// A stream of cars that never ends must not keep a guest waiting for ever.
TEST(GuestsAtTheGate, DoNotWaitForEverBesideAStreamOfCars) {
  std::vector<FakeTrip> trips = {{"bike", 0.0, "S-C", "C-N", "bike"}};
  for (int i = 0; i < 60; ++i) {
    trips.push_back({fmt::format("w{}", i), 3.0 * i, "W-C", "C-E"});
    trips.push_back({fmt::format("e{}", i), 3.0 * i + 1.0, "E-C", "C-W"});
  }
  ClosedLoop run(crossroads_shape(), trips);
  while (run.traffic.time() < 120.0) run.step();
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_TRUE(run.traffic.passages().contains("bike"));
}

TEST(GuestsAtTheGate, AreThoseWhoseBodiesCannotTurnAndAreNamed) {
  ClosedLoop run(u_turn_shape(), {{"u", 0.0, "W-C", "C-W"}, {"car", 5.0, "E-C", "C-S"}});
  run.run_until(100.0);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 2);
  const std::vector<LeftToTraffic> left = run.coordinator.left_to_sumo();
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].what, "type car from lane W-C_0 to lane C-W_0");
  EXPECT_FALSE(left[0].why.empty());
}

// Until its tail is through, or its driver heeds rights of path again in the middle of the
// junction.
TEST(GuestsAtTheGate, PassUntilTheyAreThrough) {
  ClosedLoop run(crossroads_shape(), {{"bike", 0.0, "W-C", "C-E", "bike"}});
  const double length = run.traffic.type("bike").body.length();
  bool was_inside = false, was_behind = false;
  while (run.traffic.running() && run.traffic.time() < 100.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      const bool is_inside = run.traffic.network().lanes.at(v.lane).internal;
      const bool is_behind = v.lane == "C-E_0" && v.lane_position < length;
      was_inside |= is_inside;
      was_behind |= is_behind;
      if (is_inside || is_behind) {
        EXPECT_TRUE(run.traffic.passes("bike")) << "at t = " << run.traffic.time();
      }
    }
  }
  EXPECT_TRUE(was_inside && was_behind);
}

// Whoever stood between two junctions that have one control zone would stand before vehicles whose
// plans lead through both.
TEST(GuestsAtTheGate, PassTheJunctionsOfAZoneAtOnce) {
  ClosedLoop run(chain_shape(), {{"bike", 0.0, "W-A", "B-E", "bike"},
                                 {"car", 11.0, "SB-B", "B-NB"},
                                 {"other", 14.0, "NB-B", "B-SB"}});
  bool was_between = false;
  while (run.traffic.running() && run.traffic.time() < 100.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      if (v.lane != "A-B_0") continue;
      was_between = true;
      EXPECT_FALSE(run.traffic.is_held(v.id)) << "at t = " << run.traffic.time();
    }
  }
  EXPECT_TRUE(was_between);
  EXPECT_THAT(run.broken, IsEmpty());
  EXPECT_EQ(run.traffic.arrived(), 3);
}

TEST(GuestsAtTheGate, WaitUntilThereIsRoomBehindTheJunction) {
  ClosedLoop run(crossroads_shape(),
                 {{.id = "stops",
                   .depart = 0.0,
                   .from = "W-C",
                   .to = "C-E",
                   .stop = FakeStop{.lane = "C-E_0", .position = 6.0, .duration = 30.0}},
                  {"next", 10.0, "W-C", "C-E"}},
                 0.1, all_guests());
  double waits = 0.0;
  while (run.traffic.running() && run.traffic.time() < 120.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      if (v.id != "next" || v.speed > 0.1) continue;
      waits += 0.1;
      EXPECT_EQ(v.lane, "W-C_0") << "at t = " << run.traffic.time();
    }
  }
  EXPECT_GT(waits, 5.0);
  EXPECT_EQ(run.traffic.arrived(), 2);
}

// Behind the junction, too: with its tail inside it may be in a lane from which it cannot go on.
TEST(GuestsAtTheGate, ChangeLanesBehindTheJunctionWhereTheyHaveTo) {
  ClosedLoop run(with_end_of_right_lane(),
                 {{.id = "guest", .depart = 0.0, .from = "W-C", .to = "E-F", .onto = "C-E_0"}}, 0.1,
                 all_guests());
  bool was_kept = false;
  int behind = 0;  // steps
  while (run.traffic.running() && run.traffic.time() < 60.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      const bool is_kept = run.traffic.is_kept_in_lane(v.id);
      was_kept |= is_kept;
      if (v.lane != "C-E_0" || ++behind <= 5) continue;  // there is a decision in between
      EXPECT_FALSE(is_kept) << "at t = " << run.traffic.time();
    }
  }
  EXPECT_TRUE(was_kept);
  EXPECT_GT(behind, 5);
  EXPECT_EQ(run.traffic.arrived(), 1);
}

// A driver keeps behind a vehicle on his lane there, even if it turns off at the next junction.
TEST(GuestsAtTheGate, KnowWhoIsOnALaneBetweenTwoJunctions) {
  ClosedLoop run(chain_shape(), {{"car", 0.0, "W-A", "B-E"}});
  int between = 0;
  while (run.traffic.running() && run.traffic.time() < 100.0) {
    run.step();
    for (const auto& [id, driven] : run.coordinator.driven()) {
      const auto& states = run.traffic.vehicles();
      const bool is_there = !states.empty() && states.front().lane == "A-B_0" &&
                            states.front().lane_position > 2.0;  // [m]: a step further
      if (!is_there || driven.road.now.s > driven.road.stop_lines.back()) continue;
      EXPECT_FALSE(driven.road.is_on_junction()) << run.traffic.time();
      between += driven.road.now.s > driven.road.stop_lines.front() ? 1 : 0;
    }
  }
  EXPECT_GT(between, 0);
}

}  // namespace
}  // namespace mvtp
