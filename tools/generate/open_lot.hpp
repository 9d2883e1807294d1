#pragma once

#include "planner/problem/parking_lot.hpp"

namespace mvtp {

/// A parking lot of 51 x 40 m with its south-west corner at (0, 0): six columns of slots square to
/// three aisles of 6 m, parted by a footpath in the middle, with a cross aisle of 6.5 m in the
/// south and in the north. Entries and exits are left to whoever uses it; scenarios/parking is the
/// same lot for SUMO.
///
/// 40 slots of 2.5 x 5 m, 10 of 2.5 x 5.5 m in the first column, 8 of 2.8 x 6 m in the last.
[[nodiscard]] ParkingLot open_lot();

}  // namespace mvtp
