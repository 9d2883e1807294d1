#pragma once

#include <cstdint>
#include <string>

#include "planner/problem/instance.hpp"
#include "tools/generate/suite.hpp"

namespace mvtp {

struct GenerateOptions {
  std::string vehicle = "escot";  ///< a preset
  Bounds bounds = Bounds::kAxle;  ///< written into the instance; bodies never start or end outside
  std::uint64_t seed = 0;
};

struct GeneratedInstance {
  Instance instance;
  std::string description;  ///< suite, seed, number, and how far apart the robots stand
};

/// Instance number `index` of a cell: the same for the same options, whatever else is generated.
///
/// Coordinates are whole millimetres, headings whole 1e-4 rad. Starts keep their distance from
/// starts and goals from goals: reference points at least sqrt(20) m (the rule of the public sets)
/// and bodies 0.5 m apart where that fits, else the bodies only. Bodies keep 0.5 m from obstacles
/// and lie inside the map. A start may lie on another robot's goal. Each robot has a motion to its
/// goal if the others are absent: robots_without_single_agent_path(). In Layout::kCircle number 0
/// is exact, the others are shifted by up to 1 m and turned by up to 0.2 rad.
/// @throws InputError if so many robots do not fit, or too many of them find no path.
[[nodiscard]] GeneratedInstance generate_instance(const Cell& cell, const GenerateOptions& options,
                                                  int index);

}  // namespace mvtp
