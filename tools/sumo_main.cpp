#include <array>

#include "tools/cli/commands.hpp"

/// The commands that load SUMO's libraries; `mvtp` runs this program for them.
int main(int argc, char** argv) {
  constexpr std::array kCommands = {
      mvtp::Command{"coordinate", "Run a SUMO scenario headless, coordinated",
                    mvtp::declare_coordinate},
      mvtp::Command{"compare", "One demand under SUMO's own control and coordinated",
                    mvtp::declare_compare},
      mvtp::Command{"sweep", "Demand x penetration x controllers x seeds", mvtp::declare_sweep},
  };
  return mvtp::run_program(argc, argv, kCommands);
}
