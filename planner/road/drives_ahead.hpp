#pragma once

#include "planner/road/road_scene.hpp"

namespace mvtp {

/// Is vehicle `a`, with its rear axle at `s` [m], ahead of `b` on the path of `b`, along it?
[[nodiscard]] bool drives_ahead(const RoadScene& scene, const RoadVehicle& a, double s,
                                const RoadVehicle& b);

}  // namespace mvtp
