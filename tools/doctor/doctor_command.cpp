#include <fmt/format.h>
#include <sys/wait.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tools/cli/child_process.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/sibling.hpp"
#include "tools/view/browser.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

/// Something that a command needs; without it the others work.
struct Need {
  std::string what;
  bool found = false;
  bool required = false;  ///< a part of mvtp itself, as it was built
  std::string without;    ///< what does not work then
  std::string remedy;
};

/// Does this program run and say that all is well?
bool runs(const std::vector<std::string>& arguments) {
  Job job{.arguments = arguments, .messages = "/dev/null", .time_limit = 20.0};
  int status = -1;
  const bool complete = run_jobs(std::span(&job, 1), 1, [&](std::size_t, int end) {
    status = end;
    return true;
  });
  return complete && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool has_sumo() {
  const fs::path program = sibling_path("mvtp-sumo");
  return fs::exists(program) && runs({program.string(), "--version"});
}

bool has_matplotlib() {
  const char* python = "/usr/bin/python3";
  return fs::exists(python) && runs({python, "-E", "-c", "import matplotlib"});
}

std::string sumo_home() {
  const char* home = std::getenv("SUMO_HOME");
  return home == nullptr || *home == '\0' ? "/usr/share/sumo" : home;
}

std::vector<Need> examine() {
  constexpr bool kRequired = true;
  return {{"mvtp-sumo", has_sumo(), MVTP_HAS_SUMO != 0, "coordinate, compare, sweep",
           "install sumo and libsumo, and build with -DMVTP_WITH_SUMO=ON"},
          {"report.py", fs::exists(shared_file("report.py")), kRequired, "figures of report",
           "install mvtp again"},
          {"sumo-gui", find_program("sumo-gui").has_value(), !kRequired, "coordinate --gui",
           "install sumo"},
          {"netconvert", find_program("netconvert").has_value(), !kRequired,
           "making networks (networks/make.sh), roads of export --to openscenario", "install sumo"},
          {"SUMO's data in " + sumo_home(), fs::is_directory(fs::path(sumo_home()) / "data"),
           !kRequired, "scenarios that use them, e.g. scenarios/rilsa",
           "install sumo-tools or set SUMO_HOME"},
          {"matplotlib of /usr/bin/python3", has_matplotlib(), !kRequired, "figures of report",
           "install python3-matplotlib"},
          {"Chromium", Browser::find().has_value(), !kRequired, "view --video",
           "install chromium-headless-shell or chromium"},
          {"rsvg-convert", find_program("rsvg-convert").has_value(), !kRequired,
           "view --at with a PNG", "install librsvg2-bin"},
          {"Bluetooth support", MVTP_HAS_BLUETOOTH != 0, !kRequired, "toio scan, run, calibrate",
           "install libsystemd-dev and build again"},
          {"D-Bus system bus", fs::exists("/run/dbus/system_bus_socket"), !kRequired,
           "toio scan, run, calibrate with real cubes", "install and start dbus and bluez"}};
}

int examine_and_tell() {
  bool complete = true;
  for (const Need& need : examine()) {
    if (need.found) {
      fmt::print("ok       {}\n", need.what);
      continue;
    }
    complete = complete && !need.required;
    fmt::print("{}  {}: without it not: {}; {}\n", need.required ? "MISSING" : "absent ", need.what,
               need.without, need.remedy);
  }
  fmt::print("solve, validate, generate, bench, view, export and toio export need nothing more.\n");
  return complete ? kDone : kNotAchieved;
}

}  // namespace

Action declare_doctor(CLI::App& app) {
  app.footer(
      "absent: an optional part; MISSING: a part of mvtp itself.\n"
      "Exit code: 0 nothing is MISSING; 1 something is.");
  return [] { return examine_and_tell(); };
}

}  // namespace mvtp
