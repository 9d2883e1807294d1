#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "tools/toio/cube/protocol.hpp"
#include "tools/toio/emulator/air.hpp"
#include "tools/toio/emulator/emulated_bluez.hpp"
#include "tools/toio/emulator/emulated_cube.hpp"
#include "tools/toio/emulator/emulated_signals.hpp"

namespace mvtp {

/// All emulated cubes on their desk: how they move, what befalls them, and their links.
class EmulatedCubes {
 public:
  static constexpr double kStep = 0.005;  ///< of the physics [s]

  /// @param signals  tell what happens to the cubes
  EmulatedCubes(const EmulatedWorld& world, const EmulatedSignals& signals);

  /// Lives for kStep.
  void step();
  /// So long they have lived [s].
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] WorldReport report() const;

  [[nodiscard]] std::vector<EmulatedCube>& all() { return cubes_; }
  [[nodiscard]] const std::vector<EmulatedCube>& all() const { return cubes_; }

  /// From now on cubes can be found.
  void scan() { scanning_since_ = time_; }
  void end_scan() { scanning_since_.reset(); }
  [[nodiscard]] bool scanning() const { return scanning_since_.has_value(); }

  /// @return false if this attempt fails
  bool connect(EmulatedCube& cube);
  /// Ends the link, if there is one.
  void drop(EmulatedCube& cube);
  /// Takes what is written to a cube, if it is not too long or to be lost.
  void take(EmulatedCube& cube, Characteristic to, Bytes bytes);

 private:
  void add_cube(std::size_t i);
  /// Lets a cube be found once a scan has gone on for a while, and its characteristics once it has
  /// been connected for a while.
  void show(EmulatedCube& cube);
  void befall(std::size_t i);
  /// Keeps how near the bodies have been to each other.
  void watch();

  EmulatedWorld world_;
  EmulatedSignals signals_;
  WorldDice dice_;
  std::vector<EmulatedCube> cubes_;
  double time_ = 0.0;
  std::optional<double> scanning_since_;
  double least_clearance_ = std::numeric_limits<double>::infinity();
};

}  // namespace mvtp
