#include "coordinator/prediction/following.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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
  std::vector<Forecast> followed(std::vector<Forecast> forecasts) {
    follow_leaders(forecasts, scene);
    return forecasts;
  }
  /// In the first ten seconds.
  bool latest_touch(const Forecast& a, const Forecast& b) {
    const auto soon = [](const Forecast& f) {
      SpeedProfile t = *f.latest;
      t.states.resize(std::min<std::size_t>(t.states.size(), 100));
      return t;
    };
    return ever_touch(a.vehicle, soon(a), b.vehicle, soon(b));
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

}  // namespace
}  // namespace mvtp
