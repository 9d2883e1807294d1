#include <CLI/CLI.hpp>

#include "tools/cli/commands.hpp"
#include "tools/toio/commands.hpp"

namespace mvtp {

Action declare_toio(CLI::App& app) {
  app.require_subcommand(1);
  app.footer("From a plan to moving cubes: docs/toio.md.");
  const std::vector<ToioCommand> commands = {
      declare_toio_fit(app),       declare_toio_export(app), declare_toio_check(app),
      declare_toio_emulate(app),   declare_toio_run(app),    declare_toio_scan(app),
      declare_toio_calibrate(app),
  };
  return [commands]() -> int {
    for (const ToioCommand& command : commands) {
      if (command.app->parsed()) return command.action();
    }
    return kBadInput;
  };
}

}  // namespace mvtp
