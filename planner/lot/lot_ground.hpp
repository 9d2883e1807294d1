#pragma once

#include "planner/lot/lot_planner.hpp"
#include "planner/problem/instance.hpp"
#include "planner/problem/parking_lot.hpp"

namespace mvtp {

/// The strip of a lane on the ground between two places on it [m].
[[nodiscard]] Polygon strip(const LotLane& lane, double from, double to);
/// What is kept free for those who come in by a lane.
[[nodiscard]] Polygon entry_strip(const LotLane& lane);
/// All of them, on a map of the given size.
[[nodiscard]] Map entry_strips(const ParkingLot& lot, const Map& size);

/// The border of the lot, its obstacles, and bars where no car drives although there is room.
[[nodiscard]] Map walls_of(const ParkingLot& lot);

[[nodiscard]] Polygon outline(const StandingCar& car);

}  // namespace mvtp
