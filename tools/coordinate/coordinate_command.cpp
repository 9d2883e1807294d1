#include <memory>

#include "tools/cli/command_line.hpp"
#include "tools/cli/commands.hpp"
#include "tools/coordinate/run.hpp"

namespace mvtp {

Action declare_coordinate(CLI::App& app) {
  auto options = std::make_shared<CoordinateOptions>();
  declare_coordinate_options(app, *options);
  return [options] { return run_coordinate(*options, command_line()); };
}

}  // namespace mvtp
