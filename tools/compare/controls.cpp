#include "tools/compare/controls.hpp"

#include <algorithm>
#include <filesystem>

#include "planner/problem/input_error.hpp"
#include "tools/coordinate/options.hpp"
#include "traci_bridge/configuration.hpp"
#include "traci_bridge/network.hpp"

namespace mvtp {

std::optional<std::string> twin_of(const std::string& configuration, const std::string& kind) {
  std::filesystem::path twin = configuration;
  twin.replace_extension("." + kind + twin.extension().string());
  if (!std::filesystem::exists(twin)) return std::nullopt;
  return twin.string();
}

std::vector<Control> named_controls(const std::string& configuration,
                                    const std::vector<std::string>& names) {
  std::vector<Control> controls;
  const bool signals = !read_network(read_configuration(configuration).net_file).signals.empty();
  for (const std::string& name : names) {
    const ControllerKind& kind = controller_named("--controllers", name);
    if (std::ranges::find(controls, name, &Control::name) != controls.end()) continue;
    std::optional<std::string> scenario = configuration;
    if (kind.needs_signals && !signals) {
      scenario = name == "actuated" ? twin_of(configuration, name) : std::nullopt;
      if (!scenario) scenario = twin_of(configuration, "static");
    }
    if (!scenario) {
      throw InputError("--controllers " + name,
                       "needs traffic signals: " + configuration +
                           " has none, and no twin with a light lies beside it");
    }
    controls.push_back({name, *scenario, name, kind.drives});
  }
  return controls;
}

}  // namespace mvtp
