#pragma once

#include "tools/cli/program.hpp"

namespace mvtp {

// The sub-commands, each in its room: tools/NAME/NAME_command.cpp; validate is in solve/.
[[nodiscard]] Action declare_solve(CLI::App& app);
[[nodiscard]] Action declare_validate(CLI::App& app);
[[nodiscard]] Action declare_generate(CLI::App& app);
[[nodiscard]] Action declare_bench(CLI::App& app);
[[nodiscard]] Action declare_report(CLI::App& app);
[[nodiscard]] Action declare_view(CLI::App& app);
[[nodiscard]] Action declare_export(CLI::App& app);
[[nodiscard]] Action declare_doctor(CLI::App& app);
[[nodiscard]] Action declare_toio(CLI::App& app);

// Those of the sibling executable mvtp-sumo.
[[nodiscard]] Action declare_coordinate(CLI::App& app);
[[nodiscard]] Action declare_compare(CLI::App& app);
[[nodiscard]] Action declare_sweep(CLI::App& app);

}  // namespace mvtp
