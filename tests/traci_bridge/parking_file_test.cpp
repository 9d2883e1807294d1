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
  const Configuration configuration =
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
  for (const ParkingSlot& slot : shipped("parking").front().slots) {
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

}  // namespace
}  // namespace mvtp
