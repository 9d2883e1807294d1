#pragma once

#include <string>

namespace mvtp {

/// "1.0.0".
[[nodiscard]] std::string version();

/// The versions of this program and of SUMO, OMPL and FCL that it was built against, for --version.
[[nodiscard]] std::string version_text();

}  // namespace mvtp
