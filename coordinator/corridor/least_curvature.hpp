#pragma once

#include <vector>

#include "coordinator/network/drivable_area.hpp"
#include "planner/geometry.hpp"

namespace mvtp {

/// Of a path, for the rear axle [m].
struct Stretch {
  double from = 0.0;
  double to = 0.0;
};

/// Where a path may be beside the middle of its lanes.
struct FreeCourse {
  Stretch within;             ///< nowhere else
  std::vector<double> lines;  ///< [m] before which bodies wait: half as far beside it
};

/// The path with the smallest sum of squared curvatures among those at most `room` [m] beside
/// `path` around its bends where they are free, and nowhere beside it elsewhere: a kink becomes a
/// long bend, which can be driven faster. Offsets are taken as small against the radius.
/// Source: Heilmeier et al., Minimum curvature trajectory planning and control for an autonomous
/// race car, Vehicle System Dynamics 58 (2020), section 3.1; here the offset is a cubic B-spline.
[[nodiscard]] ReferencePath least_curved(const ReferencePath& path, const FreeCourse& free,
                                         double room);

/// least_curved() as far as the body still has room: within its lanes, and no more off the road
/// than on `path`.
/// @param driven  nobody is on the path beyond it.
/// @param lane_width  of the narrowest lane [m].
/// @param own   the road in this direction, as of make_reference_path(),
/// @param area  the whole road.
[[nodiscard]] ReferencePath straightened(ReferencePath path, const Stretch& driven,
                                         const FreeCourse& free, double lane_width,
                                         const Vehicle& body, const DrivableArea& own,
                                         const DrivableArea& area);

}  // namespace mvtp
