// Real runs of SUMO; libsumo holds one simulation per process, and CTest gives each TEST one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "tests/traci_bridge/fixtures.hpp"
#include "traci_bridge/configuration.hpp"
#include "traci_bridge/network.hpp"
#include "traci_bridge/parking_file.hpp"
#include "traci_bridge/sumo_frame.hpp"
#include "traci_bridge/sumo_traffic.hpp"
#include "traci_bridge/trips.hpp"

namespace mvtp {
namespace {

constexpr double kStep = 0.1;

std::string parked(const std::string& id, double stays) {
  return "<vehicle id=\"" + id +
         "\" type=\"car\" depart=\"0\" departPos=\"stop\"><route edges=\"entry exit\"/>"
         "<stop parkingArea=\"lot\" duration=\"" +
         std::to_string(stays) + "\"/></vehicle>";
}

std::string arriving(const std::string& id, double depart, double stays) {
  return "<vehicle id=\"" + id + "\" type=\"car\" depart=\"" + std::to_string(depart) +
         "\" departSpeed=\"max\"><route edges=\"entry exit\"/><stop parkingArea=\"lot\" "
         "duration=\"" +
         std::to_string(stays) + "\"/></vehicle>";
}

/// The shipped lot with cars of 4.5 x 1.8 m.
class SumoParkingTest : public testing::TestWithParam<bool> {
 protected:
  std::unique_ptr<SumoTraffic> open(const std::string& elements) {
    directory_.write(
        "test.rou.xml",
        R"(<routes><vType id="car" length="4.5" width="1.8" sigma="0" speedDev="0"/>)" + elements +
            "</routes>");
    options_.configuration = directory_.write(
        "test.sumocfg", "<configuration><net-file value=\"" +
                            project_file("scenarios/parking/parking.net.xml") +
                            R"("/><route-files value="test.rou.xml"/><additional-files value=")" +
                            project_file("scenarios/parking/parking.add.xml") +
                            R"("/><step-length value="0.1"/></configuration>)");
    options_.fcd_output = directory_ / "fcd.xml";
    options_.tripinfo_output = directory_ / "tripinfo.xml";
    options_.separate_process = GetParam();
    return open_sumo(options_);
  }

  [[nodiscard]] ParkingLot lot() const {
    const SumoConfiguration configuration = read_configuration(options_.configuration);
    return read_parking_lots(configuration.additional_files, read_network(configuration.net_file))
        .front();
  }

  TemporaryDirectory directory_;
  SumoOptions options_;
};

/// Drives a vehicle along an arc for some seconds, from where it is; SUMO follows to the digit.
void drive(Traffic& traffic, const std::string& id, double speed, double curvature,
           double seconds) {
  const Pose start = find(traffic, id)->pose;
  const int steps = int(std::lround(seconds / kStep));
  for (int i = 1; i <= steps; ++i) {
    const Pose pose = drive(start, speed * kStep * i, curvature);
    traffic.place(id, pose, speed);
    traffic.step();
    ASSERT_NE(find(traffic, id), nullptr);
    ASSERT_NEAR(distance(find(traffic, id)->pose, pose), 0.0, 1e-6);
  }
}

void stand(Traffic& traffic, double seconds) {
  for (int i = 0; i < int(std::lround(seconds / kStep)); ++i) traffic.step();
}

void run_until_empty(Traffic& traffic, double limit) {
  while (traffic.running() && traffic.time() < limit) traffic.step();
  EXPECT_FALSE(traffic.running());
}

// The front bumper of the first space is at (17.2, 12.75), heading west or east.
TEST_P(SumoParkingTest, ParkedCarsStandInTheirSlots) {
  const auto traffic = open(parked("a", 1000) + parked("b", 1000) + parked("c", 1000) +
                            parked("d", 1000) + parked("e", 1000) + parked("f", 1000));
  for (int i = 0; i < 10; ++i) {
    traffic->step();
    for (const VehicleState& state : traffic->vehicles()) {
      EXPECT_TRUE(state.lane.empty());
      EXPECT_TRUE(traffic->parking_stop(state.id)->parked);
    }
  }
  const ParkingLot place = lot();
  ASSERT_EQ(traffic->vehicles().size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const VehicleState& state = traffic->vehicles()[i];
    const ParkingSlot& slot = place.slots[i];
    const Pose seen = relative(slot.middle, state.pose);
    EXPECT_NEAR(seen.y, 0.0, 1e-3);
    EXPECT_NEAR(std::cos(seen.theta), i % 4 == 3 ? -1.0 : 1.0, 1e-9) << i;
    const Vehicle body = body_of(4.5, 1.8);
    const double front = seen.x + std::cos(seen.theta) * body.front;
    const double rear = seen.x - std::cos(seen.theta) * body.rear;
    EXPECT_LE(std::max(std::abs(front), std::abs(rear)), slot.length / 2 + 1e-3);
  }
}

TEST_P(SumoParkingTest, AnArrivingCarIsDrivenIntoASlotAndOut) {
  const auto traffic = open(arriving("a", 0, 600));
  while (find(*traffic, "a") == nullptr || find(*traffic, "a")->lane_position < 175.0) {
    traffic->step();
  }
  const auto stop = traffic->parking_stop("a");
  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->area, "lot");
  EXPECT_DOUBLE_EQ(stop->duration, 600.0);
  EXPECT_LT(stop->until, 0.0);
  EXPECT_FALSE(stop->parked);

  traffic->drop_parking_stop("a");
  EXPECT_FALSE(traffic->parking_stop("a"));
  traffic->take_over("a");
  drive(*traffic, "a", 2.7, 0.0, 12.0);
  drive(*traffic, "a", 2.0, 1.0 / 4.5, 3.0);
  drive(*traffic, "a", -1.0, -1.0 / 4.5, 5.0);
  stand(*traffic, 30.0);
  EXPECT_TRUE(find(*traffic, "a")->lane.empty());
  traffic->place("a", {-1.0, 36.75, std::numbers::pi}, 0.0);
  traffic->step();
  drive(*traffic, "a", 2.7, 0.0, 6.0);
  EXPECT_EQ(find(*traffic, "a")->lane, "exit_0");
  EXPECT_THAT(traffic->route("a"), testing::ElementsAre("exit"));
  traffic->hand_back("a");
  run_until_empty(*traffic, 200.0);
  traffic->close();
  const std::vector<Trip> trips = read_trips(options_.tripinfo_output);
  ASSERT_EQ(trips.size(), 1U);
  EXPECT_TRUE(trips[0].arrival);
  EXPECT_EQ(trips[0].arrival_lane, "exit_0");
}

TEST_P(SumoParkingTest, AParkedCarIsTakenOverAndLeaves) {
  const auto traffic = open(parked("a", 50) + parked("b", 50) + parked("c", 150));
  stand(*traffic, 20.0);
  const Pose pose = find(*traffic, "b")->pose;
  EXPECT_NEAR(traffic->parking_stop("b")->duration, 50.0, 1e-6);
  traffic->drop_parking_stop("b");
  traffic->take_over("b");
  stand(*traffic, 5.0);
  EXPECT_NEAR(distance(find(*traffic, "b")->pose, pose), 0.0, 1e-6);
  drive(*traffic, "b", -1.0, 0.0, 3.0);
  traffic->place("b", {-1.0, 36.75, std::numbers::pi}, 0.0);
  traffic->step();
  drive(*traffic, "b", 2.7, 0.0, 6.0);
  traffic->hand_back("b");
  run_until_empty(*traffic, 1200.0);
  traffic->close();
  const std::vector<Trip> trips = read_trips(options_.tripinfo_output);
  ASSERT_EQ(trips.size(), 3U);
  for (const Trip& trip : trips) EXPECT_TRUE(trip.arrival);
}

/// Puts every car that comes into a slot of its own, in one jump, and later at the exit.
class Valet {
 public:
  Valet(Traffic& traffic, const ParkingLot& lot) : traffic_(traffic), slots_(lot.slots) {}

  void step() {
    for (const VehicleState& state : traffic_.vehicles()) {
      const auto stop = traffic_.parking_stop(state.id);
      if (!stop) continue;
      const bool comes = state.lane == "entry_0" && state.lane_position > 175.0;
      if (comes) park(state.id, stop->duration);
      if (stop->parked && !seen_parked_.contains(state.id)) {
        seen_parked_[state.id] = traffic_.time() + stop->duration - 1.0;
      }
      if (stop->parked && traffic_.time() >= seen_parked_.at(state.id)) park(state.id, 1.0);
    }
    for (auto& [id, leaves] : leaves_at_) {
      if (leaves > traffic_.time() || !driving_out_.empty()) continue;
      driving_out_ = id;
      out_ = 0.0;
    }
    if (!driving_out_.empty()) drive_out();
    traffic_.step();
  }

  int served = 0;

 private:
  void park(const std::string& id, double stays) {
    const Pose pose =
        traffic_.parking_stop(id)->parked
            ? find(traffic_, id)->pose
            : compose(slots_[std::size_t(served) % slots_.size()].middle, {-1.3, 0, 0});
    traffic_.drop_parking_stop(id);
    traffic_.take_over(id);
    traffic_.place(id, pose, 0.0);
    leaves_at_[id] = traffic_.time() + stays;
    ++served;
  }

  void drive_out() {
    out_ += 4.0 * kStep;
    traffic_.place(driving_out_, {-out_, 36.75, std::numbers::pi}, 4.0);
    if (out_ < 25.0) return;
    traffic_.hand_back(driving_out_);
    leaves_at_.erase(driving_out_);
    driving_out_.clear();
  }

  Traffic& traffic_;
  std::vector<ParkingSlot> slots_;
  std::map<std::string, double> seen_parked_;
  std::map<std::string, double> leaves_at_;
  std::string driving_out_;
  double out_ = 0.0;
};

class ManyCarsTest : public SumoParkingTest {};

// Nobody gets lost on the way between SUMO's lanes, parking area and open ground.
TEST_P(ManyCarsTest, EverybodyOfManyArrives) {
  std::string cars;
  for (int i = 0; i < 24; ++i) cars += parked("p" + std::to_string(i), 10.0 * (i + 1));
  for (int i = 0; i < 30; ++i) cars += arriving("a" + std::to_string(i), 6.0 * i, 40.0 + i);
  const auto traffic = open(cars);
  Valet valet(*traffic, lot());
  while (traffic->running() && traffic->time() < 900.0) valet.step();

  EXPECT_FALSE(traffic->running());
  EXPECT_EQ(valet.served, 54);
  traffic->close();
  const std::vector<Trip> trips = read_trips(options_.tripinfo_output);
  EXPECT_EQ(trips.size(), 54U);
  for (const Trip& trip : trips) {
    EXPECT_TRUE(trip.arrival) << trip.id;
    EXPECT_EQ(trip.arrival_lane, "exit_0") << trip.id;
    EXPECT_EQ(trip.vaporized, "") << trip.id;
  }
}

TEST_P(SumoParkingTest, TheTurningCircleIsThatOfTheSizeUnlessGiven) {
  const auto traffic = open(
      R"(<vType id="van" length="5.9" width="2"/>
         <vType id="taxi" length="4.6" width="1.8"><param key="turning-radius" value="3.75"/></vType>
         <vType id="odd" length="4.6" width="1.8"><param key="turning-radius" value="small"/></vType>
         <vType id="none" length="4.6" width="1.8"><param key="turning-radius" value="0"/></vType>)");
  EXPECT_NEAR(traffic->type("van").body.min_turning_radius, 5.06, 0.01);
  EXPECT_DOUBLE_EQ(traffic->type("taxi").body.min_turning_radius, 3.75);
  EXPECT_DOUBLE_EQ(traffic->type("taxi").body.wheelbase, 0.6 * 4.6);
  EXPECT_THAT(
      message_of([&] { return traffic->type("odd"); }),
      testing::HasSubstr("vType \"odd\": the param turning-radius is \"small\", not a number "
                         "of metres above 0"));
  EXPECT_THAT(message_of([&] { return traffic->type("none"); }), testing::HasSubstr("\"0\", not"));
}

TEST_P(SumoParkingTest, PeopleOnTheFootpathAreSeen) {
  const auto traffic = open(
      R"(<person id="p" depart="0"><walk edges="footpath"/></person>
         <person id="q" depart="0" departPos="91"><walk edges="footpath" arrivalPos="0"/></person>)");
  stand(*traffic, 10.0);
  ASSERT_EQ(traffic->pedestrians().size(), 2U);
  const Pedestrian& p = traffic->pedestrians()[0];
  const Pedestrian& q = traffic->pedestrians()[1];
  EXPECT_EQ(p.id, "p");
  EXPECT_NEAR(p.position.x, -20.0 + 10.0 * p.speed, 2.0);
  EXPECT_NEAR(q.position.x, 71.0 - 10.0 * q.speed, 2.0);
  EXPECT_NEAR(p.position.y, 20.0, 1.0);
  EXPECT_NEAR(p.theta, 0.0, 1e-6);
  EXPECT_NEAR(std::abs(q.theta), std::numbers::pi, 1e-6);
  EXPECT_GT(p.radius, 0.2);
  EXPECT_LT(p.radius, 0.4);
  run_until_empty(*traffic, 150.0);
  EXPECT_TRUE(traffic->pedestrians().empty());
}

INSTANTIATE_TEST_SUITE_P(Inside, ManyCarsTest, testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Sumo, SumoParkingTest, testing::Values(false, true),
                         [](const auto& run) { return run.param ? "Separate" : "Inside"; });

}  // namespace
}  // namespace mvtp
