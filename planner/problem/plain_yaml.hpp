#pragma once

#include <string_view>

#include "planner/problem/document_builder.hpp"

namespace mvtp {

/// Reads the plain part of YAML in which plans and instances are written, many times faster than a
/// complete parser: block maps and lists by indentation, flow maps and lists within a line, and
/// words of letters, digits and _ . + -, or anything printable between double quotes.
///
/// @return false at the first thing beyond that, right or wrong, also where the builder refuses
/// what it gets: the builder is then spoilt, and the complete parser has the word. What this
/// function does accept, it reads as the complete parser would.
[[nodiscard]] bool parse_plain_yaml(DocumentBuilder& builder, std::string_view text);

}  // namespace mvtp
