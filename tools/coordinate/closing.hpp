#pragma once

#include <string>
#include <vector>

#include "coordinator/report/report.hpp"

namespace mvtp {

/// The closing table of a run, as of `mvtp compare`.
/// @param folder  where its files are
[[nodiscard]] std::string closing_table(const RunReport& report, const std::string& folder);

/// Why the run is no success, a line each.
/// @param events  path of events.csv
[[nodiscard]] std::vector<std::string> complaints(const RunReport& report,
                                                  const std::string& configuration,
                                                  const std::string& events);

}  // namespace mvtp
