#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planner/problem/pose.hpp"

namespace mvtp {

/// Where a human driver may be some seconds later: between the slowest and the quickest motion that
/// those under control reckon with.
struct ReplayTube {
  static constexpr std::array<double, 2> kLater = {2.0, 4.0};  ///< [s]
  /// [m] of `Reach` then; kept ones are rounded outwards, but not over a line.
  static constexpr std::array<double, 2> kUnits = {1.0, 2.0};
  static constexpr std::int64_t kEvery = 1000;  ///< [ms] between two that are kept

  /// How far his rear axle may have come by then [m].
  struct Reach {
    double least = 0.0;
    double most = 0.0;
  };
  std::size_t fork = 0;  ///< index returned by ReplayTubes::add_fork
  bool passes = false;   ///< he has green, or is inside; else he stays before his line
  std::array<Reach, kLater.size()> reaches{};  ///< along each path of the fork
};

/// The tubes of a replay, packed.
///
/// One is kept where there was none, where its fork or `passes` changes, and then every second if he
/// passes; the line of one who waits stays where it is.
class ReplayTubes {
 public:
  /// Makes a path of the rear axle known and returns its index.
  std::size_t add_path(std::vector<Point> path);
  /// Makes the paths known that a driver may take, by their indices, one if it is known where he
  /// turns; returns the index of the fork.
  std::size_t add_fork(std::vector<std::size_t> paths);

  /// The next frame of a track, `time` [ms] after the run's zero.
  void push(std::size_t track, std::int64_t time, const std::optional<ReplayTube>& tube);

  [[nodiscard]] bool empty() const { return !any_; }
  [[nodiscard]] const std::vector<std::vector<Point>>& paths() const { return paths_; }
  [[nodiscard]] const std::vector<std::vector<std::size_t>>& forks() const { return forks_; }
  /// The packed columns (replay.cpp says which) of so many tracks.
  [[nodiscard]] std::string bytes(std::size_t tracks) const;

  /// 0 for none, else 1 + 2 * fork + (does he pass?).
  [[nodiscard]] static std::int64_t code_of(const std::optional<ReplayTube>& tube);

 private:
  struct Track {
    std::vector<std::pair<std::int64_t, std::int64_t>> runs;  ///< how many frames, code
    std::int64_t kept = 0;                                    ///< [ms] the last one
    /// In units, least and most.
    std::vector<std::array<std::int64_t, 2 * ReplayTube::kLater.size()>> reaches;
  };
  std::vector<std::vector<Point>> paths_;
  std::vector<std::vector<std::size_t>> forks_;
  std::vector<Track> tracks_;
  bool any_ = false;
};

}  // namespace mvtp
