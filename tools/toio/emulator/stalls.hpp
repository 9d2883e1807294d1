#pragma once

#include <string>

namespace mvtp {

/// How often wheels are blocked, and for how long.
struct Stalls {
  double per_minute = 0.0;  ///< of each cube
  double shortest = 1.0;    ///< [s]
  double longest = 5.0;     ///< [s]
};

/// Reads "2:1-5", twice a minute for 1 to 5 s; "2:3", for 3 s; "0", never.
/// @throws InputError naming --stall.
[[nodiscard]] Stalls parse_stalls(const std::string& text);

}  // namespace mvtp
