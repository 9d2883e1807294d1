#pragma once

#include <string>

#include "tools/view/replay.hpp"

namespace mvtp {

/// One moment of a replay as a drawing (SVG), in the colours of the page.
/// @param time   [s]
/// @param where  name of the replay in messages
/// @throws InputError if the replay does not reach that moment
[[nodiscard]] std::string to_svg(const Replay& replay, double time, const std::string& where);

}  // namespace mvtp
