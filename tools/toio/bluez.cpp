#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <thread>
#include <utility>

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
using dbus::Slot;

constexpr const char* kBluez = "org.bluez";
constexpr double kCallTime = 5.0;      // of calls but Connect [s]
constexpr double kConnectTime = 20.0;  // [s]
constexpr double kSlice = 0.01;        // between two looks whether to stop [s]
constexpr int kTries = 3;              // to connect, and
constexpr double kRetryPause = 0.3;    // between them, and
constexpr double kRetryLater = 1.0;    // between those that nobody waits for [s]
constexpr int kLeastMtu = 23;

/// What is known of one object of BlueZ; which fields count depends on its interface.
struct Object {
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

/// The value of a variant if it is of this type; else it is skipped.
template <class Value>
std::optional<Value> variant(sd_bus_message* m, const char* type) {
  const char* content = nullptr;
  if (sd_bus_message_peek_type(m, nullptr, &content) > 0 && std::strcmp(content, type) == 0) {
    Value value{};
    if (sd_bus_message_read(m, "v", type, &value) >= 0) return value;
  }
  (void)sd_bus_message_skip(m, "v");
  return std::nullopt;
}

void read_text(sd_bus_message* m, std::string& target) {
  if (const auto text = variant<const char*>(m, "s")) target = *text;
}

void read_flag(sd_bus_message* m, bool& target) {
  if (const auto flag = variant<int>(m, "b")) target = *flag != 0;
}

/// Reads "as".
std::vector<std::string> read_list(sd_bus_message* m) {
  std::vector<std::string> texts;
  char** list = nullptr;
  (void)sd_bus_message_read_strv(m, &list);
  for (char** text = list; text != nullptr && *text != nullptr; ++text) {
    texts.emplace_back(*text);
    std::free(*text);
  }
  std::free(static_cast<void*>(list));
  return texts;
}

/// Reads a variant of "as".
std::vector<std::string> read_texts(sd_bus_message* m) {
  if (sd_bus_message_enter_container(m, 'v', "as") <= 0) {
    (void)sd_bus_message_skip(m, "v");
    return {};
  }
  std::vector<std::string> texts = read_list(m);
  (void)sd_bus_message_exit_container(m);
  return texts;
}

std::optional<Bytes> read_bytes(sd_bus_message* m) {
  if (sd_bus_message_enter_container(m, 'v', "ay") <= 0) {
    (void)sd_bus_message_skip(m, "v");
    return std::nullopt;
  }
  const void* data = nullptr;
  std::size_t size = 0;
  std::optional<Bytes> bytes;
  if (sd_bus_message_read_array(m, 'y', &data, &size) >= 0) {
    const auto* begin = static_cast<const std::uint8_t*>(data);
    bytes.emplace(begin, begin + size);
  }
  (void)sd_bus_message_exit_container(m);
  return bytes;
}

/// Reads "a{sv}" into the object. @return the `Value`, if it was among them.
std::optional<Bytes> read_properties(sd_bus_message* m, Object& object) {
  std::optional<Bytes> value;
  if (sd_bus_message_enter_container(m, 'a', "{sv}") < 0) return value;
  while (sd_bus_message_enter_container(m, 'e', "sv") > 0) {
    const char* key = nullptr;
    (void)sd_bus_message_read(m, "s", &key);
    const std::string_view name = key == nullptr ? "" : key;
    if (name == "Address") {
      read_text(m, object.address);
    } else if (name == "Name") {
      read_text(m, object.name);
    } else if (name == "UUID") {
      read_text(m, object.uuid);
    } else if (name == "UUIDs") {
      object.uuids = read_texts(m);
    } else if (name == "Powered") {
      read_flag(m, object.powered);
    } else if (name == "Connected") {
      read_flag(m, object.connected);
    } else if (name == "ServicesResolved") {
      read_flag(m, object.resolved);
    } else if (name == "RSSI") {
      if (const auto rssi = variant<std::int16_t>(m, "n")) object.rssi = *rssi;
    } else if (name == "MTU") {
      if (const auto mtu = variant<std::uint16_t>(m, "q")) object.mtu = *mtu;
    } else if (name == "Value") {
      value = read_bytes(m);
    } else {
      (void)sd_bus_message_skip(m, "v");
    }
    (void)sd_bus_message_exit_container(m);
  }
  (void)sd_bus_message_exit_container(m);
  return value;
}

/// Reads "a{sa{sv}}".
void read_interfaces(sd_bus_message* m, Object& object) {
  if (sd_bus_message_enter_container(m, 'a', "{sa{sv}}") < 0) return;
  while (sd_bus_message_enter_container(m, 'e', "sa{sv}") > 0) {
    const char* interface = nullptr;
    (void)sd_bus_message_read(m, "s", &interface);
    const std::string_view name = interface == nullptr ? "" : interface;
    object.adapter = object.adapter || name == kAdapter;
    object.device = object.device || name == kDevice;
    object.characteristic = object.characteristic || name == kGatt;
    if (name == kAdapter || name == kDevice || name == kGatt) {
      (void)read_properties(m, object);
    } else {
      (void)sd_bus_message_skip(m, "a{sv}");
    }
    (void)sd_bus_message_exit_container(m);
  }
  (void)sd_bus_message_exit_container(m);
}

bool is_cube(const Object& object) {
  return object.device && std::ranges::any_of(object.uuids, [](const std::string& uuid) {
           // Upper or lower case, as with characteristics.
           return uuid.size() == kServiceUuid.size() &&
                  std::ranges::equal(uuid, kServiceUuid, [](char a, char b) {
                    return a == b || (a >= 'A' && a <= 'F' && a - 'A' + 'a' == b);
                  });
         });
}

}  // namespace

class Bluetooth::Bus {
 public:
  explicit Bus(std::function<bool()> interrupted) : interrupted_(std::move(interrupted)) {
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
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  ~Bus() = default;

  std::function<void(const std::string&, const Notification&)> handler;
  bool finishing = false;

  [[nodiscard]] const std::map<std::string, Object>& objects() const { return objects_; }
  [[nodiscard]] const std::string& adapter() const { return adapter_; }

  [[nodiscard]] const Object* find(const std::string& path) const {
    const auto found = objects_.find(path);
    return found == objects_.end() ? nullptr : &found->second;
  }

  /// Is the cube connected, with its characteristics?
  [[nodiscard]] bool ready(const std::string& path) const {
    const Object* object = find(path);
    return object != nullptr && object->connected && object->resolved;
  }

  /// Where a cube's characteristic is on the bus; empty if the cube has none.
  [[nodiscard]] std::string characteristic(const std::string& cube, Characteristic wanted) const {
    for (auto at = objects_.lower_bound(cube + "/"); at != objects_.end(); ++at) {
      if (!at->first.starts_with(cube + "/")) break;
      if (at->second.characteristic && characteristic_of(at->second.uuid) == wanted) {
        return at->first;
      }
    }
    return "";
  }

  /// The same. @throws BluetoothError if the cube has none.
  [[nodiscard]] std::string place_of(const std::string& cube, Characteristic wanted) const {
    const Object* object = find(cube);
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

  [[nodiscard]] Message method(const std::string& path, const char* interface, const char* name) {
    sd_bus_message* message = nullptr;
    check(
        sd_bus_message_new_method_call(bus_.get(), &message, kBluez, path.c_str(), interface, name),
        name);
    return Message(message);
  }

  /// Calls, and handles what else comes in until the reply is there.
  /// @throws BluetoothError with the reason in the reply, or if none comes.
  Message call(const Message& message, double seconds = kCallTime) {
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

  /// Asks a cube to connect, unless that is under way or was tried a moment ago.
  void begin_to_connect(const std::string& path) {
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

  /// Only sends.
  void cast(const Message& message) {
    check(sd_bus_message_set_expect_reply(message.get(), 0), "send");
    check(sd_bus_send(bus_.get(), message.get(), nullptr), "send");
    check(sd_bus_flush(bus_.get()), "send");
  }

  /// @return whether the condition came true.
  bool wait_until(double seconds, const std::function<bool()>& condition) {
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

  void load_objects() {
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

 private:
  /// To connect a cube that nobody waits for.
  struct Attempt {
    Slot slot;
    bool under_way = false;
    Clock::time_point next;  ///< not before
  };

  static int on_signal(sd_bus_message* m, void* data, sd_bus_error*) {
    static_cast<Bus*>(data)->handle(m);
    return 0;
  }

  void handle(sd_bus_message* m) {
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

  void hand_on(const std::string& path, const Object& object, const Bytes& value) {
    if (!handler || !object.characteristic) return;
    const std::optional<Characteristic> from = characteristic_of(object.uuid);
    const std::size_t cube = path.find("/service");
    if (from && cube != std::string::npos) handler(path.substr(0, cube), {*from, value});
  }

  dbus::Bus bus_;
  std::function<bool()> interrupted_;
  std::map<std::string, Object> objects_;
  std::string adapter_;
  std::map<std::string, Attempt> attempts_;  ///< by path
};

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
  const Object* object = bus_->find(path);
  return object != nullptr && object->connected;
}

int Bluetooth::mtu(const std::string& path) const {
  const Object* object = bus_->find(bus_->characteristic(path, Characteristic::kMotor));
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

namespace {

/// Fills in the arguments of WriteValue; only the motors take writes without an answer.
void append_write(const Message& message, const Write& write) {
  check(sd_bus_message_append_array(message.get(), 'y', write.bytes.data(), write.bytes.size()),
        "WriteValue");
  check(sd_bus_message_append(message.get(), "a{sv}", 1, "type", "s",
                              write.to == Characteristic::kMotor ? "command" : "request"),
        "WriteValue");
}

}  // namespace

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
