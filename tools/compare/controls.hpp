#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mvtp {

/// A control to run: which scenario it is found in, and who drives.
struct Control {
  std::string name;
  std::string configuration;
  std::string controller;
  bool drives = false;  ///< vehicles; else at most signals
};

/// NAME.KIND.sumocfg beside NAME.sumocfg, if it is there: the same demand at a network with a
/// light.
[[nodiscard]] std::optional<std::string> twin_of(const std::string& configuration,
                                                 const std::string& kind);

/// The controllers with these names, each once. Those that need signals run on a twin where the
/// network has none.
/// @throws InputError for a name of none, and where signals are missing
[[nodiscard]] std::vector<Control> named_controls(const std::string& configuration,
                                                  const std::vector<std::string>& names);

}  // namespace mvtp
