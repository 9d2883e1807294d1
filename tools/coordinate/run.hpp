#pragma once

#include <functional>
#include <memory>
#include <string>

#include "coordinator/controller.hpp"
#include "coordinator/report/report.hpp"
#include "tools/cli/run_folder.hpp"
#include "tools/coordinate/options.hpp"
#include "traci_bridge/sumo_traffic.hpp"

namespace mvtp {

/// Runs a scenario as `mvtp coordinate` does and writes its files. Returns the exit code.
/// @param command  the command line, for the record.
/// @throws InputError
int run_coordinate(const CoordinateOptions& options, const std::string& command);

/// Who has a scenario run.
struct RunHost {
  std::function<void(const std::string&)> say;  ///< takes a line for the user
  std::function<bool()> interrupted = [] { return false; };
};

/// Such a run step by step: SUMO, the road, who drives, and who watches.
class SumoRun {
 public:
  /// Opens the scenario. @param options, folder  outlive it
  /// @throws InputError, and Interruption if the host is interrupted meanwhile
  SumoRun(const CoordinateOptions& options, const std::string& command, RunFolder& folder,
          RunHost host);
  SumoRun(const SumoRun&) = delete;
  SumoRun& operator=(const SumoRun&) = delete;
  ~SumoRun();

  [[nodiscard]] SumoTraffic& traffic();
  /// One more controller, which outlives the run; it gives the report its name. @pre no step yet
  void plug_in(Controller& controller, const std::string& name);
  /// Makes a step, unless the run has ended. @return whether it did @throws InputError
  [[nodiscard]] bool step();
  /// How much of it is done, as far as can be told, in [0, 1).
  [[nodiscard]] double fraction() const;
  /// What there would be to report if the run were interrupted now.
  [[nodiscard]] const RunReport& report_so_far();
  /// Ends SUMO and writes the files; the last of the functions to be called.
  /// @param failure  what went wrong, in one line; empty: nothing, and a run that has not ended is
  /// interrupted @throws InputError if the files cannot be written
  const RunReport& finish(const std::string& failure = "");
  /// Steps to the end, finishes, and tells the user what came of it. Returns the exit code.
  int drive();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mvtp
