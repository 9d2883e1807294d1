#pragma once

#include <fmt/format.h>
#include <systemd/sd-bus.h>

#include <cstring>
#include <memory>

#include "tools/toio/device/bluetooth.hpp"

/// What the client of BlueZ and the stand-in for it share: owners of sd-bus's objects, and names.
namespace mvtp::dbus {

inline constexpr const char* kAdapter = "org.bluez.Adapter1";
inline constexpr const char* kDevice = "org.bluez.Device1";
inline constexpr const char* kGatt = "org.bluez.GattCharacteristic1";

struct CloseBus {
  void operator()(sd_bus* bus) const { sd_bus_flush_close_unref(bus); }
};
struct FreeMessage {
  void operator()(sd_bus_message* message) const { sd_bus_message_unref(message); }
};
struct FreeSlot {
  void operator()(sd_bus_slot* slot) const { sd_bus_slot_unref(slot); }
};
using Bus = std::unique_ptr<sd_bus, CloseBus>;
using Message = std::unique_ptr<sd_bus_message, FreeMessage>;
using Slot = std::unique_ptr<sd_bus_slot, FreeSlot>;

/// @throws BluetoothError if `result`, of a call of sd-bus, is an error.
inline void check(int result, const char* what) {
  if (result < 0) throw BluetoothError(fmt::format("D-Bus: {}: {}", what, std::strerror(-result)));
}

}  // namespace mvtp::dbus
