#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "tools/sweep/rows.hpp"

namespace mvtp {

using ReportJson = nlohmann::ordered_json;

/// A line of arrivals by the minute: means over the seeds, each minute over those runs that lasted
/// as long.
[[nodiscard]] ReportJson arrivals_line(const std::string& label, std::span<const SweepRow> rows);

/// The figure "arrivals-by-minute", of panels with such lines.
[[nodiscard]] ReportJson arrivals_figure(ReportJson panels);

}  // namespace mvtp
