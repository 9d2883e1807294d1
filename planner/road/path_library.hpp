#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "planner/road/contact_table.hpp"
#include "planner/road/reservation.hpp"

namespace mvtp {

/// The reference paths in use, each for one body, and the contact tables of those pairs whose
/// bodies come near each other.
///
/// add(), remove() and build_tables() change the library and are for one thread at a time;
/// everything else may run in many threads between them. References stay valid until what they
/// refer to is removed; numbers are never given to another path.
class PathLibrary {
 public:
  explicit PathLibrary(const Margins& margins, Reservation reservation = Reservation::kNone)
      : margins_(margins), reservation_(reservation) {}

  /// Returns the number of the new path.
  /// @param stretches  over junctions, for reservations there.
  int add(ReferencePath path, const Vehicle& body, std::vector<JunctionStretch> stretches = {}) {
    return add(std::move(path), body, margins_, std::move(stretches));
  }
  /// The same with margins of its own.
  int add(ReferencePath path, const Vehicle& body, const Margins& margins,
          std::vector<JunctionStretch> stretches = {});
  /// The path numbered `like`, for a body of the same shape that moves otherwise: the two share
  /// their contacts. Returns its number.
  int add_like(int like, const Vehicle& body);

  /// Nobody uses these paths any more: what is kept for them alone goes. Each number once.
  void remove(std::span<const int> paths);
  /// Is there what add_like() needs of the path numbered so?
  [[nodiscard]] bool holds(int p) const { return grounds_[std::size_t(ground_of(p))] != nullptr; }

  [[nodiscard]] const Margins& margins() const { return margins_; }
  /// Paths so far, with those removed.
  [[nodiscard]] int size() const { return int(entries_.size()); }
  [[nodiscard]] const ReferencePath& path(int p) const { return ground(p).path; }
  [[nodiscard]] const Vehicle& body(int p) const { return entries_[std::size_t(p)].body; }

  /// Where a body on path `a` meets one on path `b`. A look-up in what build_tables() has built;
  /// the table of any other pair is built at its first use, one thread after the other.
  [[nodiscard]] const ContactTable& contacts(int a, int b) const;

  /// Positions on `a` and `b` that reservations forbid, among the paths of the last build_tables().
  [[nodiscard]] const ContactTable& reserved(int a, int b) const;

  /// Builds the tables that are missing among `paths`, and between them and the `others`, on all
  /// cores. What the others have among themselves nobody asks for.
  void build_tables(std::span<const int> paths, std::span<const int> others = {});

  /// Tables held [pairs], for one who looks after the memory.
  [[nodiscard]] std::size_t tables() const { return tables_.size(); }

 private:
  /// A path with the ground that a body covers along it.
  struct Ground {
    Ground(ReferencePath line, const Vehicle& body, const Margins& margins,
           std::vector<JunctionStretch> on_junctions)
        : path(std::move(line)), swept(path, body, margins), stretches(std::move(on_junctions)) {}

    const ReferencePath path;  ///< where `swept` looks at it
    SweptPath swept;
    std::vector<JunctionStretch> stretches;
    std::vector<int> near;  ///< those added before this one, and itself, whose bounds overlap
    int users = 1;          ///< paths
  };
  struct Entry {
    int ground;
    Vehicle body;
  };
  /// By the grounds of both.
  using Tables = std::unordered_map<std::uint64_t, std::unique_ptr<const ContactTable>>;

  [[nodiscard]] int ground_of(int p) const { return entries_[std::size_t(p)].ground; }
  [[nodiscard]] const Ground& ground(int p) const { return *grounds_[std::size_t(ground_of(p))]; }
  [[nodiscard]] const ContactTable& build_late(int a, int b) const;
  void reserve_among(std::span<const int> paths);

  Margins margins_;
  Reservation reservation_;
  std::vector<Entry> entries_;
  std::vector<std::unique_ptr<Ground>> grounds_;  ///< null: removed
  Tables tables_;
  Tables reserved_;
  mutable std::mutex late_guard_;
  mutable Tables late_;  ///< built by contacts(); guarded by late_guard_
};

}  // namespace mvtp
