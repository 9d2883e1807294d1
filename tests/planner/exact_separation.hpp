#pragma once

#include "planner/problem/referee_geometry.hpp"

namespace mvtp::referee {

// The referee's separations by the separating axis theorem, written out: what FCL's are tested
// against.

[[nodiscard]] double exact_separation(const Box& a, const Box& b);
[[nodiscard]] double exact_separation(const Box& box, const Circle& circle);
[[nodiscard]] double exact_separation(const Box& box, const Point& a, const Point& b);

/// Distance of two rectangles [m]; 0 if they overlap.
[[nodiscard]] double exact_distance(const Box& a, const Box& b);

}  // namespace mvtp::referee
