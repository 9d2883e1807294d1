#pragma once

#include <cstddef>
#include <string>

#include "tools/export/recording.hpp"

namespace mvtp {

// The recording as text in a format of other tools; docs/file-formats.md has the details.

/// t, id, x, y, yaw, v, steer, in the order of time.
[[nodiscard]] std::string to_csv(const Recording& recording);

/// SUMO's floating car data.
[[nodiscard]] std::string to_fcd(const Recording& recording);

struct CommonRoadRequest {
  std::string ego;  ///< becomes the planning problem and is no obstacle; empty: all are obstacles,
                    ///< and the planning problem repeats the first one, as there must be one
  bool obstacle_start_at_zero = false;  ///< leave out who enters after time step 0
};

/// A CommonRoad scenario, version 2020a. Its schema wants every obstacle to be there at time step
/// 0.
struct CommonRoadScenario {
  std::string text;
  std::size_t obstacles = 0;
  std::size_t late = 0;  ///< of them, enter after time step 0
};

/// @throws InputError if there is no such ego vehicle
[[nodiscard]] CommonRoadScenario to_commonroad(Recording recording,
                                               const CommonRoadRequest& request);

/// An OpenSCENARIO 1.2 scenario in which every vehicle follows its trajectory.
/// @param road_file  OpenDRIVE file of the road network; empty: none
[[nodiscard]] std::string to_openscenario(Recording recording, const std::string& road_file);

}  // namespace mvtp
