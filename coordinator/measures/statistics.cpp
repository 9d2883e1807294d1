#include "coordinator/measures/statistics.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace mvtp {

double mean(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::ranges::max_element(values);
}

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const double place = p * double(values.size() - 1);
  const auto i = std::size_t(place);
  const std::size_t j = std::min(i + 1, values.size() - 1);
  return values[i] + (place - double(i)) * (values[j] - values[i]);
}

}  // namespace mvtp
