#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/view/replay.hpp"

namespace mvtp {

// What the header of a replay says; `where` names the file in messages.
// @throws InputError if it lacks something.
[[nodiscard]] std::vector<ReplayVehicle> vehicles_of(const Replay& replay,
                                                     const std::string& where);
[[nodiscard]] ReplayScene scene_of(const Replay& replay, const std::string& where);

/// What the frames of a replay say: the inverse of ReplayRecorder, but for tubes.
struct ReplayFrames {
  ReplayMotion motion = ReplayMotion::kContinuous;
  std::vector<double> times;  ///< [s]
  /// For each of them the vehicles that are there, in the order of the tracks.
  std::vector<std::vector<ReplayVehicleState>> states;
};
/// @throws InputError if the frames are damaged.
[[nodiscard]] ReplayFrames frames_of(const Replay& replay, const std::string& where);

/// A signal and what it shows from when on [s]: a letter for each of its lights.
struct ReplaySignal {
  std::string id;
  std::vector<std::pair<double, std::string>> shown;
};
/// @throws InputError if the header lacks something.
[[nodiscard]] std::vector<ReplaySignal> signals_of(const Replay& replay, const std::string& where);

/// What each signal shows at a moment, a letter for each light; empty before it is known.
/// @throws InputError if the header lacks something.
[[nodiscard]] std::vector<std::string> lights_at(const Replay& replay, double time,
                                                 const std::string& where);

/// Everybody at one moment, between two frames along the arc that joins them. A vehicle is there
/// from its first frame to its last one.
[[nodiscard]] std::vector<ReplayVehicleState> states_at(const ReplayFrames& frames, double time);

}  // namespace mvtp
