#include "planner/motion/path_library.hpp"

namespace mvtp {

int PathLibrary::add(GuidePath path, const Vehicle& body) {
  entries_.push_back({std::move(path), body});
  for (auto& row : tables_) row.emplace_back();
  tables_.emplace_back(entries_.size());
  return size() - 1;
}

const ContactTable& PathLibrary::contacts(int a, int b) const {
  auto& table = tables_[std::size_t(a)][std::size_t(b)];
  if (!table) {
    table = std::make_unique<ContactTable>(path(a), body(a), path(b), body(b), margins_);
  }
  return *table;
}

}  // namespace mvtp
