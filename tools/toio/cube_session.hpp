#pragma once

#include <string>
#include <vector>

#include "tools/toio/bluetooth.hpp"

namespace mvtp {

/// Connected cubes, ready to drive; stopped and let go when this ends, whatever the reason.
class CubeSession {
 public:
  explicit CubeSession(Bluetooth& bluetooth) : bluetooth_(bluetooth) {}
  CubeSession(const CubeSession&) = delete;
  CubeSession& operator=(const CubeSession&) = delete;
  ~CubeSession();

  /// Connects a cube, and asks it for positions all the time.
  /// @throws BluetoothError if it cannot be connected, its firmware is too old or its battery low.
  void add(const FoundCube& cube);

  [[nodiscard]] const std::vector<FoundCube>& cubes() const { return cubes_; }
  [[nodiscard]] Bluetooth& bluetooth() const { return bluetooth_; }

 private:
  /// Tells every cube to stop, twice, and waits until it is sent.
  void stop_all();

  Bluetooth& bluetooth_;
  std::vector<FoundCube> cubes_;
};

/// The cubes that answer, until there are `count`; those named are waited for.
/// @throws BluetoothError that says how many or which are missing.
[[nodiscard]] std::vector<FoundCube> find_cubes(Bluetooth& bluetooth, std::size_t count,
                                                const std::vector<std::string>& named,
                                                double seconds);

/// Is the cube called so, by address or name, whole or its last three signs?
[[nodiscard]] bool is_called(const FoundCube& cube, const std::string& name);

}  // namespace mvtp
