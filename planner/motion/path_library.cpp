#include "planner/motion/path_library.hpp"

#include <tbb/parallel_for.h>

#include <utility>

namespace mvtp {
namespace {

const ContactTable kNoContact;

std::uint64_t pair_key(int a, int b) {
  return (std::uint64_t(std::uint32_t(a)) << 32U) | std::uint32_t(b);
}

std::unique_ptr<const ContactTable> transpose_of(const ContactTable& table) {
  return std::make_unique<ContactTable>(table.transposed());
}

}  // namespace

int PathLibrary::add(GuidePath path, const Vehicle& body) {
  SweptPath swept(path, body, margins_);
  std::vector<int> near;
  for (int p = 0; p < size(); ++p) {
    if (entry(p).swept.bounds().overlaps(swept.bounds())) near.push_back(p);
  }
  near.push_back(size());
  entries_.push_back(
      std::make_unique<Entry>(Entry{std::move(path), body, std::move(swept), std::move(near)}));
  return size() - 1;
}

const ContactTable& PathLibrary::contacts(int a, int b) const {
  if (!entry(a).swept.bounds().overlaps(entry(b).swept.bounds())) return kNoContact;
  const auto table = tables_.find(pair_key(a, b));
  return table != tables_.end() ? *table->second : build_late(a, b);
}

const ContactTable& PathLibrary::build_late(int a, int b) const {
  const std::scoped_lock lock(late_guard_);
  auto& table = late_[pair_key(a, b)];
  if (!table) {
    // As prepare() would: from the smaller number's side, so that it makes no difference.
    ContactTable built(entry(std::min(a, b)).swept, entry(std::max(a, b)).swept);
    table = a <= b ? std::make_unique<ContactTable>(std::move(built)) : transpose_of(built);
  }
  return *table;
}

void PathLibrary::prepare(std::span<const int> paths) {
  std::vector<bool> wanted(entries_.size(), false);
  for (const int p : paths) wanted[std::size_t(p)] = true;
  std::vector<std::pair<int, int>> missing;  // the smaller number first
  for (int b = 0; b < size(); ++b) {
    if (!wanted[std::size_t(b)]) continue;
    for (const int a : entry(b).near) {
      if (wanted[std::size_t(a)] && !tables_.contains(pair_key(a, b))) missing.emplace_back(a, b);
    }
  }
  std::vector<std::unique_ptr<const ContactTable>> built(missing.size());
  std::vector<std::unique_ptr<const ContactTable>> transposed(missing.size());
  tbb::parallel_for(std::size_t{0}, missing.size(), [&](std::size_t i) {
    const auto [a, b] = missing[i];
    built[i] = std::make_unique<ContactTable>(entry(a).swept, entry(b).swept);
    if (a != b) transposed[i] = transpose_of(*built[i]);
  });
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const auto [a, b] = missing[i];
    if (a != b) tables_[pair_key(b, a)] = std::move(transposed[i]);
    tables_[pair_key(a, b)] = std::move(built[i]);
  }
}

}  // namespace mvtp
