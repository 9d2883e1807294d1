#include "planner/problem/plain_yaml.hpp"

#include <algorithm>
#include <vector>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kLongestWord = 500;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_word_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_' || c == '.' ||
         c == '+' || c == '-';
}

/// Words that mean no string and no number to YAML, or a mark of its own, are left to others.
bool is_plain_word(std::string_view word) {
  if (word.empty() || word.size() > kLongestWord || word == "null" || word == "Null" ||
      word == "NULL") {
    return false;
  }
  if (word.starts_with("..")) return false;  // "..." ends a document
  return word[0] != '-' || (word.size() > 1 && (is_digit(word[1]) || word[1] == '.'));
}

/// One pass over the lines; every parse function returns false for what is beyond the plain part.
class PlainParser {
 public:
  PlainParser(DocumentBuilder& builder, std::string_view text) : builder_(builder), text_(text) {}

  bool parse() {
    while (!text_.empty()) {
      const std::size_t end = std::min(text_.find('\n'), text_.size());
      std::string_view line = text_.substr(0, end);
      text_.remove_prefix(std::min(end + 1, text_.size()));
      line = line.substr(0, line.find_last_not_of(" \r") + 1);
      const std::size_t column = line.find_first_not_of(' ');
      if (column == std::string_view::npos || line[column] == '#') continue;
      if (!parse_line(column, line.substr(column))) return false;
    }
    if (blocks_.empty()) return false;
    while (!blocks_.empty()) close_block();
    return true;
  }

 private:
  struct Block {
    Value::Kind kind;
    std::size_t column;
  };

  bool parse_line(std::size_t column, std::string_view rest) {
    return rest.starts_with("- ") ? parse_item(column, rest) : parse_entry(column, rest);
  }

  /// "- value" or "- key: ..." of the list at this column. A list may begin at the column of the
  /// key whose value it is.
  bool parse_item(std::size_t column, std::string_view rest) {
    while (!blocks_.empty() && blocks_.back().column > column) close_block();
    if (awaits_value_ || blocks_.empty()) {
      if (!open_block(Value::Kind::kList, column)) return false;
    }
    if (blocks_.back().kind != Value::Kind::kList || blocks_.back().column != column) return false;

    const std::size_t gap = rest.find_first_not_of(' ', 1);
    rest.remove_prefix(gap);
    if (rest[0] == '[' || rest[0] == '{') return parse_flow_line(rest);
    if (rest.find(':') == std::string_view::npos) return parse_word_line(rest);
    return open_block(Value::Kind::kMap, column + gap) && parse_key_and_value(rest);
  }

  /// "key: value" or "key:" of the map at this column.
  bool parse_entry(std::size_t column, std::string_view rest) {
    const auto ends_here = [&](const Block& block) {
      return block.column > column || (block.column == column && block.kind == Value::Kind::kList);
    };
    while (!blocks_.empty() && ends_here(blocks_.back())) close_block();
    if (blocks_.empty() || (awaits_value_ && blocks_.back().column < column)) {
      if (!open_block(Value::Kind::kMap, column)) return false;
    }
    if (blocks_.back().kind != Value::Kind::kMap || blocks_.back().column != column) return false;
    end_awaited_value();
    return parse_key_and_value(rest);
  }

  bool parse_key_and_value(std::string_view rest) {
    if (!parse_word(rest) || !rest.starts_with(':')) return false;
    rest.remove_prefix(1);
    if (rest.empty()) {
      awaits_value_ = true;
      return true;
    }
    if (rest[0] != ' ') return false;
    skip_spaces(rest);
    return rest[0] == '[' || rest[0] == '{' ? parse_flow_line(rest) : parse_word_line(rest);
  }

  bool parse_flow_line(std::string_view rest) { return parse_flow(rest) && rest.empty(); }
  bool parse_word_line(std::string_view rest) { return parse_word(rest) && rest.empty(); }

  bool parse_word(std::string_view& rest) {
    if (rest.starts_with('"')) return parse_quoted(rest);
    std::size_t size = 0;
    while (size < rest.size() && is_word_character(rest[size])) ++size;
    const std::string_view word = rest.substr(0, size);
    if (!is_plain_word(word)) return false;
    builder_.scalar(word);
    rest.remove_prefix(size);
    return true;
  }

  /// "..." with its end on the same line, and nothing in it that stands for something else.
  bool parse_quoted(std::string_view& rest) {
    const std::size_t end = rest.find('"', 1);
    if (end == std::string_view::npos || end > kLongestWord) return false;
    const std::string_view text = rest.substr(1, end - 1);
    const auto stands_for_itself = [](char c) { return c >= ' ' && c <= '~' && c != '\\'; };
    if (!std::ranges::all_of(text, stands_for_itself)) return false;
    builder_.scalar(text);
    rest.remove_prefix(end + 1);
    return true;
  }

  /// "[a, [b], {c: d}]": a word, or a list or map with its end on the same line.
  bool parse_flow(std::string_view& rest) {
    if (rest.empty()) return false;
    if (rest[0] != '[' && rest[0] != '{') return parse_word(rest);
    const bool is_map = rest[0] == '{';
    const char closing = is_map ? '}' : ']';
    builder_.open(is_map ? Value::Kind::kMap : Value::Kind::kList);
    rest.remove_prefix(1);
    skip_spaces(rest);
    while (!rest.starts_with(closing)) {
      if (is_map && !parse_flow_key(rest)) return false;
      if (!parse_flow(rest)) return false;
      skip_spaces(rest);
      if (rest.starts_with(closing)) break;
      if (!rest.starts_with(',')) return false;
      rest.remove_prefix(1);
      skip_spaces(rest);
      if (rest.starts_with(closing)) return false;  // a comma before the end
    }
    rest.remove_prefix(1);
    builder_.close();
    return true;
  }

  bool parse_flow_key(std::string_view& rest) {
    if (!parse_word(rest) || !rest.starts_with(": ")) return false;
    rest.remove_prefix(1);
    skip_spaces(rest);
    return true;
  }

  static void skip_spaces(std::string_view& rest) {
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  }

  /// False where a second root would begin.
  bool open_block(Value::Kind kind, std::size_t column) {
    if (blocks_.empty() && has_root_) return false;
    has_root_ = true;
    awaits_value_ = false;
    builder_.open(kind);
    blocks_.push_back({kind, column});
    return true;
  }

  void close_block() {
    end_awaited_value();
    builder_.close();
    blocks_.pop_back();
  }

  /// "key:" with nothing behind it and nothing deeper below.
  void end_awaited_value() {
    if (awaits_value_) builder_.null();
    awaits_value_ = false;
  }

  DocumentBuilder& builder_;
  std::string_view text_;
  std::vector<Block> blocks_;  ///< the open ones, by rising column
  bool has_root_ = false;
  bool awaits_value_ = false;  ///< the last line was "key:"
};

}  // namespace

bool parse_plain_yaml(DocumentBuilder& builder, std::string_view text) {
  try {
    return PlainParser(builder, text).parse();
  } catch (const InputError&) {
    return false;  // the complete parser tells where
  }
}

}  // namespace mvtp
