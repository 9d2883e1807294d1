#include "coordinator/prediction/tube.hpp"

#include <gtest/gtest.h>

#include "planner/road/profile_planner.hpp"
#include "tests/coordinator/fake_traffic.hpp"
#include "tests/coordinator/walk.hpp"

namespace mvtp {
namespace {

constexpr double kLimit = 13.9;

/// A driver on 300 m of straight road, his line at 100 m.
TubeDriver driver(double s, double v) {
  TubeDriver d;
  d.road.now = {s, v};
  d.road.s_end = 300.0;
  d.limits.assign(std::size_t(300.0 / ReferencePath::kSpacing) + 1, kLimit);
  d.line = 100.0;
  return d;
}

Tube predict(const TubeDriver& d, const std::vector<TubeLeader>& leaders = {}) {
  return predict_tube(d, leaders, DecisionGrid{}, 7);
}

TEST(Tube, TheLatestMotionIsNowhereAheadOfTheEarliest) {
  for (const double v : {0.0, 5.0, 13.9}) {
    const Tube t = predict(driver(70.0, v));
    EXPECT_EQ(t.earliest.begin, 7);
    EXPECT_EQ(t.latest.states.front().s, 70.0);
    EXPECT_GE(t.latest.states.back().s, 300.0);
    for (std::int64_t k = 7; k < t.latest.end(); ++k) {
      EXPECT_LE(t.latest.at(k).s, t.earliest.at(k).s + 1e-9) << v << " at " << k;
    }
  }
}

// Each step as fast as at its end, as SUMO's drivers do.
TEST(BrakingGap, IsWhatTheStepsOfADriverAddUpTo) {
  for (const double dt : {0.05, 0.1, 0.2, 0.25}) {
    for (double v = 0.0; v < 20.0; v += 0.37) {
      double gap = 0.0;
      for (double left = v - 4.5 * dt; left > 0.0; left -= 4.5 * dt) gap += left * dt;
      EXPECT_NEAR(braking_gap(v, 4.5, dt), gap, 1e-9) << v << " " << dt;
    }
  }
}

TEST(Tube, HoldsADriverWhoTakesHisTimeAndOneWhoHurries) {
  const Tube t = predict(driver(99.0, 0.0));
  const auto hurries = [](double seconds) { return 99.0 + 0.5 * 2.6 * seconds * seconds; };
  EXPECT_GE(t.earliest.at(7 + 30).s, hurries(3.0) - 1e-6);
  // Dawdling by half as SUMO does (sigma 0.5), he has 3/4 of his acceleration on average.
  EXPECT_LE(t.latest.at(7 + 30).s, 99.0 + 0.75 * (hurries(3.0) - 99.0));
}

TEST(Tube, SlowsDownForALowerLimit) {
  TubeDriver d = driver(50.0, kLimit);
  for (std::size_t i = std::size_t(100.0 / ReferencePath::kSpacing); i < d.limits.size(); ++i) {
    d.limits[i] = 6.5;
  }
  const Tube t = predict(d);
  for (std::int64_t k = 7; k < t.earliest.end(); ++k) {
    if (t.earliest.at(k).s <= 102.0) continue;
    EXPECT_LT(t.earliest.at(k).v, 6.7);
  }
}

// Where those wait inside who yield, SUMO's drivers could stop until they are 4.5 m before it, and
// do not have to.
TEST(Tube, MayComeSlowlyToAPlaceWhereOthersWait) {
  constexpr double kPlace = 120.0;
  TubeDriver d = driver(70.0, kLimit);
  const Tube freely = predict(d);
  d.waiting_places = {kPlace, 1e6, 0.0};  // the others are off his path
  const Tube t = predict(d);
  EXPECT_EQ(t.earliest.states, freely.earliest.states);
  for (std::int64_t k = 7; k < t.latest.end(); ++k) {
    const InertialState at = t.latest.at(k);
    if (at.s > kPlace - 5.0 && at.s < kPlace - 4.5) {
      EXPECT_LE(at.v, std::sqrt(2.0 * d.max_decel * 5.0)) << at.s;
    }
  }
  EXPECT_GE(t.latest.states.back().s, 300.0);
  EXPECT_GT(t.latest.end(), freely.latest.end());
}

TEST(Tube, NobodyDrivesThroughHisLeader) {
  SpeedProfile stands{.begin = 7, .states = {{0.0, 0.0}}, .complete = false};
  const Tube t = predict(driver(70.0, 10.0),
                         {{.gap = 20.0, .speed = 0.0, .earliest = &stands, .latest = &stands}});
  EXPECT_LE(t.earliest.states.back().s, 90.0);
  EXPECT_LE(t.latest.states.back().s, 90.0);
}

TEST(Tube, AFollowerStartsAfterHisLeader) {
  const Tube leader = predict(driver(99.0, 0.0));
  const Tube t =
      predict(driver(92.0, 0.0),
              {{.gap = 2.5, .speed = 0.0, .earliest = &leader.earliest, .latest = &leader.latest}});
  const Tube alone = predict(driver(92.0, 0.0));
  EXPECT_LT(t.latest.at(7 + 30).s, alone.latest.at(7 + 30).s - 1.0);
  EXPECT_LT(t.earliest.at(7 + 30).s, alone.earliest.at(7 + 30).s + 1e-9);
}

/// Two drivers whose paths cross at 100 m, where both have their lines just before.
class TwoTubes : public testing::Test {
 protected:
  TwoTubes() {
    for (const auto& [from, to] :
         {std::pair(Point{-100, 0}, Point{200, 0}), std::pair(Point{0, -100}, Point{0, 200})}) {
      const std::vector<Point> line = {from, to};
      library.add(ReferencePath(line), fake_type("car").body);
    }
  }
  [[nodiscard]] bool meet(const Tube& a, const Tube& b, double end = 300.0) const {
    return may_meet(library.contacts(0, 1), a, end, b, end, 7);
  }
  PathLibrary library{Margins{}};
};

TEST_F(TwoTubes, MeetWhereBothMayBeAtTheCrossing) {
  EXPECT_TRUE(meet(predict(driver(70.0, 10.0)), predict(driver(70.0, 10.0))));
  EXPECT_FALSE(meet(predict(driver(110.0, 10.0)), predict(driver(70.0, 10.0))));
  // One drives at 10 m/s; the other one starts: whether he is there before it depends on him.
  EXPECT_TRUE(meet(predict(driver(50.0, 10.0)), predict(driver(92.0, 0.0))));
}

TEST_F(TwoTubes, DoNotMeetBehindTheirEnds) {
  EXPECT_FALSE(meet(predict(driver(70.0, 10.0)), predict(driver(70.0, 10.0)), 80.0));
}

/// One under control on the first path, and a driver who has green on the second.
class OursAndATube : public TwoTubes {
 protected:
  OursAndATube() {
    scene.library = &library;
    scene.step = 7;
    RoadVehicle ours{.key = 0, .path = 0, .now = {40.0, 10.0}};
    ours.envelope = std::make_shared<SpeedEnvelope>(std::vector<double>(1201, kLimit), 3.5);
    ours.exit_lane = 0;
    ours.s_exit_lane = 110.0;
    ours.s_handback = 250.0;
    ours.s_end = 270.0;
    scene.vehicles.push_back(ours);
    let_come(60.0);
  }
  void let_come(double s) {
    Tube tube = predict(driver(s, 10.0));
    Forecast human{.vehicle = driver(s, 10.0).road,
                   .earliest = std::move(tube.earliest),
                   .latest = std::move(tube.latest),
                   .yields = false};
    human.vehicle.key = -1;
    human.vehicle.path = 1;
    scene.forecasts = {human};
  }
  [[nodiscard]] std::optional<SpeedProfile> plan() const {
    return plan_vehicle(RoadPairs(scene), scene.vehicles.front(), {}, {});
  }
  [[nodiscard]] bool fits(const SpeedProfile& t) const {
    return still_fits(RoadPairs(scene), scene.vehicles.front(), t, {}, {});
  }
  RoadScene scene;
};

TEST_F(OursAndATube, NewPlansKeepSlackAndOldOnesNeedNot) {
  const auto tight = plan();
  ASSERT_TRUE(tight.has_value());
  EXPECT_TRUE(fits(*tight));
  scene.forecasts.front().slack_before = 10;
  scene.forecasts.front().slack_behind = 10;
  const auto careful = plan();
  ASSERT_TRUE(careful.has_value());
  EXPECT_GT(careful->end(), tight->end());
  EXPECT_TRUE(fits(*tight));
}

TEST_F(OursAndATube, BesideSomebodyNewOldPlansKeepSlackToo) {
  const auto tight = plan();
  scene.forecasts.front().slack_before = 10;
  scene.forecasts.front().slack_behind = 10;
  scene.forecasts.front().is_new = true;
  const auto careful = plan();
  ASSERT_TRUE(tight.has_value() && careful.has_value());
  EXPECT_FALSE(fits(*tight));
  EXPECT_TRUE(fits(*careful));
}

TEST_F(OursAndATube, BrakingBeforeADriverWhoReliesOnHisGreenIsNotSafe) {
  // It comes to rest within the decision, right on the crossing, where he is by then.
  scene.vehicles.front().now = {98.0, 2.0};
  let_come(91.0);
  const SpeedProfile stop = stop_after(scene, scene.vehicles.front().now, -4.5, 4.5);
  EXPECT_TRUE(fits(stop));
  scene.forecasts.front().relies = true;
  EXPECT_FALSE(fits(stop));
}

}  // namespace
}  // namespace mvtp
