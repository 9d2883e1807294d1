#pragma once

#include <span>

#include "planner/geometry.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// How the traffic itself moves a body: its front is on the line, and it points there from where
/// its rear would be on the line. In bends its tail sticks out behind.
[[nodiscard]] ReferencePath drivers_path(std::span<const Point> line, const Vehicle& body);

}  // namespace mvtp
