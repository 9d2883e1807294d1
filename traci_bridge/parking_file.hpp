#pragma once

#include <string>
#include <vector>

#include "coordinator/network/road_network.hpp"
#include "planner/problem/parking_lot.hpp"

namespace mvtp {

/// Reads the open parking lots of a scenario from its additional files, ordered by id.
///
/// A lot is a polygon `<poly type="parking.ground">` and the `<parkingArea>` of the same id, whose
/// `<space>`s are the slots, numbered from 1 in the order of the file; polygons of the type
/// "parking.obstacle" on the ground are solid. Lanes of vehicles that end on the ground are its
/// entries, those that begin on it its exits; lanes for people only that touch it are its
/// footpaths. Parking areas without ground are SUMO's own and left out.
///
/// SUMO puts the front bumper of a parked vehicle at (x, y) of the space, heading `angle` - 90
/// degrees (counter-clockwise from east), and draws the space behind it. Which short side is open
/// to the aisle, so that vehicles stand there either way round, is found out from what lies beyond:
/// where both are open, cars park forward.
///
/// Throws InputError, naming file and line, for a lot that cannot be used.
[[nodiscard]] std::vector<ParkingLot> read_parking_lots(
    const std::vector<std::string>& additional_files, const RoadNetwork& network);

}  // namespace mvtp
