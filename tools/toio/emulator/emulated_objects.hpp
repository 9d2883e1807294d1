#pragma once

#include <systemd/sd-bus.h>

#include "tools/toio/cube/protocol.hpp"
#include "tools/toio/emulator/emulated_cube.hpp"

/// The objects of the emulated BlueZ, as D-Bus messages describe them.
namespace mvtp {

/// Where its one adapter is on the bus.
inline constexpr const char* kAdapterPath = "/org/bluez/hci0";

// Each appends "a{sa{sv}}": one interface with its properties.
void append_adapter(sd_bus_message* m, bool powered, bool discovering);
void append_device(sd_bus_message* m, const EmulatedCube& cube);
void append_characteristic(sd_bus_message* m, const EmulatedCube& cube, Characteristic c, int mtu);

/// Appends the `Value` of a characteristic as an entry of "a{sv}".
void append_value(sd_bus_message* m, const Bytes& bytes);

}  // namespace mvtp
