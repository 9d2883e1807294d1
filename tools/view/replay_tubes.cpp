#include "tools/view/replay_tubes.hpp"

#include <cmath>

#include "tools/view/replay.hpp"

namespace mvtp {

std::size_t ReplayTubes::add_path(std::vector<Point> path) {
  paths_.push_back(std::move(path));
  return paths_.size() - 1;
}

std::size_t ReplayTubes::add_fork(std::vector<std::size_t> paths) {
  forks_.push_back(std::move(paths));
  return forks_.size() - 1;
}

std::int64_t ReplayTubes::code_of(const std::optional<ReplayTube>& tube) {
  if (!tube) return 0;
  return 1 + 2 * static_cast<std::int64_t>(tube->fork) + (tube->passes ? 1 : 0);
}

void ReplayTubes::push(std::size_t track, std::int64_t time,
                       const std::optional<ReplayTube>& tube) {
  constexpr double kTolerance = 1e-6;  // of a unit
  if (track >= tracks_.size()) tracks_.resize(track + 1);
  Track& t = tracks_[track];
  const std::int64_t code = code_of(tube);
  const bool changes = t.runs.empty() || t.runs.back().second != code;
  if (changes) t.runs.emplace_back(0, code);
  ++t.runs.back().first;
  if (!tube || (!changes && (!tube->passes || time - t.kept < ReplayTube::kEvery))) return;
  any_ = true;
  t.kept = time;
  auto& reaches = t.reaches.emplace_back();
  for (std::size_t h = 0; h < tube->reaches.size(); ++h) {
    const auto& [least, most] = tube->reaches[h];
    reaches[2 * h] = std::llround(std::floor(least / ReplayTube::kUnits[h] + kTolerance));
    const double units = most / ReplayTube::kUnits[h];
    reaches[2 * h + 1] = std::llround(tube->passes ? std::ceil(units - kTolerance)
                                                   : std::floor(units + kTolerance));
  }
}

std::string ReplayTubes::bytes(std::size_t tracks) const {
  ReplayColumn counts;
  ReplayColumn lengths;
  ReplayColumn codes;
  std::array<ReplayColumn, 2 * ReplayTube::kLater.size()> reaches;
  for (std::size_t i = 0; i < tracks; ++i) {
    const Track track = i < tracks_.size() ? tracks_[i] : Track{};
    counts.push(static_cast<std::int64_t>(track.runs.size()));
    for (const auto& [length, code] : track.runs) {
      lengths.push(length);
      codes.push(code);
    }
    for (const auto& kept : track.reaches) {
      for (std::size_t c = 0; c < kept.size(); ++c) reaches[c].push(kept[c]);
    }
  }
  std::string bytes = counts.bytes() + lengths.bytes() + codes.bytes();
  for (const ReplayColumn& column : reaches) bytes += column.bytes();
  return bytes;
}

}  // namespace mvtp
