#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "planner/motion/obstacles.hpp"

namespace mvtp {

/// The obstacles that one car overlaps where it starts or where it is to end, and may: from its
/// start until it is apart from them, from its last approach on to its goal, and never more deeply
/// than there.
///
/// Judged arc by arc, without memory: an arc may overlap what its first pose overlaps already, if
/// that is the start's, or what its last pose still overlaps, if that is the goal's. So nobody
/// comes back into the one, or leaves the other.
class Exemptions {
 public:
  Exemptions() = default;  ///< none
  /// @param obstacles  of `map`
  Exemptions(const Vehicle& vehicle, const Map& map, const Obstacles& obstacles, const Pose& start,
             const Pose& goal);

  [[nodiscard]] bool empty() const { return exempt_.empty(); }

  /// May the car drive the arc, which hits an obstacle? Not if it hits any that is not exempt.
  /// @param obstacles  those of the constructor
  [[nodiscard]] bool allow(const Obstacles& obstacles, const Sweep& sweep, const Pose& from,
                           const Arc& arc) const;

 private:
  /// What the car may not hit even so: a smaller obstacle, or the obstacle with a smaller body.
  struct Core {
    std::shared_ptr<const Obstacles> obstacle;
    Vehicle body;
  };
  struct Exempt {
    std::shared_ptr<const Obstacles> obstacle;  ///< it alone
    std::optional<Core> at_start;
    std::optional<Core> at_goal;
  };

  void add(const Map& map, const std::vector<int>& hit, const Pose& pose,
           std::optional<Core> Exempt::*place);
  [[nodiscard]] Core core(const Map& map, int obstacle, const Pose& pose) const;
  [[nodiscard]] bool allow(const Exempt& exempt, const Pose& from, const Arc& arc) const;

  Vehicle vehicle_;
  std::vector<int> numbers_;    ///< of the exempt obstacles
  std::vector<Exempt> exempt_;  ///< in the same order
};

}  // namespace mvtp
