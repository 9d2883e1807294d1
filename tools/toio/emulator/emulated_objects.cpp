#include "tools/toio/emulator/emulated_objects.hpp"

#include <string>

#include "tools/toio/device/dbus.hpp"

namespace mvtp {
namespace {

using dbus::check;
using dbus::kAdapter;
using dbus::kDevice;
using dbus::kGatt;

// Entries of "a{sv}".
void append_text(sd_bus_message* m, const char* key, const std::string& value,
                 const char* type = "s") {
  check(sd_bus_message_append(m, "{sv}", key, type, value.c_str()), key);
}
void append_flag(sd_bus_message* m, const char* key, bool value) {
  check(sd_bus_message_append(m, "{sv}", key, "b", int(value)), key);
}

const char* flags_of(Characteristic c) {
  switch (c) {
    case Characteristic::kMotor:
      return "write-without-response";
    case Characteristic::kLight:
    case Characteristic::kSound:
    case Characteristic::kConfiguration:
      return "write";
    default:
      return "read";
  }
}

/// "a{sa{sv}}" with one interface, its properties appended by `append`.
template <class Append>
void append_interface(sd_bus_message* m, const char* name, const Append& append) {
  check(sd_bus_message_open_container(m, 'a', "{sa{sv}}"), name);
  check(sd_bus_message_open_container(m, 'e', "sa{sv}"), name);
  check(sd_bus_message_append(m, "s", name), name);
  check(sd_bus_message_open_container(m, 'a', "{sv}"), name);
  append();
  for (int level = 0; level < 3; ++level) check(sd_bus_message_close_container(m), name);
}

}  // namespace

void append_adapter(sd_bus_message* m, bool powered, bool discovering) {
  append_interface(m, kAdapter, [&] {
    append_text(m, "Address", "CA:B3:FF:00:00:01");
    append_flag(m, "Powered", powered);
    append_flag(m, "Discovering", discovering);
  });
}

void append_device(sd_bus_message* m, const EmulatedCube& cube) {
  append_interface(m, kDevice, [&] {
    append_text(m, "Address", cube.address);
    append_text(m, "Name", cube.name);
    append_text(m, "Adapter", kAdapterPath, "o");
    append_flag(m, "Connected", cube.connected);
    append_flag(m, "ServicesResolved", cube.resolved);
    check(sd_bus_message_append(m, "{sv}", "RSSI", "n", -50), "RSSI");
    check(sd_bus_message_append(m, "{sv}", "UUIDs", "as", 1, std::string(kServiceUuid).c_str()),
          "UUIDs");
  });
}

void append_characteristic(sd_bus_message* m, const EmulatedCube& cube, Characteristic c, int mtu) {
  append_interface(m, kGatt, [&] {
    append_text(m, "UUID", uuid(c));
    append_text(m, "Service", cube.service_path(), "o");
    append_flag(m, "Notifying", cube.notifying.contains(c));
    check(sd_bus_message_append(m, "{sv}", "Flags", "as", 2, flags_of(c), "notify"), "Flags");
    check(sd_bus_message_append(m, "{sv}", "MTU", "q", mtu), "MTU");
  });
}

void append_value(sd_bus_message* m, const Bytes& bytes) {
  check(sd_bus_message_open_container(m, 'e', "sv"), "bytes");
  check(sd_bus_message_append(m, "s", "Value"), "bytes");
  check(sd_bus_message_open_container(m, 'v', "ay"), "bytes");
  check(sd_bus_message_append_array(m, 'y', bytes.data(), bytes.size()), "bytes");
  check(sd_bus_message_close_container(m), "bytes");
  check(sd_bus_message_close_container(m), "bytes");
}

}  // namespace mvtp
