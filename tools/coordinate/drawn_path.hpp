#pragma once

#include <vector>

#include "planner/geometry.hpp"

namespace mvtp {

/// The path from one station to another [m] with the samples that show how it bends.
[[nodiscard]] std::vector<Point> drawn_path(const ReferencePath& path, double from, double to);

}  // namespace mvtp
