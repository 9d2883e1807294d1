#pragma once

#include <string>
#include <vector>

#include "coordinator/report/trip.hpp"

namespace mvtp {

/// Reads SUMO's tripinfo-output, in the order of the file (arrivals first).
/// Throws InputError, naming file and line.
[[nodiscard]] std::vector<Trip> read_trips(const std::string& path);

}  // namespace mvtp
