#pragma once

#include "coordinator/lot/lot_coordinator.hpp"
#include "tools/coordinate/options.hpp"

namespace mvtp {

/// What the command line of `mvtp coordinate` says about a parking lot.
/// @throws InputError for a breakdown that is not VEHICLE@SECONDS
[[nodiscard]] LotOptions lot_options(const CoordinateOptions& options);

}  // namespace mvtp
