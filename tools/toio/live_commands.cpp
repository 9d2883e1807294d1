#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <memory>

#include "tools/cli/child_process.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_files.hpp"
#include "tools/toio/commands.hpp"
#include "tools/toio/device/live_run.hpp"
#include "tools/toio/options.hpp"
#include "tools/toio/plan/check.hpp"

namespace mvtp {
namespace {

struct RunCommand {
  std::string run;
  LiveOptions options;
  std::vector<std::string> cubes;
  double lag_ms = 130.0;
  std::string log;
};

void say(const std::string& line) { fmt::print(stderr, "toio: {}\n", line); }

/// Does something with Bluetooth until it is done, fails or is interrupted.
int with_bluetooth(const std::function<int(Bluetooth&)>& job) {
  const AwaitedSignals signals;
  bool stop = false;
  try {
    Bluetooth bluetooth([&] {
      while (const std::optional<siginfo_t> info = signals.next(Deadline::in(0.0))) {
        stop = stop || info->si_signo != SIGCHLD;
      }
      return stop;
    });
    return job(bluetooth);
  } catch (const BluetoothError& error) {
    fmt::print(stderr, "mvtp: {}\n", error.what());
    return kNotAchieved;
  } catch (const Interrupted&) {
    fmt::print(stderr, "mvtp: interrupted; the cubes are stopped\n");
    return kInterrupted;
  }
}

/// Was Enter pressed on the terminal?
bool enter_pressed() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (isatty(STDIN_FILENO) == 0 || poll(&input, 1, 0) <= 0) return false;
  char buffer[64];
  return read(STDIN_FILENO, buffer, sizeof buffer) > 0;
}

ToioRun load(const RunCommand& command) {
  ToioRun run = read_drivable_run(command.run, command.options.player.mode);
  check_cube_names(command.cubes, run.robots.size());
  for (std::size_t i = 0; i < command.cubes.size(); ++i) run.robots[i].cube = command.cubes[i];
  return run;
}

int report(const ToioRun& run, const LiveOutcome& outcome) {
  for (std::size_t i = 0; i < outcome.robots.size(); ++i) {
    const RobotOutcome& robot = outcome.robots[i];
    fmt::print("{}: {}, waited {:.1f} s, late {:.1f} s, beside {:.1f} mm\n", run.robots[i].id,
               robot.arrived ? fmt::format("arrived after {:.1f} s", robot.arrival) : "NOT ARRIVED",
               robot.waited, robot.held, in_mm(robot.most_lateral));
  }
  if (outcome.finished) return kDone;
  fmt::print(stderr, "mvtp: stopped: {}\n", outcome.reason);
  return kNotAchieved;
}

int run_cubes(RunCommand command) {
  command.options.player.lag = command.lag_ms / 1000.0;
  const ToioRun run = load(command);
  LiveHooks hooks{.say = say, .log = nullptr, .pause_asked = enter_pressed};
  std::ofstream log;
  if (!command.log.empty()) {
    check_output_files({command.log}, {command.run});
    log.open(command.log);
    hooks.log = [&log](const std::string& line) { log << line << '\n'; };
  }
  return with_bluetooth([&](Bluetooth& bluetooth) {
    return report(run, run_live(bluetooth, run, command.options, hooks));
  });
}

int scan(double seconds) {
  return with_bluetooth([&](Bluetooth& bluetooth) {
    const std::vector<FoundCube> cubes =
        bluetooth.scan(seconds, [](const std::vector<FoundCube>&) { return false; });
    for (const FoundCube& cube : cubes) {
      fmt::print("{} {} {} dBm\n", cube.name, cube.address, cube.rssi);
    }
    if (!cubes.empty()) return kDone;
    throw BluetoothError(fmt::format("no cube found within {:.0f} s; switch one on", seconds));
  });
}

int measure(const std::string& mat_name, const std::string& cube) {
  const Mat mat = find_mat(mat_name);
  return with_bluetooth([&](Bluetooth& bluetooth) {
    const Calibration found =
        calibrate(bluetooth, mat, cube, {.say = say, .log = nullptr, .pause_asked = nullptr});
    fmt::print(
        "from the reported centre to the wheel axle {:.1f} mm\n"
        "speed of the wheels {:.3f} mm/s per unit\n"
        "lag {:.0f} ms\n"
        "give: mvtp toio export ... --center-to-axle {:.1f} --speed-per-unit {:.3f}\n"
        "      mvtp toio run ... --lag {:.0f}\n",
        in_mm(found.center_to_axle), in_mm(found.speed_per_unit), found.lag * 1000,
        in_mm(found.center_to_axle), in_mm(found.speed_per_unit), found.lag * 1000);
    return int(kDone);
  });
}

}  // namespace

ToioCommand declare_toio_run(CLI::App& toio) {
  CLI::App* app = toio.add_subcommand("run", "Drive a run on real cubes, over Bluetooth");
  const auto command = std::make_shared<RunCommand>();
  app->footer(
      "Put each cube on its start: its lamp turns from red to green. Enter, or the button of any\n"
      "cube, pauses all; Ctrl-C stops all.\n"
      "Exit code: 0 all arrived, 1 they did not, or no Bluetooth, 2 bad input, 130 interrupted.");
  app->add_option("RUN", command->run, "Run file of mvtp toio export")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  app->add_option("--cube", command->cubes,
                  "Name or address of the cube of each robot, in order [as the run says, else the "
                  "one nearest to the start]")
      ->type_name("NAME")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Cubes");
  app->add_option("--scan-time", command->options.scan_time, "To find the cubes [s] [10]")
      ->check(number_between(0.1, 600))
      ->type_name("S")
      ->group("Cubes");
  app->add_option("--place-time", command->options.place_time,
                  "To put them on their starts [s] [120]")
      ->check(number_between(0.1, 3600))
      ->type_name("S")
      ->group("Cubes");
  add_choice<DriveMode>(*app, "--mode", command->options.player.mode,
                        {{"track", DriveMode::kTrack}, {"target", DriveMode::kTarget}},
                        "Wheel speeds, or targets one by one [track]")
      ->group("Player");
  app->add_option("--lag", command->lag_ms,
                  "From a command to the report of what it did: see calibrate [ms] [130]")
      ->check(number_between(0, 1000))
      ->type_name("MS")
      ->group("Player");
  app->add_option("--log", command->log, "All that was sent and heard, one JSON per line [none]")
      ->type_name("FILE")
      ->group("Output");
  return {app, [command] { return run_cubes(*command); }};
}

ToioCommand declare_toio_scan(CLI::App& toio) {
  CLI::App* app = toio.add_subcommand("scan", "List the cubes in reach");
  const auto seconds = std::make_shared<double>(5.0);
  app->footer("Exit code: 0 some found, 1 none, or no Bluetooth, 2 bad usage, 130 interrupted.");
  app->add_option("--scan-time", *seconds, "To listen for them [s] [5]")
      ->check(number_between(0.1, 600))
      ->type_name("S");
  return {app, [seconds] { return scan(*seconds); }};
}

ToioCommand declare_toio_calibrate(CLI::App& toio) {
  CLI::App* app = toio.add_subcommand("calibrate", "Measure a cube: its centre, speed and lag");
  const auto mat = std::make_shared<std::string>();
  const auto cube = std::make_shared<std::string>();
  app->footer(
      "Put the cube in the middle of the mat with 150 mm of room around it: it spins, then drives\n"
      "to and fro four times.\n"
      "Exit code: 0 measured, 1 not, or no Bluetooth, 2 bad usage, 130 interrupted.");
  app->add_option("--mat", *mat, "Name of the mat that it stands on, or a file")
      ->required()
      ->type_name("NAME");
  app->add_option("--cube", *cube, "Name or address [the first one found]")->type_name("NAME");
  return {app, [mat, cube] { return measure(*mat, *cube); }};
}

}  // namespace mvtp
