#include "tools/toio/device/bluez_bus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

namespace mvtp {
namespace {

using dbus::check;
using dbus::kAdapter;
using dbus::kDevice;
using dbus::kGatt;
using dbus::Message;
using dbus::Slot;

constexpr const char* kBluez = "org.bluez";
constexpr double kSlice = 0.01;      // between two looks whether to stop [s]
constexpr double kRetryLater = 1.0;  // between tries that nobody waits for [s]

}  // namespace

Bluetooth::Bus::Bus(std::function<bool()> interrupted) : interrupted_(std::move(interrupted)) {
  sd_bus* bus = nullptr;
  if (sd_bus_open_system(&bus) < 0) {
    throw BluetoothError(
        "no D-Bus system bus: Bluetooth is reached through it; start dbus and bluetoothd");
  }
  bus_.reset(bus);
  check(sd_bus_add_match(bus, nullptr, "type='signal',sender='org.bluez'", &Bus::on_signal, this),
        "add match");
  load_objects();
  for (const auto& [path, object] : objects_) {
    if (object.adapter && adapter_.empty()) adapter_ = path;
  }
  if (adapter_.empty()) {
    throw BluetoothError("no Bluetooth adapter; plug one in, or enable it (bluetoothctl list)");
  }
}

const BluezObject* Bluetooth::Bus::find(const std::string& path) const {
  const auto found = objects_.find(path);
  return found == objects_.end() ? nullptr : &found->second;
}

bool Bluetooth::Bus::ready(const std::string& path) const {
  const BluezObject* object = find(path);
  return object != nullptr && object->connected && object->resolved;
}

std::string Bluetooth::Bus::characteristic(const std::string& cube, Characteristic wanted) const {
  for (auto at = objects_.lower_bound(cube + "/"); at != objects_.end(); ++at) {
    if (!at->first.starts_with(cube + "/")) break;
    if (at->second.characteristic && characteristic_of(at->second.uuid) == wanted) {
      return at->first;
    }
  }
  return "";
}

std::string Bluetooth::Bus::place_of(const std::string& cube, Characteristic wanted) const {
  const BluezObject* object = find(cube);
  const std::string name = object == nullptr ? cube : object->name;
  if (object == nullptr || !object->connected) {
    throw BluetoothError(fmt::format("{} lost its link; bring it nearer and try again", name));
  }
  std::string place = characteristic(cube, wanted);
  if (!place.empty()) return place;
  throw BluetoothError(
      fmt::format("{} lacks the characteristic \"{}\"; remove it from Bluetooth's list and pair "
                  "again (bluetoothctl remove {})",
                  name, to_string(wanted), object->address));
}

Message Bluetooth::Bus::method(const std::string& path, const char* interface, const char* name) {
  sd_bus_message* message = nullptr;
  check(sd_bus_message_new_method_call(bus_.get(), &message, kBluez, path.c_str(), interface, name),
        name);
  return Message(message);
}

Message Bluetooth::Bus::call(const Message& message, double seconds) {
  struct Reply {
    Message message;
    bool done = false;
  } reply;
  sd_bus_slot* slot = nullptr;
  const auto take = [](sd_bus_message* m, void* data, sd_bus_error*) {
    auto* into = static_cast<Reply*>(data);
    into->message.reset(sd_bus_message_ref(m));
    into->done = true;
    return 0;
  };
  check(sd_bus_call_async(bus_.get(), &slot, message.get(), take, &reply,
                          std::uint64_t((seconds + 1.0) * 1e6)),
        "call");
  const Slot free_slot(slot);
  wait_until(seconds, [&] { return reply.done; });
  if (!reply.done) throw BluetoothError("BlueZ does not answer; restart bluetoothd");
  if (const sd_bus_error* error = sd_bus_message_get_error(reply.message.get())) {
    throw BluetoothError(error->message != nullptr && *error->message != '\0' ? error->message
                                                                              : error->name);
  }
  return std::move(reply.message);
}

void Bluetooth::Bus::begin_to_connect(const std::string& path) {
  Attempt& attempt = attempts_[path];
  if (attempt.under_way || Clock::now() < attempt.next) return;
  const auto end = [](sd_bus_message*, void* data, sd_bus_error*) {
    auto* ended = static_cast<Attempt*>(data);
    ended->under_way = false;
    ended->next = Clock::now() + std::chrono::milliseconds(std::lround(kRetryLater * 1e3));
    return 0;
  };
  const Message message = method(path, kDevice, "Connect");
  sd_bus_slot* slot = nullptr;
  check(sd_bus_call_async(bus_.get(), &slot, message.get(), end, &attempt,
                          std::uint64_t(kConnectTime * 1e6)),
        "Connect");
  attempt.slot.reset(slot);
  attempt.under_way = true;
}

void Bluetooth::Bus::cast(const Message& message) {
  check(sd_bus_message_set_expect_reply(message.get(), 0), "send");
  check(sd_bus_send(bus_.get(), message.get(), nullptr), "send");
  check(sd_bus_flush(bus_.get()), "send");
}

bool Bluetooth::Bus::wait_until(double seconds, const std::function<bool()>& condition) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (!finishing && interrupted_()) throw Interrupted();
    const int handled = sd_bus_process(bus_.get(), nullptr);
    check(handled, "the bus is lost");
    if (handled > 0) continue;
    const double left = std::chrono::duration<double>(end - Clock::now()).count();
    if (left <= 0.0) return false;
    check(std::min(0, sd_bus_wait(bus_.get(), std::uint64_t(std::min(left, kSlice) * 1e6))),
          "wait");
  }
  return true;
}

void Bluetooth::Bus::load_objects() {
  Message reply;
  try {
    reply = call(method("/", "org.freedesktop.DBus.ObjectManager", "GetManagedObjects"));
  } catch (const BluetoothError& error) {
    throw BluetoothError(
        fmt::format("no BlueZ on the bus ({}); install and start bluetoothd", error.what()));
  }
  sd_bus_message* m = reply.get();
  check(sd_bus_message_enter_container(m, 'a', "{oa{sa{sv}}}"), "objects");
  while (sd_bus_message_enter_container(m, 'e', "oa{sa{sv}}") > 0) {
    const char* path = nullptr;
    check(sd_bus_message_read(m, "o", &path), "objects");
    read_interfaces(m, objects_[path]);
    (void)sd_bus_message_exit_container(m);
  }
}

int Bluetooth::Bus::on_signal(sd_bus_message* m, void* data, sd_bus_error*) {
  static_cast<Bus*>(data)->handle(m);
  return 0;
}

void Bluetooth::Bus::handle(sd_bus_message* m) {
  const std::string_view member = sd_bus_message_get_member(m);
  const char* path = nullptr;
  if (member == "PropertiesChanged") {
    const auto known = objects_.find(sd_bus_message_get_path(m));
    if (known == objects_.end() || sd_bus_message_skip(m, "s") < 0) return;
    const std::optional<Bytes> value = read_properties(m, known->second);
    if (value) hand_on(known->first, known->second, *value);
  } else if (member == "InterfacesAdded" && sd_bus_message_read(m, "o", &path) >= 0) {
    read_interfaces(m, objects_[path]);
  } else if (member == "InterfacesRemoved" && sd_bus_message_read(m, "o", &path) >= 0) {
    // Others may come and go, as org.bluez.Battery1 does.
    for (const std::string& interface : read_list(m)) {
      if (interface == kAdapter || interface == kDevice || interface == kGatt) {
        objects_.erase(path);
      }
    }
  }
}

void Bluetooth::Bus::hand_on(const std::string& path, const BluezObject& object,
                             const Bytes& value) {
  if (!handler || !object.characteristic) return;
  const std::optional<Characteristic> from = characteristic_of(object.uuid);
  const std::size_t cube = path.find("/service");
  if (from && cube != std::string::npos) handler(path.substr(0, cube), {*from, value});
}

}  // namespace mvtp
