#include "planner/road/contact_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>

#include "planner/motion/inertial_car.hpp"
#include "planner/problem/draws.hpp"
#include "planner/road/path_library.hpp"

namespace mvtp {
namespace {

const Vehicle kCar = {.front = 3.6, .rear = 0.9, .width = 1.8, .min_turning_radius = 3.86};
const Vehicle kBus = {.front = 9.0, .rear = 3.0, .width = 2.5, .min_turning_radius = 8.0};

ReferencePath straight(Point from, Point to) { return ReferencePath(std::vector<Point>{from, to}); }

/// Straight on, a bend of any angle, and straight on again.
ReferencePath bent(Pose at, double straight_length, double turn, double radius) {
  std::vector<Point> points;
  Pose p = at;
  for (double s = 0.0; s < straight_length; s += 0.5, p = drive(p, 0.5, 0.0)) {
    points.push_back({p.x, p.y});
  }
  const double curvature = std::copysign(1.0 / radius, turn);
  for (double s = 0.0; s < std::abs(turn) * radius; s += 0.1, p = drive(p, 0.1, curvature)) {
    points.push_back({p.x, p.y});
  }
  for (double s = 0.0; s < straight_length; s += 0.5, p = drive(p, 0.5, 0.0)) {
    points.push_back({p.x, p.y});
  }
  return ReferencePath(points);
}

/// A path that runs by the origin, from anywhere to anywhere.
ReferencePath any_path(Draws& draws) {
  const double heading = draws.share() * 6.28;
  const double aside = draws.share() * 8.0 - 4.0;
  const Pose start = compose(Pose{0, 0, heading}, Pose{-35, aside, 0});
  const double turn = draws.between(0, 2) == 0 ? 0.01 : draws.share() * 3.2 - 1.6;
  return bent(start, 30.0, turn, 5.0 + draws.share() * 15.0);
}

/// The motion of a car that changes its acceleration now and then, in looks 0.1 s apart.
struct Drive {
  std::vector<InertialState> looks;
  std::vector<double> accelerations;

  Drive(Draws& draws, double s, double v) : looks({{s, v}}) {
    double a = 0.0;
    for (int i = 0; i < 60; ++i) {
      if (i % 5 == 0) a = draws.share() * 7.1 - 4.5;
      accelerations.push_back(a);
      looks.push_back(advance(looks.back(), a, 0.1));
    }
  }
  [[nodiscard]] double position(int millisecond) const {
    const auto look = std::size_t(millisecond / 100);
    return advance(looks[look], accelerations[look], (millisecond % 100) * 0.001).s;
  }
};

bool bodies_touch(const ReferencePath& a, const Vehicle& body_a, double s_a, const ReferencePath& b,
                  const Vehicle& body_b, double s_b) {
  return separation(footprint(body_a, a.at(s_a)), footprint(body_b, b.at(s_b))) < 0.0;
}

TEST(ContactTable, HoldsWhatACheckOfAllPairsOfSamplesFinds) {
  Draws draws(1);
  for (int round = 0; round < 12; ++round) {
    const ReferencePath on_a = any_path(draws);
    const ReferencePath on_b = any_path(draws);
    const SweptPath a(on_a, round % 3 == 0 ? kBus : kCar, Margins{});
    const SweptPath b(on_b, kCar, Margins{});
    const ContactTable table(a, b);
    const double slack = std::max(0.0, (a.stride() + b.stride()) / 2.0 + 0.07 - 0.4);
    for (std::size_t i = 0; i < a.samples(); ++i) {
      for (std::size_t j = 0; j < b.samples(); ++j) {
        const double gap = separation(a.box(i), b.box(j)) - slack;
        if (std::abs(gap) < 1e-6) continue;
        ASSERT_EQ(table.touches(double(i) * 0.25, double(j) * 0.25), gap <= 0.0)
            << "round " << round << ", samples " << i << " and " << j;
      }
    }
  }
}

TEST(ContactTable, TransposedSaysTheSameWithTheRolesExchanged) {
  Draws draws(2);
  for (int round = 0; round < 20; ++round) {
    const ReferencePath on_a = any_path(draws);
    const ReferencePath on_b = any_path(draws);
    const SweptPath a(on_a, kCar, Margins{});
    const SweptPath b(on_b, kBus, Margins{});
    const ContactTable ab(a, b);
    const ContactTable ba = ab.transposed();
    for (double s_a = 0.05; s_a < 90.0; s_a += 0.25) {
      for (double s_b = 0.05; s_b < 90.0; s_b += 0.25) {
        ASSERT_EQ(ab.touches(s_a, s_b), ba.touches(s_b, s_a)) << s_a << ", " << s_b;
      }
    }
  }
}

//            .--B--.
//   A ------+-------+------>      Seen from behind the fork, and for C, they never meet again.
//            `--C
TEST(ContactTable, PathsThatPartMayMeetAgain) {
  const ReferencePath on = straight({-50, 0}, {50, 0});
  std::vector<Point> points;
  for (double x = -50.0; x <= 50.0; x += 0.5) {
    const double aside = std::abs(x) < 25.0 ? std::cos(x * std::numbers::pi / 50.0) : 0.0;
    points.push_back({x, 8.0 * aside * aside});
  }
  const ReferencePath around(points);
  const ReferencePath off = bent({-50, 0, 0}, 40.0, -1.0, 12.0);
  const auto meet_again = [&](const ReferencePath& a, const ReferencePath& b, double from) {
    return ContactTable(a, kCar, b, kCar, Margins{}).parts_and_meets_again(from, 0.0);
  };
  EXPECT_TRUE(meet_again(on, around, 0.0));
  EXPECT_TRUE(meet_again(around, on, 0.0));
  EXPECT_FALSE(meet_again(on, around, 50.0));
  EXPECT_FALSE(meet_again(on, on, 0.0));
  EXPECT_FALSE(meet_again(on, off, 0.0));
  EXPECT_FALSE(meet_again(off, on, 0.0));
}

//   Bumper to bumper, 0.6 m of margins between them, and half a sample of rounding on both paths.
TEST(ContactTable, FirstMeetsWhoStandsOrDrivesAhead) {
  const ReferencePath path = straight({-50, 0}, {50, 0});
  const ContactTable table(path, kCar, path, kCar, Margins{});
  const double apart = kCar.length() + Margins{}.along;
  EXPECT_NEAR(table.first_met(0.0, 50.0, 50.0), 50.0 - apart, 2.0 * ReferencePath::kSpacing);
  EXPECT_NEAR(table.first_met(0.0, 40.0, 60.0), 40.0 - apart, 2.0 * ReferencePath::kSpacing);
  EXPECT_NEAR(table.first_met(48.0, 50.0, 50.0), 48.0, ReferencePath::kSpacing);
  EXPECT_EQ(table.first_met(60.0, 50.0, 50.0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(ContactTable().first_met(0.0, 0.0, 90.0), std::numeric_limits<double>::infinity());
}

//   A comes round to where B has been before.
TEST(ContactTable, WhereTheOtherOneHasBeenTheyDoNotMeetAgain) {
  std::vector<Point> points;
  for (double x = -40.0; x < 0.0; x += 0.5) points.push_back({x, 0.0});
  for (double a = 0.0; a < 2.0 * std::numbers::pi; a += 0.03) {
    points.push_back({15.0 * std::sin(a), 15.0 - 15.0 * std::cos(a)});
  }
  const ReferencePath round(points);
  const ReferencePath on = straight({-40, 0}, {60, 0});
  const ContactTable table(round, kCar, on, kCar, Margins{});
  EXPECT_TRUE(table.parts_and_meets_again(0.0, 0.0));
  EXPECT_TRUE(table.parts_and_meets_again(30.0, 30.0));
  EXPECT_FALSE(table.parts_and_meets_again(30.0, 60.0));
}

// At 40 m/s each is 4 m further at the next look: at both looks they are apart.
TEST(ContactTable, SeesCarsThatMeetBetweenTwoLooks) {
  const ReferencePath east = straight({-50, 0}, {50, 0});
  const ReferencePath north = straight({0, -50}, {0, 50});
  const Vehicle tiny = {.front = 0.4, .rear = 0.4, .width = 0.5};
  const ContactTable table(east, tiny, north, tiny, Margins{});
  EXPECT_FALSE(table.touches(48.0, 48.0));
  EXPECT_FALSE(table.touches(52.0, 52.0));
  EXPECT_TRUE(table.sweeps(48.0, 52.0, 48.0, 52.0));
  EXPECT_FALSE(table.sweeps(48.0, 52.0, 44.0, 48.0));  // one after the other
}

TEST(ContactTable, WhoStandsIsMetByWhoeverDrivesPast) {
  const ReferencePath east = straight({-50, 0}, {50, 0});
  const ReferencePath north = straight({0, -50}, {0, 50});
  const ContactTable table(east, kCar, north, kCar, Margins{});
  EXPECT_TRUE(table.sweeps(49.0, 49.0, 0.0, 90.0));
  EXPECT_TRUE(table.sweeps(0.0, 90.0, 49.0, 49.0));
  EXPECT_FALSE(table.sweeps(40.0, 40.0, 0.0, 90.0));
}

// Safety between the looks: where no look and no sweep from one to the next finds a contact, the
// true bodies are apart at every millisecond.
TEST(ContactTable, WhatItClearsIsClearAtEveryMillisecond) {
  Draws draws(3);
  int cleared = 0;
  int near_misses = 0;  // cleared, but close to each other
  for (int round = 0; round < 1500; ++round) {
    const ReferencePath a = any_path(draws);
    const ReferencePath b =
        draws.between(0, 3) == 0 ? a : any_path(draws);  // following, or crossing
    const Vehicle& body_a = draws.between(0, 4) == 0 ? kBus : kCar;
    const ContactTable table(a, body_a, b, kCar, Margins{});
    const double v_a = draws.share() * 40.0;
    const double v_b = draws.between(0, 1) == 0 ? v_a : draws.share() * 40.0;
    const Drive drive_a(draws, draws.share() * 30.0, v_a);
    const Drive drive_b(draws, draws.share() * 30.0, v_b);
    bool meet = false;
    for (std::size_t i = 0; i < 60 && !meet; ++i) {
      meet = table.sweeps(drive_a.looks[i].s, drive_a.looks[i + 1].s, drive_b.looks[i].s,
                          drive_b.looks[i + 1].s);
    }
    if (meet) continue;
    ++cleared;
    double least = 1e9;
    for (int ms = 0; ms < 6000; ++ms) {
      const double s_a = drive_a.position(ms);
      const double s_b = drive_b.position(ms);
      if (s_a > a.length() || s_b > b.length()) break;
      least = std::min(least, separation(footprint(body_a, a.at(s_a)), footprint(kCar, b.at(s_b))));
      ASSERT_FALSE(bodies_touch(a, body_a, s_a, b, kCar, s_b))
          << "round " << round << " at " << ms << " ms";
    }
    near_misses += least < 1.0 ? 1 : 0;
  }
  EXPECT_GT(cleared, 300);
  EXPECT_GT(near_misses, 30);
}

/// From sample to sample a body may leap over what it would touch on its way.
TEST(ContactTable, HoldsWhatTouchesBetweenSamplesFarApart) {
  const Vehicle small = {.front = 0.3, .rear = 0.3, .width = 0.6, .min_turning_radius = 1.0};
  Draws draws(5);
  int touches = 0;
  for (int round = 0; round < 200; ++round) {
    const Pose start{-40.0, draws.share() * 20.0 - 10.0, draws.share() - 0.5};
    std::vector<Pose> poses;
    for (int i = 0; i <= 40; ++i) poses.push_back(drive(start, 2.0 * i, 0.0));
    const ReferencePath a(std::move(poses));
    const ReferencePath b = any_path(draws);
    const ContactTable table(a, small, b, small, Margins{.along = 0.0, .across = 0.0});
    for (int k = 0; k < 5000; ++k) {
      const double s_a = draws.share() * a.length();
      const double s_b = draws.share() * b.length();
      if (!bodies_touch(a, small, s_a, b, small, s_b)) continue;
      ASSERT_TRUE(table.sweeps(s_a, s_a, s_b, s_b)) << round << ": " << s_a << ", " << s_b;
      ++touches;
    }
  }
  EXPECT_GT(touches, 50);
}

TEST(ContactTable, BoundsNeverMissAContact) {
  Draws draws(4);
  for (int round = 0; round < 50; ++round) {
    const ContactTable table(any_path(draws), kCar, any_path(draws), kCar, Margins{});
    for (int k = 0; k < 2000; ++k) {
      const double a = draws.share() * 80.0;
      const double b = draws.share() * 80.0;
      const double a_end = a + draws.share() * 10.0;
      const double b_end = b + draws.share() * 10.0;
      if (table.sweeps(a, a_end, b, b_end) || table.blocks(a, b, b_end)) {
        ASSERT_TRUE(table.reaches(a, a_end, b, b_end));
      }
    }
  }
}

class PathLibraryTest : public testing::Test {
 protected:
  PathLibraryTest() {
    library.add(straight({-100, 0}, {100, 0}), kCar);
    library.add(straight({0, -100}, {0, 100}), kCar);
    library.add(straight({-100, 500}, {100, 500}), kCar);  // far from all others
    library.add(bent({-60, 0, 0}, 55.0, 1.57, 8.0), kCar);
  }
  PathLibrary library{Margins{}};
};

TEST_F(PathLibraryTest, MakesTablesOnlyForPathsThatComeNearEachOther) {
  library.build_tables(std::vector{0, 1, 2, 3});
  EXPECT_EQ(library.tables(), 10U);  // 0, 1 and 3 with each other, 2 with itself
  EXPECT_TRUE(library.contacts(0, 2).empty());
  EXPECT_EQ(&library.contacts(0, 2), &library.contacts(2, 1));
  EXPECT_EQ(library.tables(), 10U);
}

TEST_F(PathLibraryTest, WhatIsNotPreparedIsBuiltAtItsFirstUse) {
  PathLibrary prepared{Margins{}};
  for (int p = 0; p < library.size(); ++p) prepared.add(library.path(p), library.body(p));
  prepared.build_tables(std::vector{3, 0});
  EXPECT_EQ(prepared.tables(), 4U);
  for (const auto& [a, b] : {std::pair(0, 3), std::pair(3, 0), std::pair(3, 3)}) {
    for (double s_a = 0.0; s_a < 130.0; s_a += 0.5) {
      for (double s_b = 0.0; s_b < 130.0; s_b += 0.5) {
        ASSERT_EQ(prepared.contacts(a, b).touches(s_a, s_b),
                  library.contacts(a, b).touches(s_a, s_b));
      }
    }
  }
}

TEST_F(PathLibraryTest, MakesNoTablesForForecastsAmongThemselves) {
  library.build_tables(std::vector{3}, std::vector{0, 1});
  EXPECT_EQ(library.tables(), 5U);  // 3 with itself, and with 0 and 1 both ways
}

TEST_F(PathLibraryTest, BodiesThatMoveOtherwiseShareTheirContacts) {
  Vehicle weak = kCar;
  weak.max_accel *= 0.5;
  const int like = library.add_like(3, weak);
  EXPECT_EQ(library.body(like).max_accel, weak.max_accel);
  EXPECT_EQ(library.body(3).max_accel, kCar.max_accel);
  EXPECT_EQ(&library.path(like), &library.path(3));
  library.build_tables(std::vector{0, 3, like});
  EXPECT_EQ(library.tables(), 4U);
  EXPECT_EQ(&library.contacts(like, 0), &library.contacts(3, 0));
  EXPECT_EQ(&library.contacts(0, like), &library.contacts(0, 3));
}

TEST_F(PathLibraryTest, WhatIsRemovedTakesItsTablesWithIt) {
  library.build_tables(std::vector{0, 1, 3});
  EXPECT_EQ(library.tables(), 9U);
  const ContactTable& kept = library.contacts(0, 1);
  library.remove(std::vector{3});
  EXPECT_FALSE(library.holds(3));
  EXPECT_EQ(library.tables(), 4U);
  EXPECT_EQ(&library.contacts(0, 1), &kept);
  const int again = library.add(bent({-60, 0, 0}, 55.0, 1.57, 8.0), kCar);
  EXPECT_EQ(again, 4) << "another path never has the same number";
  library.build_tables(std::vector{0, 1, again});
  EXPECT_EQ(library.tables(), 9U);
  EXPECT_FALSE(library.contacts(0, again).empty());
}

TEST_F(PathLibraryTest, APathStaysAsLongAsOneOfThoseThatShareIt) {
  const int like = library.add_like(3, kCar);
  library.remove(std::vector{3});
  EXPECT_TRUE(library.holds(like));
  library.build_tables(std::vector{0, like});
  EXPECT_FALSE(library.contacts(0, like).empty());
  const int another = library.add_like(3, kCar);
  library.remove(std::vector{like});
  EXPECT_TRUE(library.holds(another));
  library.remove(std::vector{another});
  EXPECT_FALSE(library.holds(3));
}

TEST_F(PathLibraryTest, ManyThreadsMayAskForTheSameTables) {
  std::vector<const ContactTable*> seen(8);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < seen.size(); ++t) {
    threads.emplace_back([&, t] { seen[t] = &library.contacts(int(t % 2), 3); });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t t = 2; t < seen.size(); ++t) EXPECT_EQ(seen[t], seen[t - 2]);
}

TEST_F(PathLibraryTest, ReferencesStayValidWhenPathsAreAdded) {
  library.build_tables(std::vector{0, 1});
  const ContactTable& table = library.contacts(0, 1);
  for (int i = 0; i < 100; ++i) library.add(straight({0, double(i)}, {50, double(i)}), kCar);
  library.build_tables(std::vector{0, 1, 50, 51});
  EXPECT_EQ(&table, &library.contacts(0, 1));
}

}  // namespace
}  // namespace mvtp
