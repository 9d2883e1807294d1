#pragma once

#include <string>
#include <string_view>

namespace mvtp {

/// The shortest text that reads back as exactly `value`, as every YAML and JSON reader knows
/// floats: with a point ("1.0", "1.0e-07"; a bare "1e-07" is a string for YAML 1.1). @pre finite
[[nodiscard]] std::string yaml_number(double value);

/// `text` as a YAML scalar that reads back as this very string: plain if that is safe, else quoted.
[[nodiscard]] std::string yaml_string(std::string_view text);

}  // namespace mvtp
