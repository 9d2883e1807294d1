#include "coordinator/prediction/prediction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/coordinator/predictions.hpp"

namespace mvtp {
namespace {

using testing::SizeIs;

TEST(Predictor, WhoWaitsStopsBeforeItsLineAndStaysThere) {
  Prediction p(crossroads_shape());
  for (const double speed : {3.0, 8.0, 13.0}) {
    const auto forecasts = p.predict("W-C_0", 60.0, speed, {"W-C", "C-E"}, Intent::kWaits);
    ASSERT_THAT(forecasts, SizeIs(1));
    EXPECT_TRUE(forecasts[0].yields);
    EXPECT_EQ(forecasts[0].earliest.begin, 7);
    EXPECT_NEAR(p.place(forecasts[0], 7).x, -60.0, 0.1);
    const std::int64_t later = 7 + 400;
    EXPECT_EQ(forecasts[0].earliest.at(later).v, 0.0) << speed;
    EXPECT_LT(p.place(forecasts[0], later).x, -7.2);
    EXPECT_GT(p.place(forecasts[0], later).x, -14.0);
    ASSERT_TRUE(forecasts[0].held);
    EXPECT_EQ(forecasts[0].held->at(7 + 2000), forecasts[0].earliest.at(later))
        << "he is held, and leaves no sooner than he is let through";
  }
}

// He brakes at 4.5 m/s^2 instead of 3 and stands where others do, as long as that is enough; from
// even later at his line.
TEST(Predictor, WhoBrakesLateStandsAsFarBeforeHisLineAsOthers) {
  const InertialState now{50.0, 13.0};
  const auto stands_at = [&](double room) {
    const RoadVehicle v{.now = now, .cruise_speed = 13.0, .s_end = 300.0};
    return predict_leader(v, {{.s = now.s + room, .hardest = 4.5}}, {}, 0, 0.0).at(300);
  };
  for (const double room : {40.0, 29.0, 25.0, 22.0, 20.0, 19.5}) {
    EXPECT_EQ(stands_at(room).v, 0.0) << room;
    EXPECT_LT(stands_at(room).s, now.s + room - 0.95) << room;
    EXPECT_GT(stands_at(room).s, now.s + room - 2.0) << room;
  }
  EXPECT_EQ(stands_at(19.0).v, 0.0);
  EXPECT_NEAR(stands_at(19.0).s, now.s + 19.0, 0.1);
  EXPECT_GT(stands_at(17.0).s, now.s + 20.0) << "he cannot stop";
}

// SUMO's drivers do: one who was expected to slow down early is ahead of that in a moment.
TEST(Predictor, WhoIsHeldBrakesAsLateAsHeCan) {
  Prediction p(crossroads_shape());
  const double line = p.shape.network.lanes.at("W-C_0").shape.back().x;
  const double speed = 13.0;
  const auto forecasts = p.predict("W-C_0", 75.0, speed, {"W-C", "C-E"}, Intent::kWaits);
  ASSERT_THAT(forecasts, SizeIs(1));
  EXPECT_NEAR(forecasts[0].slack_before * p.grid.dt, 1.0, 1e-9) << "new plans are clear before";
  const double braking = stopping_distance(speed, p.car.max_decel);
  for (std::int64_t k = 7; k < 7 + 100; ++k) {
    const double room = line - p.place(forecasts[0], k).x;
    if (room > braking + 3.0) EXPECT_EQ(forecasts[0].earliest.at(k).v, speed) << room;
    if (room < braking - 1.0) EXPECT_LT(forecasts[0].earliest.at(k).v, speed) << room;
  }
}

// Whoever is held stops at the end of its lane, wherever that is.
TEST(Predictor, WhoHasRedStopsAtTheLineAlsoIfItsLaneEndsBefore) {
  Prediction p(seam_shape({-140, 0}, {-30, 0}, 1.5));
  const double end = p.shape.network.lanes.at("W-D_0").shape.back().x;
  const double line = p.shape.network.lanes.at("D-C_0").shape.back().x;
  const auto stands_at = [&](Intent intent) {
    const auto forecasts = p.predict("W-D_0", 70.0, 10.0, {"W-D", "D-C", "C-E"}, intent);
    EXPECT_THAT(forecasts, SizeIs(1));
    EXPECT_EQ(forecasts[0].earliest.at(7 + 400).v, 0.0);
    EXPECT_TRUE(forecasts[0].held);
    return p.place(forecasts[0], 7 + 400).x;
  };
  EXPECT_NEAR(stands_at(Intent::kWaits), end, 2.0);
  EXPECT_NEAR(stands_at(Intent::kHasRed), line, 2.0);
}

// Only the left of two lanes leads where it wants to go: until it can change over, it waits.
TEST(Predictor, WhoIsInAWrongLaneStopsAtItsEndEvenIfItMayPass) {
  Prediction p(two_lanes_shape());
  for (const Intent intent : {Intent::kPasses, Intent::kWaits}) {
    const auto forecasts = p.predict("W-C_0", 60.0, 8.0, {"W-C", "C-N"}, intent);
    ASSERT_THAT(forecasts, SizeIs(1));
    const std::int64_t later = 7 + 400;
    EXPECT_EQ(forecasts[0].earliest.at(later).v, 0.0);
    EXPECT_LT(p.place(forecasts[0], later).x, -7.2);
    EXPECT_TRUE(forecasts[0].yields);
  }
}

// Faster than he could gently stop there: whoever is behind him must not count on the road beyond.
TEST(Predictor, NobodyDrivesBeyondALaneThatDoesNotLeadOn) {
  Prediction p(two_lanes_shape());
  const double end = p.shape.network.lanes.at("W-C_0").length;
  for (const double room : {1.0, 4.0, 10.0, 20.0}) {
    const auto forecasts = p.predict("W-C_0", end - room, 13.9, {"W-C", "C-N"}, Intent::kWaits);
    ASSERT_THAT(forecasts, SizeIs(1));
    for (std::int64_t k = 7; k < 7 + 500; ++k) {
      ASSERT_LT(forecasts[0].earliest.at(k).s, SpeedProfile::kDeparted) << room;
      ASSERT_LT(p.place(forecasts[0], k).x, -12.0 + 2.0) << room;
    }
    EXPECT_EQ(forecasts[0].earliest.at(7 + 400).v, 0.0) << room;
  }
}

/// W ---- C ====(2 lanes)==== D ---- E, with roads to the south at C and D. The right lane between
/// C and D leads on to E only, the left one to the south.
NetworkShape wrong_lane_behind_shape() {
  NetworkShape shape{.name = "wrong_lane_behind"};
  NetworkMaker maker;
  maker.node("W", {-120, 0}, 0.0);
  maker.node("C", {0, 0});
  maker.node("D", {60, 0});
  maker.node("E", {180, 0}, 0.0);
  maker.node("SC", {0, -120}, 0.0);
  maker.node("SD", {60, -120}, 0.0);
  maker.road("C", "W");
  maker.one_way("C", "D", 2);
  maker.road("D", "E");
  maker.road("C", "SC");
  maker.road("D", "SD");
  maker.connect("W-C_0", "C-D_0");
  maker.connect("SC-C_0", "C-W_0");
  maker.connect("C-D_0", "D-E_0");
  maker.connect("C-D_1", "D-SD_0");
  maker.connect("SD-D_0", "D-E_0");
  shape.network = maker.make();
  return shape;
}

// It is let over the junction before, and goes. Behind it, it may have to wait for a gap.
TEST(Predictor, WhoPassesMayWaitWhereItsLaneEndsBehindTheJunction) {
  Prediction p(wrong_lane_behind_shape());
  const std::vector<std::string> route = {"W-C", "C-D", "D-SD"};
  const auto forecasts = p.predict("W-C_0", 105.0, 2.0, route, Intent::kPasses);
  ASSERT_THAT(forecasts, SizeIs(1));
  const Forecast& forecast = forecasts[0];
  EXPECT_FALSE(forecast.yields);
  EXPECT_GT(forecast.earliest.at(7 + 60).s, forecast.vehicle.now.s + 20.0) << "it goes at once";
  ASSERT_TRUE(forecast.latest);
  const InertialState later = forecast.latest->at(7 + 400);
  EXPECT_EQ(later.v, 0.0);
  const double front = p.map.library().path(forecast.vehicle.path).at(later.s).x + p.car.front;
  EXPECT_GT(front, 45.0);
  EXPECT_LT(front, 60.0 - 7.2);
}

// He comes nearer still, and it is at the line that he is held.
TEST(Predictor, WhoStandsBeforeHisLineIsNotHeldThere) {
  Prediction p(crossroads_shape());
  const auto forecasts = p.predict("W-C_0", 60.0, 0.0, {"W-C", "C-E"}, Intent::kWaits);
  ASSERT_TRUE(forecasts.at(0).held);
  EXPECT_GT(forecasts[0].held->states.back().s, forecasts[0].vehicle.now.s + 20.0);
}

TEST(Predictor, WhoMayGoIsNotHeld) {
  Prediction p(crossroads_shape());
  for (const Forecast& f : p.predict("W-C_0", 60.0, 8.0, {"W-C", "C-E"}, Intent::kPasses)) {
    EXPECT_FALSE(f.held);
  }
}

TEST(Predictor, WhoPassesGoesQuicklyOrSlowlyAndYieldsToNobody) {
  Prediction p(crossroads_shape());
  const auto forecasts = p.predict("W-C_0", 105.0, 2.0, {"W-C", "C-E"}, Intent::kPasses);
  ASSERT_THAT(forecasts, SizeIs(1));
  const Forecast& forecast = forecasts[0];
  EXPECT_FALSE(forecast.yields);
  ASSERT_TRUE(forecast.latest.has_value());
  for (const SpeedProfile* t : {&forecast.earliest, &*forecast.latest}) {
    EXPECT_GT(t->at(7 + 250).s, forecast.earliest.at(7).s + 7.2) << "it is through";
  }
  EXPECT_GT(forecast.earliest.at(60).s, forecast.latest->at(60).s + 3.0);
}

/// Crossroads whose internal lanes allow 3 m/s.
NetworkShape slow_crossroads() {
  NetworkShape shape = crossroads_shape();
  for (auto& [id, lane] : shape.network.lanes) {
    if (lane.internal) lane.speed_limit = 3.0;
  }
  return shape;
}

// As drivers do: else nobody could count on being out of a turn before them.
TEST(Predictor, WhoPassesIsNoFasterThanTheLanesOfTheJunctionAllow) {
  Prediction p(slow_crossroads());
  const auto forecasts = p.predict("W-C_0", 60.0, 13.0, {"W-C", "C-E"}, Intent::kPasses);
  ASSERT_THAT(forecasts, SizeIs(1));
  const Forecast& f = forecasts[0];
  int inside = 0;
  for (std::int64_t k = 7; k < 7 + 250; ++k) {
    const double front = p.place(f, k).x;
    if (front < -40.0) EXPECT_GT(f.earliest.at(k).v, 12.0) << "he need not brake yet";
    if (front < -7.0 || front > 7.0) continue;
    ++inside;
    EXPECT_LT(f.earliest.at(k).v, 3.2) << front;
  }
  EXPECT_GT(inside, 30);
  EXPECT_GT(f.earliest.at(7 + 150).v, 5.0) << "behind it he speeds up";
}

TEST(Predictor, TheLatestPassageIsNeverBeforeTheEarliest) {
  Prediction p(slow_crossroads());
  for (const double position : {40.0, 60.0, 80.0, 100.0, 110.0}) {
    for (const double speed : {0.0, 2.0, 8.0, 13.0, 15.0}) {
      const auto forecasts = p.predict("W-C_0", position, speed, {"W-C", "C-E"}, Intent::kPasses);
      ASSERT_THAT(forecasts, SizeIs(1));
      const Forecast& f = forecasts[0];
      ASSERT_TRUE(f.latest);
      const std::int64_t end = std::min(f.earliest.end(), f.latest->end());
      for (std::int64_t k = 7; k < end; ++k) {
        ASSERT_LE(f.latest->at(k).s, f.earliest.at(k).s + 1e-9) << position << ' ' << speed;
        ASSERT_GE(f.latest->at(k).v, 0.0);
      }
    }
  }
}

// Motorcycles start three times as fast as cars.
TEST(Predictor, WhoPassesMaySpeedUpAsItsTypeCan) {
  Prediction p(crossroads_shape());
  for (const double accel : {1.0, 2.6, 6.0}) {
    p.car.max_accel = accel;
    const auto forecasts = p.predict("W-C_0", 105.0, 2.0, {"W-C", "C-E"}, Intent::kPasses);
    ASSERT_THAT(forecasts, SizeIs(1));
    InertialState driver = forecasts[0].vehicle.now;
    for (std::int64_t k = 7; k < 17; ++k) {
      EXPECT_NEAR(forecasts[0].earliest.at(k).s, driver.s, 1e-9) << accel << " m/s^2";
      driver.v += accel * p.grid.dt;
      driver.s += driver.v * p.grid.dt;
    }
  }
}

// Bicycles of SUMO could drive at 14 m/s, but do not.
TEST(Predictor, NobodyDrivesFasterThanHeWants) {
  Prediction p(crossroads_shape());
  p.top_speed = 5.5;
  for (const Intent intent : {Intent::kPasses, Intent::kWaits}) {
    const auto forecasts = p.predict("C-E_0", 20.0, 4.0, {"C-E"}, intent);
    ASSERT_THAT(forecasts, SizeIs(1));
    EXPECT_NEAR(forecasts[0].earliest.states.back().v, 5.5, p.grid.dt);
  }
  const auto passes = p.predict("W-C_0", 100.0, 4.0, {"W-C", "C-E"}, Intent::kPasses);
  ASSERT_THAT(passes, SizeIs(1));
  EXPECT_NEAR(passes[0].earliest.states.back().v, 5.5, 1e-9);
  EXPECT_LT(passes[0].latest->states.back().v, 5.5);
}

// SUMO's drivers who start, at sigma 0.5, take three quarters of what their vehicles can on
// average.
TEST(Predictor, WhoPassesTakesHalfOfWhatItsTypeCanAtLeast) {
  Prediction p(crossroads_shape());
  for (const double accel : {0.8, 2.6}) {
    p.car.max_accel = accel;
    const auto forecasts = p.predict("W-C_0", 110.0, 0.0, {"W-C", "C-E"}, Intent::kPasses);
    ASSERT_THAT(forecasts, SizeIs(1));
    const InertialState start = forecasts[0].vehicle.now;
    for (const double t : {1.0, 2.0, 3.0}) {
      const InertialState latest = forecasts[0].latest->at(7 + std::lround(t / p.grid.dt));
      EXPECT_NEAR(latest.v, 0.5 * accel * t, 1e-9) << accel << " m/s^2";
      EXPECT_LT(latest.s, start.s + 0.5 * 0.75 * accel * t * t);
    }
  }
}

// However far its next line is.
TEST(Predictor, WhoIsInsideAJunctionIsPredictedThere) {
  Prediction p(chain_shape(7.2, 250.0));
  const LaneGraph& graph = p.walk.graph;
  for (const int k : graph.links_from(graph.find_lane("W-A_0"))) {
    if (graph.link(k).to != graph.find_lane("A-B_0")) continue;
    const std::string& inside = graph.lane(graph.link(k).via.front()).id;
    for (const Intent intent : {Intent::kWaits, Intent::kPasses}) {
      EXPECT_THAT(p.predict(inside, 2.0, 4.0, {"W-A", "A-B", "B-E"}, intent), SizeIs(1));
    }
    return;
  }
  FAIL() << "no path over A";
}

TEST(Predictor, NoForecastIsFasterThanTheBodyCan) {
  Prediction p(crossroads_shape());
  p.car.max_accel = 0.8;
  for (const Intent intent : {Intent::kWaits, Intent::kPasses}) {
    for (const Forecast& f : p.predict("W-C_0", 105.0, 2.0, {"W-C", "C-E"}, intent)) {
      const auto& states = f.earliest.states;
      for (std::size_t i = 1; i < states.size(); ++i) {
        ASSERT_LE(states[i].v - states[i - 1].v, std::max(0.8, 1.0) * p.grid.dt + 1e-9);
      }
    }
  }
}

TEST(Predictor, WhoStandsAtAStopStandsThereAsLongAsItTakes) {
  Prediction p(crossroads_shape());
  const auto forecasts =
      p.predict("W-C_0", 80.0, 0.0, {"W-C", "C-E"}, Intent::kWaits, {.scheduled = 20.0});
  ASSERT_THAT(forecasts, SizeIs(1));
  for (std::int64_t k = 7; k < 7 + 199; ++k) ASSERT_EQ(forecasts[0].earliest.at(k).v, 0.0);
  EXPECT_GT(forecasts[0].earliest.at(7 + 220).v, 0.0);
}

TEST(Predictor, WhoHasStoodForLongIsExpectedToStandAsLongAgain) {
  Prediction p(crossroads_shape());
  const auto stands = [&](double so_far) {
    const auto forecasts =
        p.predict("C-E_0", 20.0, 0.0, {"C-E"}, Intent::kWaits, {.so_far = so_far});
    const auto& states = forecasts.at(0).earliest.states;
    const auto goes =
        std::ranges::find_if(states, [](const InertialState& x) { return x.v > 0.0; });
    return double(goes - states.begin()) * p.grid.dt;
  };
  EXPECT_NEAR(stands(0.0), stands(2.0), 1e-9);
  for (const double so_far : {5.0, 17.5, 40.0}) EXPECT_NEAR(stands(so_far), so_far, 0.3) << so_far;
  EXPECT_NEAR(stands(1000.0), stands(100.0), 1e-9);
}

TEST(Predictor, WhoStopsBehindSomebodyAcrossItsLaneGoesNoFurther) {
  Prediction p(crossroads_shape());
  const double start = p.shape.network.lanes.at("W-C_0").shape.front().x;
  for (const double behind : {60.0, 70.0}) {
    const auto forecasts =
        p.predict("W-C_0", 60.0, 0.0, {"W-C", "C-E"}, Intent::kWaits, {.behind = behind});
    ASSERT_THAT(forecasts, SizeIs(1));
    const double most = p.place(forecasts[0], 7 + 400).x - start;
    EXPECT_LE(most, behind + 0.01);
    EXPECT_GE(most, behind - 1.5);
  }
}

TEST(Predictor, NobodyIsExpectedToDriveThroughAQueue) {
  Prediction p(crossroads_shape());
  const double tail = 40.0;
  p.predictor.see(HaltedQueues({{p.walk.graph.find_lane("C-E_0"), tail + 4.5, tail, 15.0}}));
  const auto& lanes = p.shape.network.lanes;
  const double exit = lanes.at("C-E_0").shape.front().x;
  const auto check = [&](const SpeedProfile& t, const Forecast& f) {
    const auto front = [&](std::int64_t k) {
      return p.place({.vehicle = f.vehicle, .earliest = t}, k).x - exit;
    };
    for (std::int64_t k = 7; k < 7 + 145; ++k) ASSERT_LT(front(k), tail) << k;
    EXPECT_GT(front(7 + 145), tail - 4.0);
    EXPECT_GT(front(7 + 220), tail);
  };
  const auto behind = p.predict("C-E_0", 10.0, 8.0, {"C-E"}, Intent::kWaits);
  check(behind.at(0).earliest, behind[0]);
  const auto passes = p.predict("W-C_0", 110.0, 8.0, {"W-C", "C-E"}, Intent::kPasses);
  check(*passes.at(0).latest, passes[0]);
}

// The queue goes on, but the line behind it is still a line.
TEST(Predictor, WhoStoodInAQueueStopsAtHisLineToo) {
  Prediction p(crossroads_shape());
  const int lane = p.walk.graph.find_lane("W-C_0");
  p.predictor.see(HaltedQueues({{lane, 100.0, 95.5, 10.0}}));
  const auto forecasts = p.predict("W-C_0", 60.0, 8.0, {"W-C", "C-E"}, Intent::kWaits);
  const double line = p.shape.network.lanes.at("W-C_0").length;
  const double begin = p.shape.network.lanes.at("W-C_0").shape.front().x;
  for (std::int64_t k = 7; k < 7 + 600; ++k) {
    ASSERT_LT(p.place(forecasts.at(0), k).x - begin, line) << k;
  }
  EXPECT_GT(p.place(forecasts[0], 7 + 600).x - begin, 100.0);
}

TEST(HaltedQueues, NobodyGoesOnBeforeTheOneAhead) {
  const HaltedQueues queues(
      {{1, 50.0, 45.5, 4.0}, {1, 57.0, 52.5, 30.0}, {1, 20.0, 15.5, 5.0}, {2, 3.0, -1.5, 9.0}});
  EXPECT_EQ(queues.first_ahead(1, 30.0)->stands, 30.0);
  EXPECT_EQ(queues.first_ahead(1, 30.0)->tail, 45.5);
  EXPECT_EQ(queues.first_ahead(1, 0.0)->stands, 5.0);  // too far behind to be in that queue
  EXPECT_EQ(queues.first_ahead(1, 52.6), nullptr);
  EXPECT_EQ(queues.first_ahead(3, 0.0), nullptr);
  EXPECT_EQ(queues.first_ahead(2, 0.0), nullptr);
  EXPECT_EQ(queues.first_ahead(2, -2.0)->stands, 9.0);
}

TEST(Predictor, WatchesTheLanesAroundCoordinatedJunctions) {
  Prediction p(crossroads_shape());
  for (int l = 0; l < p.walk.graph.lanes(); ++l) EXPECT_TRUE(p.predictor.watches(l));
  // Those from which vehicles are taken over are among them, however short the last lane is.
  const Prediction near(seam_shape());
  EXPECT_TRUE(near.predictor.watches(near.walk.graph.find_lane("D-C_0")));
  EXPECT_TRUE(near.predictor.watches(near.walk.graph.find_lane("W-D_0")));
  const Prediction far(seam_shape({-260, 0}, {-200, 0}));
  EXPECT_TRUE(far.predictor.watches(far.walk.graph.find_lane("D-C_0")));
  EXPECT_FALSE(far.predictor.watches(far.walk.graph.find_lane("W-D_0")));
}

// One at 13.9 m/s who brakes at 4.5 m/s^2 at most needs 21.5 m, and 20.8 m in SUMO's steps.
TEST(Predictor, WhoWaitsBrakesAsHardAsHeHasToBeforeHisLine) {
  Prediction p(crossroads_shape());
  const double line = p.shape.network.lanes.at("W-C_0").length;
  const auto stands = [&](double before) {
    const auto forecasts = p.predict("W-C_0", line - before, 13.9, {"W-C", "C-E"}, Intent::kWaits);
    const Forecast& f = forecasts.front();
    return f.earliest.at(7 + 100).s < f.vehicle.now.s + before + 0.1;
  };
  EXPECT_TRUE(stands(40.0));
  EXPECT_TRUE(stands(25.0));
  EXPECT_TRUE(stands(21.2));
  EXPECT_FALSE(stands(20.5));
}

// What rolls on by a rounding error would never be found to wait.
TEST(Predictor, WhoHasAllButStoppedBeforeHisLineIsHeldThere) {
  Prediction p(crossroads_shape());
  const double line = p.shape.network.lanes.at("W-C_0").length;
  for (const double speed : {0.0, 1e-12, 1e-9, 1e-3}) {
    for (double before = 0.5; before < 1.5; before += 0.002) {
      const auto forecasts =
          p.predict("W-C_0", line - before, speed, {"W-C", "C-E"}, Intent::kWaits);
      ASSERT_THAT(forecasts, SizeIs(1));
      EXPECT_TRUE(forecasts[0].held) << speed << ", " << before;
    }
  }
}

// Plans stop a hair's breadth before a driver's path: another one of the same lanes may be in them.
TEST(Predictor, WhoPassesStaysOnThePathThatHeWasExpectedOn) {
  Prediction p(crossroads_shape());
  const auto path_at = [&](const std::string& lane, double position) {
    const auto forecasts =
        p.predict(lane, position, 8.0, {"W-C", "C-E"}, Intent::kPasses, {}, "C-E_0");
    EXPECT_THAT(forecasts, SizeIs(1));
    return forecasts.at(0).vehicle.path;
  };
  const int path = path_at("W-C_0", 80.0);
  EXPECT_EQ(path_at("W-C_0", 90.0), path);
  const LaneGraph& graph = p.walk.graph;
  for (int k = 0; k < graph.links(); ++k) {
    const LaneGraph::Link& link = graph.link(k);
    const bool is_his = graph.lane(link.from).id == "W-C_0" && graph.lane(link.to).id == "C-E_0";
    if (is_his) {
      EXPECT_EQ(path_at(graph.lane(link.via.front()).id, 1.0), path);
    }
  }
  EXPECT_NE(p.predict("W-C_0", 90.0, 8.0, {"W-C", "C-S"}, Intent::kPasses)[0].vehicle.path, path)
      << "he turns elsewhere";
}

TEST(Predictor, WhereSeveralLanesLeadOnADriverGoesOntoHis) {
  Prediction p(fan_out_shape());
  const auto behind = [&](const std::string& next_lane) {
    const auto forecasts =
        p.predict("W-C_0", 60.0, 12.0, {"W-C", "C-E"}, Intent::kPasses, {}, next_lane);
    EXPECT_THAT(forecasts, SizeIs(1));
    return p.place(forecasts.at(0), 7 + 150).y;
  };
  for (const std::string lane : {"C-E_0", "C-E_1"}) {
    EXPECT_NEAR(behind(lane), p.shape.network.lanes.at(lane).shape.back().y, 0.1) << lane;
  }
}

// 3.5 m behind on the lane beside: whoever begins a change of lanes at its takeover must see it.
TEST(Predictor, SeesWhoComesAlongsideThoseTakenOver) {
  Prediction p(two_lanes_shape());
  const double takeover = p.shape.network.lanes.at("W-C_1").length - CorridorOptions{}.takeover;
  EXPECT_THAT(p.predict("W-C_1", takeover + 1.0, 13.9, {"W-C", "C-N"}, Intent::kWaits), SizeIs(1));
  EXPECT_THAT(p.predict("W-C_1", takeover - 3.5, 13.9, {"W-C", "C-N"}, Intent::kWaits), SizeIs(1));
}

// A lane's length need not be that of its ground: at the end of his route a driver is expected
// until he is there.
TEST(Predictor, ExpectsDriversUntilTheirRouteEndsOnLanesOfAnyLength) {
  for (const double share : {0.8, 1.0, 1.25}) {
    NetworkShape shape = crossroads_shape();
    Lane& last = shape.network.lanes.at("C-E_0");
    last.length *= share;
    const Point end = last.shape.back();
    Prediction p(shape);
    for (const double left : {40.0, 20.0, 6.0, 2.0}) {
      const auto forecasts = p.predict("C-E_0", last.length - left, 5.0, {"C-E"}, Intent::kWaits);
      ASSERT_THAT(forecasts, SizeIs(1)) << share << ": " << left;
      EXPECT_GE(p.place(forecasts[0], 7 + 200).x, end.x - 1.0) << share << ": " << left;
    }
  }
}

}  // namespace
}  // namespace mvtp
