#include "tools/coordinate/fault_options.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <functional>
#include <numbers>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tools/cli/suggest.hpp"

namespace mvtp {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kLongestDelay = 10.0;  ///< [s]
constexpr double kMostLoss = 0.9;
constexpr double kLongestRun = 1e9;  ///< [s]

/// A number that a key takes, and where it goes.
struct Key {
  std::string_view name;
  double most;
  std::vector<double*> targets;
  double unit = 1.0;
};

std::vector<Key> model_keys(FaultModel& m) {
  return {{"delay", kLongestDelay, {&m.command.delay, &m.report.delay}},
          {"loss", kMostLoss, {&m.command.loss, &m.report.loss}},
          {"command-delay", kLongestDelay, {&m.command.delay}},
          {"command-loss", kMostLoss, {&m.command.loss}},
          {"report-delay", kLongestDelay, {&m.report.delay}},
          {"report-loss", kMostLoss, {&m.report.loss}},
          {"position", 10.0, {&m.position}},
          {"heading", 30.0, {&m.heading}, kRadians},
          {"actuation", 5.0, {&m.actuation}}};
}

std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole ? std::optional(value) : std::nullopt;
}

/// VEHICLE@SECONDS
std::optional<VehicleFault> vehicle_fault(VehicleFault::Kind kind, const std::string& text) {
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos || at == 0) return std::nullopt;
  const std::optional<double> time = number_of(std::string_view(text).substr(at + 1));
  if (!time || !(*time >= 0.0 && *time <= kLongestRun)) return std::nullopt;
  return VehicleFault{.kind = kind, .id = text.substr(0, at), .time = *time};
}

/// Takes what is no Key. @param where  it stands: the option, and the name with its value
using OtherKeys = std::function<bool(const std::string& where, const std::string& name,
                                     const std::string& value)>;

/// Reads KEY=VALUE,...; `other` takes what is none of the keys.
void read(const std::string& option, const std::string& text, const std::vector<Key>& keys,
          const OtherKeys& other, std::vector<std::string> names) {
  for (const Key& key : keys) names.emplace_back(key.name);
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const std::size_t equal = word.find('=');
    const std::string name = word.substr(0, equal);
    const std::string value = equal == std::string::npos ? "" : word.substr(equal + 1);
    const std::string where = option + " " + word;
    const auto key = std::ranges::find(keys, name, &Key::name);
    if (key == keys.end()) {
      if (other(where, name, value)) continue;
      throw InputError(where, "is not a fault with a value; " + suggestion(name, names));
    }
    const std::optional<double> amount = number_of(value);
    if (!amount || !(*amount >= 0.0 && *amount <= key->most)) {
      throw InputError(where, fmt::format("give {} a number from 0 to {:g}", name, key->most));
    }
    for (double* target : key->targets) *target = *amount * key->unit;
  }
}

}  // namespace

FaultPlan read_faults(const std::string& text) {
  FaultPlan plan;
  double sumo_ends = -1.0;
  std::vector<Key> keys = model_keys(plan.model);
  keys.push_back({"stops", 1.0, {&plan.stop_share}});
  keys.push_back({"ignores", 1.0, {&plan.ignore_share}});
  keys.push_back({"stops-for", kLongestRun, {&plan.stop_duration}});
  keys.push_back({"late", 1.0, {&plan.late_share}});
  keys.push_back({"sumo-ends", kLongestRun, {&sumo_ends}});
  const auto vehicle = [&](const std::string& where, const std::string& name,
                           const std::string& value) {
    const bool stops = name == "stop";
    if (!stops && name != "ignore") return false;
    using enum VehicleFault::Kind;
    const auto fault = vehicle_fault(stops ? kStops : kIgnores, value);
    if (!fault) {
      throw InputError(where, fmt::format("give {} a vehicle and a time from 0 on [s], {}=VEHICLE@"
                                          "SECONDS",
                                          name, name));
    }
    plan.vehicles.push_back(*fault);
    return true;
  };
  read("--faults", text, keys, vehicle, {"stop=VEHICLE@SECONDS", "ignore=VEHICLE@SECONDS"});
  if (sumo_ends >= 0.0) plan.sumo_ends = sumo_ends;
  return plan;
}

FaultModel read_assumed(const std::string& text, const FaultPlan& faults) {
  if (text == "faults") return faults.model;
  FaultModel model;
  const auto none = [](const std::string&, const std::string&, const std::string&) {
    return false;
  };
  if (text != "none") read("--assume-noise", text, model_keys(model), none, {});
  return model;
}

}  // namespace mvtp
