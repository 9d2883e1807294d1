#include "tools/toio/emulator/emulated_bluez.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>

#include "tools/toio/device/bluetooth.hpp"
#include "tools/toio/device/dbus.hpp"
#include "tools/toio/emulator/emulated_cubes.hpp"
#include "tools/toio/emulator/emulated_objects.hpp"
#include "tools/toio/emulator/emulated_signals.hpp"

namespace mvtp {
namespace {

using Clock = std::chrono::steady_clock;
using dbus::check;
using dbus::Message;

/// The bus that the environment names as the system's.
dbus::Bus open_bus() {
  sd_bus* bus = nullptr;
  if (sd_bus_open_system(&bus) < 0) {
    throw BluetoothError(
        "no D-Bus bus; start one, e.g. dbus-run-session, and name it in "
        "DBUS_SYSTEM_BUS_ADDRESS");
  }
  return dbus::Bus(bus);
}

}  // namespace

/// Answers what BlueZ is asked.
class EmulatedBluez::Service {
 public:
  explicit Service(const EmulatedWorld& world)
      : mtu_(world.mtu),
        has_adapter_(world.adapter),
        bus_(open_bus()),
        cubes_(world, EmulatedSignals(bus_.get())) {
    check(sd_bus_add_filter(bus_.get(), nullptr, &Service::on_message, this), "filter");
    if (sd_bus_request_name(bus_.get(), "org.bluez", 0) < 0) {
      throw BluetoothError(
          "this bus has an org.bluez already, or allows none; start a private one with "
          "dbus-run-session");
    }
  }

  void live(double seconds) {
    const double end = now() + seconds;
    while (true) {
      int handled = 0;
      do {
        handled = sd_bus_process(bus_.get(), nullptr);
        check(handled, "the bus is lost");
      } while (handled > 0);
      while (cubes_.time() < now()) cubes_.step();
      const double left = end - now();
      if (left <= 0.0) return;
      check(std::min(0, sd_bus_wait(bus_.get(),
                                    std::uint64_t(std::min(left, EmulatedCubes::kStep) * 1e6))),
            "wait");
    }
  }

  [[nodiscard]] WorldReport report() const { return cubes_.report(); }

 private:
  [[nodiscard]] double now() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count();
  }

  static int on_message(sd_bus_message* m, void* data, sd_bus_error*) {
    std::uint8_t type = 0;
    if (sd_bus_message_get_type(m, &type) < 0 || type != SD_BUS_MESSAGE_METHOD_CALL) return 0;
    return static_cast<Service*>(data)->answer(m);
  }

  int answer(sd_bus_message* m) {
    const std::string_view member = sd_bus_message_get_member(m);
    const std::string_view path = sd_bus_message_get_path(m);
    if (member == "GetManagedObjects") {
      sd_bus_message* raw = nullptr;
      check(sd_bus_message_new_method_return(m, &raw), "reply");
      const Message reply(raw);
      append_objects(raw);
      check(sd_bus_send(bus_.get(), raw, nullptr), "reply");
      return 1;
    }
    if (path == kAdapterPath) return answer_adapter(m, member);
    for (EmulatedCube& cube : cubes_.all()) {
      if (path == cube.path) return answer_device(m, member, cube);
      for (const Characteristic c : kCharacteristics) {
        if (cube.resolved && path == cube.path_of(c))
          return answer_characteristic(m, member, cube, c);
      }
    }
    return refuse(m, "org.freedesktop.DBus.Error.UnknownObject", "no such object");
  }

  static int done(sd_bus_message* m) {
    check(sd_bus_reply_method_return(m, ""), "reply");
    return 1;
  }

  static int refuse(sd_bus_message* m, const char* name, const char* text) {
    check(sd_bus_reply_method_errorf(m, name, "%s", text), "reply");
    return 1;
  }

  void append_objects(sd_bus_message* m) const {
    const auto object = [&](const std::string& path, const auto& append) {
      check(sd_bus_message_open_container(m, 'e', "oa{sa{sv}}"), "objects");
      check(sd_bus_message_append(m, "o", path.c_str()), "objects");
      append();
      check(sd_bus_message_close_container(m), "objects");
    };
    check(sd_bus_message_open_container(m, 'a', "{oa{sa{sv}}}"), "objects");
    if (has_adapter_) object(kAdapterPath, [&] { append_adapter(m, powered_, cubes_.scanning()); });
    for (const EmulatedCube& cube : cubes_.all()) {
      if (cube.visible) object(cube.path, [&] { append_device(m, cube); });
      for (const Characteristic c : kCharacteristics) {
        if (cube.resolved)
          object(cube.path_of(c), [&] { append_characteristic(m, cube, c, mtu_); });
      }
    }
    check(sd_bus_message_close_container(m), "objects");
  }

  int answer_adapter(sd_bus_message* m, std::string_view member) {
    if (member == "Set") {
      powered_ = true;
    } else if (!powered_) {
      return refuse(m, "org.bluez.Error.NotReady", "Resource Not Ready");
    } else if (member == "StartDiscovery") {
      cubes_.scan();
    } else if (member == "StopDiscovery") {
      cubes_.end_scan();
    } else if (member != "SetDiscoveryFilter") {
      return refuse(m, "org.freedesktop.DBus.Error.UnknownMethod", "no such method");
    }
    return done(m);
  }

  int answer_device(sd_bus_message* m, std::string_view member, EmulatedCube& cube) {
    if (member == "Disconnect") {
      cubes_.drop(cube);
      return done(m);
    }
    if (member != "Connect") {
      return refuse(m, "org.freedesktop.DBus.Error.UnknownMethod", "no such method");
    }
    if (!cubes_.connect(cube)) {
      return refuse(m, "org.bluez.Error.Failed", "le-connection-abort-by-local");
    }
    return done(m);
  }

  int answer_characteristic(sd_bus_message* m, std::string_view member, EmulatedCube& cube,
                            Characteristic c) {
    if (member == "StartNotify") {
      cube.notifying.insert(c);
      return done(m);
    }
    if (member == "StopNotify") {
      cube.notifying.erase(c);
      return done(m);
    }
    if (member == "ReadValue") {
      sd_bus_message* raw = nullptr;
      check(sd_bus_message_new_method_return(m, &raw), "reply");
      const Message reply(raw);
      const Bytes bytes = cube.model.value(c);
      check(sd_bus_message_append_array(raw, 'y', bytes.data(), bytes.size()), "reply");
      check(sd_bus_send(bus_.get(), raw, nullptr), "reply");
      return 1;
    }
    const void* data = nullptr;
    std::size_t size = 0;
    if (member != "WriteValue" || sd_bus_message_read_array(m, 'y', &data, &size) < 0) {
      return refuse(m, "org.freedesktop.DBus.Error.UnknownMethod", "no such method");
    }
    const auto* begin = static_cast<const std::uint8_t*>(data);
    cubes_.take(cube, c, Bytes(begin, begin + size));
    return sd_bus_message_get_expect_reply(m) > 0 ? done(m) : 1;
  }

  int mtu_;
  bool has_adapter_;
  dbus::Bus bus_;
  EmulatedCubes cubes_;
  Clock::time_point begin_ = Clock::now();
  bool powered_ = false;
};

EmulatedBluez::EmulatedBluez(const EmulatedWorld& world)
    : service_(std::make_unique<Service>(world)) {}

EmulatedBluez::~EmulatedBluez() = default;

void EmulatedBluez::live(double seconds) { service_->live(seconds); }

WorldReport EmulatedBluez::report() const { return service_->report(); }

}  // namespace mvtp
