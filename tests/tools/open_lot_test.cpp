#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tools/generate/open_lot.hpp"
#include "traci_bridge/network.hpp"
#include "traci_bridge/parking_file.hpp"

namespace mvtp {
namespace {

std::string place(const ParkingSlot& slot) {
  return fmt::format("{:.3f} {:.3f} {:.3f} {:.2f} {:.2f}", slot.middle.x, slot.middle.y,
                     std::cos(slot.middle.theta), slot.length, slot.width);
}

TEST(OpenLot, IsThatOfTheScenario) {
  const std::string folder = MVTP_SOURCE_DIR "/scenarios/parking/";
  const std::vector<ParkingLot> lots =
      read_parking_lots({folder + "parking.add.xml"}, read_network(folder + "parking.net.xml"));
  ASSERT_EQ(lots.size(), 1U);
  std::vector<std::string> drawn;
  for (const ParkingSlot& slot : lots.front().slots) drawn.push_back(place(slot));
  std::vector<std::string> made;
  const ParkingLot lot = open_lot();
  for (const ParkingSlot& slot : lot.slots) made.push_back(place(slot));
  EXPECT_THAT(made, testing::UnorderedElementsAreArray(drawn));
  EXPECT_THAT(lot.obstacles, testing::UnorderedElementsAreArray(lots.front().obstacles));
}

}  // namespace
}  // namespace mvtp
