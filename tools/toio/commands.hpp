#pragma once

#include "tools/cli/program.hpp"

namespace mvtp {

/// A sub-command of `mvtp toio` and what it does.
struct ToioCommand {
  const CLI::App* app;
  Action action;
};

[[nodiscard]] ToioCommand declare_toio_fit(CLI::App& toio);
[[nodiscard]] ToioCommand declare_toio_export(CLI::App& toio);
[[nodiscard]] ToioCommand declare_toio_check(CLI::App& toio);
[[nodiscard]] ToioCommand declare_toio_emulate(CLI::App& toio);
[[nodiscard]] ToioCommand declare_toio_run(CLI::App& toio);
[[nodiscard]] ToioCommand declare_toio_scan(CLI::App& toio);
[[nodiscard]] ToioCommand declare_toio_calibrate(CLI::App& toio);

}  // namespace mvtp
