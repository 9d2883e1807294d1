#pragma once

#include <span>

#include "planner/geometry.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// How the traffic itself moves a body: its front is on the line, and it points there from where
/// its rear would be on the line. In bends its tail sticks out behind. Along the path s is what the
/// front has covered of the line, beyond the length of the body: that is what drivers' speeds are.
[[nodiscard]] ReferencePath drivers_path(std::span<const Point> line, const Vehicle& body);

}  // namespace mvtp
