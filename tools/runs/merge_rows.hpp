#pragma once

#include <map>
#include <vector>

namespace mvtp {

/// The rows of all lists, each run once (the first found counts), ordered by key.
/// @param key_of  what identifies the run of a row
template <class Row, class KeyOf>
[[nodiscard]] std::vector<Row> merge_rows(const std::vector<std::vector<Row>>& lists,
                                          KeyOf key_of) {
  std::map<decltype(key_of(lists.front().front())), const Row*> runs;
  for (const std::vector<Row>& rows : lists) {
    for (const Row& row : rows) runs.emplace(key_of(row), &row);
  }
  std::vector<Row> merged;
  for (const auto& [key, row] : runs) merged.push_back(*row);
  return merged;
}

}  // namespace mvtp
