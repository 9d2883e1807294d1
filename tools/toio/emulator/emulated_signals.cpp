#include "tools/toio/emulator/emulated_signals.hpp"

#include "tools/toio/emulator/emulated_objects.hpp"

namespace mvtp {
namespace {

using dbus::check;
using dbus::kGatt;
using dbus::Message;

}  // namespace

Message EmulatedSignals::signal(const std::string& path, const char* interface,
                                const char* name) const {
  sd_bus_message* m = nullptr;
  check(sd_bus_message_new_signal(bus_, &m, path.c_str(), interface, name), name);
  return Message(m);
}

template <class Append>
void EmulatedSignals::added(const std::string& path, const Append& append) const {
  const Message m = signal("/", "org.freedesktop.DBus.ObjectManager", "InterfacesAdded");
  check(sd_bus_message_append(m.get(), "o", path.c_str()), "added");
  append(m.get());
  check(sd_bus_send(bus_, m.get(), nullptr), "added");
}

void EmulatedSignals::added(const EmulatedCube& cube) const {
  added(cube.path, [&](sd_bus_message* m) { append_device(m, cube); });
}

void EmulatedSignals::added(const EmulatedCube& cube, Characteristic c, int mtu) const {
  added(cube.path_of(c), [&](sd_bus_message* m) { append_characteristic(m, cube, c, mtu); });
}

void EmulatedSignals::removed(const std::string& path, const char* interface) const {
  const Message m = signal("/", "org.freedesktop.DBus.ObjectManager", "InterfacesRemoved");
  check(sd_bus_message_append(m.get(), "oas", path.c_str(), 1, interface), "removed");
  check(sd_bus_send(bus_, m.get(), nullptr), "removed");
}

void EmulatedSignals::changed(const std::string& path, const char* interface, const char* key,
                              bool value) const {
  const Message m = signal(path, "org.freedesktop.DBus.Properties", "PropertiesChanged");
  check(sd_bus_message_append(m.get(), "sa{sv}as", interface, 1, key, "b", int(value), 0), key);
  check(sd_bus_send(bus_, m.get(), nullptr), key);
}

void EmulatedSignals::notify(const EmulatedCube& cube, const Notification& n) const {
  const Message m =
      signal(cube.path_of(n.from), "org.freedesktop.DBus.Properties", "PropertiesChanged");
  sd_bus_message* raw = m.get();
  check(sd_bus_message_append(raw, "s", kGatt), "notify");
  check(sd_bus_message_open_container(raw, 'a', "{sv}"), "notify");
  append_value(raw, n.bytes);
  check(sd_bus_message_close_container(raw), "notify");
  check(sd_bus_message_append(raw, "as", 0), "notify");
  check(sd_bus_send(bus_, raw, nullptr), "notify");
}

}  // namespace mvtp
