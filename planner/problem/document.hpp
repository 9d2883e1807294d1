#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mvtp {

class Document;

/// One value of a Document: null, a scalar, a list or a map. A light view; the document must live.
///
/// Every accessor throws InputError naming the place ("cross.yaml: agents[3].goal") when the value
/// is not what is asked for.
class Value {
 public:
  enum class Kind : std::uint8_t { kNull, kScalar, kList, kMap };

  [[nodiscard]] Kind kind() const;
  [[nodiscard]] bool is_map() const { return kind() == Kind::kMap; }
  [[nodiscard]] bool is_list() const { return kind() == Kind::kList; }

  /// The number of entries of a list or map; 0 for the others.
  [[nodiscard]] std::size_t size() const;
  /// Entry i of a list or map, in the order of the file. @pre i < size()
  [[nodiscard]] Value operator[](std::size_t i) const;
  /// The key of this entry of a map; empty elsewhere.
  [[nodiscard]] std::string_view key() const;

  /// The entry of a map with this key, if there is one.
  [[nodiscard]] std::optional<Value> find(std::string_view key) const;
  /// The entry of a map with this key. @throws InputError if it is missing.
  [[nodiscard]] Value at(std::string_view key) const;

  /// A finite number; `unit` ("m", "rad", ...) is for the message only.
  [[nodiscard]] double number(std::string_view unit) const;
  /// A finite number > 0.
  [[nodiscard]] double positive(std::string_view unit) const;
  /// An integer >= 0.
  [[nodiscard]] std::uint64_t count() const;
  [[nodiscard]] std::string text() const;

  /// @throws InputError unless this is a map / a list of `min` to `max` entries.
  void require_map(std::string_view example) const;
  void require_list(std::size_t min, std::size_t max, std::string_view example) const;
  /// @throws InputError at the first key that is not in `known`: most likely a typing mistake.
  void require_known_keys(std::initializer_list<std::string_view> known) const;

  /// "FILE: agents[3].goal".
  [[nodiscard]] std::string where() const;
  /// What stands here, for messages: `"abc"`, `a list of 2`, `nothing`.
  [[nodiscard]] std::string description() const;

 private:
  friend class Document;
  Value(const Document* document, std::uint32_t index) : document_(document), index_(index) {}

  const Document* document_;
  std::uint32_t index_;
};

/// A YAML or JSON text as a tree of values, for input that nobody vouches for.
///
/// Only what data files need is accepted: one document, no anchors, aliases or own tags, at most 32
/// levels deep, no key twice. All values lie in two flat arrays, so that plans with millions of
/// numbers load in little memory.
class Document {
 public:
  /// @param name stands for the file in messages.
  /// @param keys a text without any of these words cannot be meant; it is refused unparsed, so that
  /// garbage of any size fails at once. `what` says what is expected: "an instance file".
  /// @throws InputError with line and column where the text is not well-formed.
  [[nodiscard]] static Document parse(const std::string& name, const std::string& text,
                                      std::initializer_list<std::string_view> keys,
                                      std::string_view what);

  [[nodiscard]] Value root() const { return Value(this, root_); }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  friend class Value;
  friend class DocumentBuilder;

  struct Slice {
    std::uint32_t begin = 0;
    std::uint32_t size = 0;
  };
  struct Record {
    Value::Kind kind = Value::Kind::kNull;
    Slice key;      ///< in text_; only entries of a map have one
    Slice content;  ///< of a scalar: in text_; of a list or map: its entries in records_
    std::uint32_t parent = 0;
  };

  [[nodiscard]] std::string_view text(const Slice& slice) const {
    return std::string_view(text_).substr(slice.begin, slice.size);
  }
  [[nodiscard]] std::string path(std::uint32_t index) const;

  std::string name_;
  std::string text_;
  std::vector<Record> records_;
  std::uint32_t root_ = 0;
};

}  // namespace mvtp
