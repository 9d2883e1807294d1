#pragma once

#include <string>

#include "coordinator/faults/fault_model.hpp"

namespace mvtp {

/// What `--faults` says goes wrong: KEY=VALUE with commas between.
/// @throws InputError for a key that there is not, or a value out of range
[[nodiscard]] FaultPlan read_faults(const std::string& text);

/// What `--assume-noise` declares; a part of the keys of `--faults`, or "faults": the same.
/// @throws InputError likewise
[[nodiscard]] FaultModel read_assumed(const std::string& text, const FaultPlan& faults);

}  // namespace mvtp
