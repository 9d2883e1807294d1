#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tools/toio/plan/export.hpp"

namespace mvtp {

/// A plan for 4 to 6 cubes between random starts and goals on a collection mat, laid out as a run;
/// nullopt where the seed gives none.
[[nodiscard]] std::optional<ToioRun> random_run(std::uint64_t seed);

/// The first `count` of them.
[[nodiscard]] std::vector<ToioRun> random_runs(std::size_t count);

}  // namespace mvtp
