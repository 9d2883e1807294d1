#pragma once

#include <span>

#include "coordinator/network/drivable_area.hpp"
#include "planner/geometry.hpp"

namespace mvtp {

/// The path of the rear axle along a centre line for this body: smooth enough for its turning
/// circle and, where the body is long, wide enough to keep its footprint on the road. The line may
/// have any number of turns.
/// @param from,to  the stretch that the rear axle drives [m]: nobody is on the path beyond it.
/// @param own   the road in this direction: where the body should stay,
/// @param area  the whole road: where it may swing to if it has to.
[[nodiscard]] ReferencePath make_reference_path(std::span<const Point> centre_line, double from,
                                                double to, const Vehicle& body,
                                                const DrivableArea& own, const DrivableArea& area);

constexpr double kJudgedEvery = 0.5;  ///< [m] between the places where a path is judged

/// Is the footprint off the road, as the audit judges it, at s or nearer to it than to the next
/// places that are judged?
[[nodiscard]] bool leaves_road(const ReferencePath& path, double s, const Vehicle& body,
                               const DrivableArea& area);

}  // namespace mvtp
