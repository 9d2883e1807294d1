#pragma once

/// @file
/// Bodies and lines in the plane, as all worlds have them, beside Point, Pose and Vehicle.
///
/// - Arc and drive(): where a drive of constant curvature leads.
/// - OrientedBox, footprint() and separation(): the body of a vehicle at a pose, and how far apart
///   two bodies are.
/// - contains(): is a point inside a polygon?
/// - ReferencePath: a smooth curve for the rear axle, by its length; resample() and smooth() make
///   one from the middle line of a lane.
///
/// - Units: metres, radians, 1/m.
/// - Frame: the world's, x and y at right angles, headings counter-clockwise from +x, curvatures
///   positive to the left. The pose of a vehicle is that of its rear axle, and `s` on a path is the
///   distance of the rear axle from its begin.
/// - Shapes: polygons are not closed (the last point differs from the first), boxes are half
///   lengths around a middle, paths have a sample every ReferencePath::kSpacing.
/// - Errors: nothing here throws, but for want of memory; what must hold before is at each
///   function.
/// - Sources: drive() is eq. (5) of the ESCoT paper, integrated exactly; separation() is the
///   separating axis theorem.
///
/// The referee does not use any of this: its geometry is its own (problem/referee_geometry.hpp).

// IWYU pragma: begin_exports
#include "planner/geometry/arc.hpp"
#include "planner/geometry/oriented_box.hpp"
#include "planner/geometry/polygon.hpp"
#include "planner/motion/reference_path.hpp"
// IWYU pragma: end_exports
