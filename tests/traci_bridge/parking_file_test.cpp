#include "traci_bridge/parking_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "tests/traci_bridge/fixtures.hpp"
#include "traci_bridge/configuration.hpp"
#include "traci_bridge/network.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

std::vector<ParkingLot> shipped(const std::string& name) {
  const SumoConfiguration configuration =
      read_configuration(project_file("scenarios/parking/" + name + ".sumocfg"));
  return read_parking_lots(configuration.additional_files, read_network(configuration.net_file));
}

TEST(ReadParkingLots, TheShippedLotHasSlotsLanesAndAFootpath) {
  const std::vector<ParkingLot> lots = shipped("parking");
  ASSERT_THAT(lots, SizeIs(1));
  const ParkingLot& lot = lots.front();
  EXPECT_EQ(lot.id, "lot");
  EXPECT_THAT(lot.slots, SizeIs(58));
  EXPECT_THAT(lot.obstacles, SizeIs(4));
  EXPECT_THAT(lot.footpaths, SizeIs(1));
  ASSERT_THAT(lot.entries, SizeIs(1));
  EXPECT_EQ(lot.entries[0].lane, "entry_0");
  EXPECT_NEAR(lot.entries[0].begin.x, -28.0, 1e-4);
  EXPECT_NEAR(lot.entries[0].begin.y, 3.25, 1e-9);
  EXPECT_NEAR(lot.entries[0].begin.theta, 0.0, 1e-9);
  EXPECT_NEAR(lot.entries[0].length, 28.0, 1e-4);
  EXPECT_NEAR(lot.entries[0].offset, 172.0, 1e-4);
  ASSERT_THAT(lot.exits, SizeIs(1));
  EXPECT_EQ(lot.exits[0].lane, "exit_0");
  EXPECT_NEAR(lot.exits[0].begin.x, 0.0, 1e-9);
  EXPECT_NEAR(lot.exits[0].begin.theta, std::numbers::pi, 1e-9);
  EXPECT_NEAR(lot.exits[0].length, 28.0, 1e-4);
  EXPECT_NEAR(lot.exits[0].offset, 0.0, 1e-9);
}

TEST(ReadParkingLots, SlotsPointAwayFromTheirAisle) {
  const std::vector<ParkingLot> lots = shipped("parking");
  for (const ParkingSlot& slot : lots.front().slots) {
    const bool to_the_east = slot.middle.x > 40.0 ||
                             (slot.middle.x > 24.0 && slot.middle.x < 32.0) ||
                             (slot.middle.x > 8.0 && slot.middle.x < 16.0);
    EXPECT_NEAR(std::cos(slot.middle.theta), to_the_east ? 1.0 : -1.0, 1e-9) << slot.middle.x;
  }
}

TEST(ReadParkingLots, AngledSlots) {
  const std::vector<ParkingLot> lots = shipped("angled");
  ASSERT_THAT(lots, SizeIs(1));
  EXPECT_THAT(lots[0].slots, SizeIs(24));
  for (const ParkingSlot& slot : lots[0].slots) {
    EXPECT_NEAR(slot.middle.theta, (slot.middle.y > 0.0 ? 1.0 : -1.0) * std::numbers::pi / 3, 1e-9);
  }
}

//         x = -20      0              20      40
//   y = 10             +--------------+
//                      |   2 slots    |
//    0    in ----------|>            >|----------- out     lanes along y = 0
//                      |   obstacle   |
//  -10                 +--------------+
class HostileLot : public testing::Test {
 protected:
  [[nodiscard]] std::vector<ParkingLot> read() const {
    const TemporaryDirectory directory;
    const std::string net = directory.write("test.net.xml", R"(<net>
      <edge id="in" from="a" to="b"><lane id="in_0" index="0" speed="5" length="52" shape=")" +
                                                                entry_ + R"("/></edge>
      <edge id="out" from="b" to="c"><lane id="out_0" index="0" speed="5" length="26" shape=")" +
                                                                exit_ + R"("/></edge>
      <edge id="walk" from="d" to="e"><lane id="walk_0" index="0" allow="pedestrian" speed="1" length="40" width="3" shape="10,-20 10,20"/></edge>
      <edge id="aisle" from="f" to="g"><lane id="aisle_0" index="0" speed="1" length="9" shape="5,-3 14,-3"/></edge>
      <junction id="b" type="priority" x="10" y="0"/></net>)");
    return read_parking_lots(
        {directory.write("test.add.xml", "<additional>\n" + content() + "\n</additional>")},
        read_network(net));
  }

  [[nodiscard]] std::string content() const {
    return "<poly id=\"p\" type=\"parking.ground\" shape=\"" + ground_ + "\"/>\n" + polygons_ +
           "\n<parkingArea id=\"p\" lane=\"in_0\" " + area_ + ">\n" + spaces_ + "\n</parkingArea>" +
           areas_;
  }

  /// The message without the directory.
  [[nodiscard]] std::string error() const {
    const std::string message = message_of([&] { return read(); });
    const std::size_t name = message.find("test.add.xml");
    return name == std::string::npos ? message : message.substr(name);
  }

  std::string entry_ = "-20,0 6,0";
  std::string exit_ = "14,0 40,0";
  std::string ground_ = "0,-10 20,-10 20,10 0,10";
  std::string polygons_ = R"(<poly id="o" type="parking.obstacle" shape="2,-9 4,-9 4,-7 2,-7"/>)";
  std::string spaces_ = R"(<space x="3" y="9.5" angle="180" width="2.5" length="5"/>
                           <space x="6" y="4.5" angle="0" width="2.5" length="5"/>)";
  std::string area_;   ///< more attributes
  std::string areas_;  ///< more elements
};

TEST_F(HostileLot, IsFineAsDrawnHere) {
  EXPECT_EQ(error(), "");
  const ParkingLot lot = read().front();
  // The lane is 52 m long by its attribute, its centre line 26 m: SUMO counts along the first.
  EXPECT_THAT(lot.entries, SizeIs(1));
  EXPECT_NEAR(lot.entries[0].begin.x, 0.0, 1e-9);
  EXPECT_NEAR(lot.entries[0].length, 6.0, 1e-9);
  EXPECT_NEAR(lot.entries[0].offset, 40.0, 1e-9);
  EXPECT_THAT(lot.exits, SizeIs(1));
  EXPECT_NEAR(lot.exits[0].length, 6.0, 1e-9);
  ASSERT_THAT(lot.footpaths, SizeIs(1));
  EXPECT_DOUBLE_EQ(lot.footpaths[0].width, 3.0);
  EXPECT_THAT(lot.footpaths[0].line, ElementsAre(Point{10.0, -20.0}, Point{10.0, 20.0}));
  EXPECT_THAT(lot.obstacles, SizeIs(1));
  // Parked forward, and in reverse: one place, the path in is the same.
  for (const ParkingSlot& slot : lot.slots) {
    EXPECT_NEAR(slot.middle.y, 7.0, 1e-9);
    EXPECT_NEAR(slot.middle.theta, std::numbers::pi / 2, 1e-9);
  }
}

TEST_F(HostileLot, WhatSpacesLackTheirAreaSays) {
  spaces_ = R"(<space x="3" y="9.5"/><space x="6" y="9.5" width="2"/>)";
  EXPECT_EQ(error(), "test.add.xml:5: <space> length: missing");
  area_ = R"(width="2.5" length="5" angle="180")";
  const std::vector<ParkingSlot> slots = read().front().slots;
  ASSERT_THAT(slots, SizeIs(2));
  EXPECT_EQ(slots[0].length, 5.0);
  EXPECT_EQ(slots[0].width, 2.5);
  EXPECT_NEAR(slots[0].middle.theta, std::numbers::pi / 2, 1e-9);
  EXPECT_EQ(slots[1].width, 2.0);
}

TEST_F(HostileLot, ParkingAreasWithoutGroundAreLeftOut) {
  areas_ = R"(<parkingArea id="q" lane="in_0" roadsideCapacity="5"/>)";
  EXPECT_THAT(read(), SizeIs(1));
}

TEST_F(HostileLot, GroundsHaveASimpleOutline) {
  ground_ = "0,0 1,0 1,0 0,0";
  EXPECT_EQ(error(), "test.add.xml:2: polygon \"p\" has 2 points; draw at least 3");
  ground_ = "0,-10 20,10 20,-10 0,10";
  EXPECT_EQ(error(),
            "test.add.xml:2: polygon \"p\" touches or crosses itself: sides 1 and 3; draw a simple "
            "outline");
  ground_ = "0,-10 20,-10 20,10 30,10 20,10 0,10";
  EXPECT_THAT(error(), testing::HasSubstr("touches or crosses itself: sides 2 and 4;"));
  ground_ = "0,0 20,0 40,0";
  EXPECT_THAT(error(), testing::HasSubstr("touches or crosses itself"));
  ground_ = "0,-10 20,-10 nan,10";
  EXPECT_EQ(error(), "test.add.xml:2: <poly> shape: \"nan,10\" is not a point x,y");
  ground_ = "0,-10 1e300,-10 20,10";
  EXPECT_THAT(error(), testing::HasSubstr("reaches to (1e+300, -10) m; draw it on the network"));
  ground_.clear();
  for (int i = 0; i < 2000; ++i) ground_ += std::to_string(i) + "," + std::to_string(i * i) + " ";
  EXPECT_THAT(error(), testing::HasSubstr("has 2000 points; draw at most 1000"));
  ground_ = "";
  EXPECT_THAT(error(), testing::HasSubstr("has 0 points"));
}

TEST_F(HostileLot, GroundsInDegreesAreRefused) {
  polygons_ =
      R"(<poly id="g" type="parking.ground" geo="true" shape="7.1,50.7 7.2,50.7 7.2,50.8"/>)";
  EXPECT_EQ(
      error(),
      "test.add.xml:3: polygon \"g\" is given as longitudes and latitudes; save it in metres, "
      "without geo=\"1\"");
}

TEST_F(HostileLot, TypesAreSpelledAsTheyAre) {
  polygons_ = R"(<poly id="o" type="parking.wall" shape="2,-9 4,-9 4,-7 2,-7"/>)";
  EXPECT_EQ(error(),
            "test.add.xml:3: <poly> type: \"parking.wall\" is unknown; choose parking.ground or "
            "parking.obstacle");
  polygons_ = R"(<poly id="o" type="forest" shape="2"/>)";
  EXPECT_EQ(error(), "");
}

TEST_F(HostileLot, IdsAreGivenOnce) {
  areas_ = R"(<parkingArea id="p" lane="in_0"/>)";
  EXPECT_EQ(error(), "test.add.xml:7: the parkingArea \"p\" is defined twice; delete one");
  areas_ = R"(<poly id="p" type="parking.ground" shape="50,40 90,40 90,60 50,60"/>)";
  EXPECT_EQ(error(), "test.add.xml:7: the ground of lot \"p\" is defined twice; delete one");
}

TEST_F(HostileLot, LotsHaveSlots) {
  spaces_ = "";
  EXPECT_EQ(error(), "test.add.xml:4: lot \"p\" has no slots; add a <space> for each");
  areas_ = R"(<poly id="q" type="parking.ground" shape="50,40 90,40 90,60 50,60"/>)";
  spaces_ = R"(<space x="3" y="9.5" angle="180" width="2.5" length="5"/>)";
  EXPECT_EQ(
      error(),
      "test.add.xml:6: lot \"q\" has no slots; add <parkingArea id=\"q\"> with its <space>s to "
      "the additional files");
}

TEST_F(HostileLot, SlotsAreLargeEnoughAndOnTheGround) {
  spaces_ = R"(<space x="3" y="9.5" angle="180" width="0.9" length="5"/>)";
  EXPECT_EQ(error(),
            "test.add.xml:5: slot 1 of lot \"p\" is 5 x 0.9 m, smaller than any car; give at least "
            "2 x 1 m");
  spaces_ = R"(<space x="3" y="10.5" angle="180" width="2.5" length="5"/>)";
  EXPECT_EQ(
      error(),
      "test.add.xml:5: slot 1 of lot \"p\" around (3.00, 8.00) m is not all on the ground; move "
      "it, or draw a larger ground");
  spaces_ = R"(<space x="3" y="-6" angle="0" width="2.5" length="5"/>)";
  EXPECT_EQ(error(), "");
  spaces_ = R"(<space x="3" y="-8" angle="0" width="2.5" length="5"/>)";
  EXPECT_EQ(error(), "test.add.xml:5: slot 1 of lot \"p\" lies on an obstacle; move one of them");
  spaces_ = R"(<space x="3" y="9.5" angle="180" width="2.5" length="5"/>
               <space x="5" y="9.5" angle="180" width="2.5" length="5"/>)";
  EXPECT_EQ(error(), "test.add.xml:6: slot 2 of lot \"p\" overlaps slot 1; move one of them");
}

TEST_F(HostileLot, SlotsAreNumbersAboveZero) {
  spaces_ = R"(<space x="nan" y="9.5" angle="180" width="2.5" length="5"/>)";
  EXPECT_EQ(error(), "test.add.xml:5: <space> x: \"nan\" is not a finite number");
  spaces_ = R"(<space x="3" y="9.5" angle="inf" width="2.5" length="5"/>)";
  EXPECT_EQ(error(), "test.add.xml:5: <space> angle: \"inf\" is not a finite number");
  spaces_ = R"(<space x="3" y="9.5" angle="180" width="-2.5" length="5"/>)";
  EXPECT_EQ(error(), "test.add.xml:5: <space> width: \"-2.5\" is not above 0");
  spaces_ = R"(<space y="9.5" angle="180" width="2.5" length="5"/>)";
  EXPECT_EQ(error(), "test.add.xml:5: <space> x: missing");
  spaces_ = R"(<space x="3" y="9.5" width="1e300" length="5"/>)";
  EXPECT_EQ(error(), "test.add.xml:5: a length of 1e+300 m; draw the space on the network");
}

TEST_F(HostileLot, SlotsOpenToAnAisle) {
  polygons_ = R"(<poly id="o" type="parking.obstacle" shape="1,3.5 5,3.5 5,4.2 1,4.2"/>)";
  EXPECT_EQ(
      error(),
      "test.add.xml:5: slot 1 of lot \"p\" is closed at both short sides; leave ground free at "
      "one of them");
}

TEST_F(HostileLot, LanesLeadInAndOut) {
  entry_ = "-20,0 -1,0";
  EXPECT_EQ(
      error(),
      "test.add.xml:2: no lane ends on the ground of lot \"p\"; draw the ground over the last "
      "metres of a lane that leads there");
  entry_ = "-20,0 0,0";  // ends on the border
  EXPECT_THAT(error(), testing::HasSubstr("no lane ends on the ground"));
  entry_ = "-20,0 6,0";
  exit_ = "30,0 40,0";
  EXPECT_EQ(error(),
            "test.add.xml:2: no lane begins on the ground of lot \"p\"; draw the ground over the "
            "first metres of a lane that leads away");
}

TEST_F(HostileLot, LanesAreStraightOnTheGround) {
  entry_ = "-20,0 2,0 6,1";
  EXPECT_EQ(error(),
            "test.add.xml:2: lane \"in_0\" is not straight on the ground of lot \"p\": it bends by "
            "0.33 m; straighten it, or end the ground before the bend");
  entry_ = "-20,9 0,0 6,0";  // bends at the border, where its piece begins
  EXPECT_EQ(error(), "");
}

TEST_F(HostileLot, GroundsAreApart) {
  const std::string slots =
      R"(<parkingArea id="q" lane="in_0"><space x="17" y="-9" angle="0" width="2" length="5"/></parkingArea>)";
  const std::string overlapping =
      "test.add.xml:7: the ground of lot \"q\" overlaps that of lot \"p\"; move one of them";
  // Crossing sides, one in the other, the same, and side by side along common sides.
  for (const char* shape : {"5,-12 19,-12 19,9 5,9", "1,-9.5 19,-9.5 19,9 1,9",
                            "0,-10 20,-10 20,10 0,10", "5,-10 30,-10 30,10 5,10"}) {
    areas_ =
        "<poly id=\"q\" type=\"parking.ground\" shape=\"" + std::string(shape) + "\"/>" + slots;
    EXPECT_EQ(error(), overlapping) << shape;
  }
  areas_ = R"(<poly id="q" type="parking.ground" shape="20,-10 30,-10 30,10 20,10"/>)" + slots;
  EXPECT_THAT(error(), testing::Not(testing::HasSubstr("overlaps that of")));  // a common border
}

TEST_F(HostileLot, OtherFilesAreRefusedInOneLine) {
  const TemporaryDirectory directory;
  EXPECT_EQ(message_of([] { return read_parking_lots({"/"}, {}); }),
            "/: not a file; give the path of an additional file of SUMO");
  EXPECT_THAT(message_of([&] { return read_parking_lots({directory.write("a", "<a")}, {}); }),
              testing::HasSubstr("not XML"));
  EXPECT_THAT(read_parking_lots({directory.write("a", "<a/>")}, {}), SizeIs(0));
}

}  // namespace
}  // namespace mvtp
