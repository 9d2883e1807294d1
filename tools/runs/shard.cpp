#include "tools/runs/shard.hpp"

#include <fmt/format.h>

#include "planner/problem/input_error.hpp"
#include "tools/cli/option_values.hpp"

namespace mvtp {

Shard parse_shard(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto part = [&](std::size_t begin, std::size_t end) {
    const std::string word = text.substr(begin, end - begin);
    return whole_number_between(1, 1'000'000)(word).empty() ? std::stoi(word) : 0;
  };
  if (slash != std::string::npos) {
    const Shard shard{part(0, slash), part(slash + 1, text.size())};
    if (shard.index >= 1 && shard.index <= shard.count) return shard;
  }
  throw InputError("--shard",
                   fmt::format("is \"{}\"; give I/N with I from 1 to N, e.g. 2/4", text));
}

}  // namespace mvtp
