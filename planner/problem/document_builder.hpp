#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "planner/problem/document.hpp"
#include "planner/problem/input_error.hpp"

namespace mvtp {

/// Text from a file as part of a one-line message: short, quoted and printable.
[[nodiscard]] std::string excerpt(std::string_view text);

/// Collects the events of a parser into a Document; all parsers drive the same four calls.
class DocumentBuilder {
 public:
  explicit DocumentBuilder(std::string name) { document_.name_ = std::move(name); }

  void scalar(std::string_view text) {
    if (expects_key()) {
      key_ = store(text);
      has_key_ = true;
      return;
    }
    add(Value::Kind::kScalar, store(text));
  }

  void null() {
    if (expects_key()) throw InputError(name(), "has an empty key; remove the stray ':'");
    add(Value::Kind::kNull, {});
  }

  void open(Value::Kind kind) {
    if (expects_key()) {
      throw InputError(name(),
                       "has a list or map as a key; use a plain word; or is the file cut off?");
    }
    constexpr std::size_t kMaxDepth = 32;
    if (open_.size() == kMaxDepth) {
      throw InputError(document_.name_, fmt::format("is nested more than {} levels deep; is it the "
                                                    "right file?",
                                                    kMaxDepth));
    }
    open_.push_back({kind, take_key(), pending_.size()});
  }

  void close() {
    const Open container = open_.back();
    open_.pop_back();
    const Slice entries = place(container.first_pending);
    if (container.kind == Value::Kind::kMap) reject_repeated_keys(entries);
    pending_.push_back(Record{container.kind, container.key, entries, 0});
  }

  /// @pre the parser came to its end.
  [[nodiscard]] Document finish() {
    if (pending_.empty()) throw InputError(document_.name_, "is empty; give a YAML or JSON file");
    document_.root_ = place(0).begin;
    return std::move(document_);
  }

  [[nodiscard]] const std::string& name() const { return document_.name_; }

 private:
  using Record = Document::Record;
  using Slice = Document::Slice;
  struct Open {
    Value::Kind kind;
    Slice key;
    std::size_t first_pending;
  };

  [[nodiscard]] bool expects_key() const {
    return !open_.empty() && open_.back().kind == Value::Kind::kMap && !has_key_;
  }

  Slice take_key() {
    const Slice key = has_key_ ? key_ : Slice{};
    has_key_ = false;
    return key;
  }

  void add(Value::Kind kind, const Slice& content) {
    pending_.push_back(Record{kind, take_key(), content, 0});
  }

  Slice store(std::string_view text) {
    const Slice slice{static_cast<std::uint32_t>(document_.text_.size()),
                      static_cast<std::uint32_t>(text.size())};
    document_.text_ += text;
    return slice;
  }

  /// Moves the finished siblings from `first` on to their final, adjacent places.
  Slice place(std::size_t first) {
    std::vector<Record>& records = document_.records_;
    const auto begin = static_cast<std::uint32_t>(records.size());
    records.insert(records.end(), pending_.begin() + std::ptrdiff_t(first), pending_.end());
    pending_.resize(first);
    for (auto i = begin; i < records.size(); ++i) {
      if (records[i].kind != Value::Kind::kList && records[i].kind != Value::Kind::kMap) continue;
      const Slice children = records[i].content;
      for (auto c = children.begin; c < children.begin + children.size; ++c) records[c].parent = i;
    }
    return {begin, static_cast<std::uint32_t>(records.size()) - begin};
  }

  void reject_repeated_keys(const Slice& entries) {
    keys_.clear();
    for (auto i = entries.begin; i < entries.begin + entries.size; ++i) {
      keys_.push_back(document_.text(document_.records_[i].key));
    }
    std::sort(keys_.begin(), keys_.end());
    const auto twice = std::adjacent_find(keys_.begin(), keys_.end());
    if (twice == keys_.end()) return;
    throw InputError(document_.name_,
                     fmt::format("a map has the key {} twice; remove one", excerpt(*twice)));
  }

  Document document_;
  std::vector<Open> open_;       ///< the lists and maps around the current event
  std::vector<Record> pending_;  ///< finished values whose container is still open
  std::vector<std::string_view> keys_;
  Slice key_;
  bool has_key_ = false;
};

}  // namespace mvtp
