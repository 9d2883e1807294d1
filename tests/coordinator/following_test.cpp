#include "coordinator/prediction/following.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

//           .--4--->   Path 4 comes from the south and turns into path 0, on which others come from
//   0 -----/------->   the west.
//          |
class Following : public Crossing {
 protected:
  Following() {
    const std::vector<Point> turn = {{0, -60}, {0, -12}, {3, -4}, {10, -0.5}, {16, 0}, {100, 0}};
    library.add(ReferencePath(smooth(resample(turn, 0.25), 3.0)), kCar);
  }

  /// A driver who passes, at any speed between two.
  Forecast passing(int path, double s, double fast, double slow) {
    Forecast f{.vehicle = add(path, s, fast), .earliest = {}, .yields = false};
    scene.vehicles.pop_back();
    f.vehicle.key = -1;
    f.earliest = steady(s, fast);
    f.latest = steady(s, slow);
    return f;
  }
  static SpeedProfile steady(double s, double v) {
    SpeedProfile t{.states = {}};
    while (s < 190.0) {
      t.states.push_back({s, v});
      s += 0.1 * v;
    }
    return t;
  }
  /// As early as he may be, until half a second after the leader, as late as that may be, is in his
  /// lane; then he brakes to its speed.
  SpeedProfile brakes_once_it_is_ahead(const Forecast& driver, const Forecast& leader) {
    SpeedProfile t{.states = {driver.vehicle.now}};
    std::int64_t seen = -1;
    while (t.states.size() < 100) {
      const InertialState now = t.states.back();
      const std::int64_t k = t.end() - 1;
      const InertialState there = leader.latest->at(k);
      const Pose pose = library.path(leader.vehicle.path).at(there.s);
      const bool is_ahead = pose.x + 100.0 > now.s && std::abs(pose.y) < 0.3;
      if (seen < 0 && is_ahead) seen = k;
      const bool brakes = seen >= 0 && k >= seen + 5 && now.v > there.v;
      t.states.push_back(advance(now, brakes ? std::max(-4.5, (there.v - now.v) / 0.1) : 0.0, 0.1));
    }
    return t;
  }
  std::vector<Forecast> followed(std::vector<Forecast> forecasts) {
    follow_leaders(forecasts, scene);
    return forecasts;
  }
  /// In the first ten seconds.
  bool soon_touch(const RoadVehicle& a, SpeedProfile of_a, const RoadVehicle& b,
                  SpeedProfile of_b) {
    for (SpeedProfile* t : {&of_a, &of_b}) {
      t->states.resize(std::min<std::size_t>(t->states.size(), 100));
    }
    return ever_touch(a, of_a, b, of_b);
  }
  bool latest_touch(const Forecast& a, const Forecast& b) {
    return soon_touch(a.vehicle, *a.latest, b.vehicle, *b.latest);
  }
};

// He brakes for who turns into his lane before him, harder than he would by himself.
TEST_F(Following, WhoComesFromBehindStaysBehindWhoTurnsIn) {
  const Forecast leader = passing(4, 52.0, 7.0, 4.0);
  for (const double behind : {20.0, 25.0, 30.0, 40.0}) {
    const Forecast driver = passing(0, 100.0 - behind, 13.0, 11.0);
    ASSERT_TRUE(latest_touch(leader, driver)) << "there is something to show";
    const auto after = followed({driver, leader});
    EXPECT_FALSE(latest_touch(after[0], after[1])) << behind;
    EXPECT_EQ(after[0].earliest.states, driver.earliest.states);
    EXPECT_EQ(after[1].latest->states, leader.latest->states) << "who is ahead waits for nobody";
  }
}

TEST_F(Following, NobodyIsExpectedSoonerBecauseOfOthersAndEverybodyArrives) {
  for (double place = 40.0; place < 75.0; place += 2.5) {
    const Forecast leader = passing(4, place, 7.0, 4.0);
    const Forecast driver = passing(0, 75.0, 13.0, 9.0);
    const auto after = followed({driver, leader});
    const auto& before = driver.latest->states;
    const auto& states = after[0].latest->states;
    EXPECT_EQ(states.back(), before.back());
    for (std::size_t k = 0; k < before.size(); ++k) ASSERT_LE(states[k].s, before[k].s + 1e-9);
    EXPECT_TRUE(std::ranges::is_sorted(states, {}, &InertialState::s));
  }
}

// What those do who wait for others is not known well enough to stop anybody.
TEST_F(Following, OnlyThosePassingCount) {
  Forecast waits = passing(4, 56.0, 4.0, 4.0);
  waits.yields = true;
  waits.latest.reset();
  const Forecast driver = passing(0, 70.0, 13.0, 11.0);
  EXPECT_EQ(followed({driver, waits})[0].latest->states, driver.latest->states);
  EXPECT_FALSE(followed({driver, waits})[1].latest);
}

TEST_F(Following, WhoCrossesOrDrivesElsewhereDelaysNobodyThatIsPast) {
  const Forecast past = passing(0, 112.0, 8.0, 4.0);
  const Forecast elsewhere = passing(3, 130.0, 8.0, 4.0);
  const Forecast driver = passing(1, 60.0, 13.0, 11.0);
  const auto after = followed({past, elsewhere, driver});
  EXPECT_EQ(after[2].latest->states, driver.latest->states);
}

// A driver who looks at nobody but those ahead in his lane.
TEST_F(Following, WhoMergesBehindTouchesNobody) {
  int behind = 0, not_behind = 0;
  for (double leader_s = 50.0; leader_s < 130.0; leader_s += 5.0) {
    for (double s = 30.0; s < 100.0; s += 5.0) {
      const Forecast leader = passing(4, leader_s, 7.0, 4.0);
      const Forecast driver = passing(0, s, 13.0, 11.0);
      if (library.contacts(0, 4).touches(s, leader_s)) continue;
      if (!merges_behind(driver, leader, library, 0.1)) {
        ++not_behind;
        continue;
      }
      ++behind;
      EXPECT_FALSE(merges_behind(leader, driver, library, 0.1)) << leader_s << ", " << s;
      const SpeedProfile braked = brakes_once_it_is_ahead(driver, leader);
      EXPECT_FALSE(soon_touch(leader.vehicle, *leader.latest, driver.vehicle, braked))
          << leader_s << ", " << s;
    }
  }
  EXPECT_GT(behind, 30);
  EXPECT_GT(not_behind, 30);
}

// Path 5 leaves path 0 to one side, and comes back across it.
TEST_F(Following, NobodyFollowsOneWhomHeMeetsAgainBehindAFork) {
  std::vector<Point> points;
  for (double x = -100.0; x <= 100.0; x += 0.5) {
    const double aside = std::abs(x) < 25.0 ? std::cos(x * std::numbers::pi / 50.0) : 0.0;
    points.push_back({x, 8.0 * aside * aside});
  }
  library.add(ReferencePath(points), kCar);
  const Forecast driver = passing(0, 20.0, 13.0, 11.0);
  EXPECT_FALSE(merges_behind(driver, passing(5, 60.0, 7.0, 4.0), library, 0.1));
  EXPECT_TRUE(merges_behind(driver, passing(2, 60.0, 7.0, 4.0), library, 0.1));
  EXPECT_FALSE(follows(driver, {5, 60.0}, library));
  EXPECT_TRUE(follows(driver, {2, 60.0}, library));
}

TEST_F(Following, WhoIsBehindOrBesideOrTurnsInIsNotFollowed) {
  const Forecast driver = passing(0, 80.0, 13.0, 11.0);
  EXPECT_FALSE(follows(driver, {2, 70.0}, library)) << "behind";
  EXPECT_FALSE(follows(driver, {3, 95.0}, library)) << "in another lane";
  EXPECT_FALSE(follows(driver, {1, 100.0}, library)) << "across";
  EXPECT_FALSE(follows(driver, {4, 56.0}, library)) << "turns in";
  EXPECT_TRUE(follows(driver, {4, 90.0}, library)) << "has turned in";
}

//   Held at 80 m of path 2, which is path 0 again: it may move up by 5 m.
TEST_F(Following, NobodyDrivesThroughWhoIsHeld) {
  const auto last_of = [&](int path, double s, const HeldVehicle& held) {
    Forecast driver = passing(path, s, 13.0, 11.0);
    stay_behind(driver, std::array{held}, library);
    EXPECT_GE(driver.earliest.at(1000).s, driver.latest->at(1000).s);
    return driver.latest->at(1000).s;
  };
  const double stands = last_of(0, 20.0, {{2, 80.0}, 85.0});
  EXPECT_LT(stands, 85.0 - kCar.length());
  EXPECT_GT(stands, 85.0 - kCar.length() - 2.5);
  EXPECT_EQ(last_of(0, 20.0, {{2, 10.0}, 15.0}), SpeedProfile::kDeparted) << "is behind";
  EXPECT_EQ(last_of(0, 20.0, {{1, 97.0}, 97.0}), SpeedProfile::kDeparted) << "comes from the side";
  EXPECT_EQ(last_of(0, 20.0, {{3, 80.0}, 85.0}), SpeedProfile::kDeparted) << "in another lane";
}

}  // namespace
}  // namespace mvtp
