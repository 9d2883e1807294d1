#include "tools/suggest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <vector>

namespace mvtp {
namespace {

constexpr std::size_t kListed = 8;

/// How many letters must be put in, left out or replaced to make one word of the other; letters
/// that differ in case only count as the same.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const bool same = std::tolower(static_cast<unsigned char>(a[i])) ==
                        std::tolower(static_cast<unsigned char>(b[j]));
      const std::size_t replaced = diagonal + (same ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string suggestion(const std::string& name, std::span<const std::string> names) {
  if (names.empty()) return "there are none";
  const auto nearest =
      std::ranges::min_element(names, {}, [&](const auto& n) { return edit_distance(name, n); });
  const std::size_t slips = std::max<std::size_t>(1, name.size() / 3);
  std::string text;
  if (edit_distance(name, *nearest) <= slips) text = fmt::format("did you mean {}? ", *nearest);
  const auto some = names.first(std::min(names.size(), kListed));
  text += fmt::format("there {} {}", names.size() == 1 ? "is" : "are", fmt::join(some, ", "));
  if (some.size() < names.size()) text += fmt::format(", ... ({} in all)", names.size());
  return text;
}

}  // namespace mvtp
