#include "tools/toio/emulator/emulated_cubes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "planner/problem/referee_geometry.hpp"
#include "tools/toio/device/dbus.hpp"
#include "tools/toio/emulator/emulated_objects.hpp"

namespace mvtp {
namespace {

using dbus::kDevice;
using dbus::kGatt;

constexpr double kFindTime = 0.2;     // until a cube shows in a scan [s]
constexpr double kResolveTime = 0.1;  // until its characteristics show [s]

/// Counts down the settings, or the answers to them, that never arrive.
bool is_lost(Characteristic characteristic, int& left) {
  if (characteristic != Characteristic::kConfiguration || left == 0) return false;
  --left;
  return true;
}

}  // namespace

EmulatedCubes::EmulatedCubes(const EmulatedWorld& world, const EmulatedSignals& signals)
    : world_(world), signals_(signals), dice_(world.seed) {
  for (std::size_t i = 0; i < world.starts.size(); ++i) add_cube(i);
}

void EmulatedCubes::add_cube(std::size_t i) {
  const double error = 0.02;
  const CubeFlaws flaws{dice_.between(1 - error, 1 + error), dice_.between(1 - error, 1 + error),
                        static_cast<std::uint8_t>(world_.battery), world_.version};
  const auto number = int(i) + 1;
  EmulatedCube cube{.name = fmt::format("toio-{}{}a", char('E' + number / 10), number % 10),
                    .address = fmt::format("CA:B3:00:00:00:{:02X}", number),
                    .path = {},
                    .model = CubeModel(world_.mat, world_.cube, world_.starts[i], flaws),
                    .failures_left = world_.connect_failures,
                    .settings_to_lose = world_.lost_settings,
                    .answers_to_lose = world_.lost_settings};
  std::string file = cube.address;
  std::ranges::replace(file, ':', '_');
  cube.path = fmt::format("{}/dev_{}", kAdapterPath, file);
  cubes_.push_back(std::move(cube));
}

void EmulatedCubes::step() {
  for (std::size_t i = 0; i < cubes_.size(); ++i) {
    EmulatedCube& cube = cubes_[i];
    show(cube);
    befall(i);
    cube.to_cube.deliver(time_, [&](const Write& w) { cube.model.write(w.to, w.bytes); });
    if (dice_.happens(world_.stalls_per_minute / 60.0 * kStep)) {
      cube.model.block(dice_.between(world_.shortest_stall, world_.longest_stall));
    }
    cube.model.step(kStep);
    for (Notification& n : cube.model.take_notifications()) {
      if (!cube.connected || is_lost(n.from, cube.answers_to_lose)) continue;
      cube.from_cube.send(std::move(n), time_, world_.air, dice_);
    }
    cube.from_cube.deliver(time_, [&](const Notification& n) {
      if (cube.connected && cube.notifying.contains(n.from)) signals_.notify(cube, n);
    });
  }
  watch();
  time_ += kStep;
}

void EmulatedCubes::show(EmulatedCube& cube) {
  if (scanning_since_ && !cube.visible && time_ > *scanning_since_ + kFindTime) {
    cube.visible = true;
    signals_.added(cube);
  }
  if (cube.connected && !cube.resolved && time_ > cube.connected_at + kResolveTime) {
    for (const Characteristic c : kCharacteristics) signals_.added(cube, c, world_.mtu);
    cube.resolved = true;
    signals_.changed(cube.path, kDevice, "ServicesResolved", true);
  }
}

void EmulatedCubes::befall(std::size_t i) {
  EmulatedCube& cube = cubes_[i];
  const auto due = [&](const std::optional<Mishap>& mishap) {
    return mishap && mishap->cube == i && cube.moved_at && time_ >= *cube.moved_at + mishap->after;
  };
  if (due(world_.disconnect)) {
    const double never = std::numeric_limits<double>::infinity();
    cube.deaf_until = time_ + world_.disconnect->lasts.value_or(never);
    world_.disconnect.reset();
    drop(cube);
  }
  if (due(world_.press)) {
    world_.press.reset();
    cube.model.press(true);
  }
  if (due(world_.bump)) {
    world_.bump.reset();
    cube.model.bump();
  }
}

void EmulatedCubes::watch() {
  const Vehicle body = body_of(world_.cube, Facing::kNoseFirst, {0.0, 0.0});
  for (std::size_t i = 0; i < cubes_.size(); ++i) {
    const referee::Box a = referee::footprint(body, cubes_[i].model.pose());
    for (std::size_t j = i + 1; j < cubes_.size(); ++j) {
      const referee::Box b = referee::footprint(body, cubes_[j].model.pose());
      least_clearance_ = std::min(least_clearance_, referee::separation(a, b));
    }
  }
}

bool EmulatedCubes::connect(EmulatedCube& cube) {
  if (cube.failures_left > 0 || time_ < cube.deaf_until) {
    cube.failures_left = std::max(0, cube.failures_left - 1);
    return false;
  }
  cube.connected = true;
  cube.connected_at = time_;
  signals_.changed(cube.path, kDevice, "Connected", true);
  return true;
}

void EmulatedCubes::drop(EmulatedCube& cube) {
  if (!cube.connected) return;
  cube.connected = cube.resolved = false;
  cube.notifying.clear();
  cube.model.disconnect();
  for (const Characteristic c : kCharacteristics) signals_.removed(cube.path_of(c), kGatt);
  signals_.changed(cube.path, kDevice, "ServicesResolved", false);
  signals_.changed(cube.path, kDevice, "Connected", false);
}

void EmulatedCubes::take(EmulatedCube& cube, Characteristic to, Bytes bytes) {
  ++cube.writes;
  if (int(bytes.size()) > world_.mtu - 3) {
    ++cube.dropped;
    return;
  }
  if (to == Characteristic::kMotor) {
    cube.last_motor = to_hex(bytes);
    if (!cube.moved_at) cube.moved_at = time_;
  }
  if (is_lost(to, cube.settings_to_lose)) return;
  cube.to_cube.send({to, std::move(bytes)}, time_, world_.air, dice_);
}

WorldReport EmulatedCubes::report() const {
  WorldReport report{.least_clearance = least_clearance_, .touched = least_clearance_ < 0.0};
  const DeskFrame desk{world_.mat, world_.cube, Facing::kNoseFirst};
  for (const EmulatedCube& cube : cubes_) {
    report.cubes.push_back({cube.name, cube.model.wheel_speed_now(), cube.last_motor, cube.writes,
                            cube.dropped, desk.to_mat(cube.model.pose())});
  }
  return report;
}

}  // namespace mvtp
