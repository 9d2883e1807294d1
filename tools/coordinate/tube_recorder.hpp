#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "coordinator/junctions/coordinator.hpp"
#include "tools/view/replay_tubes.hpp"

namespace mvtp {

/// What the coordinator expects of human drivers who get their greens from it, for the replay page.
class TubeRecorder {
 public:
  /// @param coordinator  nullptr: nobody expects anything. It outlives the recorder.
  /// @param step_length  of the traffic [s]
  TubeRecorder(const Coordinator* coordinator, double step_length);

  /// The tube of a vehicle that is where `state` says, as of the last decision; nullopt if it is
  /// not a human driver near such a signal. Paths that are new become known to the replay.
  [[nodiscard]] std::optional<ReplayTube> tube_of(const VehicleState& state, ReplayTubes& tubes);

 private:
  [[nodiscard]] std::size_t path_in(ReplayTubes& tubes, int path);

  const Coordinator* coordinator_;
  std::vector<int> later_;            ///< ReplayTube::kLater in steps
  std::map<int, std::size_t> paths_;  ///< by number in the PathLibrary
  std::map<std::vector<int>, std::size_t> forks_;
};

}  // namespace mvtp
