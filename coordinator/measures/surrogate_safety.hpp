#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/audit/audit.hpp"
#include "coordinator/network/road_network.hpp"
#include "planner/geometry.hpp"

namespace mvtp {

/// A surrogate measure of safety over a run.
struct ConflictFigures {
  static constexpr double kBin = 0.5;  ///< [s]

  double least = std::numeric_limits<double>::infinity();  ///< [s]
  std::int64_t below_1s = 0;                               ///< pairs of vehicles
  std::int64_t pairs = 0;                                  ///< that had such a time at all
  /// The distribution: pairs whose least time is from i to i + 1 bins, up to
  /// SurrogateSafety::kMost.
  std::array<std::int64_t, 10> counts{};
};

/// When two boxes that go on evenly, without turning, begin to overlap [s]; 0 if they do now,
/// nullopt if never.
/// @param velocity_a, velocity_b  [m/s]
[[nodiscard]] std::optional<double> time_to_collision(const OrientedBox& a, const Point& velocity_a,
                                                      const OrientedBox& b,
                                                      const Point& velocity_b);

/// Post-encroachment time and time to collision of all vehicles, from true footprints.
///
/// PET: on the ground of junctions, in cells of kCell: from when one vehicle has left a cell until
/// another, which comes from another direction (its heading differs by more than 30 degrees), is on
/// it, exact to a step of the traffic. TTC: both go on as they do now; looked at every kLook.
class SurrogateSafety {
 public:
  static constexpr double kCell = 0.5;   ///< [m]
  static constexpr double kLook = 0.5;   ///< [s] between two looks at times to collision
  static constexpr double kLimit = 1.0;  ///< [s] below which a pair is counted
  static constexpr double kMost = 5.0;   ///< [s] longer times are no encounters

  /// @param step_length  of the traffic [s]
  SurrogateSafety(const RoadNetwork& network, double step_length);

  /// After each step of the traffic.
  void observe(double time, std::span<const Observation> vehicles);

  [[nodiscard]] const ConflictFigures& post_encroachment() const { return pet_; }
  [[nodiscard]] const ConflictFigures& to_collision() const { return ttc_; }

 private:
  using Cell = std::pair<int, int>;
  using Pair = std::pair<std::string, std::string>;
  struct Occupant {
    std::string id;
    double theta = 0.0;  ///< [rad]
    double until = 0.0;  ///< [s] last seen there
  };

  [[nodiscard]] bool is_on_junction(const Pose& pose) const;
  void occupy(double time, const Observation& vehicle);
  void encounter(double time, const Occupant& before, const Observation& vehicle);
  void look_ahead(std::span<const Observation> vehicles);
  static void note(double seconds, const Pair& pair, std::map<Pair, double>& known,
                   ConflictFigures& figures);

  struct Bounds {
    double x_low, x_high, y_low, y_high;
  };
  double step_length_;
  std::vector<Bounds> junctions_;
  std::map<Cell, Occupant> occupants_;
  std::map<Pair, double> least_pet_;
  std::map<Pair, double> least_ttc_;
  ConflictFigures pet_;
  ConflictFigures ttc_;
  double next_look_ = -1e300;  ///< [s]
};

}  // namespace mvtp
