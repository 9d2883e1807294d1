#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mvtp {

/// The benchmark suites: three of the ESCoT paper (Sec. IV-A) and one denser than those.
enum class Suite { kTypical, kSparse, kDense, kCrowd };

/// Where the robots of a cell stand.
enum class Layout {
  kRandom,
  kCircle,  ///< around a circle, each with its goal straight across
};

/// Instances that differ in chance only: what a point in the paper's figures averages over.
struct Cell {
  Suite suite = Suite::kSparse;
  Layout layout = Layout::kRandom;
  int side = 50;      ///< of the square map [m]
  int obstacles = 0;  ///< discs with a radius of 0.8 m
  int robots = 2;
  int instances = 60;

  friend bool operator==(const Cell&, const Cell&) = default;
};

[[nodiscard]] const char* to_string(Suite suite);

/// All cells of a suite, in the order of maps and then of robots.
[[nodiscard]] std::vector<Cell> cells_of(Suite suite);

/// What of a suite is wanted; an empty list means everything.
struct CellChoice {
  std::vector<int> sides;
  std::vector<int> obstacles;
  std::vector<int> robots;
  std::optional<int> instances;  ///< per cell
};

/// The cells of `suite` that `choice` leaves. In Suite::kCrowd a choice that names sides and robots
/// makes cells of its own, without obstacles unless it names these too.
/// @throws InputError if none is left.
[[nodiscard]] std::vector<Cell> choose_cells(Suite suite, const CellChoice& choice);

/// The name of an instance's file, which says its cell: "dense_map100x100_obst40_a110_ex07.yaml".
[[nodiscard]] std::string file_name(const Cell& cell, int index);

}  // namespace mvtp
