#pragma once

#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "planner/problem/instance.hpp"

namespace mvtp {

/// What makes an instance unsolvable before anybody plans: starts or goals that overlap an obstacle
/// or each other, unless InitialOverlap::kAllow exempts them; then those that leave the map; then
/// paths of more steps than memory holds. Each problem reads "FILE: agents[3].goal: the footprint
/// at (12.00, 4.00) overlaps obstacles[7] by 0.21 m; move the goal or the obstacle". `file` stands
/// for the instance in the messages.
[[nodiscard]] std::vector<InputError> check_instance(const Instance& instance,
                                                     const std::string& file);

}  // namespace mvtp
