#pragma once

#include <map>
#include <tuple>

#include "coordinator/network/lane_graph.hpp"
#include "planner/road.hpp"

namespace mvtp {

/// The paths of people over crossings, as paths for the planner: one per crossing and direction,
/// from a few metres before the kerb to a few metres behind the other one. Stations count from the
/// beginning of a path [m].
class CrossingPaths {
 public:
  /// How much of the ground a person needs: the whole width of the crossing, with room before and
  /// behind him, while he walks on it; less of the width, on the side where he is, where he walks
  /// around those who stand on its edge; no room before the kerb at which he may stop; and only his
  /// own place where he stands.
  enum class Room { kWalks, kSqueezes, kComes, kStands };

  /// Where the path of a crossing meets the first kerb: a sample, so that who stands there is.
  static constexpr double kKerb = 4.0;

  /// @param graph, library  must outlive it.
  CrossingPaths(const LaneGraph& graph, PathLibrary& library) : graph_(graph), library_(library) {}

  /// A point by the path of a crossing: how far along, and how far to its left [m]. Before the
  /// crossing `s` is the kerb's less the shortest path there; negative: not on the path yet.
  struct Place {
    double s = 0.0;
    double aside = 0.0;
  };
  [[nodiscard]] Place place(int crossing, bool forward, bool is_on_it, const Point& p);
  /// Which path somebody before the crossing will go over it: from the nearer kerb.
  [[nodiscard]] bool starts_forward(int crossing, const Point& p) const;
  /// Which path somebody on the crossing goes who walks in this direction [rad].
  [[nodiscard]] bool heads_forward(int crossing, double theta) const;

  /// The number of the path in the library.
  /// @param aside  to its left [m]; of Room::kStands and kSqueezes only.
  [[nodiscard]] int path(int crossing, bool forward, Room room, double aside = 0.0);
  /// The stations of the other kerb and of the path's end [m].
  [[nodiscard]] double other_kerb(int crossing) const {
    return kKerb + graph_.crossing(crossing).length;
  }
  [[nodiscard]] double end(int crossing, bool forward);

 private:
  [[nodiscard]] ReferencePath line(int crossing, bool forward, double aside) const;

  const LaneGraph& graph_;
  PathLibrary& library_;
  std::map<std::tuple<int, bool, Room, int>, int> paths_;  ///< the last: in steps aside
};

}  // namespace mvtp
