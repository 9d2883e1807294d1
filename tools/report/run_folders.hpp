#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/sweep/rows.hpp"
#include "tools/view/replay.hpp"

namespace mvtp {

/// What mvtp coordinate left in a folder.
struct ReportedRun {
  std::string folder;
  std::string label;  ///< short, and another one for each control
  SweepRow row;       ///< what its summary.json says; the controller is the label
  /// Pairs of vehicles by their shortest post-encroachment time and time to collision, in halves
  /// of a second; empty if the summary has no distribution.
  std::vector<double> post_encroachment, to_collision;
  std::optional<Replay> replay;  ///< none: it ran with --no-view

  [[nodiscard]] std::string page() const { return folder + "/view.html"; }
};

/// Reads runs from their folders, or from that of mvtp compare, which holds several.
/// @throws InputError if one is no such folder.
[[nodiscard]] std::vector<ReportedRun> read_runs(const std::vector<std::string>& folders);

}  // namespace mvtp
