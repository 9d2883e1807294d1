#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "planner/problem/input_error.hpp"
#include "tools/cli/child_process.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/program.hpp"
#include "tools/manual/command_help.hpp"
#include "tools/toio/device/bluetooth.hpp"
#include "tools/toio/emulator/emulated_bluez.hpp"
#include "tools/toio/emulator/stalls.hpp"

namespace mvtp {
namespace {

struct EmulatorOptions {
  EmulatedWorld world;
  std::string run;
  std::string mat = "simple";
  int cubes = 1;
  std::string stall = "0";
  std::string disconnect;
  std::string press;
  std::string bump;
  double delay_ms = 60.0;
  double loss_percent = 0.0;
  bool no_adapter = false;
};

/// "2:1.5": the second cube, after 1.5 s; "2:1.5:3": for 3 s.
std::optional<Mishap> parse_mishap(const std::string& option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ':');) words.push_back(word);
  const auto is_time = number_between(0, 1e6);
  if (words.size() < 2 || words.size() > 3 || !whole_number_between(1, 100)(words[0]).empty() ||
      !is_time(words[1]).empty() || !is_time(words.back()).empty()) {
    throw InputError(option, fmt::format("is \"{}\"; give CUBE:SECONDS, e.g. 2:1.5", text));
  }
  Mishap mishap{std::stoul(words[0]) - 1, std::stod(words[1]), std::nullopt};
  if (words.size() == 3) mishap.lasts = std::stod(words[2]);
  return mishap;
}

/// The cubes on the starts of a run, in another order than its robots.
void place_for_run(const std::string& path, EmulatedWorld& world) {
  const ToioRun run = read_run(path);
  world.mat = run.desk.mat;
  world.cube = run.desk.cube;
  for (auto robot = run.robots.rbegin(); robot != run.robots.rend(); ++robot) {
    const Pose start = run.desk.to_desk(robot->waypoints.front().pose);
    world.starts.push_back(run.desk.own_heading(start));
  }
}

/// In a row across the middle of the mat.
void place_in_row(int cubes, EmulatedWorld& world) {
  for (int i = 0; i < cubes; ++i) {
    world.starts.push_back(
        {world.mat.width() * (i + 1) / (cubes + 1), world.mat.height() / 2, std::numbers::pi / 2});
  }
}

EmulatedWorld world_of(const EmulatorOptions& options) {
  EmulatedWorld world = options.world;
  if (options.run.empty()) {
    world.mat = find_mat(options.mat);
    place_in_row(options.cubes, world);
  } else {
    place_for_run(options.run, world);
  }
  world.air = {options.delay_ms / 1000.0, 0.3, options.loss_percent / 100.0};
  const Stalls stalls = parse_stalls(options.stall);
  world.stalls_per_minute = stalls.per_minute;
  world.shortest_stall = stalls.shortest;
  world.longest_stall = stalls.longest;
  world.disconnect = parse_mishap("--disconnect", options.disconnect);
  world.press = parse_mishap("--press", options.press);
  world.bump = parse_mishap("--bump", options.bump);
  world.adapter = !options.no_adapter;
  return world;
}

std::string json_of(const WorldReport& report) {
  nlohmann::ordered_json cubes = nlohmann::ordered_json::array();
  for (const WorldReport::OfCube& cube : report.cubes) {
    cubes.push_back({{"name", cube.name},
                     {"wheels_mm_s", std::round(cube.wheel_speed * 1e4) / 10},
                     {"last_motor", cube.last_motor},
                     {"writes", cube.writes},
                     {"dropped", cube.dropped},
                     {"x", std::round(cube.place.x)},
                     {"y", std::round(cube.place.y)},
                     {"deg", std::round(cube.place.degrees)}});
  }
  const bool any = std::isfinite(report.least_clearance);
  const nlohmann::ordered_json json = {
      {"touched", report.touched},
      {"clearance_least_mm",
       any ? nlohmann::ordered_json(std::round(report.least_clearance * 1e4) / 10)
           : nlohmann::ordered_json()},
      {"cubes", cubes}};
  return json.dump(1);
}

int serve(const EmulatorOptions& options) {
  const AwaitedSignals signals;
  EmulatedBluez bluez(world_of(options));
  fmt::print(stderr, "mvtp-toio-emulator: serving org.bluez\n");
  while (true) {
    bluez.live(0.02);
    const std::optional<siginfo_t> signal = signals.next(Deadline::in(0.0));
    if (signal && signal->si_signo != SIGCHLD) break;
  }
  const WorldReport report = bluez.report();
  fmt::print("{}\n", json_of(report));
  return report.touched ? kNotAchieved : kDone;
}

void declare(CLI::App& app, EmulatorOptions& options) {
  app.footer(
      "Serves org.bluez with emulated cubes on the bus that DBUS_SYSTEM_BUS_ADDRESS names, until\n"
      "SIGTERM or SIGINT; then prints how the cubes fared (JSON). On a private bus:\n"
      "  dbus-run-session sh -c 'export DBUS_SYSTEM_BUS_ADDRESS=$DBUS_SESSION_BUS_ADDRESS;\n"
      "    mvtp-toio-emulator --run run.json & mvtp toio run run.json; kill $!; wait'\n"
      "Exit code: 0 no two cubes touched, 1 they did, or no bus, 2 bad usage.");
  app.add_option("--run", options.run, "Put a cube on each start of this run")->type_name("FILE");
  app.add_option("--cubes", options.cubes, "Without --run: so many in a row [1]")
      ->check(whole_number_between(0, 30));
  app.add_option("--mat", options.mat, "Without --run: what they stand on [simple]");
  app.add_option("--delay", options.delay_ms, "Each direction, +-30 % [ms] [60]")
      ->check(number_between(0, 1000));
  app.add_option("--loss", options.loss_percent, "Of commands and reports [%] [0]")
      ->check(number_between(0, 90));
  app.add_option("--lose-settings", options.world.lost_settings,
                 "Of each cube, the first so many settings, then so many answers [0]")
      ->check(whole_number_between(0, 1000));
  app.add_option("--stall", options.stall, "Blocked wheels: RATE:SECONDS, as with emulate [none]");
  app.add_option("--mtu", options.world.mtu, "Longer writes are dropped [bytes] [247]")
      ->check(whole_number_between(23, 517));
  app.add_option("--connect-failures", options.world.connect_failures,
                 "Of each cube, before it can be connected [0]")
      ->check(whole_number_between(0, 1000));
  app.add_option("--disconnect", options.disconnect,
                 "CUBE:SECONDS[:FOR]: its link ends so long after it first was told to move, for "
                 "ever or so long [none]");
  app.add_option("--press", options.press, "CUBE:SECONDS: its button is pressed then [none]");
  app.add_option("--bump", options.bump, "CUBE:SECONDS: it feels a collision then [none]");
  app.add_option("--battery", options.world.battery, "Of the cubes [%] [90]")
      ->check(whole_number_between(0, 100));
  app.add_option("--protocol", options.world.version, "Version of the cubes' protocol [2.4.0]");
  app.add_flag("--no-adapter", options.no_adapter, "BlueZ without an adapter");
  app.add_option("--seed", options.world.seed, "Of the world's chances [0]");
}

int run_emulator(int argc, char** argv) {
  CLI::App app("toio cubes that exist only here, behind a BlueZ that does, too",
               "mvtp-toio-emulator");
  EmulatorOptions options;
  declare(app, options);
  if (asks_for_description(argc, argv)) {
    fmt::print("{}\n", to_json(help_of(app)));
    return kDone;
  }
  try {
    app.parse(argc, argv);
    return serve(options);
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app.help());
    return kDone;
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "mvtp-toio-emulator: {}; see --help\n", error.what());
  } catch (const InputError& error) {
    fmt::print(stderr, "mvtp-toio-emulator: {}\n", error.what());
  } catch (const BluetoothError& error) {
    fmt::print(stderr, "mvtp-toio-emulator: {}\n", error.what());
    return kNotAchieved;
  }
  return kBadInput;
}

}  // namespace
}  // namespace mvtp

int main(int argc, char** argv) { return mvtp::run_emulator(argc, argv); }
