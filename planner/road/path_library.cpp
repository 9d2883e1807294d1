#include "planner/road/path_library.hpp"

#include <tbb/parallel_for.h>

#include <utility>

namespace mvtp {
namespace {

const ContactTable kNoContact;

std::uint64_t pair_key(int a, int b) {
  return (std::uint64_t(std::uint32_t(a)) << 32U) | std::uint32_t(b);
}

std::pair<int, int> grounds_of(std::uint64_t key) {
  return {int(key >> 32U), int(std::uint32_t(key))};
}

std::unique_ptr<const ContactTable> transpose_of(const ContactTable& table) {
  return std::make_unique<ContactTable>(table.transposed());
}

}  // namespace

int PathLibrary::add(ReferencePath path, const Vehicle& body, const Margins& margins,
                     std::vector<JunctionStretch> stretches) {
  const int number = int(grounds_.size());
  auto added = std::make_unique<Ground>(std::move(path), body, margins, std::move(stretches));
  for (int g = 0; g < number; ++g) {
    const auto& other = grounds_[std::size_t(g)];
    if (other && other->swept.bounds().overlaps(added->swept.bounds())) added->near.push_back(g);
  }
  added->near.push_back(number);
  grounds_.push_back(std::move(added));
  entries_.push_back({number, body});
  return size() - 1;
}

int PathLibrary::add_like(int like, const Vehicle& body) {
  entries_.push_back({ground_of(like), body});
  ++grounds_[std::size_t(ground_of(like))]->users;
  return size() - 1;
}

void PathLibrary::remove(std::span<const int> paths) {
  for (const int p : paths) {
    auto& ground = grounds_[std::size_t(ground_of(p))];
    if (--ground->users == 0) ground.reset();
  }
  const auto is_removed = [&](int g) { return grounds_[std::size_t(g)] == nullptr; };
  for (const auto& ground : grounds_) {
    if (ground) std::erase_if(ground->near, is_removed);
  }
  for (Tables* tables : {&tables_, &reserved_, &late_}) {
    std::erase_if(*tables, [&](const auto& table) {
      const auto [a, b] = grounds_of(table.first);
      return is_removed(a) || is_removed(b);
    });
  }
}

const ContactTable& PathLibrary::contacts(int a, int b) const {
  if (!ground(a).swept.bounds().overlaps(ground(b).swept.bounds())) return kNoContact;
  const int from = ground_of(a);
  const int to = ground_of(b);
  const auto table = tables_.find(pair_key(from, to));
  return table != tables_.end() ? *table->second : build_late(from, to);
}

const ContactTable& PathLibrary::build_late(int a, int b) const {
  const std::scoped_lock lock(late_guard_);
  auto& table = late_[pair_key(a, b)];
  if (!table) {
    // As build_tables() would: from the smaller number's side, so that it makes no difference.
    ContactTable built(grounds_[std::size_t(std::min(a, b))]->swept,
                       grounds_[std::size_t(std::max(a, b))]->swept);
    table = a <= b ? std::make_unique<ContactTable>(std::move(built)) : transpose_of(built);
  }
  return *table;
}

const ContactTable& PathLibrary::reserved(int a, int b) const {
  const auto table = reserved_.find(pair_key(ground_of(a), ground_of(b)));
  return table != reserved_.end() ? *table->second : kNoContact;
}

void PathLibrary::reserve_among(std::span<const int> paths) {
  if (reservation_ == Reservation::kNone) return;
  for (const int a : paths) {
    for (const int b : paths) {
      if (ground_of(a) > ground_of(b)) continue;
      auto& table = reserved_[pair_key(ground_of(a), ground_of(b))];
      if (table) continue;
      const Ground& on_a = ground(a);
      const Ground& on_b = ground(b);
      table = std::make_unique<ContactTable>(
          reserved_ground(reservation_, {&on_a.swept, on_a.stretches},
                          {&on_b.swept, on_b.stretches}, contacts(a, b)));
      if (ground_of(a) == ground_of(b)) continue;
      reserved_[pair_key(ground_of(b), ground_of(a))] = transpose_of(*table);
    }
  }
}

void PathLibrary::build_tables(std::span<const int> paths, std::span<const int> others) {
  tables_.merge(late_);
  enum class Role : std::uint8_t { kNone, kOther, kDriven };
  std::vector<Role> roles(grounds_.size(), Role::kNone);
  for (const int p : others) roles[std::size_t(ground_of(p))] = Role::kOther;
  for (const int p : paths) roles[std::size_t(ground_of(p))] = Role::kDriven;
  std::vector<std::pair<int, int>> missing;  // the smaller number first
  for (int b = 0; b < int(grounds_.size()); ++b) {
    const Role role = roles[std::size_t(b)];
    if (role == Role::kNone) continue;
    const Role least = role == Role::kDriven ? Role::kOther : Role::kDriven;
    for (const int a : grounds_[std::size_t(b)]->near) {
      if (roles[std::size_t(a)] >= least && !tables_.contains(pair_key(a, b))) {
        missing.emplace_back(a, b);
      }
    }
  }
  std::vector<std::unique_ptr<const ContactTable>> built(missing.size());
  std::vector<std::unique_ptr<const ContactTable>> transposed(missing.size());
  tbb::parallel_for(std::size_t{0}, missing.size(), [&](std::size_t i) {
    const auto [a, b] = missing[i];
    built[i] = std::make_unique<ContactTable>(grounds_[std::size_t(a)]->swept,
                                              grounds_[std::size_t(b)]->swept);
    if (a != b) transposed[i] = transpose_of(*built[i]);
  });
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const auto [a, b] = missing[i];
    // What is there already may be referred to.
    if (a != b) tables_.try_emplace(pair_key(b, a), std::move(transposed[i]));
    tables_.try_emplace(pair_key(a, b), std::move(built[i]));
  }
  reserve_among(paths);
}

}  // namespace mvtp
