#pragma once

/// @file
/// Roads: at which speed does each vehicle drive along its path, so that nobody touches anybody and
/// everybody gets to the end?
///
/// What a caller does, in this order:
/// 1. PathLibrary::add() for each path and body: a ReferencePath for the rear axle, with no bend
///    tighter than the body can turn. It gives the number by which vehicles name their path.
/// 2. A RoadScene for this moment: a RoadVehicle for each vehicle under control (where it is, its
///    SpeedEnvelope, where its plan may end) and a Forecast for each other one.
/// 3. PathLibrary::build_tables() for the paths of the scene: where the bodies meet. Planning
///    looks up these tables, and tests no two bodies any more.
/// 4. decide_on_road() with the complete plans so far, and the keys of those who have none, in
///    their order of priority: it gives a SpeedProfile for each vehicle.
/// 5. For the steps of one decision, SpeedProfile::at() says where each vehicle is on its path, and
///    ReferencePath::at() with which pose. Then again from 2. Where somebody appears before the
///    next decision, who_must_brake() and stop_after() say what to do until then.
///
/// Beside these: RoadContact (may two vehicles touch?), ContactTable (at which positions?), and
/// arrival_step(), drives_ahead() and drivers_gap() for those who read plans and forecasts.
///
/// - Units: metres, seconds, radians, m/s, m/s^2.
/// - Frame: poses and paths are in the world's; positions `s` are those of the rear axle from the
///   begin of its own path, and no vehicle reverses. Time is counted in steps of DecisionGrid::dt,
///   the same for all.
/// - Shapes: RoadScene::vehicles are ordered by key, each key once; a SpeedEnvelope has one limit
///   per ReferencePath::kSpacing of its path; a SpeedProfile has one state per step.
/// - Laws: after each decision "everyone brakes now" is free of contact, at every moment, if it was
///   when the vehicles came. A complete plan that still fits the forecasts is replaced only by one
///   that is complete and costs no more. The same arguments give the same plan with any number of
///   threads, unless a GroupBudget runs out.
/// - Errors: nothing throws, but for want of memory. A vehicle for which no complete plan was found
///   gets a profile that ends in braking (SpeedProfile::complete is false, RoadDecision::stepped
///   counts them); groups that took too long are named in RoadDecision::late.
/// - Threads: no two may change one PathLibrary at once; decide_on_road() starts its own.
/// - Sources: the ESCoT paper, Alg. 1 and 2; Dresner and Stone 2008 for Reservation. Which line of
///   the paper is which function: planner/road/README.md.

// IWYU pragma: begin_exports
#include "planner/geometry.hpp"
#include "planner/motion/inertial_car.hpp"
#include "planner/road/contact_table.hpp"
#include "planner/road/crossing.hpp"
#include "planner/road/emergency_braking.hpp"
#include "planner/road/path_library.hpp"
#include "planner/road/profile_planner.hpp"
#include "planner/road/reservation.hpp"
#include "planner/road/road_contact.hpp"
#include "planner/road/road_escot.hpp"
#include "planner/road/road_scene.hpp"
// IWYU pragma: end_exports
