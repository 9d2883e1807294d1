#pragma once

#include <cmath>
#include <optional>
#include <span>

namespace mvtp {

struct MeanAndDeviation {
  double mean = 0.0;
  std::optional<double> deviation;  ///< of the sample; none for a single value
};

/// @pre !values.empty()
[[nodiscard]] inline MeanAndDeviation mean_and_deviation(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += value;
  MeanAndDeviation result{sum / n, std::nullopt};
  if (values.size() < 2) return result;
  double squares = 0.0;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.deviation = std::sqrt(squares / (n - 1.0));
  return result;
}

}  // namespace mvtp
