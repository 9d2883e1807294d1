#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mvtp {

/// The fields of one record of a CSV text.
using CsvRecord = std::vector<std::string>;

/// Takes records off a CSV text [RFC 4180]; both ends of line will do.
class CsvReader {
 public:
  explicit CsvReader(std::string_view text) : text_(text) {}

  /// The next record; nullopt at the end, or if the rest does not end with an end of line.
  [[nodiscard]] std::optional<CsvRecord> next();

  /// Behind the last record taken.
  [[nodiscard]] std::size_t position() const { return position_; }
  /// On which line the last record taken began, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
  std::size_t next_line_ = 1;
};

}  // namespace mvtp
