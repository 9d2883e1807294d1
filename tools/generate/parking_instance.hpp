#pragma once

#include <cstdint>
#include <string>

#include "tools/generate/random_instance.hpp"

namespace mvtp {

/// How many cars come and go at once.
struct ParkingCell {
  int in = 24;   ///< wait on the entry road and go into free slots
  int out = 24;  ///< stand in slots and go to places on the exit road
  int instances = 60;
};

/// Throws InputError unless there is someone and all find a slot.
void check_parking_cell(const ParkingCell& cell);

/// Instance number `index`: the same for the same cell and seed, whatever else is generated.
///
/// The lot is open_lot(), with a road of two lanes to the cross aisle in its south, on which the
/// arriving cars queue, and one in its north, where each leaving car has a place of its own,
/// farther away the nearer it stands. All other slots are taken by cars that stay, as polygons.
/// Cars of 4.3 to 5.2 m and vans of 5.9 m, each in a slot that it fits; half of them stand, or will
/// stand, the wrong way round. All may drive 10 km/h; a step is about half a car. Each has a motion
/// to its goal if the others are absent: robots_without_single_agent_path().
/// @throws InputError as check_parking_cell().
[[nodiscard]] GeneratedInstance generate_parking(const ParkingCell& cell, std::uint64_t seed,
                                                 int index);

/// "parking_in24_out24_ex07.yaml"
[[nodiscard]] std::string file_name(const ParkingCell& cell, int index);

}  // namespace mvtp
