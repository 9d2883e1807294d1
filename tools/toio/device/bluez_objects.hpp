#pragma once

#include <systemd/sd-bus.h>

#include <optional>
#include <string>
#include <vector>

#include "tools/toio/cube/protocol.hpp"

namespace mvtp {

/// Bytes of a packet where BlueZ does not say how many.
inline constexpr int kLeastMtu = 23;

/// What is known of one object of BlueZ; which fields count depends on its interface.
struct BluezObject {
  bool adapter = false;
  bool device = false;
  bool characteristic = false;
  std::string address;
  std::string name;
  std::string uuid;
  std::vector<std::string> uuids;
  bool powered = false;
  bool connected = false;
  bool resolved = false;
  int rssi = 0;
  int mtu = kLeastMtu;
};

/// Reads "a{sv}" into the object. @return the `Value`, if it was among them.
std::optional<Bytes> read_properties(sd_bus_message* m, BluezObject& object);

/// Reads "a{sa{sv}}".
void read_interfaces(sd_bus_message* m, BluezObject& object);

/// Reads "as".
[[nodiscard]] std::vector<std::string> read_list(sd_bus_message* m);

/// Is it a device with the service of cubes?
[[nodiscard]] bool is_cube(const BluezObject& object);

}  // namespace mvtp
