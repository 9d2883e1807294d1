#pragma once

#include <cstdint>

#include "planner/road/crossing_search.hpp"

namespace mvtp {

/// Makes a complete plan of a group better: other orders of a small group, and neighbourhoods of a
/// large one (CrossingOptions::many), for as long as tries and work last.
/// @param seed  of the moves tried.
void improve(CrossingResult& best, CrossingSearch& search, std::uint64_t seed);

}  // namespace mvtp
