#include "planner/escot/pbcr.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <span>

namespace mvtp {
namespace {

/// Robots on numbered places; a motion goes to a place and may sweep over others on its way.
struct Places {
  using State = int;
  struct Motion {
    int from;
    int to;
    std::set<int> swept;  ///< `to`, and what else is driven over
    friend bool operator==(const Motion&, const Motion&) = default;
  };

  /// For each robot and place: where to, best first.
  std::map<std::pair<int, int>, std::vector<int>> wishes;
  /// Places swept beside the target by the way (from, to).
  std::map<std::pair<int, int>, std::set<int>> wide;

  [[nodiscard]] Motion go(int from, int to) const {
    Motion motion{from, to, {to}};
    if (const auto more = wide.find({from, to}); more != wide.end()) {
      motion.swept.insert(more->second.begin(), more->second.end());
    }
    return motion;
  }
  [[nodiscard]] std::vector<Motion> candidates(int i, int from) const {
    std::vector<Motion> result;
    if (const auto wish = wishes.find({i, from}); wish != wishes.end()) {
      for (const int to : wish->second) result.push_back(go(from, to));
    }
    return result;
  }
  [[nodiscard]] Motion safe_stop(int, int from) const { return go(from, from); }
  [[nodiscard]] bool conflict(int, const Motion& a, int, const Motion& b) const {
    const bool swap = a.from == b.to && b.from == a.to && a.from != a.to;
    return swap || std::ranges::any_of(a.swept, [&](int place) { return b.swept.contains(place); });
  }
};

std::vector<int> targets(const std::vector<Places::Motion>& motions) {
  std::vector<int> result;
  for (const Places::Motion& motion : motions) result.push_back(motion.to);
  return result;
}

std::vector<int> in_order(std::size_t n) {
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

//  place:  0    1    2    3
//        [0>] [1]       [<2]     0 pushes 1 to place 2, which robot 2 wants as well
TEST(Pbcr, ThePushedRobotInheritsThePriorityOfItsPusher) {
  const Places world{.wishes = {{{0, 0}, {1}}, {{1, 1}, {2}}, {{2, 3}, {2}}}, .wide = {}};
  const auto next = Pbcr{world}.step(std::vector{0, 1, 3}, std::vector{0, 2, 1});
  EXPECT_EQ(targets(next.value()), (std::vector{1, 2, 3}));
}

//  place:  0    1
//        [0>] [1] |wall
TEST(Pbcr, ARobotWaitsWhenTheOneThatBlocksItCannotYield) {
  const Places world{.wishes = {{{0, 0}, {1}}}, .wide = {}};
  const auto next = Pbcr{world}.step(std::vector{0, 1}, std::vector{0, 1});
  EXPECT_EQ(targets(next.value()), (std::vector{0, 1}));
}

//   0 -> 1 -> 2 -> 0 is a roundabout that would turn, but the path 0 -> 1 also sweeps over place 3,
//   whose robot cannot leave. Robots 1 and 2 were pushed first: 2 into the place of robot 0.
TEST(Pbcr, AWithdrawnCandidateUndoesEverythingDecidedBelowIt) {
  const Places world{.wishes = {{{0, 0}, {1}}, {{1, 1}, {2}}, {{2, 2}, {0}}},
                     .wide = {{{0, 1}, {3}}}};
  const auto next = Pbcr{world}.step(std::vector{0, 1, 2, 3}, std::vector{0, 1, 2, 3});
  EXPECT_EQ(targets(next.value()), (std::vector{0, 1, 2, 3}));
}

//   The same roundabout turns when nobody stands on place 3.
TEST(Pbcr, ACycleOfPushesTurns) {
  const Places world{.wishes = {{{0, 0}, {1}}, {{1, 1}, {2}}, {{2, 2}, {0}}},
                     .wide = {{{0, 1}, {3}}}};
  const auto next = Pbcr{world}.step(std::vector{0, 1, 2}, std::vector{0, 1, 2});
  EXPECT_EQ(targets(next.value()), (std::vector{1, 2, 0}));
}

TEST(Pbcr, AWithdrawnCandidateIsFollowedByTheNextBest) {
  const Places world{.wishes = {{{0, 0}, {1, 2}}}, .wide = {}};
  const auto next = Pbcr{world}.step(std::vector{0, 1}, std::vector{0, 1});
  EXPECT_EQ(targets(next.value()), (std::vector{2, 1}));
}

TEST(Pbcr, DecidedMotionsAreKeptAndPushTheFreeRobots) {
  const Places world{.wishes = {{{0, 0}, {1}}, {{1, 1}, {1, 2}}, {{2, 5}, {2}}}, .wide = {}};
  const auto next = Pbcr{world}.step(std::vector{0, 1, 5}, std::vector{2, 1, 0},
                                     {world.go(0, 1), std::nullopt, std::nullopt});
  EXPECT_EQ(targets(next.value()), (std::vector{1, 2, 5}));
}

TEST(Pbcr, TellsWhenNobodyCanMakeRoomForADecidedMotion) {
  const Places world{.wishes = {{{1, 1}, {0}}}, .wide = {}};
  EXPECT_FALSE(
      Pbcr{world}.step(std::vector{0, 1}, std::vector{0, 1}, {world.go(0, 1), std::nullopt}));
}

TEST(Pbcr, RobotsThatOverlapAlreadyStayAndTheOthersMoveOn) {
  const Places world{.wishes = {{{2, 5}, {6}}}, .wide = {}};
  const auto next = Pbcr{world}.step(std::vector{4, 4, 5}, std::vector{0, 1, 2});
  EXPECT_EQ(targets(next.value()), (std::vector{4, 4, 6}));
}

//   A spent allowance for backtracking makes robots brake; it never makes them collide.
TEST(Pbcr, WithoutAllowanceForBacktrackingRobotsBrake) {
  const Places world{.wishes = {{{0, 0}, {1, 2}}}, .wide = {}};
  const auto next = Pbcr{world, {.max_withdrawn = 0}}.step(std::vector{0, 1}, std::vector{0, 1});
  EXPECT_EQ(targets(next.value()), (std::vector{0, 1}));
}

/// A random world: 14 places, motions to up to four others, some of them wide; 9 robots.
struct RandomScene {
  Places world;
  std::vector<int> from;

  explicit RandomScene(unsigned seed) {
    std::mt19937_64 rng(seed);
    const auto below = [&rng](int n) { return int(rng() % std::uint64_t(n)); };
    std::vector<int> places = in_order(14);
    std::ranges::shuffle(places, rng);
    from.assign(places.begin(), places.begin() + 9);
    for (int a = 0; a < 14; ++a) {
      std::vector<int> wishes_of(4);
      for (int& wish : wishes_of) wish = (a + 1 + below(13)) % 14;
      for (const int to : wishes_of) {
        if (below(3) == 0) world.wide[{a, to}] = {below(14)};
      }
      for (int i = 0; i < 9; ++i) {
        std::ranges::shuffle(wishes_of, rng);
        world.wishes[{i, a}] = wishes_of;
      }
    }
  }
};

/// The same, but it names the first candidate beforehand and who is near whom, as a test of nothing
/// but time: both leave every decision as it is.
struct QuickPlaces : Places {
  std::vector<std::vector<int>> near_;

  [[nodiscard]] std::optional<Motion> first_choice(int i, int from) const {
    const auto all = candidates(i, from);
    return all.empty() ? std::nullopt : std::optional(all.front());
  }
  [[nodiscard]] std::span<const int> near(int i) const { return near_[std::size_t(i)]; }

  /// Those whose motions can touch, in the order of priority.
  void update_neighbours(const std::vector<int>& from) {
    near_.assign(from.size(), {});
    const auto motions = [&](int i) {
      auto all = candidates(i, from[std::size_t(i)]);
      all.push_back(safe_stop(i, from[std::size_t(i)]));
      return all;
    };
    for (int i = 0; i < int(from.size()); ++i) {
      for (int j = 0; j < int(from.size()); ++j) {
        const auto others = motions(j);
        const bool meet = std::ranges::any_of(motions(i), [&](const Motion& a) {
          return std::ranges::any_of(others, [&](const Motion& b) { return conflict(i, a, j, b); });
        });
        if (i != j && meet) near_[std::size_t(i)].push_back(j);
      }
    }
  }
};

class PbcrLaws : public testing::TestWithParam<unsigned> {};

TEST_P(PbcrLaws, EveryStepIsLegalAndLeavesEverybodyAStop) {
  RandomScene scene(GetParam());
  for (int t = 0; t < 20; ++t) {
    const auto next = Pbcr{scene.world}.step(scene.from, in_order(scene.from.size())).value();
    for (int i = 0; i < int(next.size()); ++i) {
      for (int j = 0; j < i; ++j) {
        ASSERT_FALSE(scene.world.conflict(i, next[std::size_t(i)], j, next[std::size_t(j)]));
      }
    }
    scene.from = targets(next);
  }
}

TEST_P(PbcrLaws, TheFirstRobotMovesUnlessNoneOfItsWishesCanBeCleared) {
  RandomScene scene(GetParam());
  const auto next = Pbcr{scene.world}.step(scene.from, in_order(scene.from.size())).value();
  // A wish onto a free place that sweeps over nobody can always be granted to the first robot.
  const auto free = [&](const Places::Motion& motion) {
    return std::ranges::none_of(scene.from,
                                [&](int place) { return motion.swept.contains(place); });
  };
  if (std::ranges::any_of(scene.world.candidates(0, scene.from[0]), free)) {
    EXPECT_NE(next[0].to, scene.from[0]);
  }
}

TEST_P(PbcrLaws, KnowingTheFirstChoiceAndTheNeighboursChangesNoDecision) {
  RandomScene scene(GetParam());
  QuickPlaces quick{scene.world, {}};
  static_assert(LocalWorld<QuickPlaces> && DecisiveWorld<QuickPlaces>);
  for (int t = 0; t < 20; ++t) {
    const std::vector<int> order = in_order(scene.from.size());
    quick.update_neighbours(scene.from);
    const auto next = Pbcr{scene.world}.step(scene.from, order).value();
    ASSERT_EQ(Pbcr{quick}.step(scene.from, order).value(), next);
    scene.from = targets(next);
  }
}

INSTANTIATE_TEST_SUITE_P(RandomWorlds, PbcrLaws, testing::Range(0U, 20U));

/// Cars 4 m long on one line with speed as state: a step of 1 s, then braking at 4 m/s^2.
struct Line {
  struct State {
    double x;
    double v;
  };
  struct Motion {
    State from;
    double accel;

    /// Position t seconds after the start of the step, the safe stop included.
    [[nodiscard]] double x(double t) const {
      const double v1 = from.v + accel;
      if (t <= 1.0) return from.x + from.v * t + accel * t * t / 2;
      const double braking = std::min(t - 1.0, v1 / kBrake);
      return from.x + from.v + accel / 2 + v1 * braking - kBrake * braking * braking / 2;
    }
    [[nodiscard]] State after_step() const { return {x(1.0), from.v + accel}; }
  };
  static constexpr double kBrake = 4.0;

  [[nodiscard]] std::vector<Motion> candidates(int, const State& s) const {
    std::vector<Motion> result;
    for (const double accel : {2.0, 1.0, 0.0, -1.0, -2.0}) {
      if (s.v + accel >= 0 && s.v + accel <= 15) result.push_back({s, accel});
    }
    return result;
  }
  [[nodiscard]] Motion safe_stop(int, const State& s) const { return {s, -std::min(kBrake, s.v)}; }
  [[nodiscard]] bool conflict(int, const Motion& a, int, const Motion& b) const {
    for (double t = 0; t <= 6.0; t += 0.05) {
      if (std::abs(a.x(t) - b.x(t)) < 4.0) return true;
    }
    return false;
  }
};

//   Followers of a leader that brakes for good, first in the order or last: nobody is hit.
TEST(Pbcr, KeepsEverybodyAbleToBrakeForCarsWithInertia) {
  const Line world;
  std::vector<Line::State> cars = {{60, 10}, {40, 12}, {20, 14}, {0, 9}};
  for (int t = 0; t < 15; ++t) {
    const std::vector<int> order = {3, 2, 1, 0};
    std::vector<std::optional<Line::Motion>> decided(cars.size());
    decided[0] = world.safe_stop(0, cars[0]);
    const auto next = Pbcr{world}.step(cars, order, decided).value();
    for (std::size_t i = 0; i < cars.size(); ++i) cars[i] = next[i].after_step();
    for (std::size_t i = 1; i < cars.size(); ++i) {
      ASSERT_FALSE(
          world.conflict(0, world.safe_stop(0, cars[i - 1]), 1, world.safe_stop(1, cars[i])));
    }
  }
  for (const Line::State& car : cars) EXPECT_LT(car.v, 3.0);  // they queue up behind the leader
}

}  // namespace
}  // namespace mvtp
