#pragma once

#include <cstdint>

namespace mvtp {

/// What PBCR ranks robots and motion primitives by.
enum class PbcrScore : std::uint8_t {
  /// Giving way in time, reference paths as a floor of the cost-to-go, noise for those kept from
  /// them.
  kStrengthened,
  /// As the paper's authors have it: who has been under way for longest first, the nearest of
  /// these; cost-to-go and the cost of the primitive, higher where the robot has been before.
  /// Source: ESCoT paper, Sec. III-A; Guo et al. 2024 (PBCR), their code.
  kPaper,
};

}  // namespace mvtp
