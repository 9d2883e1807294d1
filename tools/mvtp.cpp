#include <array>

#include "tools/cli/commands.hpp"

int main(int argc, char** argv) {
  constexpr std::array kCommands = {
      mvtp::Command{"solve", "Solve one standalone instance", mvtp::declare_solve},
      mvtp::Command{"validate", "Judge a plan, ours or anyone's", mvtp::declare_validate},
      mvtp::Command{"generate", "Write the benchmark suites", mvtp::declare_generate},
      mvtp::Command{"bench", "Run instances x algorithms x seeds", mvtp::declare_bench},
      mvtp::Command{"report", "The figures and tables of such runs", mvtp::declare_report},
      mvtp::Command{"view", "One page that replays plans and SUMO runs", mvtp::declare_view},
      mvtp::Command{"export", "Trajectories for other tools", mvtp::declare_export},
      mvtp::Command{"doctor", "What is installed, what is missing, and what that switches off",
                    mvtp::declare_doctor},
      mvtp::Command{"toio", "Drive a plan with toio cubes: fit, export, check, emulate, run",
                    mvtp::declare_toio},
      mvtp::Command{"coordinate", "Run a SUMO scenario headless, coordinated", nullptr},
      mvtp::Command{"compare", "One demand under SUMO's own control and coordinated", nullptr},
      mvtp::Command{"sweep", "Demand x penetration x controllers x seeds", nullptr},
  };
  return mvtp::run_program(argc, argv, kCommands);
}
