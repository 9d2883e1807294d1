#include "tools/runs/csv_reader.hpp"

namespace mvtp {

std::optional<CsvRecord> CsvReader::next() {
  CsvRecord record(1);
  bool in_quotes = false;
  std::size_t lines = 0;
  for (std::size_t i = position_; i < text_.size(); ++i) {
    const char c = text_[i];
    if (c == '\n') ++lines;
    if (c == '"') {
      const bool is_pair = in_quotes && i + 1 < text_.size() && text_[i + 1] == '"';
      if (is_pair)
        record.back() += text_[i++];
      else
        in_quotes = !in_quotes;
    } else if (in_quotes) {
      record.back() += c;
    } else if (c == ',') {
      record.emplace_back();
    } else if (c == '\n') {
      if (record.back().ends_with('\r')) record.back().pop_back();
      position_ = i + 1;
      line_ = next_line_;
      next_line_ += lines;
      return record;
    } else {
      record.back() += c;
    }
  }
  return std::nullopt;
}

}  // namespace mvtp
