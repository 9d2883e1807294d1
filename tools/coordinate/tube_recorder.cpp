#include "tools/coordinate/tube_recorder.hpp"

#include <cmath>

#include "coordinator/drivers/human_drivers.hpp"
#include "tools/coordinate/drawn_path.hpp"

namespace mvtp {

TubeRecorder::TubeRecorder(const Coordinator* coordinator, double step_length)
    : coordinator_(coordinator) {
  for (const double seconds : ReplayTube::kLater) {
    later_.push_back(int(std::lround(seconds / step_length)));
  }
}

std::size_t TubeRecorder::path_in(ReplayTubes& tubes, int path) {
  const auto [known, is_new] = paths_.try_emplace(path);
  if (is_new) {
    const ReferencePath& p = coordinator_->corridors().library().path(path);
    known->second = tubes.add_path(drawn_path(p, 0.0, p.length()));
  }
  return known->second;
}

std::optional<ReplayTube> TubeRecorder::tube_of(const VehicleState& state, ReplayTubes& tubes) {
  if (coordinator_ == nullptr || coordinator_->humans() == nullptr) return std::nullopt;
  const auto ground =
      coordinator_->humans()->ground_of(state.id, state.pose, coordinator_->steps(), later_);
  if (!ground) return std::nullopt;
  const auto [fork, is_new] = forks_.try_emplace(ground->paths);
  if (is_new) {
    std::vector<std::size_t> paths;
    for (const int path : ground->paths) paths.push_back(path_in(tubes, path));
    fork->second = tubes.add_fork(std::move(paths));
  }
  ReplayTube tube{.fork = fork->second, .passes = ground->passes};
  for (std::size_t i = 0; i < tube.reaches.size(); ++i) {
    tube.reaches[i] = {ground->reaches[i].least, ground->reaches[i].most};
  }
  return tube;
}

}  // namespace mvtp
