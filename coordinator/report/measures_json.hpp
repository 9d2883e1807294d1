#pragma once

#include <nlohmann/json.hpp>

#include "coordinator/report/report.hpp"

namespace mvtp {

/// Adds the measures beyond delay and safety to a summary: emissions, stops, jerk,
/// post-encroachment time, time to collision, fairness, delay by type and by movement, arrivals by
/// the minute.
void add_measures(const RunReport& report, nlohmann::ordered_json& summary);

}  // namespace mvtp
