#pragma once

#include <span>

namespace mvtp {

/// From where on its lane a vehicle may drive `step` metres so that SUMO finds its tail afterwards.
///
/// SUMO looks for the lanes below a tail before the step. After it, it can tell that the tail has
/// left the last of them, but where it has left two SUMO stops. Then the vehicle is to be put a
/// little further on first.
/// @param position  [m] of its front along the lane of `lane_length` [m]; `length` [m]: its own.
/// @param before  lengths of the lanes behind, the next one first [m].
/// @return [m] from `position` to where it drives, or to the end of the lane.
[[nodiscard]] double where_tail_is_found(double position, double length, double step,
                                         double lane_length, std::span<const double> before);

}  // namespace mvtp
