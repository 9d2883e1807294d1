#include "tools/generate/suite.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

constexpr int kPerCell = 60;  // as in the paper
constexpr int kPerCrowdCell = 10;

/// One map with several numbers of robots.
void add_map(std::vector<Cell>& cells, Cell cell, const std::vector<int>& robots) {
  for (const int n : robots) {
    cell.robots = n;
    cells.push_back(cell);
  }
}

std::vector<Cell> typical_cells() {
  std::vector<Cell> cells;
  add_map(cells, {Suite::kTypical, Layout::kCircle, 50, 0, 0, 1}, {2, 4, 8});
  return cells;
}

std::vector<Cell> sparse_cells() {
  std::vector<Cell> cells;
  add_map(cells, {Suite::kSparse, Layout::kRandom, 50, 20, 0, kPerCell}, {2, 4, 6, 8, 10});
  return cells;
}

/// The paper gives the four kinds of map, 5 to 120 robots, 29 cells of 60, and one example: 110
/// robots among 40 obstacles on 100 x 100 m. The split over the maps is ours.
std::vector<Cell> dense_cells() {
  std::vector<Cell> cells;
  const Cell base{Suite::kDense, Layout::kRandom, 50, 0, 0, kPerCell};
  const auto map = [&](int side, int obstacles) {
    Cell cell = base;
    cell.side = side;
    cell.obstacles = obstacles;
    return cell;
  };
  add_map(cells, map(50, 0), {10, 20, 30, 40, 50, 60});
  add_map(cells, map(50, 20), {5, 10, 15, 20, 25, 30, 35});
  add_map(cells, map(100, 0), {20, 30, 40, 50, 60, 80, 100, 120});
  add_map(cells, map(100, 40), {20, 30, 40, 50, 60, 80, 100, 110});
  return cells;
}

std::vector<Cell> crowd_cells() {
  std::vector<Cell> cells;
  const auto map = [](int side, int obstacles) {
    return Cell{Suite::kCrowd, Layout::kRandom, side, obstacles, 0, kPerCrowdCell};
  };
  add_map(cells, map(50, 0), {60, 80, 100});
  add_map(cells, map(50, 40), {60, 80});
  add_map(cells, map(100, 0), {120, 150, 200, 300});
  add_map(cells, map(100, 50), {120, 150, 200, 300});
  add_map(cells, map(300, 0), {1000});
  return cells;
}

std::vector<Cell> own_cells(const CellChoice& choice) {
  std::vector<Cell> cells;
  for (const int side : choice.sides) {
    for (const int obstacles : choice.obstacles.empty() ? std::vector{0} : choice.obstacles) {
      add_map(cells, {Suite::kCrowd, Layout::kRandom, side, obstacles, 0, kPerCrowdCell},
              choice.robots);
    }
  }
  return cells;
}

/// What values the cells of a suite have, for messages.
std::string values(const std::vector<Cell>& cells, int Cell::*field) {
  std::set<int> all;
  for (const Cell& cell : cells) all.insert(cell.*field);
  return fmt::format("{}", fmt::join(all, ", "));
}

}  // namespace

const char* to_string(Suite suite) {
  switch (suite) {
    case Suite::kTypical:
      return "typical";
    case Suite::kSparse:
      return "sparse";
    case Suite::kDense:
      return "dense";
    case Suite::kCrowd:
      return "crowd";
  }
  return "";
}

std::vector<Cell> cells_of(Suite suite) {
  switch (suite) {
    case Suite::kTypical:
      return typical_cells();
    case Suite::kSparse:
      return sparse_cells();
    case Suite::kDense:
      return dense_cells();
    case Suite::kCrowd:
      return crowd_cells();
  }
  return {};
}

std::vector<Cell> choose_cells(Suite suite, const CellChoice& choice) {
  std::vector<Cell> cells = cells_of(suite);
  if (suite == Suite::kCrowd && !choice.sides.empty() && !choice.robots.empty()) {
    cells = own_cells(choice);
  } else {
    const auto is_wanted = [](const std::vector<int>& wanted, int value) {
      return wanted.empty() || std::ranges::find(wanted, value) != wanted.end();
    };
    std::erase_if(cells, [&](const Cell& cell) {
      return !is_wanted(choice.sides, cell.side) || !is_wanted(choice.robots, cell.robots) ||
             !is_wanted(choice.obstacles, cell.obstacles);
    });
  }
  if (cells.empty()) {
    const std::vector<Cell> all = cells_of(suite);
    throw InputError(to_string(suite),
                     fmt::format("has no cell with these --size, --obstacles and --robots; it has "
                                 "sizes {} m, {} obstacles, {} robots",
                                 values(all, &Cell::side), values(all, &Cell::obstacles),
                                 values(all, &Cell::robots)));
  }
  if (choice.instances) {
    for (Cell& cell : cells) cell.instances = *choice.instances;
  }
  return cells;
}

std::string file_name(const Cell& cell, int index) {
  const std::string kind = cell.layout == Layout::kCircle ? std::string("circle")
                                                          : fmt::format("obst{}", cell.obstacles);
  return fmt::format("{}_map{}x{}_{}_a{:03}_ex{:02}.yaml", to_string(cell.suite), cell.side,
                     cell.side, kind, cell.robots, index);
}

}  // namespace mvtp
