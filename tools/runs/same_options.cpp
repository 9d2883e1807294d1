#include "tools/runs/same_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <sstream>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMostBytes = 1'000'000;

std::string shown(const std::vector<std::string>& options) {
  return options.empty() ? "no options" : fmt::format("{}", fmt::join(options, " "));
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

std::string options_note(const std::string& file) { return file + ".options"; }

void require_same_options(const std::string& file, const std::vector<std::string>& options,
                          bool resume) {
  const std::string note = options_note(file);
  if (!resume || !std::filesystem::exists(note)) {
    write_text_file(note, options.empty() ? "" : fmt::format("{}\n", fmt::join(options, "\n")));
    return;
  }
  const std::vector<std::string> before =
      std::filesystem::is_empty(note) ? std::vector<std::string>{}
                                      : lines_of(read_text_file(note, kMostBytes));
  if (before == options) return;
  throw InputError(file, fmt::format("has runs with {}, not with {}; give the same, or choose "
                                     "another --output",
                                     shown(before), shown(options)));
}

}  // namespace mvtp
