#include "traci_bridge/trips.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/traci_bridge/fixtures.hpp"

namespace mvtp {
namespace {

using testing::MatchesRegex;

std::vector<Trip> parse(const std::string& content) {
  const TemporaryDirectory directory;
  return read_trips(directory.write("tripinfo.xml", content));
}

constexpr const char* kArrived =
    R"(<tripinfo id="W-left.2" depart="120.30" departLane="Wi_0" departPos="4.60" departSpeed="12.12"
       departDelay="0.09" arrival="175.70" arrivalLane="No_0" arrivalPos="292.80"
       arrivalSpeed="12.02" duration="55.40" routeLength="595.20" waitingTime="1.80"
       waitingCount="1" stopTime="0.00" timeLoss="5.43" rerouteNo="0" devices="tripinfo_W-left.2"
       vType="car" speedFactor="0.87" vaporized=""/>)";

TEST(ReadTrips, AnArrivalHasAllItsFigures) {
  const Trip trip = parse(fmt::format("<tripinfos>{}</tripinfos>", kArrived)).at(0);

  EXPECT_EQ(trip.id, "W-left.2");
  EXPECT_EQ(trip.type, "car");
  EXPECT_EQ(trip.depart, 120.3);
  EXPECT_DOUBLE_EQ(trip.depart_delay, 0.09);
  EXPECT_EQ(trip.depart_lane, "Wi_0");
  EXPECT_DOUBLE_EQ(trip.depart_position, 4.6);
  EXPECT_DOUBLE_EQ(trip.depart_speed, 12.12);
  EXPECT_EQ(trip.arrival, 175.7);
  EXPECT_EQ(trip.arrival_lane, "No_0");
  EXPECT_DOUBLE_EQ(trip.arrival_position, 292.8);
  EXPECT_DOUBLE_EQ(trip.duration, 55.4);
  EXPECT_DOUBLE_EQ(trip.route_length, 595.2);
  EXPECT_DOUBLE_EQ(trip.time_loss, 5.43);
  EXPECT_DOUBLE_EQ(trip.waiting_time, 1.8);
  EXPECT_DOUBLE_EQ(trip.speed_factor, 0.87);
  EXPECT_EQ(trip.vaporized, "");
}

TEST(ReadTrips, ATypeOfItsOwnIsTheDeclaredOne) {
  const Trip trip = parse(R"(<tripinfos><tripinfo id="a@b" depart="1" departDelay="0" arrival="2"
      duration="1" routeLength="1" waitingTime="0" timeLoss="0" vType="car@a@b"
      speedFactor="1"/></tripinfos>)")
                        .at(0);
  EXPECT_EQ(trip.type, "car");
}

TEST(ReadTrips, MinusOneMeansNotYet) {
  const Trip trip = parse(R"(<tripinfos><tripinfo id="a" depart="-1" departDelay="20.5"
      arrival="-1.00" duration="0" routeLength="0" waitingTime="0" timeLoss="0" vType="car"
      speedFactor="1.1"/></tripinfos>)")
                        .at(0);

  EXPECT_EQ(trip.depart, std::nullopt);
  EXPECT_EQ(trip.arrival, std::nullopt);
  EXPECT_DOUBLE_EQ(trip.depart_delay, 20.5);
}

TEST(ReadTrips, OtherFilesAreRefused) {
  EXPECT_THAT(message_of([] { parse("<routes/>"); }),
              MatchesRegex(".*:1: the root element is <routes>, not <tripinfos>; .*"));
  EXPECT_THAT(message_of([] { parse("<tripinfos>\n<tripinfo id=\"a\"/></tripinfos>"); }),
              MatchesRegex(".*:2: <tripinfo> vType: missing"));
}

}  // namespace
}  // namespace mvtp
