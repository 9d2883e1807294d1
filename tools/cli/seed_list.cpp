#include "tools/cli/seed_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMaxSeeds = 1000;

[[noreturn]] void refuse_seeds(const std::string& text) {
  throw InputError("--seeds", fmt::format("is \"{}\"; give at most {} whole numbers as in 1-5 or "
                                          "1,2,7",
                                          text, kMaxSeeds));
}

std::uint32_t parse_seed(std::string_view word, const std::string& text) {
  std::uint32_t seed = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), seed);
  if (error != std::errc() || end != word.data() + word.size() || seed > 2147483647U) {
    refuse_seeds(text);
  }
  return seed;
}

}  // namespace

std::vector<std::uint32_t> parse_seeds(const std::string& text) {
  std::vector<std::uint32_t> seeds;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string_view word = std::string_view(text).substr(begin, comma - begin);
    const std::size_t dash = word.find('-');
    const std::uint32_t first = parse_seed(word.substr(0, dash), text);
    const std::uint32_t last =
        dash == std::string_view::npos ? first : parse_seed(word.substr(dash + 1), text);
    if (last < first || last - first >= kMaxSeeds) refuse_seeds(text);
    for (std::uint32_t seed = first; seed <= last; ++seed) seeds.push_back(seed);
    begin = comma + 1;
  }
  std::ranges::sort(seeds);
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  if (seeds.size() > kMaxSeeds) refuse_seeds(text);
  return seeds;
}

}  // namespace mvtp
