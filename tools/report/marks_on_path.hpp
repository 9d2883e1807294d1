#pragma once

#include <span>
#include <vector>

#include "planner/geometry.hpp"
#include "tools/report/time_space.hpp"
#include "tools/view/read_replay.hpp"

namespace mvtp {

// What of the road lies on the path of a movement: stations, ascending [m].

/// Where lanes in its direction end at a junction.
[[nodiscard]] std::vector<double> stop_lines_on(const ReferencePath& path,
                                                const ReplayScene& scene);

/// Where it is inside a junction.
[[nodiscard]] std::vector<Stretch> junctions_on(const ReferencePath& path,
                                                const ReplayScene& scene);

/// From the takeover to the hand-back, of the corridors that lie on it; those that meet are one.
[[nodiscard]] std::vector<Stretch> zones_on(const ReferencePath& path,
                                            std::span<const ReplayCorridor> corridors);

/// The lights for those who go on along the path, and what they show in that time.
[[nodiscard]] std::vector<TimeSpaceSignal> signals_on(const ReferencePath& path,
                                                      const ReplayScene& scene,
                                                      std::span<const ReplaySignal> signals,
                                                      Stretch time);

}  // namespace mvtp
