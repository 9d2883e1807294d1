#pragma once

#include <string>
#include <vector>

#include "planner/problem/pose.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

struct Agent {
  std::string name;
  Vehicle vehicle;
  Pose start;
  Pose goal;
};

struct Circle {
  double x = 0.0;
  double y = 0.0;
  double radius = 0.8;
};

/// A solid simple polygon, either orientation, not closed (the last point differs from the first).
using Polygon = std::vector<Point>;

/// What must stay inside the map: the rear-axle centre (the peers' rule) or the whole body.
enum class Bounds { kAxle, kFootprint };

/// The workspace: the rectangle [0, width] x [0, height] minus the obstacles [m].
struct Map {
  double width = 0.0;
  double height = 0.0;
  std::vector<Circle> circles;
  std::vector<Polygon> polygons;
  Bounds bounds = Bounds::kFootprint;
};

/// How robots may not touch: along the whole motion, or only at whole steps (the peers' rule).
enum class CollisionRule { kContinuous, kSteps };

/// What of an agent that overlaps an obstacle or another agent where it starts or ends: bad input,
/// or exempt from the collision rule there (see OverlappingPlace).
enum class InitialOverlap { kRefuse, kAllow };

/// One MVTP instance: the tuple <R, W, O, S, G, ...> of the ESCoT paper, Sec. II.
struct Instance {
  std::vector<Agent> agents;
  Map map;
  double dt = 1.0;  ///< duration of one step [s]
  InitialOverlap initial_overlap = InitialOverlap::kRefuse;
};

}  // namespace mvtp
