#include "tools/cli/number_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

std::optional<double> to_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

/// The numbers of "FROM:TO:STEP"; none if it is something else.
std::vector<double> range(std::string_view word, std::size_t most) {
  const std::vector<std::string_view> parts = split(word, ':');
  if (parts.size() != 3) return {};
  const auto from = to_number(parts[0]), to = to_number(parts[1]), step = to_number(parts[2]);
  if (!from || !to || !step || *step <= 0.0 || *to < *from) return {};
  const double count = std::floor((*to - *from) / *step + 1e-9) + 1.0;
  if (count > double(most)) return {};
  std::vector<double> values;
  // Rounded, so that the same number is written the same way wherever the range begins.
  for (int i = 0; i < int(count); ++i) {
    values.push_back(std::round((*from + i * *step) * 1e9) / 1e9);
  }
  return values;
}

}  // namespace

std::vector<double> parse_numbers(const std::string& option, const std::string& text, double low,
                                  double high) {
  constexpr std::size_t kMost = 1000;
  std::vector<double> values;
  bool good = true;
  for (const std::string_view word : split(text, ',')) {
    std::vector<double> more = range(word, kMost);
    if (const auto single = to_number(word)) more = {*single};
    good = good && !more.empty();
    values.insert(values.end(), more.begin(), more.end());
  }
  good = good && values.size() <= kMost &&
         std::ranges::all_of(values, [&](double v) { return v >= low && v <= high; });
  if (!good) {
    throw InputError(
        option, fmt::format("is \"{}\"; give numbers from {} to {} as in 0.5,1 or FROM:TO:STEP",
                            text, low, high));
  }
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

}  // namespace mvtp
