#pragma once

#include <span>
#include <string>

#include "tools/sweep/rows.hpp"

namespace mvtp {

/// The table of a sweep: mean and deviation over the seeds, per scenario, demand, penetration and
/// controller.
[[nodiscard]] std::string sweep_to_markdown(std::span<const SweepRow> rows);

/// What report.py draws of it: delay over demand; over penetration, if there are several; arrivals
/// by the minute.
[[nodiscard]] std::string sweep_to_json(std::span<const SweepRow> rows);

}  // namespace mvtp
