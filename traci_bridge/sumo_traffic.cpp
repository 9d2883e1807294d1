#include "traci_bridge/sumo_traffic.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "traci_bridge/configuration.hpp"
#include "traci_bridge/network.hpp"
#include "traci_bridge/sumo_backend.hpp"

namespace mvtp {
namespace {

/// Options of SUMO that would end the run before it begins, or that break what Traffic promises.
constexpr std::array<std::string_view, 22> kRefused = {"--help",
                                                       "-?",
                                                       "--version",
                                                       "-V",
                                                       "--save-configuration",
                                                       "-C",
                                                       "--save-template",
                                                       "--save-schema",
                                                       "--save-commented",
                                                       "--net-file",
                                                       "-n",
                                                       "--net",
                                                       "-c",
                                                       "--configuration",
                                                       "--remote-port",
                                                       "--num-clients",
                                                       "--mesosim",
                                                       "--fcd-output",
                                                       "--tripinfo-output",
                                                       "--seed",
                                                       "--random",
                                                       "--error-log"};

/// An option of the command line without its value.
std::string_view name_of(std::string_view argument) {
  return argument.substr(0, argument.find('='));
}

/// An option, or a value, which may be a negative number?
bool is_option(std::string_view argument) {
  return argument.starts_with('-') && argument.find_first_of("0123456789.") != 1;
}

void check_extra(const SumoOptions& options, const std::vector<std::string>& ours) {
  for (const std::string& argument : options.extra) {
    if (!is_option(argument)) continue;
    const std::string_view name = name_of(argument);
    const bool refused = std::ranges::find(kRefused, name) != kRefused.end() ||
                         std::ranges::find(ours, name) != ours.end();
    if (refused) {
      throw InputError("SUMO option " + std::string(name),
                       "this program sets it itself or cannot run with it; leave it out");
    }
  }
}

std::vector<std::string> arguments_of(const SumoOptions& options) {
  std::vector<std::string> arguments = {
      options.gui ? "sumo-gui" : "sumo", "--configuration-file", options.configuration,
      // Say nothing but errors and warnings.
      "--no-step-log", "true", "--duration-log.disable", "true", "--no-warnings", "false",
      "--xml-validation", "never",
      // Vehicles stay where they are: a jam or a contact shows in the results, not in teleports.
      "--time-to-teleport", "-1", "--collision.action", "warn", "--collision.check-junctions",
      "true", "--collision.mingap-factor", "0"};
  const auto add = [&](std::initializer_list<std::string> more) {
    arguments.insert(arguments.end(), more);
  };
  if (options.seed) add({"--seed", std::to_string(*options.seed), "--random", "false"});
  if (options.gui) add({"--start", "true", "--quit-on-end", "true"});
  return arguments;
}

/// What goes before the name of every output file; SUMO's word TIME is the time of day.
std::string output_prefix(const SumoConfiguration& configuration) {
  const auto given = configuration.others.find("output-prefix");
  if (given == configuration.others.end()) return "";
  std::string prefix = given->second;
  if (const std::size_t at = prefix.find("TIME"); at != std::string::npos) {
    const std::time_t now = std::time(nullptr);
    std::tm local{};
    std::array<char, 32> text{};
    localtime_r(&now, &local);
    std::strftime(text.data(), text.size(), "%Y-%m-%d-%H-%M-%S", &local);
    prefix.replace(at, 4, text.data());
  }
  return prefix;
}

/// Options of a scenario with which SUMO would wait for other programs, or is no microscopic one.
void check_configuration(const SumoOptions& options, const SumoConfiguration& configuration) {
  const auto refuse_unless = [&](const char* option, std::initializer_list<const char*> harmless,
                                 const char* why) {
    const auto given = configuration.others.find(option);
    if (given == configuration.others.end()) return;
    if (std::ranges::find(harmless, given->second) != harmless.end()) return;
    throw InputError(options.configuration, std::string(option) + " " + given->second + ": " + why);
  };
  refuse_unless("remote-port", {"", "0", "-1"},
                "SUMO would wait for another program to connect; leave it out");
  refuse_unless("num-clients", {"", "1"}, "this program is SUMO's only client; leave it out");
  refuse_unless("mesosim", {"", "0", "false", "no", "off"},
                "the mesoscopic model has no vehicles that can be driven; leave it out");
}

/// @throws InputError if there is no screen on which a window could be shown.
void require_display() {
  for (const char* variable : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    const char* value = std::getenv(variable);
    if (value != nullptr && *value != '\0') return;
  }
  throw InputError("--gui",
                   "there is no display (DISPLAY is not set); run it on a desktop, or leave "
                   "--gui out");
}

/// What only the one who starts SUMO can say.
void check_remote(const SumoOptions& options) {
  const std::string where = "--remote " + options.remote->host;
  if (options.gui) {
    throw InputError(where, "joins a SUMO that runs already; leave --gui out, or start sumo-gui");
  }
  if (!options.extra.empty()) {
    throw InputError(where, "joins a SUMO that runs already; give it the option " +
                                options.extra.front() + " where it is started");
  }
}

}  // namespace

std::unique_ptr<SumoTraffic> open_sumo(const SumoOptions& options) {
  const SumoConfiguration configuration = read_configuration(options.configuration);
  SumoLaunch launch{.configuration = options.configuration,
                    .arguments = arguments_of(options),
                    .network = read_network(configuration.net_file, options.point),
                    .outputs = {},
                    .log = options.log,
                    .remote = options.remote,
                    .point = options.point};
  if (options.remote) {
    check_remote(options);
    return launch_libtraci(std::move(launch));
  }
  check_configuration(options, configuration);
  check_extra(options, launch.arguments);

  const std::string prefix = output_prefix(configuration);
  if (!prefix.empty()) {
    launch.arguments.insert(launch.arguments.end(), {"--output-prefix", prefix});
  }
  const auto write = [&](const char* option, const std::string& path) {
    launch.outputs.emplace_back(path, prefix);
    launch.arguments.insert(launch.arguments.end(), {option, launch.outputs.back().part()});
  };
  if (!options.fcd_output.empty()) write("--fcd-output", options.fcd_output);
  if (!options.tripinfo_output.empty()) {
    write("--tripinfo-output", options.tripinfo_output);
    launch.arguments.insert(launch.arguments.end(), {"--tripinfo-output.write-unfinished", "true",
                                                     "--tripinfo-output.write-undeparted", "true"});
  }
  launch.arguments.insert(launch.arguments.end(), options.extra.begin(), options.extra.end());
  if (options.gui) require_display();
  return options.gui || options.separate_process ? launch_libtraci(std::move(launch))
                                                 : launch_libsumo(std::move(launch));
}

}  // namespace mvtp
