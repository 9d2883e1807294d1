// Bluetooth by BlueZ: what is asked of its adapter, devices and characteristics.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "tools/toio/device/bluetooth.hpp"
#include "tools/toio/device/bluez_bus.hpp"
#include "tools/toio/device/bluez_objects.hpp"
#include "tools/toio/device/dbus.hpp"

namespace mvtp {
namespace {

using dbus::check;
using dbus::kAdapter;
using dbus::kDevice;
using dbus::kGatt;
using dbus::Message;

constexpr int kTries = 3;            // to connect, and
constexpr double kRetryPause = 0.3;  // between them [s]

/// Fills in the arguments of WriteValue; only the motors take writes without an answer.
void append_write(const Message& message, const Write& write) {
  check(sd_bus_message_append_array(message.get(), 'y', write.bytes.data(), write.bytes.size()),
        "WriteValue");
  check(sd_bus_message_append(message.get(), "a{sv}", 1, "type", "s",
                              write.to == Characteristic::kMotor ? "command" : "request"),
        "WriteValue");
}

}  // namespace

Bluetooth::Bluetooth(std::function<bool()> interrupted)
    : bus_(std::make_unique<Bus>(std::move(interrupted))) {
  if (bus_->find(bus_->adapter())->powered) return;
  const Message set = bus_->method(bus_->adapter(), "org.freedesktop.DBus.Properties", "Set");
  check(sd_bus_message_append(set.get(), "ssv", kAdapter, "Powered", "b", 1), "Powered");
  try {
    bus_->call(set);
  } catch (const BluetoothError& error) {
    throw BluetoothError(
        fmt::format("the Bluetooth adapter is off and stays off ({}); see rfkill", error.what()));
  }
}

Bluetooth::~Bluetooth() = default;

void Bluetooth::on_notification(
    std::function<void(const std::string&, const Notification&)> handler) {
  bus_->handler = std::move(handler);
}

std::vector<FoundCube> Bluetooth::scan(
    double seconds, const std::function<bool(const std::vector<FoundCube>&)>& enough) {
  const auto found = [this] {
    std::vector<FoundCube> cubes;
    for (const auto& [path, object] : bus_->objects()) {
      // BlueZ remembers cubes of earlier days; those in reach have a signal strength.
      if (!is_cube(object) || (object.rssi == 0 && !object.connected)) continue;
      cubes.push_back({path, object.address, object.name, object.rssi});
    }
    std::ranges::sort(cubes, {}, &FoundCube::address);
    return cubes;
  };
  const Message filter = bus_->method(bus_->adapter(), kAdapter, "SetDiscoveryFilter");
  check(sd_bus_message_append(filter.get(), "a{sv}", 2, "UUIDs", "as", 1,
                              std::string(kServiceUuid).c_str(), "Transport", "s", "le"),
        "filter");
  bus_->call(filter);
  bus_->call(bus_->method(bus_->adapter(), kAdapter, "StartDiscovery"));
  (void)bus_->wait_until(seconds, [&] { return enough(found()); });
  bus_->call(bus_->method(bus_->adapter(), kAdapter, "StopDiscovery"));
  return found();
}

void Bluetooth::connect(const std::string& path) {
  for (int attempt = 1;; ++attempt) {
    try {
      bus_->call(bus_->method(path, kDevice, "Connect"), kConnectTime);
      if (bus_->wait_until(kCallTime, [&] { return bus_->ready(path); })) return;
      throw BluetoothError("its services do not show");
    } catch (const BluetoothError& error) {
      if (attempt == kTries) {
        throw BluetoothError(fmt::format("{} cannot be connected ({}); switch it off and on",
                                         path.substr(path.rfind('/') + 1), error.what()));
      }
      wait(kRetryPause);
    }
  }
}

bool Bluetooth::connect_meanwhile(const std::string& path) {
  if (bus_->ready(path)) return true;
  if (!connected(path)) bus_->begin_to_connect(path);
  return false;
}

void Bluetooth::disconnect(const std::string& path) {
  bus_->call(bus_->method(path, kDevice, "Disconnect"));
}

bool Bluetooth::connected(const std::string& path) const {
  const BluezObject* object = bus_->find(path);
  return object != nullptr && object->connected;
}

int Bluetooth::mtu(const std::string& path) const {
  const BluezObject* object = bus_->find(bus_->characteristic(path, Characteristic::kMotor));
  return object == nullptr ? kLeastMtu : object->mtu;
}

void Bluetooth::subscribe(const std::string& path, Characteristic characteristic) {
  bus_->call(bus_->method(bus_->place_of(path, characteristic), kGatt, "StartNotify"));
}

Bytes Bluetooth::read(const std::string& path, Characteristic characteristic) {
  const Message message = bus_->method(bus_->place_of(path, characteristic), kGatt, "ReadValue");
  check(sd_bus_message_append(message.get(), "a{sv}", 0), "ReadValue");
  const Message reply = bus_->call(message);
  const void* data = nullptr;
  std::size_t size = 0;
  check(sd_bus_message_read_array(reply.get(), 'y', &data, &size), "ReadValue");
  const auto* begin = static_cast<const std::uint8_t*>(data);
  return {begin, begin + size};
}

void Bluetooth::write(const std::string& path, const Write& write) {
  const Message message = bus_->method(bus_->place_of(path, write.to), kGatt, "WriteValue");
  append_write(message, write);
  bus_->call(message);
}

void Bluetooth::write_now(const std::string& path, const Write& write) {
  const std::string place = bus_->characteristic(path, write.to);
  if (place.empty()) return;  // the link is lost, which the next look at connected() tells
  const Message message = bus_->method(place, kGatt, "WriteValue");
  append_write(message, write);
  bus_->cast(message);
}

void Bluetooth::wait(double seconds) {
  (void)bus_->wait_until(seconds, [] { return false; });
}

bool Bluetooth::wait_until(double seconds, const std::function<bool()>& condition) {
  return bus_->wait_until(seconds, condition);
}

void Bluetooth::finish() { bus_->finishing = true; }

}  // namespace mvtp
