#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/toio/emulator/air.hpp"
#include "tools/toio/emulator/cube_model.hpp"
#include "tools/toio/plan/run_file.hpp"

namespace mvtp {

/// Something that befalls one cube, so many seconds after it was first told to move.
struct Mishap {
  std::size_t cube = 0;
  double after = 0.0;
  std::optional<double> lasts;  ///< [s]; none: for ever, if it is of the kind that lasts
};

/// The world of the emulator, and what goes wrong in it.
struct EmulatedWorld {
  Mat mat;
  Cube cube;
  std::vector<Pose> starts;       ///< of the cubes' axles on the desk, with their own headings
  AirQuality air;                 ///< each way
  int mtu = 247;                  ///< longer writes are dropped, as a cube does
  int connect_failures = 0;       ///< of each cube, before it can be connected
  int lost_settings = 0;          ///< of each cube: so many first ones, and then so many answers
  bool adapter = true;            ///< is there one?
  int battery = 90;               ///< of the cubes [%]
  std::string version = "2.4.0";  ///< of their protocol
  double stalls_per_minute = 0.0;
  double shortest_stall = 1.0;
  double longest_stall = 5.0;
  std::optional<Mishap> disconnect;
  std::optional<Mishap> press;
  std::optional<Mishap> bump;
  std::uint64_t seed = 0;
};

/// How the cubes are, and what has happened to them.
struct WorldReport {
  struct OfCube {
    std::string name;
    double wheel_speed = 0.0;  ///< of the faster wheel [m/s]
    std::string last_motor;    ///< the last command to the motors, in hexadecimal
    int writes = 0;
    int dropped = 0;  ///< longer than the MTU allows
    MatPose place;
  };
  double least_clearance = 0.0;  ///< of the bodies, since the start [m]
  bool touched = false;
  std::vector<OfCube> cubes;
};

/// Serves `org.bluez` with emulated cubes on a private bus, so that the code that drives real cubes
/// is tested as it ships: an adapter that finds, connects and forgets devices, their GATT
/// characteristics, notifications and writes. The cubes live in real time.
class EmulatedBluez {
 public:
  /// On the bus that the environment names as the system's.
  /// @throws BluetoothError if it cannot be reached, or has an org.bluez already.
  explicit EmulatedBluez(const EmulatedWorld& world);
  EmulatedBluez(const EmulatedBluez&) = delete;
  EmulatedBluez& operator=(const EmulatedBluez&) = delete;
  ~EmulatedBluez();

  /// Serves and lives for so long [s].
  void live(double seconds);
  [[nodiscard]] WorldReport report() const;

 private:
  class Service;
  std::unique_ptr<Service> service_;
};

}  // namespace mvtp
