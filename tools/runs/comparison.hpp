#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/runs/mean.hpp"

namespace mvtp {

/// One run of a comparison, and what its summary.json says.
struct ComparedRun {
  std::string control;  ///< the name of its row: a controller, "coordinated", ...
  bool drives = false;  ///< vehicles are driven by us
  std::uint32_t seed = 0;
  std::string folder;
  /// Why there are no figures, e.g. "crashed (Segmentation fault)"; empty: there are.
  std::string failure = "did not run";
  std::string status;  ///< "finished", "end reached", "stuck", "interrupted"
  /// By the names of compared_figures(), and of more on a parking lot; one that the summary leaves
  /// open is missing.
  std::map<std::string, double> figures;
};

/// A figure of summary.json that is compared.
struct ComparedFigure {
  const char* name;     ///< column of compare.csv and key of compare.json
  const char* pointer;  ///< where summary.json has it (JSON pointer)
};
/// Those that all runs have.
[[nodiscard]] std::span<const ComparedFigure> compared_figures();

/// Takes the figures from the text of a summary.json.
/// @param where  name of the file in messages
/// @throws InputError if the text is no such summary.
void read_summary(const std::string& text, const std::string& where, ComparedRun& run);

/// Did the run do its job? A light that cannot cope is a result, our own failure is one too, but a
/// bad one: a coordinated run may neither get stuck nor let a coordinated vehicle overlap.
[[nodiscard]] bool succeeded(const ComparedRun& run);

/// The table for people: a row per control, in the order in which they first appear, then a line
/// per run that failed.
[[nodiscard]] std::string comparison_table(std::span<const ComparedRun> runs);

/// The text of compare.csv: a row per run.
[[nodiscard]] std::string comparison_csv(std::span<const ComparedRun> runs);

/// The text of compare.json: mean and standard deviation of every figure per control.
[[nodiscard]] std::string comparison_json(std::span<const ComparedRun> runs,
                                          const std::string& scenario, const std::string& version,
                                          const std::string& command);

}  // namespace mvtp
