#pragma once

namespace mvtp {

/// Who drives when, on a lot.
enum class LotController {
  kEscot,        ///< everyone at once; groups are planned anew where that pays
  kPrioritized,  ///< everyone at once; each plans once, against all earlier ones
  kPbcr,         ///< everyone at once, every step by priorities; nobody plans ahead
  kOneAtATime,   ///< one vehicle drives, the others wait
};

}  // namespace mvtp
