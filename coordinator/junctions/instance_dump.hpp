#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/network/drivable_area.hpp"
#include "planner/problem/instance.hpp"

namespace mvtp {

/// The vehicles under control as of the last decision as one instance of multi-vehicle trajectory
/// planning. Starts are where they are at that decision. Goals are where their plans are complete,
/// or as far before that on their own paths as keeps them clear of each other. The obstacles are
/// the ground off the road, in rectangles; no path in use touches them. The map is the box around
/// all paths, its lower left corner at (0, 0).
/// @param dt  duration of a step [s]
/// @pre at least one vehicle is under control
[[nodiscard]] Instance instance_of(const Coordinator& coordinator, const DrivableArea& area,
                                   double dt);

struct InstanceDumpOptions {
  std::string folder;  ///< exists
  int every = 20;      ///< of the decisions with at least two vehicles, every so many
  std::string origin;  ///< scenario and seed, for the files' descriptions
  double dt = 0.1;     ///< [s] duration of a step
};

/// Writes decisions on roads as instance files, named by their time: t000123.50.yaml.
class InstanceDump {
 public:
  /// Both outlive the object.
  InstanceDump(const Coordinator& coordinator, const DrivableArea& area,
               InstanceDumpOptions options)
      : coordinator_(coordinator), area_(area), options_(std::move(options)) {}

  /// After a step of the traffic: writes the decision before it if there was one, and it is due.
  /// @throws InputError if the file cannot be written.
  void observe();

 private:
  const Coordinator& coordinator_;
  const DrivableArea& area_;
  InstanceDumpOptions options_;
  std::size_t replans_ = 0;  ///< seen
  int counted_ = 0;          ///< decisions with at least two vehicles since the last file
};

}  // namespace mvtp
