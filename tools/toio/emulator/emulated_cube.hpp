#pragma once

#include <fmt/format.h>

#include <optional>
#include <set>
#include <string>

#include "tools/toio/cube/protocol.hpp"
#include "tools/toio/emulator/air.hpp"
#include "tools/toio/emulator/cube_model.hpp"

namespace mvtp {

/// One emulated cube, its link, and how BlueZ sees it.
struct EmulatedCube {
  std::string name;
  std::string address;
  std::string path;
  CubeModel model;
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

}  // namespace mvtp
