#include <CLI/CLI.hpp>

#include "planner/problem/input_error.hpp"
#include "tools/toio/commands.hpp"

namespace mvtp {
namespace {

/// Takes any arguments, and says what is missing.
ToioCommand declare_missing(CLI::App& toio, const std::string& name) {
  CLI::App* app = toio.add_subcommand(name, "(left out: this build has no Bluetooth)");
  app->allow_extras();
  return {app, [name]() -> int {
            throw InputError("toio " + name,
                             "needs Bluetooth, which this build lacks; install libsystemd-dev and "
                             "build again, or try mvtp toio emulate");
          }};
}

}  // namespace

ToioCommand declare_toio_run(CLI::App& toio) { return declare_missing(toio, "run"); }
ToioCommand declare_toio_scan(CLI::App& toio) { return declare_missing(toio, "scan"); }
ToioCommand declare_toio_calibrate(CLI::App& toio) { return declare_missing(toio, "calibrate"); }

}  // namespace mvtp
