#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "tools/toio/device/bluetooth.hpp"
#include "tools/toio/device/bluez_objects.hpp"
#include "tools/toio/device/dbus.hpp"

namespace mvtp {

inline constexpr double kCallTime = 5.0;      ///< of calls but Connect [s]
inline constexpr double kConnectTime = 20.0;  ///< [s]

/// BlueZ on the system bus: its objects as they change, calls of their methods, and what the cubes
/// notify.
class Bluetooth::Bus {
 public:
  /// See Bluetooth. @throws BluetoothError if there is no bus, no BlueZ or no adapter.
  explicit Bus(std::function<bool()> interrupted);
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  ~Bus() = default;

  std::function<void(const std::string&, const Notification&)> handler;
  bool finishing = false;

  [[nodiscard]] const std::map<std::string, BluezObject>& objects() const { return objects_; }
  [[nodiscard]] const std::string& adapter() const { return adapter_; }
  [[nodiscard]] const BluezObject* find(const std::string& path) const;

  /// Is the cube connected, with its characteristics?
  [[nodiscard]] bool ready(const std::string& path) const;

  /// Where a cube's characteristic is on the bus; empty if the cube has none.
  [[nodiscard]] std::string characteristic(const std::string& cube, Characteristic wanted) const;

  /// The same. @throws BluetoothError if the cube has none.
  [[nodiscard]] std::string place_of(const std::string& cube, Characteristic wanted) const;

  [[nodiscard]] dbus::Message method(const std::string& path, const char* interface,
                                     const char* name);

  /// Calls, and handles what else comes in until the reply is there.
  /// @throws BluetoothError with the reason in the reply, or if none comes.
  dbus::Message call(const dbus::Message& message, double seconds = kCallTime);

  /// Asks a cube to connect, unless that is under way or was tried a moment ago.
  void begin_to_connect(const std::string& path);

  /// Only sends.
  void cast(const dbus::Message& message);

  /// @return whether the condition came true.
  bool wait_until(double seconds, const std::function<bool()>& condition);

 private:
  using Clock = std::chrono::steady_clock;

  /// To connect a cube that nobody waits for.
  struct Attempt {
    dbus::Slot slot;
    bool under_way = false;
    Clock::time_point next;  ///< not before
  };

  static int on_signal(sd_bus_message* m, void* data, sd_bus_error*);
  void load_objects();
  void handle(sd_bus_message* m);
  void hand_on(const std::string& path, const BluezObject& object, const Bytes& value);

  dbus::Bus bus_;
  std::function<bool()> interrupted_;
  std::map<std::string, BluezObject> objects_;
  std::string adapter_;
  std::map<std::string, Attempt> attempts_;  ///< by path
};

}  // namespace mvtp
