#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

#include "planner/geometry/arc.hpp"

namespace mvtp {

/// A path of at most five arcs, none of them empty.
struct ReedsSheppPath {
  std::array<Arc, 5> arcs;
  int count = 0;

  [[nodiscard]] const Arc* begin() const { return arcs.data(); }
  [[nodiscard]] const Arc* end() const { return arcs.data() + count; }
  [[nodiscard]] double length() const;
};

/// The shortest path of a car without obstacles that drives forwards and in reverse; empty if
/// from == to. It ends at `to` within 1e-9 radii for distances up to some hundred of them.
///
/// Source: Reeds & Shepp 1990, eqs. (8.1) to (8.11). @pre radius > 0 [m], the smallest turning
/// radius.
[[nodiscard]] ReedsSheppPath reeds_shepp_path(const Pose& from, const Pose& to, double radius);

/// Length of that path [m].
[[nodiscard]] double reeds_shepp_length(const Pose& from, const Pose& to, double radius);

/// The same with paths as vectors.
class ReedsShepp {
 public:
  [[nodiscard]] double length(const Pose& from, const Pose& to, double radius) const {
    return reeds_shepp_length(from, to, radius);
  }
  [[nodiscard]] std::vector<Arc> path(const Pose& from, const Pose& to, double radius) const {
    const ReedsSheppPath path = reeds_shepp_path(from, to, radius);
    return {path.begin(), path.end()};
  }
};

/// Lengths of Reeds-Shepp paths over relative poses, by interpolation: some ten nanoseconds each.
///
/// For the heuristics of searches: about right (mean error 0.01, largest 0.4 radii) but no bound.
/// Entries are computed when first asked for, by whichever thread asks.
class ReedsSheppTable {
 public:
  ReedsSheppTable();

  /// The one table of the process.
  [[nodiscard]] static const ReedsSheppTable& shared();

  /// Length of the path between the origin and (x, y, theta) for radius 1, either way.
  [[nodiscard]] double length(double x, double y, double theta) const;

 private:
  [[nodiscard]] float inside(float x, float y, float theta) const;

  [[nodiscard]] float entry(std::size_t index) const;
  [[nodiscard]] float compute(std::size_t index) const;

  mutable std::vector<std::atomic<float>> lengths_;  ///< negative: not computed yet
};

}  // namespace mvtp
