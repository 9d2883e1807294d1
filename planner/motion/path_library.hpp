#pragma once

#include <memory>
#include <vector>

#include "planner/motion/contact_table.hpp"

namespace mvtp {

/// The guide paths in use, each for one body, and the contact tables of all their pairs.
class PathLibrary {
 public:
  explicit PathLibrary(const Margins& margins) : margins_(margins) {}

  /// Returns the number of the new path.
  int add(GuidePath path, const Vehicle& body);

  [[nodiscard]] int size() const { return int(entries_.size()); }
  [[nodiscard]] const GuidePath& path(int p) const { return entries_[std::size_t(p)].path; }
  [[nodiscard]] const Vehicle& body(int p) const { return entries_[std::size_t(p)].body; }

  /// Where a body on path `a` meets one on path `b`. Built at its first use, about a millisecond.
  [[nodiscard]] const ContactTable& contacts(int a, int b) const;

 private:
  struct Entry {
    GuidePath path;
    Vehicle body;
  };
  Margins margins_;
  std::vector<Entry> entries_;
  mutable std::vector<std::vector<std::unique_ptr<const ContactTable>>> tables_;
};

}  // namespace mvtp
