#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/toio/cube/protocol.hpp"

namespace mvtp {

/// What the radio, or whoever runs it, does not do; one line with a remedy.
class BluetoothError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user wants to stop.
class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// A cube that answers a scan. `path` is its name on the bus, and for this class.
struct FoundCube {
  std::string path;
  std::string address;  ///< "CA:B3:00:00:00:01"
  std::string name;     ///< "toio-A1b"
  int rssi = 0;         ///< [dBm]; 0: unknown
};

/// Cubes over Bluetooth: a client of BlueZ on the D-Bus system bus, through systemd's sd-bus.
///
/// One thread and no callbacks from elsewhere: everything happens inside the calls, and
/// notifications are handed on while one of them waits. Sources: BlueZ 5.66, doc/adapter-api.txt,
/// device-api.txt, gatt-api.txt.
class Bluetooth {
 public:
  /// @param interrupted is asked while anything waits; true ends that with Interrupted.
  /// @throws BluetoothError if there is no bus, no BlueZ or no adapter.
  explicit Bluetooth(std::function<bool()> interrupted);
  Bluetooth(const Bluetooth&) = delete;
  Bluetooth& operator=(const Bluetooth&) = delete;
  ~Bluetooth();

  /// Called for whatever a subscribed characteristic of a connected cube notifies.
  void on_notification(std::function<void(const std::string& path, const Notification&)> handler);

  /// Looks for cubes until `enough` says so, at most so long [s]; sorted by address.
  [[nodiscard]] std::vector<FoundCube> scan(
      double seconds, const std::function<bool(const std::vector<FoundCube>&)>& enough);

  /// Connects, and finds the cube's characteristics. Tries three times: adapters abort the first
  /// attempt now and then ("le-connection-abort-by-local").
  void connect(const std::string& path);
  /// connect() for those who cannot wait: begins, and says whether it is done. To be called again
  /// until it is; tries as often as it takes.
  [[nodiscard]] bool connect_meanwhile(const std::string& path);
  void disconnect(const std::string& path);
  [[nodiscard]] bool connected(const std::string& path) const;
  /// Bytes of a packet on this link, three of which are not a write's; 23 if BlueZ does not say.
  [[nodiscard]] int mtu(const std::string& path) const;

  void subscribe(const std::string& path, Characteristic characteristic);
  [[nodiscard]] Bytes read(const std::string& path, Characteristic characteristic);
  /// Waits until BlueZ has taken it, and the cube if the characteristic answers writes.
  /// @throws BluetoothError if either does not, or the link is lost.
  void write(const std::string& path, const Write& write);
  /// Does not wait, and nobody says whether it arrived: for commands that follow each other fast.
  void write_now(const std::string& path, const Write& write);

  /// Handles what comes in for so long [s].
  void wait(double seconds);
  /// The same until `condition` is true. @return whether it is.
  bool wait_until(double seconds, const std::function<bool()>& condition);
  /// From now on nothing ends with Interrupted: for stopping the cubes.
  void finish();

 private:
  class Bus;
  std::unique_ptr<Bus> bus_;
};

}  // namespace mvtp
