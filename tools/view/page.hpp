#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/view/replay.hpp"

namespace mvtp {

/// One HTML page without any outside part that plays the replays: side by side and in step if there
/// are several. Text of the replays reaches the page as data only, never as markup.
/// The same replays give the same bytes.
[[nodiscard]] std::string to_html(std::span<const Replay> replays);

/// The replays inside a page made by to_html.
/// @param where name of the file in messages
/// @throws InputError if `html` is no such page, or is damaged.
[[nodiscard]] std::vector<Replay> replays_of(const std::string& html, const std::string& where);

}  // namespace mvtp
