#include "tools/bench/instance_paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

/// Does the file begin like a plan? Those of a former run may lie among the instances.
bool looks_like_plan(const fs::path& file) {
  std::array<char, 4096> head{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), head.size());
  std::string text = "\n";
  text.append(head.data(), std::size_t(stream.gcount()));
  return text.find("\nstatistics:") != std::string::npos ||
         text.find("\nschedule:") != std::string::npos;
}

bool may_be_instance(const fs::directory_entry& entry) {
  const fs::path extension = entry.path().extension();
  return (extension == ".yaml" || extension == ".yml" || extension == ".json") &&
         !is_hidden(entry.path()) && entry.is_regular_file() && !looks_like_plan(entry.path());
}

[[noreturn]] void report_unreadable(const std::string& path, const std::string& why) {
  throw InputError(path, fmt::format("cannot be read: {}; check the path", why));
}

void add_folder(const fs::path& folder, std::vector<fs::path>& files) {
  const std::size_t before = files.size();
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    if (entry->is_directory() && is_hidden(entry->path())) entry.disable_recursion_pending();
    if (may_be_instance(*entry)) files.push_back(entry->path());
  }
  if (error) report_unreadable(folder.string(), error.message());
  if (files.size() == before) {
    throw InputError(folder.string(), "holds no instance (*.yaml, *.json); give another folder");
  }
}

fs::path common_part(const fs::path& a, const fs::path& b) {
  fs::path common;
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end() && *i == *j; ++i, ++j) {
    common /= *i;
  }
  return common;
}

/// Orders "a5" before "a10": runs of digits count as numbers.
bool natural_less(std::string_view a, std::string_view b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto take_number = [&](std::string_view& text) {
    const std::size_t zeros = std::min(text.find_first_not_of('0'), text.size());
    text.remove_prefix(zeros);
    std::size_t length = 0;
    while (length < text.size() && is_digit(text[length])) ++length;
    const std::string_view digits = text.substr(0, length);
    text.remove_prefix(length);
    return std::pair(length, digits);
  };
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const auto x = take_number(a);
      const auto y = take_number(b);
      if (x != y) return x < y;
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;
}

}  // namespace

std::vector<InstancePath> find_instances(const std::vector<std::string>& paths) {
  std::vector<fs::path> files;
  fs::path root;
  for (const std::string& path : paths) {
    std::error_code error;
    const fs::path canonical = fs::canonical(path, error);
    if (error) report_unreadable(path, error.message());
    const bool is_folder = fs::is_directory(canonical);
    const fs::path folder = is_folder ? canonical : canonical.parent_path();
    root = root.empty() ? folder : common_part(root, folder);
    if (is_folder) {
      add_folder(canonical, files);
    } else {
      files.push_back(canonical);
    }
  }
  std::vector<InstancePath> instances;
  for (const fs::path& file : files) {
    instances.push_back({file.string(), file.lexically_relative(root).string()});
  }
  std::ranges::sort(instances, natural_less, &InstancePath::name);
  const auto repeated = std::ranges::unique(instances);
  instances.erase(repeated.begin(), repeated.end());
  return instances;
}

}  // namespace mvtp
