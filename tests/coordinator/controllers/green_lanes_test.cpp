#include "coordinator/signals/green_lanes.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <tuple>

#include "coordinator/controllers/registry.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "planner/geometry/oriented_box.hpp"
#include "planner/road/reservation.hpp"
#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {
namespace {

using testing::Combine;
using testing::Values;

/// Traffic with a signal at "C" that runs a program: each approach in turn has green for 8 s,
/// yellow for 3 s.
class Programmed : public FakeTraffic {
 public:
  Programmed(RoadNetwork network, std::vector<FakeTrip> trips)
      : FakeTraffic(std::move(network), std::move(trips)) {
    const Junction& junction = this->network().junctions.at("C");
    for (const std::string& lane : junction.incoming_lanes) {
      std::string lights;
      for (const Connection& c : junction.connections) lights += c.from_lane == lane ? 'G' : 'r';
      phases.push_back({8.0, 8.0, 8.0, lights});
      for (char& light : lights) light = light == 'G' ? 'y' : 'r';
      phases.push_back({3.0, 3.0, 3.0, lights});
    }
    show_phase();
  }

  std::vector<SignalPhase> signal_phases(const std::string&) const override { return phases; }
  SignalControl signal_control(const std::string&) const override { return control; }
  std::string shown(const std::string&) const override { return phases[now].lights; }
  void step() override {
    FakeTraffic::step();
    left -= step_length();
    if (left > 1e-6) return;
    now = (now + 1) % phases.size();
    left = phases[now].duration;
    show_phase();
  }
  void show_phase() {
    for (std::size_t i = 0; i < phases[now].lights.size(); ++i) {
      const char light = phases[now].lights[i];
      show("C", int(i), light == 'G' ? Light::kGreen : light == 'y' ? Light::kYellow : Light::kRed);
    }
  }

  std::vector<SignalPhase> phases;
  SignalControl control = SignalControl::kFixed;
  std::size_t now = 0;
  double left = 8.0;
};

std::vector<FakeTrip> cars(unsigned seed, int vehicles = 24) {
  return random_trips(with_signals(crossroads_shape()), {.vehicles = vehicles, .seed = seed});
}

/// A run of a controller, by its name, that is looked at after every step.
class Watched {
 public:
  Watched(const std::string& controller, double penetration, std::vector<FakeTrip> trips)
      : trips_(int(trips.size())),
        traffic(with_signals(crossroads_shape()).network, std::move(trips)),
        area_(traffic.network()),
        audit(area_, traffic.step_length()) {
    CoordinatorOptions options;
    options.share = {.penetration = penetration, .seed = 1};
    options.escot.threads = 1;
    controller_ = find_controller(controller)->make({traffic, area_, options});
    simulation_.add(*controller_);
    simulation_.add([this](const Snapshot& seen) { look(seen); });
  }

  Watched& until(double end) {
    while (traffic.running() && traffic.time() < end) simulation_.step();
    return *this;
  }
  [[nodiscard]] bool everybody_arrived() const { return traffic.arrived() == trips_; }
  [[nodiscard]] const std::string& log() const { return log_; }

 private:
  int trips_;

 public:
  Programmed traffic;

 private:
  DrivableArea area_;
  std::unique_ptr<Controller> controller_;
  Simulation simulation_{traffic};

 public:
  Audit audit;
  int passed_at_red = 0;    ///< steps on the junction of those under control who came at red
  int shared_tiles = 0;     ///< steps of two of them on one tile
  int on_green_ground = 0;  ///< steps of one who came at red on the path of a green lane

 private:
  struct Inside {
    std::string id;
    const Connection* connection;
    OrientedBox body;
  };

  void look(const Snapshot& seen) {
    audit.observe(seen.time, seen.vehicles);
    std::vector<Inside> inside;
    for (const Observation& s : seen.vehicles) {
      log_ += fmt::format("{} {:.3f} {:.3f};", s.state->id, s.state->pose.x, s.state->pose.y);
      if (!s.coordinated) continue;
      for (const Connection& c : traffic.network().junctions.at("C").connections) {
        if (std::ranges::count(c.via, s.state->lane) == 0) continue;
        inside.push_back(
            {s.state->id, &c, footprint(traffic.type(s.state->type).body, s.state->pose)});
      }
    }
    log_ += '\n';
    for (std::size_t i = 0; i < inside.size(); ++i) {
      look_at_lights(inside[i]);
      for (std::size_t j = 0; j < i; ++j) {
        shared_tiles += inside[i].connection->from_lane != inside[j].connection->from_lane &&
                                share_a_tile(inside[i].body, inside[j].body)
                            ? 1
                            : 0;
      }
    }
  }

  void look_at_lights(const Inside& car) {
    const std::string& lights = traffic.phases[traffic.now].lights;
    const bool is_red = lights[std::size_t(car.connection->signal_index)] == 'r';
    if (!came_at_red_.try_emplace(car.id, is_red).first->second) return;
    ++passed_at_red;
    for (const Connection& c : traffic.network().junctions.at("C").connections) {
      if (c.from_lane == car.connection->from_lane) continue;
      const bool green = lights[std::size_t(c.signal_index)] == 'G';
      on_green_ground += green && touches(car.body, c) ? 1 : 0;
    }
  }

  /// Does a body touch the middle of a path over the junction?
  bool touches(const OrientedBox& body, const Connection& connection) {
    for (const std::string& via : connection.via) {
      for (const Point& p : traffic.network().lanes.at(via).shape) {
        const OrientedBox point{.x = p.x, .y = p.y, .half_length = 0.01, .half_width = 0.01};
        if (separation(body, point) <= 0.0) return true;
      }
    }
    return false;
  }

  static bool share_a_tile(const OrientedBox& a, const OrientedBox& b) {
    const int x = int(std::floor(a.x)), y = int(std::floor(a.y));
    for (int i = x - 4; i <= x + 4; ++i) {
      for (int j = y - 4; j <= y + 4; ++j) {
        const OrientedBox tile{.x = i + 0.5 * kTile,
                               .y = j + 0.5 * kTile,
                               .half_length = kTile / 2,
                               .half_width = kTile / 2};
        if (separation(a, tile) <= 0.0 && separation(b, tile) <= 0.0) return true;
      }
    }
    return false;
  }

  std::string log_;
  std::map<std::string, bool> came_at_red_;  ///< over the line
};

/// Controller, penetration.
class Greens : public testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(Greens, AreNotTouched) {
  const auto& [controller, penetration] = GetParam();
  int passed_at_red = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    Watched run(controller, penetration, cars(seed));
    run.until(600.0);
    EXPECT_TRUE(run.everybody_arrived());
    EXPECT_EQ(run.audit.figures().overlap_pairs, 0);
    EXPECT_EQ(run.shared_tiles, 0);
    if (std::string(controller) == "fcfs-light") {
      EXPECT_EQ(run.on_green_ground, 0);
    }
    passed_at_red += run.passed_at_red;
  }
  EXPECT_GT(passed_at_red, 0);
}

INSTANTIATE_TEST_SUITE_P(Rivals, Greens, Combine(Values("fcfs-light", "h-aim"), Values(0.5, 1.0)));

TEST(GreenLanes, WithoutHumanDriversDecideAsTilesAlone) {
  Watched aim("aim", 1.0, cars(1));
  Watched h_aim("h-aim", 1.0, cars(1));
  EXPECT_EQ(aim.until(120.0).log(), h_aim.until(120.0).log());
  EXPECT_GT(h_aim.on_green_ground, 0);
}

TEST(GreenLanes, LeaveHumanDriversToTheSignal) {
  for (const char* rival : {"fcfs-light", "h-aim"}) {
    Watched none("sumo", 0.0, cars(2));
    Watched run(rival, 0.0, cars(2));
    EXPECT_EQ(none.until(200.0).log(), run.until(200.0).log()) << rival;
  }
}

TEST(GreenLanes, AreKeptFreeThoughNobodyIsThere) {
  const auto arrives_at = [](const char* rival) {
    Watched run(rival, 1.0, {{.id = "a", .from = "S-C", .to = "C-N"}});
    run.until(200.0);
    EXPECT_TRUE(run.everybody_arrived());
    return std::pair(run.traffic.time(), run.on_green_ground);
  };
  const auto [light, light_on_green] = arrives_at("fcfs-light");
  const double sensed = arrives_at("h-aim").first;
  EXPECT_GT(light, sensed + 3.0);
  EXPECT_EQ(light_on_green, 0);
}

TEST(SignalProgram, LooksAheadByTheClock) {
  Programmed traffic(with_signals(crossroads_shape()).network, {});
  SignalProgram program(traffic, "C");
  EXPECT_EQ(program.courses(30.0).size(), 2U);  // nobody saw the phase begin
  while (traffic.now < 2) {
    traffic.step();
    program.observe();
  }
  for (int i = 0; i < 20; ++i) traffic.step();
  const auto courses = program.courses(12.0);
  ASSERT_EQ(courses.size(), 1U);
  ASSERT_EQ(courses[0].size(), 3U);
  EXPECT_NEAR(courses[0][0].end, 6.0, 0.11);
  EXPECT_EQ(courses[0][1].phase, 3U);
  EXPECT_NEAR(courses[0][1].end, 9.0, 0.11);
  EXPECT_EQ(program.light_now(0), 'r');
  EXPECT_EQ(program.right(3, 3), program.light(2, 3));
}

TEST(SignalProgram, ThatTrafficEndsMayEndSoonOrLate) {
  Programmed traffic(with_signals(crossroads_shape()).network, {});
  traffic.control = SignalControl::kActuated;
  for (std::size_t p = 0; p < traffic.phases.size(); p += 2) {
    traffic.phases[p].least = 5.0;
    traffic.phases[p].most = 50.0;
  }
  SignalProgram program(traffic, "C");
  while (traffic.now < 2) {
    traffic.step();
    program.observe();
  }
  for (int i = 0; i < 20; ++i) traffic.step();
  const auto courses = program.courses(12.0);
  ASSERT_EQ(courses.size(), 2U);
  EXPECT_NEAR(courses[0][0].end, 48.0, 0.11);
  EXPECT_NEAR(courses[1][0].end, 3.0, 0.11);
}

}  // namespace
}  // namespace mvtp
