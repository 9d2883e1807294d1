#pragma once

#include <string>
#include <vector>

#include "tools/view/replay.hpp"

namespace mvtp {

// What the header of a replay says; `where` names the file in messages.
// @throws InputError if it lacks something.
[[nodiscard]] std::vector<ReplayVehicle> vehicles_of(const Replay& replay,
                                                     const std::string& where);
[[nodiscard]] ReplayScene scene_of(const Replay& replay, const std::string& where);

}  // namespace mvtp
