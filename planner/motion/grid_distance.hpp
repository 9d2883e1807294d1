#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "planner/problem/instance.hpp"

namespace mvtp {

/// Which cells of a grid over the map a point robot may use: those farther than `inflation` from
/// every obstacle. Cells are squares of side() metres.
class ObstacleGrid {
 public:
  ObstacleGrid(const Map& map, double inflation);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] double side() const { return side_; }
  [[nodiscard]] bool blocked(int column, int row) const {
    return blocked_[std::size_t(row * columns_ + column)];
  }
  [[nodiscard]] int column_of(double x) const;
  [[nodiscard]] int row_of(double y) const;

 private:
  int columns_;
  int rows_;
  double side_;
  std::vector<bool> blocked_;
};

/// Length of the shortest path to a goal on the grid, for every cell: 16 neighbours, Dijkstra.
///
/// Blocked cells next to free ones take over their distance, as a car may stand there; cells
/// without a path are at infinity.
class GridDistance {
 public:
  GridDistance(std::shared_ptr<const ObstacleGrid> grid, const Point& goal);

  /// [m]; infinity if there is no path on the grid.
  [[nodiscard]] double at(double x, double y) const {
    return double(
        distance_[std::size_t(grid_->row_of(y) * grid_->columns() + grid_->column_of(x))]);
  }

 private:
  void search(const Point& goal);
  void fill_blocked_cells();

  std::shared_ptr<const ObstacleGrid> grid_;
  std::vector<float> distance_;
};

}  // namespace mvtp
