#pragma once

/// @file
/// Parking lots: cars come and go on open ground, each on a path of arcs, forwards and in reverse.
///
/// What a caller does, in this order:
/// 1. A LotPlanner for the ParkingLot (ground, obstacles, slots, lanes), and an empty LotMotion.
/// 2. LotPlanner::set_standing(): the bodies that stand on the lot now, and do not move.
/// 3. LotPlanner::admit() for each car that asks: a LotRequest with its pose and all goals that
///    would do. If there is a path, the car is on it in the LotMotion; if not, nothing has changed,
///    and it may ask again at the next decision.
/// 4. LotPlanner::decide(), once per decision: a better order for those under way.
/// 5. LotMotion::step() for each step of the simulation until the next decision: everybody drives
///    as far as it is its turn. LotCar::pose() says where each one is. LotMotion::remove() for a
///    car that is at its end. Then again from 2.
///
/// What else the LotMotion has to know: at each step, where cars must stop for somebody on foot;
/// stop_permanently() for a car that broke down.
///
/// - Units: metres, seconds, radians, m/s, m/s^2.
/// - Frame: the lot's own, ground in x, y > 0, headings counter-clockwise from +x; the pose of a
///   car is that of its rear axle. `s` is the distance that a car has driven on its path, which
///   grows in reverse, too.
/// - Shapes: the `stopping_points` of LotMotion::step() are one for each of LotMotion::cars(), in
/// their
///   order, which is that of the keys; polygons are not closed.
/// - Laws: "everyone brakes now" is free of contact at every step; cars whose order is that of one
///   plan all arrive, however late one of them is. The same calls give the same plans.
/// - Errors: nothing throws, but for want of memory. Without a path now, admit() gives nullopt.
/// - Threads: no two may use one planner, or its motion, at once.
/// - Sources: the ESCoT paper, Alg. 1 and 2; Hoenig et al. 2016 for the order of passage (temporal
///   plan graphs). Which line of the paper is which function: planner/lot/README.md.

// IWYU pragma: begin_exports
#include "planner/geometry.hpp"
#include "planner/lot/lot_motion.hpp"
#include "planner/lot/lot_planner.hpp"
#include "planner/motion/inertial_car.hpp"
#include "planner/problem/parking_lot.hpp"
// IWYU pragma: end_exports
