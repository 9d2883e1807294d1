#pragma once

#include <systemd/sd-bus.h>

#include <string>

#include "tools/toio/cube/protocol.hpp"
#include "tools/toio/device/dbus.hpp"
#include "tools/toio/emulator/emulated_cube.hpp"

namespace mvtp {

/// What the emulated BlueZ tells unasked: objects that come and go, and what changes.
class EmulatedSignals {
 public:
  /// @param bus outlives this object.
  explicit EmulatedSignals(sd_bus* bus) : bus_(bus) {}

  /// A cube is found.
  void added(const EmulatedCube& cube) const;
  /// A characteristic of a connected cube is found.
  void added(const EmulatedCube& cube, Characteristic c, int mtu) const;
  void removed(const std::string& path, const char* interface) const;
  void changed(const std::string& path, const char* interface, const char* key, bool value) const;
  /// The characteristic has a new value.
  void notify(const EmulatedCube& cube, const Notification& n) const;

 private:
  [[nodiscard]] dbus::Message signal(const std::string& path, const char* interface,
                                     const char* name) const;
  template <class Append>
  void added(const std::string& path, const Append& append) const;

  sd_bus* bus_;
};

}  // namespace mvtp
