#include "tools/toio/device/bluez_objects.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "tools/toio/device/dbus.hpp"

namespace mvtp {
namespace {

using dbus::kAdapter;
using dbus::kDevice;
using dbus::kGatt;

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

}  // namespace

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

std::optional<Bytes> read_properties(sd_bus_message* m, BluezObject& object) {
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

void read_interfaces(sd_bus_message* m, BluezObject& object) {
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

bool is_cube(const BluezObject& object) {
  return object.device && std::ranges::any_of(object.uuids, [](const std::string& uuid) {
           // Upper or lower case, as with characteristics.
           return uuid.size() == kServiceUuid.size() &&
                  std::ranges::equal(uuid, kServiceUuid, [](char a, char b) {
                    return a == b || (a >= 'A' && a <= 'F' && a - 'A' + 'a' == b);
                  });
         });
}

}  // namespace mvtp
