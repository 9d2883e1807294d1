#include "tools/cli/suggest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>
#include <vector>

namespace mvtp {
namespace {

constexpr std::size_t kListed = 8;

bool is_same(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

/// How many letters must be put in, left out, replaced, or swapped with the next to make one word
/// of the other (optimal string alignment); letters that differ in case only count as the same.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, above(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    before = std::exchange(above, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = above[j] + (is_same(a[i], b[j]) ? 0 : 1);
      row[j + 1] = std::min({replaced, row[j] + 1, above[j + 1] + 1});
      const bool swapped = i > 0 && j > 0 && is_same(a[i], b[j - 1]) && is_same(a[i - 1], b[j]);
      if (swapped) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
  }
  return row.back();
}

}  // namespace

std::string did_you_mean(const std::string& name, std::span<const std::string> names) {
  if (names.empty()) return {};
  const auto nearest =
      std::ranges::min_element(names, {}, [&](const auto& n) { return edit_distance(name, n); });
  const std::size_t slips = name.size() < 3 ? 0 : std::max<std::size_t>(1, name.size() / 3);
  if (edit_distance(name, *nearest) > slips) return {};
  return fmt::format("did you mean {}? ", *nearest);
}

std::string suggestion(const std::string& name, std::span<const std::string> names) {
  if (names.empty()) return "there are none";
  const auto some = names.first(std::min(names.size(), kListed));
  std::string text = did_you_mean(name, names);
  text += fmt::format("there {} {}", names.size() == 1 ? "is" : "are", fmt::join(some, ", "));
  if (some.size() < names.size()) text += fmt::format(", ... ({} in all)", names.size());
  return text;
}

std::string stray_word(const CLI::App& command) {
  std::vector<std::string> rest = command.remaining();
  std::erase(rest, "--");
  if (rest.empty()) return {};
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    for (const std::string& name : option->get_snames()) known.push_back("-" + name);
  }
  for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
    known.push_back(below->get_name());
  }
  const std::string word = rest.front().substr(0, rest.front().find('='));
  return fmt::format("{} was not expected; {}", word, did_you_mean(word, known));
}

}  // namespace mvtp
