#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "coordinator/measures/driving_style.hpp"
#include "coordinator/measures/surrogate_safety.hpp"
#include "coordinator/report/report.hpp"

namespace mvtp {
namespace {

using nlohmann::json;

constexpr double kNorth = 1.5707963267948966;

/// A car of 4 x 2 m whose rear axle is 1 m before its tail.
VehicleType car() {
  VehicleType type{.id = "car"};
  type.body.front = 3.0;
  type.body.rear = 1.0;
  type.body.width = 2.0;
  return type;
}

OrientedBox box_at(double x, double y, double theta = 0.0) {
  return footprint(car().body, {x - std::cos(theta), y - std::sin(theta), theta});
}

TEST(TimeToCollision, IsThatOfKnownMeetings) {
  const Point stands{0, 0};
  EXPECT_NEAR(time_to_collision(box_at(0, 0), {10, 0}, box_at(20, 0), stands).value(), 1.6, 1e-9);
  EXPECT_NEAR(time_to_collision(box_at(0, 0), {10, 0}, box_at(20, 0), {-10, 0}).value(), 0.8, 1e-9);
  // Across: the long side of one is reached after 20 - 2 - 1 m.
  EXPECT_NEAR(time_to_collision(box_at(0, 0), {10, 0}, box_at(20, 0, kNorth), stands).value(), 1.7,
              1e-9);
  EXPECT_EQ(time_to_collision(box_at(0, 0), {10, 0}, box_at(1, 0), stands), 0.0);
  EXPECT_FALSE(time_to_collision(box_at(0, 0), {10, 0}, box_at(20, 2.1), stands));
  EXPECT_TRUE(time_to_collision(box_at(0, 0), {10, 0}, box_at(20, 1.9), stands));
  EXPECT_FALSE(time_to_collision(box_at(0, 0), {5, 0}, box_at(20, 0), {10, 0}));  // drives away
  EXPECT_FALSE(time_to_collision(box_at(0, 0), {10, 0}, box_at(20, -30, kNorth), {0, 30 / 0.5}));
}

TEST(TimeToCollision, IsTheSameForBoth) {
  for (int i = 0; i < 40; ++i) {
    const OrientedBox a = box_at(0, 0, 0.3 * i);
    const OrientedBox b = box_at(15 * std::cos(i), 15 * std::sin(i), 0.7 * i);
    const Point va{-3 * std::sin(2.0 * i), 5 * std::cos(i)};
    const Point vb{-8 * std::cos(i), -8 * std::sin(i)};
    const auto ab = time_to_collision(a, va, b, vb);
    const auto ba = time_to_collision(b, vb, a, va);
    ASSERT_EQ(ab.has_value(), ba.has_value()) << i;
    if (!ab) continue;
    EXPECT_NEAR(*ab, *ba, 1e-9);
    // They touch then, and not before.
    const auto moved = [](OrientedBox box, const Point& v, double t) {
      box.x += v.x * t;
      box.y += v.y * t;
      return box;
    };
    EXPECT_NEAR(separation(moved(a, va, *ab), moved(b, vb, *ab)), 0.0, 1e-6) << i;
    EXPECT_GT(separation(moved(a, va, *ab - 0.01), moved(b, vb, *ab - 0.01)), 0.0) << i;
  }
}

/// Vehicles put where they are wanted, a step of 0.1 s after another.
class Scene {
 public:
  void put(const std::string& id, double x, double y, double theta, double speed) {
    states_.push_back({.id = id, .type = "car", .pose = {x, y, theta}, .speed = speed});
  }
  template <class Observer>
  void step(Observer observe) {
    std::ranges::sort(states_, {}, &VehicleState::id);
    std::vector<Observation> observations;
    for (const VehicleState& s : states_) observations.push_back({&s, &type_, false});
    const std::vector<char> resting(states_.size(), 0);
    observe(time_, std::span<const Observation>(observations), std::span<const char>(resting));
    time_ += 0.1;
    states_.clear();
  }

 private:
  VehicleType type_ = car();
  std::vector<VehicleState> states_;
  double time_ = 0.0;
};

RoadNetwork square_junction() {
  RoadNetwork network;
  network.junctions["J"] = {.id = "J",
                            .type = "priority",
                            .shape = {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}},
                            .has_conflicts = true};
  return network;
}

/// One drives east at 10 m/s; another north or east, so that its front comes to the middle of the
/// junction `gap` seconds after the tail of the first has left it.
ConflictFigures pet_of(double gap, double theta) {
  const RoadNetwork network = square_junction();
  SurrogateSafety safety(network, 0.1);
  Scene scene;
  for (int k = 0; k < 120; ++k) {
    const double t = 0.1 * k;
    const double first = -20.0 + 10.0 * t;                 // its tail is at `first` - 1
    const double second = -20.0 - 4.0 + 10.0 * (t - gap);  // its front is at `second` + 3
    scene.put("a", first, 0.0, 0.0, 10.0);
    scene.put("b", second * std::cos(theta), second * std::sin(theta), theta, 10.0);
    scene.step([&](double time, auto vehicles, auto) { safety.observe(time, vehicles); });
  }
  return safety.post_encroachment();
}

TEST(PostEncroachment, IsTheTimeBetweenTailAndFront) {
  // Both bodies are 2 m wide: at the far corner the first leaves 0.1 s later than in the middle,
  // and the other is there 0.1 s earlier. Cells are half a metre, and steps 0.1 s.
  for (const double gap : {0.8, 1.5, 3.0}) {
    const ConflictFigures pet = pet_of(gap, kNorth);
    EXPECT_EQ(pet.pairs, 1);
    EXPECT_NEAR(pet.least, gap - 0.15, 0.11) << gap;
    EXPECT_EQ(pet.below_1s, gap < 1.0 ? 1 : 0) << gap;
    EXPECT_EQ(pet.counts[std::size_t(pet.least / ConflictFigures::kBin)], 1) << gap;
  }
}

//   While two come nearer their time is another one at each look; the shortest counts.
TEST(TimeToCollisionOfARun, EachPairIsInItsDistributionOnce) {
  const RoadNetwork network = square_junction();
  SurrogateSafety safety(network, 0.1);
  Scene scene;
  for (int k = 0; k < 20; ++k) {
    scene.put("a", k, 100.0, 0.0, 10.0);    // its front is at k + 3
    scene.put("b", 41.0, 100.0, 0.0, 0.0);  // its tail is at 40
    scene.step([&](double time, auto vehicles, auto) { safety.observe(time, vehicles); });
  }
  const ConflictFigures& ttc = safety.to_collision();
  EXPECT_GT(ttc.least, 1.5);
  EXPECT_EQ(ttc.counts[std::size_t(ttc.least / ConflictFigures::kBin)], 1);
  EXPECT_EQ(std::accumulate(ttc.counts.begin(), ttc.counts.end(), std::int64_t{0}), ttc.pairs);
}

TEST(PostEncroachment, WhoFollowsOrComesLateIsNoEncounter) {
  EXPECT_EQ(pet_of(1.5, 0.0).pairs, 0);
  EXPECT_EQ(pet_of(5.5, kNorth).pairs, 0);
  EXPECT_TRUE(std::isinf(pet_of(5.5, kNorth).least));
}

TEST(TimeToCollisionOfARun, CountsPairsOnce) {
  const RoadNetwork network = square_junction();
  SurrogateSafety safety(network, 0.1);
  Scene scene;
  for (int k = 0; k < 30; ++k) {
    scene.put("a", 0.0, 100.0, 0.0, 10.0);
    scene.put("b", 11.0, 100.0, 0.0, 0.0);   // 7 m ahead: 0.7 s
    scene.put("c", 60.0, 100.0, 0.0, 10.0);  // drives away from both
    scene.step([&](double time, auto vehicles, auto) { safety.observe(time, vehicles); });
  }
  EXPECT_NEAR(safety.to_collision().least, 0.7, 1e-9);
  EXPECT_EQ(safety.to_collision().below_1s, 1);
  EXPECT_EQ(safety.to_collision().pairs, 1);
}

DrivingFigures style_of(const std::vector<double>& speeds) {
  DrivingStyle style;
  Scene scene;
  for (const double speed : speeds) {
    scene.put("a", 0, 0, 0, speed);
    scene.step(
        [&](double time, auto vehicles, auto resting) { style.observe(time, vehicles, resting); });
  }
  return style.figures().at("a");
}

TEST(DrivingStyle, AnEvenAccelerationHasNoJerk) {
  std::vector<double> speeds;
  for (int k = 0; k < 60; ++k) speeds.push_back(0.2 * k);
  EXPECT_NEAR(style_of(speeds).jerk, 0.0, 1e-6);
  EXPECT_EQ(style_of(speeds).stops, 0);  // it began at rest
}

TEST(DrivingStyle, JerkIsTheChangeOfAcceleration) {
  // a = 2 t: the mean accelerations of two half seconds differ by 1 m/s^2.
  std::vector<double> speeds;
  for (int k = 0; k < 50; ++k) speeds.push_back(0.01 * k * k);
  EXPECT_NEAR(style_of(speeds).jerk, 2.0, 1e-6);
}

TEST(DrivingStyle, CreepingForwardInAQueueIsOneStop) {
  std::vector<double> speeds(20, 10.0);
  speeds.insert(speeds.end(), 30, 0.0);
  speeds.insert(speeds.end(), 10, 0.8);
  speeds.insert(speeds.end(), 50, 0.0);
  EXPECT_EQ(style_of(speeds).stops, 1);
  EXPECT_NEAR(style_of(speeds).standing, 4.9, 1e-6);
  speeds.insert(speeds.end(), 10, 5.0);
  speeds.insert(speeds.end(), 10, 0.0);
  EXPECT_EQ(style_of(speeds).stops, 2);
}

TEST(Measures, AreWhatTheVehiclesSay) {
  RunReport report;
  report.end = 121.0;
  report.vehicles = {{.id = "a",
                      .type = "car",
                      .departure = 0.0,
                      .arrival = 30.0,
                      .free_flow = 20.0,
                      .movement = "W>E",
                      .driving = {.stops = 2, .jerk = 1.0, .standing = 7.0},
                      .emissions = Emissions{.fuel = 40.0, .co2 = 100.0, .nox = 0.2}},
                     {.id = "b",
                      .type = "bus",
                      .departure = 0.0,
                      .arrival = 65.0,
                      .free_flow = 25.0,
                      .movement = "W>N",
                      .driving = {.stops = 0, .jerk = 3.0, .standing = 0.0},
                      .emissions = Emissions{.fuel = 60.0, .co2 = 200.0, .nox = 0.4}},
                     {.id = "c", .type = "bus"}};  // never departed: 121 s
  const json j = json::parse(summary_json(report));
  EXPECT_NEAR(j["emissions"]["fuel_ml"], 50.0, 1e-9);
  EXPECT_NEAR(j["emissions"]["co2_g"], 150.0, 1e-9);
  EXPECT_NEAR(j["emissions"]["nox_g"], 0.3, 1e-9);
  EXPECT_EQ(j["stops_per_vehicle"], 1.0);
  EXPECT_EQ(j["jerk_m_s3"]["mean"], 2.0);
  EXPECT_EQ(j["fairness"]["longest_wait_s"], 7.0);
  EXPECT_NEAR(j["fairness"]["p95_over_mean"], (40.0 + 0.9 * 81.0) / 57.0, 1e-9);
  EXPECT_EQ(j["delay_by_type_s"]["bus"]["vehicles"], 1);  // of those that departed
  EXPECT_EQ(j["delay_by_movement_s"]["W>N"]["mean"], 40.0);
  EXPECT_EQ(j["arrivals_per_minute"], json({1, 1, 0}));
  EXPECT_TRUE(j["pet_s"]["min"].is_null());
}

TEST(Measures, GroupsAreOfTheirOwnVehicles) {
  // Delays 10, 20 and 60 s; one whose emissions nobody knows, and one that never departed.
  const auto vehicle = [](const char* id, const char* type, double arrival, DrivingFigures driving,
                          std::optional<Emissions> emissions) {
    return VehicleRecord{.id = id,
                         .type = type,
                         .departure = 0.0,
                         .arrival = arrival,
                         .free_flow = 20.0,
                         .movement = "W>E",
                         .driving = driving,
                         .emissions = emissions};
  };
  RunReport report;
  report.end = 200.0;
  report.vehicles = {
      vehicle("a", "car", 30.0, {.stops = 1, .standing = 4.0}, Emissions{.co2 = 100.0}),
      vehicle("b", "car", 40.0, {.stops = 0, .standing = 0.0}, Emissions{.co2 = 140.0}),
      vehicle("c", "car", 80.0, {.stops = 2, .standing = 9.5}, std::nullopt),
      vehicle("d", "bus", 20.0, {.stops = 0, .standing = 0.0}, std::nullopt),
      {.id = "e", .type = "car", .movement = "W>E", .driving = {.stops = 50, .standing = 150.0}}};
  const json j = json::parse(summary_json(report));
  const json& cars = j["delay_by_type_s"]["car"];
  EXPECT_EQ(cars["vehicles"], 3);
  EXPECT_EQ(cars["mean"], 30.0);
  EXPECT_NEAR(cars["p95"], 56.0, 1e-9);  // nine tenths of the step from 20 to 60
  EXPECT_EQ(cars["max"], 60.0);
  EXPECT_NEAR(cars["p95_over_mean"], 56.0 / 30.0, 1e-9);
  EXPECT_EQ(cars["stops_per_vehicle"], 1.0);
  EXPECT_EQ(cars["longest_wait_s"], 9.5);
  EXPECT_EQ(cars["co2_g"], 120.0);
  const json& buses = j["delay_by_type_s"]["bus"];
  EXPECT_TRUE(buses["p95_over_mean"].is_null());  // nobody lost any time
  EXPECT_TRUE(buses["co2_g"].is_null());
  const json& movement = j["delay_by_movement_s"]["W>E"];
  EXPECT_EQ(movement["vehicles"], 4);
  EXPECT_EQ(movement["mean"], 22.5);
  EXPECT_EQ(movement["stops_per_vehicle"], 0.75);
  EXPECT_EQ(movement["longest_wait_s"], 9.5);
  EXPECT_EQ(movement["co2_g"], 120.0);
}

}  // namespace
}  // namespace mvtp
