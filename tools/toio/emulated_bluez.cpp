#include "tools/toio/emulated_bluez.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <set>

#include "planner/problem/referee_geometry.hpp"
#include "tools/toio/bluetooth.hpp"
#include "tools/toio/dbus.hpp"

namespace mvtp {
namespace {

using Clock = std::chrono::steady_clock;
using dbus::check;
using dbus::kAdapter;
using dbus::kDevice;
using dbus::kGatt;
using dbus::Message;

constexpr double kStep = 0.005;       // of the physics [s]
constexpr double kFindTime = 0.2;     // until a cube shows in a scan [s]
constexpr double kResolveTime = 0.1;  // until its characteristics show [s]
constexpr const char* kAdapterPath = "/org/bluez/hci0";

// Entries of "a{sv}".
void append_text(sd_bus_message* m, const char* key, const std::string& value,
                 const char* type = "s") {
  check(sd_bus_message_append(m, "{sv}", key, type, value.c_str()), key);
}
void append_flag(sd_bus_message* m, const char* key, bool value) {
  check(sd_bus_message_append(m, "{sv}", key, "b", int(value)), key);
}

/// One emulated cube and its link.
struct Station {
  std::string name;
  std::string address;
  std::string path;
  CubeModel cube;
  Air<Write> to_cube;
  Air<Notification> from_cube;
  int failures_left = 0;
  int settings_to_lose = 0;
  int answers_to_lose = 0;
  bool visible = false;
  bool connected = false;
  bool resolved = false;
  double connected_at = 0.0;
  std::set<Characteristic> notifying;
  std::string last_motor;
  int writes = 0;
  int dropped = 0;
  std::optional<double> moved_at;
  double deaf_until = 0.0;  ///< cannot be connected before [s]

  [[nodiscard]] std::string service_path() const { return path + "/service000a"; }
  [[nodiscard]] std::string path_of(Characteristic c) const {
    return fmt::format("{}/char{:04x}", service_path(), 11 + int(c));
  }
};

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

}  // namespace

class EmulatedBluez::Service {
 public:
  explicit Service(const EmulatedWorld& world) : world_(world), dice_(world.seed) {
    sd_bus* bus = nullptr;
    if (sd_bus_open_system(&bus) < 0) {
      throw BluetoothError(
          "no D-Bus bus; start one, e.g. dbus-run-session, and name it in "
          "DBUS_SYSTEM_BUS_ADDRESS");
    }
    bus_.reset(bus);
    check(sd_bus_add_filter(bus, nullptr, &Service::on_message, this), "filter");
    if (sd_bus_request_name(bus, "org.bluez", 0) < 0) {
      throw BluetoothError(
          "this bus has an org.bluez already, or allows none; start a private one with "
          "dbus-run-session");
    }
    for (std::size_t i = 0; i < world.starts.size(); ++i) add_cube(i);
  }

  void live(double seconds) {
    const double end = now() + seconds;
    while (true) {
      int handled = 0;
      do {
        handled = sd_bus_process(bus_.get(), nullptr);
        check(handled, "the bus is lost");
      } while (handled > 0);
      for (; time_ < now(); time_ += kStep) step();
      const double left = end - now();
      if (left <= 0.0) return;
      check(std::min(0, sd_bus_wait(bus_.get(), std::uint64_t(std::min(left, kStep) * 1e6))),
            "wait");
    }
  }

  [[nodiscard]] WorldReport report() const {
    WorldReport report{.least_clearance = least_clearance_, .touched = least_clearance_ < 0.0};
    const DeskFrame desk{world_.mat, world_.cube, Facing::kNoseFirst};
    for (const Station& s : stations_) {
      report.cubes.push_back({s.name, s.cube.wheel_speed_now(), s.last_motor, s.writes, s.dropped,
                              desk.to_mat(s.cube.pose())});
    }
    return report;
  }

 private:
  [[nodiscard]] double now() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count();
  }

  void add_cube(std::size_t i) {
    const double error = 0.02;
    const CubeFlaws flaws{dice_.between(1 - error, 1 + error), dice_.between(1 - error, 1 + error),
                          static_cast<std::uint8_t>(world_.battery), world_.version};
    const auto number = int(i) + 1;
    Station station{.name = fmt::format("toio-{}{}a", char('E' + number / 10), number % 10),
                    .address = fmt::format("CA:B3:00:00:00:{:02X}", number),
                    .path = {},
                    .cube = CubeModel(world_.mat, world_.cube, world_.starts[i], flaws),
                    .failures_left = world_.connect_failures,
                    .settings_to_lose = world_.lost_settings,
                    .answers_to_lose = world_.lost_settings};
    std::string file = station.address;
    std::ranges::replace(file, ':', '_');
    station.path = fmt::format("{}/dev_{}", kAdapterPath, file);
    stations_.push_back(std::move(station));
  }

  // The cubes -----------------------------------------------------------------------------------

  void step() {
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      Station& s = stations_[i];
      show(s);
      befall(i);
      s.to_cube.deliver(time_, [&](const Write& w) { s.cube.write(w.to, w.bytes); });
      if (dice_.happens(world_.stalls_per_minute / 60.0 * kStep)) {
        s.cube.block(dice_.between(world_.shortest_stall, world_.longest_stall));
      }
      s.cube.step(kStep);
      for (Notification& n : s.cube.take_notifications()) {
        if (!s.connected || is_lost(n.from, s.answers_to_lose)) continue;
        s.from_cube.send(std::move(n), time_, world_.air, dice_);
      }
      s.from_cube.deliver(time_, [&](const Notification& n) { notify(s, n); });
    }
    watch();
  }

  /// Lets a cube be found once a scan has gone on for a while, and its characteristics once it has
  /// been connected for a while.
  void show(Station& s) {
    if (scanning_since_ && !s.visible && time_ > *scanning_since_ + kFindTime) {
      s.visible = true;
      added(s.path, [&](sd_bus_message* m) { append_device(m, s); });
    }
    if (s.connected && !s.resolved && time_ > s.connected_at + kResolveTime) {
      for (const Characteristic c : kCharacteristics) {
        added(s.path_of(c), [&](sd_bus_message* m) { append_characteristic(m, s, c); });
      }
      s.resolved = true;
      changed(s.path, kDevice, "ServicesResolved", true);
    }
  }

  void befall(std::size_t i) {
    Station& s = stations_[i];
    const auto due = [&](const std::optional<Mishap>& mishap) {
      return mishap && mishap->cube == i && s.moved_at && time_ >= *s.moved_at + mishap->after;
    };
    if (due(world_.disconnect)) {
      const double never = std::numeric_limits<double>::infinity();
      s.deaf_until = time_ + world_.disconnect->lasts.value_or(never);
      world_.disconnect.reset();
      drop(s);
    }
    if (due(world_.press)) {
      world_.press.reset();
      s.cube.press(true);
    }
    if (due(world_.bump)) {
      world_.bump.reset();
      s.cube.bump();
    }
  }

  void watch() {
    const Vehicle body = body_of(world_.cube, Facing::kNoseFirst, {0.0, 0.0});
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      const referee::Box a = referee::footprint(body, stations_[i].cube.pose());
      for (std::size_t j = i + 1; j < stations_.size(); ++j) {
        const referee::Box b = referee::footprint(body, stations_[j].cube.pose());
        least_clearance_ = std::min(least_clearance_, referee::separation(a, b));
      }
    }
  }

  void drop(Station& s) {
    if (!s.connected) return;
    s.connected = s.resolved = false;
    s.notifying.clear();
    s.cube.disconnect();
    for (const Characteristic c : kCharacteristics) removed(s.path_of(c), kGatt);
    changed(s.path, kDevice, "ServicesResolved", false);
    changed(s.path, kDevice, "Connected", false);
  }

  void take(Station& s, Characteristic to, Bytes bytes) {
    ++s.writes;
    if (int(bytes.size()) > world_.mtu - 3) {
      ++s.dropped;
      return;
    }
    if (to == Characteristic::kMotor) {
      s.last_motor = to_hex(bytes);
      if (!s.moved_at) s.moved_at = time_;
    }
    if (is_lost(to, s.settings_to_lose)) return;
    s.to_cube.send({to, std::move(bytes)}, time_, world_.air, dice_);
  }

  /// Counts down the settings, or the answers to them, that never arrive.
  static bool is_lost(Characteristic characteristic, int& left) {
    if (characteristic != Characteristic::kConfiguration || left == 0) return false;
    --left;
    return true;
  }

  // What BlueZ tells ----------------------------------------------------------------------------

  [[nodiscard]] Message signal(const std::string& path, const char* interface, const char* name) {
    sd_bus_message* m = nullptr;
    check(sd_bus_message_new_signal(bus_.get(), &m, path.c_str(), interface, name), name);
    return Message(m);
  }

  template <class Append>
  void added(const std::string& path, const Append& append) {
    const Message m = signal("/", "org.freedesktop.DBus.ObjectManager", "InterfacesAdded");
    check(sd_bus_message_append(m.get(), "o", path.c_str()), "added");
    append(m.get());
    check(sd_bus_send(bus_.get(), m.get(), nullptr), "added");
  }

  void removed(const std::string& path, const char* interface) {
    const Message m = signal("/", "org.freedesktop.DBus.ObjectManager", "InterfacesRemoved");
    check(sd_bus_message_append(m.get(), "oas", path.c_str(), 1, interface), "removed");
    check(sd_bus_send(bus_.get(), m.get(), nullptr), "removed");
  }

  void changed(const std::string& path, const char* interface, const char* key, bool value) {
    const Message m = signal(path, "org.freedesktop.DBus.Properties", "PropertiesChanged");
    check(sd_bus_message_append(m.get(), "sa{sv}as", interface, 1, key, "b", int(value), 0), key);
    check(sd_bus_send(bus_.get(), m.get(), nullptr), key);
  }

  void notify(Station& s, const Notification& n) {
    if (!s.connected || !s.notifying.contains(n.from)) return;
    const Message m =
        signal(s.path_of(n.from), "org.freedesktop.DBus.Properties", "PropertiesChanged");
    sd_bus_message* raw = m.get();
    check(sd_bus_message_append(raw, "s", kGatt), "notify");
    check(sd_bus_message_open_container(raw, 'a', "{sv}"), "notify");
    append_bytes(raw, n.bytes);
    check(sd_bus_message_close_container(raw), "notify");
    check(sd_bus_message_append(raw, "as", 0), "notify");
    check(sd_bus_send(bus_.get(), raw, nullptr), "notify");
  }

  static void append_bytes(sd_bus_message* m, const Bytes& bytes) {
    check(sd_bus_message_open_container(m, 'e', "sv"), "bytes");
    check(sd_bus_message_append(m, "s", "Value"), "bytes");
    check(sd_bus_message_open_container(m, 'v', "ay"), "bytes");
    check(sd_bus_message_append_array(m, 'y', bytes.data(), bytes.size()), "bytes");
    check(sd_bus_message_close_container(m), "bytes");
    check(sd_bus_message_close_container(m), "bytes");
  }

  /// "a{sa{sv}}" with one interface, its properties appended by `append`.
  template <class Append>
  static void append_interface(sd_bus_message* m, const char* name, const Append& append) {
    check(sd_bus_message_open_container(m, 'a', "{sa{sv}}"), name);
    check(sd_bus_message_open_container(m, 'e', "sa{sv}"), name);
    check(sd_bus_message_append(m, "s", name), name);
    check(sd_bus_message_open_container(m, 'a', "{sv}"), name);
    append();
    for (int level = 0; level < 3; ++level) check(sd_bus_message_close_container(m), name);
  }

  void append_adapter(sd_bus_message* m) const {
    append_interface(m, kAdapter, [&] {
      append_text(m, "Address", "CA:B3:FF:00:00:01");
      append_flag(m, "Powered", powered_);
      append_flag(m, "Discovering", scanning_since_.has_value());
    });
  }

  static void append_device(sd_bus_message* m, const Station& s) {
    append_interface(m, kDevice, [&] {
      append_text(m, "Address", s.address);
      append_text(m, "Name", s.name);
      append_text(m, "Adapter", kAdapterPath, "o");
      append_flag(m, "Connected", s.connected);
      append_flag(m, "ServicesResolved", s.resolved);
      check(sd_bus_message_append(m, "{sv}", "RSSI", "n", -50), "RSSI");
      check(sd_bus_message_append(m, "{sv}", "UUIDs", "as", 1, std::string(kServiceUuid).c_str()),
            "UUIDs");
    });
  }

  void append_characteristic(sd_bus_message* m, const Station& s, Characteristic c) const {
    append_interface(m, kGatt, [&] {
      append_text(m, "UUID", uuid(c));
      append_text(m, "Service", s.service_path(), "o");
      append_flag(m, "Notifying", s.notifying.contains(c));
      check(sd_bus_message_append(m, "{sv}", "Flags", "as", 2, flags_of(c), "notify"), "Flags");
      check(sd_bus_message_append(m, "{sv}", "MTU", "q", world_.mtu), "MTU");
    });
  }

  void append_objects(sd_bus_message* m) const {
    const auto object = [&](const std::string& path, const auto& append) {
      check(sd_bus_message_open_container(m, 'e', "oa{sa{sv}}"), "objects");
      check(sd_bus_message_append(m, "o", path.c_str()), "objects");
      append();
      check(sd_bus_message_close_container(m), "objects");
    };
    check(sd_bus_message_open_container(m, 'a', "{oa{sa{sv}}}"), "objects");
    if (world_.adapter) object(kAdapterPath, [&] { append_adapter(m); });
    for (const Station& s : stations_) {
      if (s.visible) object(s.path, [&] { append_device(m, s); });
      for (const Characteristic c : kCharacteristics) {
        if (s.resolved) object(s.path_of(c), [&] { append_characteristic(m, s, c); });
      }
    }
    check(sd_bus_message_close_container(m), "objects");
  }

  // What BlueZ is asked -------------------------------------------------------------------------

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
    for (Station& s : stations_) {
      if (path == s.path) return answer_device(m, member, s);
      for (const Characteristic c : kCharacteristics) {
        if (s.resolved && path == s.path_of(c)) return answer_characteristic(m, member, s, c);
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

  int answer_adapter(sd_bus_message* m, std::string_view member) {
    if (member == "Set") {
      powered_ = true;
    } else if (!powered_) {
      return refuse(m, "org.bluez.Error.NotReady", "Resource Not Ready");
    } else if (member == "StartDiscovery") {
      scanning_since_ = time_;
    } else if (member == "StopDiscovery") {
      scanning_since_.reset();
    } else if (member != "SetDiscoveryFilter") {
      return refuse(m, "org.freedesktop.DBus.Error.UnknownMethod", "no such method");
    }
    return done(m);
  }

  int answer_device(sd_bus_message* m, std::string_view member, Station& s) {
    if (member == "Disconnect") {
      drop(s);
      return done(m);
    }
    if (member != "Connect") {
      return refuse(m, "org.freedesktop.DBus.Error.UnknownMethod", "no such method");
    }
    if (s.failures_left > 0 || time_ < s.deaf_until) {
      s.failures_left = std::max(0, s.failures_left - 1);
      return refuse(m, "org.bluez.Error.Failed", "le-connection-abort-by-local");
    }
    s.connected = true;
    s.connected_at = time_;
    changed(s.path, kDevice, "Connected", true);
    return done(m);
  }

  int answer_characteristic(sd_bus_message* m, std::string_view member, Station& s,
                            Characteristic c) {
    if (member == "StartNotify") {
      s.notifying.insert(c);
      return done(m);
    }
    if (member == "StopNotify") {
      s.notifying.erase(c);
      return done(m);
    }
    if (member == "ReadValue") {
      sd_bus_message* raw = nullptr;
      check(sd_bus_message_new_method_return(m, &raw), "reply");
      const Message reply(raw);
      const Bytes bytes = s.cube.value(c);
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
    take(s, c, Bytes(begin, begin + size));
    return sd_bus_message_get_expect_reply(m) > 0 ? done(m) : 1;
  }

  EmulatedWorld world_;
  WorldDice dice_;
  dbus::Bus bus_;
  std::vector<Station> stations_;
  Clock::time_point begin_ = Clock::now();
  double time_ = 0.0;
  bool powered_ = false;
  std::optional<double> scanning_since_;
  double least_clearance_ = std::numeric_limits<double>::infinity();
};

EmulatedBluez::EmulatedBluez(const EmulatedWorld& world)
    : service_(std::make_unique<Service>(world)) {}

EmulatedBluez::~EmulatedBluez() = default;

void EmulatedBluez::live(double seconds) { service_->live(seconds); }

WorldReport EmulatedBluez::report() const { return service_->report(); }

}  // namespace mvtp
