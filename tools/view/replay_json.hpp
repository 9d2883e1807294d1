#pragma once

#include <nlohmann/json.hpp>

#include "tools/view/replay.hpp"

namespace mvtp {

/// What the header of a replay is written as.
using ReplayJson = nlohmann::ordered_json;

[[nodiscard]] ReplayJson to_json(const ReplayScene& scene);
[[nodiscard]] ReplayJson to_json(const ReplayVehicle& vehicle);
/// What is the same for all tubes: their times, units, paths and forks.
[[nodiscard]] ReplayJson to_json(const ReplayTubes& tubes);
/// @param end  of what began at event.time [s]
[[nodiscard]] ReplayJson to_json(const ReplayEvent& event, double end);

/// The name of a kind of lane in the header; empty for one that is open to cars.
[[nodiscard]] const char* name_of(ReplayLaneKind kind);

}  // namespace mvtp
