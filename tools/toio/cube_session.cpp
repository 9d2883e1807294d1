#include "tools/toio/cube_session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

namespace mvtp {
namespace {

constexpr int kLeastBattery = 20;                    // [%]
constexpr double kVersionTime = 2.0;                 // [s]
constexpr std::string_view kLeastVersion = "2.2.0";  // the first that can notify all the time

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char p, char q) {
    return std::tolower(static_cast<unsigned char>(p)) ==
           std::tolower(static_cast<unsigned char>(q));
  });
}

/// Asks for the protocol version; empty if the cube does not tell.
std::string version_of(Bluetooth& bluetooth, const FoundCube& cube) {
  std::string version;
  bluetooth.on_notification([&](const std::string& path, const Notification& notification) {
    const auto event = decode_event(notification.from, notification.bytes);
    if (path != cube.path || !event) return;
    if (const auto* told = std::get_if<Version>(&*event)) version = told->text;
  });
  bluetooth.write(cube.path, encode(AskVersion{}));
  for (double waited = 0.0; version.empty() && waited < kVersionTime; waited += 0.02) {
    bluetooth.wait(0.02);
  }
  bluetooth.on_notification(nullptr);
  return version;
}

void refuse_unfit(Bluetooth& bluetooth, const FoundCube& cube) {
  const std::string version = version_of(bluetooth, cube);
  if (version < kLeastVersion) {  // digits and points of equal length
    throw BluetoothError(
        fmt::format("{} has protocol {}, at least {} is needed; update its firmware "
                    "with toio's update page",
                    cube.name, version.empty() ? "unknown" : version, kLeastVersion));
  }
  const Bytes battery = bluetooth.read(cube.path, Characteristic::kBattery);
  const auto event = decode_event(Characteristic::kBattery, battery);
  if (const auto* level = event ? std::get_if<Battery>(&*event) : nullptr) {
    if (level->percent < kLeastBattery) {
      throw BluetoothError(
          fmt::format("the battery of {} is at {} %, at least {} % is needed; "
                      "charge it",
                      cube.name, level->percent, kLeastBattery));
    }
  }
}

}  // namespace

CubeSession::~CubeSession() {
  bluetooth_.on_notification(nullptr);  // who listened may be gone already
  bluetooth_.finish();
  stop_all();
  for (const FoundCube& cube : cubes_) {
    try {
      if (bluetooth_.connected(cube.path)) bluetooth_.disconnect(cube.path);
    } catch (const BluetoothError&) {
      // It will notice that nobody talks to it.
    }
  }
}

void CubeSession::add(const FoundCube& cube) {
  bluetooth_.connect(cube.path);
  cubes_.push_back(cube);
  for (const Characteristic c : {Characteristic::kId, Characteristic::kMotor,
                                 Characteristic::kButton, Characteristic::kConfiguration}) {
    bluetooth_.subscribe(cube.path, c);
  }
  refuse_unfit(bluetooth_, cube);
  // Always, so that silence means trouble.
  bluetooth_.write(cube.path, encode(NotifyId{1, NotifyWhen::kAlways}));
  bluetooth_.write(cube.path, encode(NotifyIdMissed{10}));
}

void CubeSession::stop_all() {
  const Write stop = encode(DriveOn{});
  // All at once first; then each by itself, so that one that does not answer holds up no other.
  try {
    for (const FoundCube& cube : cubes_) bluetooth_.write_now(cube.path, stop);
    bluetooth_.wait(0.05);  // cubes may miss commands that come closer
  } catch (const BluetoothError&) {
    // The bus is gone: the cubes stop by themselves when their last command ends.
  }
  for (const FoundCube& cube : cubes_) {
    try {
      if (bluetooth_.connected(cube.path)) bluetooth_.write(cube.path, stop);
    } catch (const BluetoothError&) {
      // Its last command ends by itself.
    }
  }
}

bool is_called(const FoundCube& cube, const std::string& name) {
  if (equal_ignoring_case(cube.address, name) || cube.name == name) return true;
  return name.size() == 3 && cube.name.size() > 3 && cube.name.ends_with("-" + name);
}

std::vector<FoundCube> find_cubes(Bluetooth& bluetooth, std::size_t count,
                                  const std::vector<std::string>& named, double seconds) {
  const auto missing = [&](const std::vector<FoundCube>& cubes) {
    std::vector<std::string> names;
    for (const std::string& name : named) {
      const auto called = [&](const FoundCube& cube) { return is_called(cube, name); };
      if (std::ranges::none_of(cubes, called)) names.push_back(name);
    }
    return names;
  };
  const std::vector<FoundCube> cubes =
      bluetooth.scan(seconds, [&](const std::vector<FoundCube>& found) {
        return found.size() >= count && missing(found).empty();
      });
  const std::vector<std::string> names = missing(cubes);
  if (!names.empty()) {
    throw BluetoothError(
        fmt::format("no cube called {} within {:.0f} s; switch it on, or see mvtp "
                    "toio scan",
                    fmt::join(names, ", "), seconds));
  }
  if (cubes.size() < count) {
    throw BluetoothError(
        fmt::format("{} of {} cubes found within {:.0f} s; switch the others on "
                    "near the computer",
                    cubes.size(), count, seconds));
  }
  return cubes;
}

}  // namespace mvtp
