#pragma once

#include <string>

#include "tools/export/recording.hpp"

namespace mvtp {

// The recording as text in a format of other tools; docs/file-formats.md has the details.

/// t, id, x, y, yaw, v, steer, in the order of time.
[[nodiscard]] std::string to_csv(const Recording& recording);

/// SUMO's floating car data.
[[nodiscard]] std::string to_fcd(const Recording& recording);

/// A CommonRoad scenario, version 2020a.
/// @param ego  vehicle that becomes the planning problem and is no obstacle; empty: all are
///   obstacles, and the planning problem repeats the first one, as there must be one
/// @throws InputError if there is no such vehicle
[[nodiscard]] std::string to_commonroad(Recording recording, const std::string& ego);

/// An OpenSCENARIO 1.2 scenario in which every vehicle follows its trajectory.
/// @param road_file  OpenDRIVE file of the road network; empty: none
[[nodiscard]] std::string to_openscenario(Recording recording, const std::string& road_file);

}  // namespace mvtp
