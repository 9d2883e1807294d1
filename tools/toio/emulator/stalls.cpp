#include "tools/toio/emulator/stalls.hpp"

#include <fmt/format.h>

#include <charconv>

#include "planner/problem/input_error.hpp"

namespace mvtp {

Stalls parse_stalls(const std::string& text) {
  const InputError bad("--stall",
                       fmt::format("is \"{}\"; give RATE:SECONDS or RATE:FROM-TO, stalls of "
                                   "each cube per minute and how long, e.g. 2:1-5",
                                   text));
  const auto number = [&](const std::string& word) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool whole = error == std::errc() && end == word.data() + word.size();
    if (!whole || !(value >= 0.0 && value <= 1000.0)) throw bad;
    return value;
  };
  const std::size_t colon = text.find(':');
  Stalls stalls;
  stalls.per_minute = number(text.substr(0, colon));
  if (colon == std::string::npos) return stalls;
  const std::string seconds = text.substr(colon + 1);
  const std::size_t dash = seconds.find('-');
  stalls.shortest = number(seconds.substr(0, dash));
  stalls.longest = dash == std::string::npos ? stalls.shortest : number(seconds.substr(dash + 1));
  if (stalls.longest < stalls.shortest) throw bad;
  return stalls;
}

}  // namespace mvtp
