#pragma once

#include <span>
#include <string>

namespace CLI {
class App;
}

namespace mvtp {

/// "did you mean X? " with the nearest of `names`, if `name` could be a slip; else empty.
[[nodiscard]] std::string did_you_mean(const std::string& name, std::span<const std::string> names);

/// What to say after a name that is not among `names`: the nearest one if it could be a slip of the
/// pen, and some of what there is; e.g. "did you mean C? there are A, B, C, ... (12 in all)".
[[nodiscard]] std::string suggestion(const std::string& name, std::span<const std::string> names);

/// "--fly was not expected; did you mean --dry? ", of the first word that the command does not
/// know; empty if there is none.
[[nodiscard]] std::string stray_word(const CLI::App& command);

}  // namespace mvtp
