#pragma once

#include <vector>

namespace mvtp {

/// The arithmetic mean; 0 if there are no values.
[[nodiscard]] double mean(const std::vector<double>& values);
/// 0 if there are none.
[[nodiscard]] double largest(const std::vector<double>& values);
/// The p-quantile of the values, 0 <= p <= 1, interpolated; 0 if there are none.
[[nodiscard]] double quantile(std::vector<double> values, double p);

}  // namespace mvtp
