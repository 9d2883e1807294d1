#pragma once

#include <cstddef>
#include <string>

namespace mvtp {

/// Part `index` of `count` of the work, from 1: every count-th piece.
struct Shard {
  int index = 1;
  int count = 1;

  [[nodiscard]] bool has(std::size_t piece) const {
    return int(piece % std::size_t(count)) == index - 1;
  }
};

/// Reads the option --shard: "2/4". @throws InputError
[[nodiscard]] Shard parse_shard(const std::string& text);

}  // namespace mvtp
