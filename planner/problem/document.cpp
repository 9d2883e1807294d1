#include "planner/problem/document.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>

#include "planner/problem/document_builder.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/plain_yaml.hpp"

namespace mvtp {
std::string excerpt(std::string_view text) {
  constexpr std::size_t kMaxShown = 40;
  std::string shown;
  for (const char c : text.substr(0, kMaxShown)) shown += (c == '\n' || c == '\t') ? ' ' : c;
  // Not in the middle of a UTF-8 sequence.
  if (text.size() > kMaxShown) {
    while (!shown.empty() && (static_cast<unsigned char>(shown.back()) & 0xc0u) == 0x80u) {
      shown.pop_back();
    }
    if (!shown.empty() && static_cast<unsigned char>(shown.back()) >= 0xc0u) shown.pop_back();
    shown += "...";
  }
  return '"' + shown + '"';
}

namespace {

template <class Number>
std::optional<Number> parse_whole(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string position(const YAML::Mark& mark) {
  return fmt::format("line {}, column {}", mark.line + 1, mark.column + 1);
}

class YamlEvents final : public YAML::EventHandler {
 public:
  explicit YamlEvents(DocumentBuilder& builder) : builder_(builder) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (seen_document_) fail(mark, "a second document begins here; keep one per file");
    seen_document_ = true;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    require_plain(mark, anchor, "");
    builder_.null();
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    require_plain(mark, anchor, "");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    require_plain(mark, anchor, tag);
    builder_.scalar(value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    require_plain(mark, anchor, tag);
    builder_.open(Value::Kind::kList);
  }
  void OnSequenceEnd() override { builder_.close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    require_plain(mark, anchor, tag);
    builder_.open(Value::Kind::kMap);
  }
  void OnMapEnd() override { builder_.close(); }

 private:
  /// Aliases can make a small file huge; tags name types that nobody here knows. ("?" and "!"
  /// are what the parser itself gives to plain and to quoted scalars.)
  void require_plain(const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& tag) const {
    if (anchor != 0) fail(mark, "anchors and aliases are not supported; write the value out");
    if (!tag.empty() && tag != "?" && tag != "!") {
      fail(mark, "the tag " + excerpt(tag) + " is not supported; remove it");
    }
  }

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& what) const {
    throw InputError(builder_.name() + ": " + position(mark), what);
  }

  DocumentBuilder& builder_;
  bool seen_document_ = false;
};

void parse_yaml(DocumentBuilder& builder, const std::string& text) {
  std::istringstream stream(text);
  YamlEvents events(builder);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(events)) {
    }
  } catch (const YAML::Exception& error) {
    throw InputError(builder.name() + ": " + position(error.mark), "is not YAML: " + error.msg);
  }
}

constexpr const char* kCutOff = "; or is the file cut off?";

class JsonEvents final : public nlohmann::json_sax<nlohmann::json> {
 public:
  /// @param size  of the text
  JsonEvents(DocumentBuilder& builder, std::size_t size) : builder_(builder), size_(size) {}

  bool null() override { return builder_.null(), true; }
  bool boolean(bool value) override { return builder_.scalar(value ? "true" : "false"), true; }
  bool number_integer(number_integer_t value) override { return scalar(value); }
  bool number_unsigned(number_unsigned_t value) override { return scalar(value); }
  bool number_float(number_float_t, const string_t& text) override {
    return builder_.scalar(text), true;
  }
  bool string(string_t& value) override { return builder_.scalar(value), true; }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return builder_.open(Value::Kind::kMap), true; }
  bool key(string_t& value) override { return builder_.scalar(value), true; }
  bool end_object() override { return builder_.close(), true; }
  bool start_array(std::size_t) override { return builder_.open(Value::Kind::kList), true; }
  bool end_array() override { return builder_.close(), true; }
  bool parse_error(std::size_t offset, const std::string& last,
                   const nlohmann::detail::exception&) override {
    throw InputError(builder_.name(), fmt::format("is not JSON at offset {}, at {}{}", offset,
                                                  excerpt(last), offset > size_ ? kCutOff : ""));
  }

 private:
  template <class Integer>
  bool scalar(Integer value) {
    return builder_.scalar(fmt::to_string(value)), true;
  }

  DocumentBuilder& builder_;
  std::size_t size_;
};

/// JSON if it is named so, or starts like nothing but JSON (YAML maps rarely start with {").
bool looks_like_json(const std::string& name, const std::string& text) {
  if (name.ends_with(".json")) return true;
  const std::size_t brace = text.find_first_not_of(" \t\r\n");
  if (brace == std::string::npos || text[brace] != '{') return false;
  const std::size_t next = text.find_first_not_of(" \t\r\n", brace + 1);
  return next != std::string::npos && text[next] == '"';
}

bool ends_with_brace(const std::string& text) {
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  return last != std::string::npos && text[last] == '}';
}

}  // namespace

Document Document::parse(const std::string& name, const std::string& text,
                         std::initializer_list<std::string_view> keys, std::string_view what) {
  const auto occurs = [&](std::string_view key) { return text.find(key) != std::string::npos; };
  if (std::none_of(keys.begin(), keys.end(), occurs)) {
    const bool cut_off = looks_like_json(name, text) && !ends_with_brace(text);
    throw InputError(name, fmt::format("is not {} (it has no key {}); give the right file{}", what,
                                       fmt::join(keys, " or "), cut_off ? kCutOff : ""));
  }
  if (text.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(name, "is larger than 4 GB; is it the right file?");
  }
  if (looks_like_json(name, text)) {
    DocumentBuilder builder(name);
    JsonEvents events(builder, text.size());
    nlohmann::json::sax_parse(text, &events);
    return builder.finish();
  }
  DocumentBuilder plain(name);
  if (parse_plain_yaml(plain, text)) return plain.finish();
  DocumentBuilder builder(name);
  parse_yaml(builder, text);
  return builder.finish();
}

std::string Document::path(std::uint32_t index) const {
  if (index == root_) return "";
  const Record& record = records_[index];
  const Record& parent = records_[record.parent];
  const std::string before = path(record.parent);
  if (parent.kind == Value::Kind::kList) {
    return fmt::format("{}[{}]", before, index - parent.content.begin);
  }
  const std::string key(text(record.key));
  return before.empty() ? key : before + "." + key;
}

Value::Kind Value::kind() const { return document_->records_[index_].kind; }

std::size_t Value::size() const {
  return is_list() || is_map() ? document_->records_[index_].content.size : 0;
}

Value Value::operator[](std::size_t i) const {
  return Value(document_,
               document_->records_[index_].content.begin + static_cast<std::uint32_t>(i));
}

std::string_view Value::key() const { return document_->text(document_->records_[index_].key); }

std::optional<Value> Value::find(std::string_view wanted) const {
  for (std::size_t i = 0; is_map() && i < size(); ++i) {
    const Value entry = (*this)[i];
    if (entry.key() == wanted) return entry;
  }
  return std::nullopt;
}

Value Value::at(std::string_view wanted) const {
  const std::optional<Value> found = find(wanted);
  if (found) return *found;
  const bool at_root = index_ == document_->root_;
  throw InputError(fmt::format("{}{}{}", where(), at_root ? ": " : ".", wanted),
                   "is missing; add it");
}

double Value::number(std::string_view unit) const {
  const std::optional<double> value =
      kind() == Kind::kScalar ? parse_whole<double>(text()) : std::nullopt;
  if (!value || !std::isfinite(*value)) {
    throw InputError(where(), fmt::format("is {}; give a finite number{}", description(),
                                          unit.empty() ? "" : fmt::format(" [{}]", unit)));
  }
  return *value;
}

double Value::positive(std::string_view unit) const {
  const double value = number(unit);
  if (!(value > 0.0)) {
    throw InputError(where(), fmt::format("is {} {}; give a number > 0", value, unit));
  }
  return value;
}

std::uint64_t Value::count() const {
  const std::optional<std::uint64_t> value =
      kind() == Kind::kScalar ? parse_whole<std::uint64_t>(text()) : std::nullopt;
  if (!value) {
    throw InputError(where(), fmt::format("is {}; give an integer >= 0", description()));
  }
  return *value;
}

std::string Value::text() const {
  if (kind() != Kind::kScalar) {
    throw InputError(where(), fmt::format("is {}; give a single value", description()));
  }
  return std::string(document_->text(document_->records_[index_].content));
}

void Value::require_map(std::string_view example) const {
  if (is_map()) return;
  throw InputError(where(), fmt::format("is {}; give a map like {}", description(), example));
}

void Value::require_list(std::size_t min, std::size_t max, std::string_view example) const {
  if (is_list() && size() >= min && size() <= max) return;
  throw InputError(where(), fmt::format("is {}; give a list like {}", description(), example));
}

void Value::require_known_keys(std::initializer_list<std::string_view> known) const {
  for (std::size_t i = 0; i < size(); ++i) {
    const std::string_view key = (*this)[i].key();
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw InputError(where(), fmt::format("has the unknown key {}; the known keys are {}",
                                          excerpt(key), fmt::join(known, ", ")));
  }
}

std::string Value::where() const {
  const std::string path = document_->path(index_);
  return path.empty() ? document_->name_ : document_->name_ + ": " + path;
}

std::string Value::description() const {
  switch (kind()) {
    case Kind::kNull:
      return "nothing";
    case Kind::kScalar:
      return excerpt(text());
    case Kind::kList:
      return fmt::format("a list of {}", size());
    case Kind::kMap:
      return "a map";
  }
  return "";
}

}  // namespace mvtp
