#include "tools/coordinate/lot_options.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

/// @throws InputError if it does not drive on parking lots
LotController controller_of(const std::string& name) {
  const char* option = "--controller";
  const std::optional<LotController> controller = controller_named(option, name).on_lots;
  if (!controller) {
    throw InputError(fmt::format("{} {}", option, name),
                     fmt::format("does not drive on parking lots; choose {}", kUsualController));
  }
  return *controller;
}

ParkingDirection direction_of(const std::string& name) {
  if (name == "forward") return ParkingDirection::kForward;
  return name == "reverse" ? ParkingDirection::kReverse : ParkingDirection::kAny;
}

}  // namespace

LotOptions lot_options(const CoordinateOptions& options) {
  LotOptions lot;
  lot.controller = controller_of(options.controller);
  lot.parking = direction_of(options.parking);
  for (const std::string& word : options.breakdowns) {
    const std::size_t at = word.rfind('@');
    double time = -1.0;
    const char* end = word.data() + word.size();
    const bool good = at != std::string::npos && at > 0 &&
                      std::from_chars(word.data() + at + 1, end, time) ==
                          std::from_chars_result{end, std::errc()} &&
                      std::isfinite(time) && time >= 0.0;
    if (!good) {
      throw InputError("--break-down " + word, "is not VEHICLE@SECONDS, e.g. in00.3@120");
    }
    lot.breakdowns[word.substr(0, at)] = time;
  }
  return lot;
}

}  // namespace mvtp
