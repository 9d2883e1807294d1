#include "planner/motion/grid_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "planner/motion/obstacles.hpp"

namespace mvtp {
namespace {

constexpr double kSide = 1.0;            // [m]
constexpr double kMaxCells = 2.5e5;      // huge maps get larger cells
constexpr double kFreeAroundGoal = 2.0;  // [m]; a goal close to an obstacle must be reachable
constexpr float kUnreachable = std::numeric_limits<float>::infinity();

/// A move to a neighbour; a knight's move passes between two cells that must be free as well.
struct Move {
  int dx, dy;
  int via1_x, via1_y, via2_x, via2_y;
  float length;
};

std::array<Move, 16> moves() {
  std::array<Move, 16> result{};
  std::size_t n = 0;
  for (int dx = -2; dx <= 2; ++dx) {
    for (int dy = -2; dy <= 2; ++dy) {
      const int larger = std::max(std::abs(dx), std::abs(dy));
      const int smaller = std::min(std::abs(dx), std::abs(dy));
      if (larger == 0 || (larger == 2 && smaller != 1)) continue;
      const int sx = (dx > 0) - (dx < 0);
      const int sy = (dy > 0) - (dy < 0);
      Move move{dx, dy, dx, 0, 0, dy, std::hypot(float(dx), float(dy))};
      if (larger == 2) {
        const bool wide = std::abs(dx) == 2;
        move = {dx, dy, wide ? sx : 0, wide ? 0 : sy, sx, sy, move.length};
      }
      result[n++] = move;
    }
  }
  return result;
}

}  // namespace

ObstacleGrid::ObstacleGrid(const Map& map, double inflation) {
  side_ = std::max(kSide, std::sqrt(map.width * map.height / kMaxCells));
  columns_ = std::max(1, int(std::ceil(map.width / side_)));
  rows_ = std::max(1, int(std::ceil(map.height / side_)));
  // A car without length as wide as twice the inflation is a disc but for its corners; the disc is
  // what is asked for, and an inflated disc test is one without corners.
  Map inflated = map;
  for (Circle& circle : inflated.circles) circle.radius += inflation;
  const Obstacles obstacles(inflated, 2 * inflation);
  const Vehicle dot{.front = inflation, .rear = inflation, .width = 2 * inflation};
  const Vehicle point{.front = 0.0, .rear = 0.0, .width = 0.0};
  blocked_.resize(std::size_t(columns_ * rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Pose middle{(column + 0.5) * side_, (row + 0.5) * side_, 0.0};
      blocked_[std::size_t(row * columns_ + column)] =
          obstacles.hit(Sweep(map.polygons.empty() ? point : dot, middle, {}));
    }
  }
}

int ObstacleGrid::column_of(double x) const { return std::clamp(int(x / side_), 0, columns_ - 1); }

int ObstacleGrid::row_of(double y) const { return std::clamp(int(y / side_), 0, rows_ - 1); }

GridDistance::GridDistance(std::shared_ptr<const ObstacleGrid> grid, const Point& goal)
    : grid_(std::move(grid)),
      distance_(std::size_t(grid_->columns() * grid_->rows()), kUnreachable) {
  search(goal);
  fill_blocked_cells();
}

void GridDistance::search(const Point& goal) {
  const ObstacleGrid& grid = *grid_;
  // Cells with a margin of two blocked ones around them, so that no move leaves the array.
  const int stride = grid.columns() + 4;
  const auto index = [&](int column, int row) { return (row + 2) * stride + column + 2; };
  std::vector<char> usable(std::size_t(stride * (grid.rows() + 4)), 0);
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      usable[std::size_t(index(column, row))] =
          !grid.blocked(column, row) ||
          std::hypot((column + 0.5) * grid.side() - goal.x, (row + 0.5) * grid.side() - goal.y) <=
              kFreeAroundGoal;
    }
  }
  struct Step {
    int to, via1, via2;
    float length;
  };
  std::array<Step, 16> steps;
  std::ranges::transform(moves(), steps.begin(), [&](const Move& m) {
    return Step{m.dy * stride + m.dx, m.via1_y * stride + m.via1_x, m.via2_y * stride + m.via2_x,
                m.length};
  });

  // Dijkstra with a macro step per cell's side: no move is shorter, so that nothing in a macro step
  // can still improve once the one before it is done.
  std::vector<float> distance(usable.size(), kUnreachable);  // in sides of a cell
  std::vector<std::vector<int>> macro_steps(4);  // of the cells at floor(distance), modulo 4
  const int source = index(grid.column_of(goal.x), grid.row_of(goal.y));
  distance[std::size_t(source)] = 0.0F;
  macro_steps[0].push_back(source);
  std::vector<int> current;
  for (std::size_t level = 0, empty = 0; empty < macro_steps.size(); ++level) {
    current.clear();
    current.swap(macro_steps[level % macro_steps.size()]);
    empty = current.empty() ? empty + 1 : 0;
    for (const int cell : current) {
      const float here = distance[std::size_t(cell)];
      if (std::size_t(here) != level) continue;
      for (const Step& step : steps) {
        const std::size_t next = std::size_t(cell + step.to);
        const float longer = here + step.length;
        if (longer >= distance[next]) continue;
        if (!usable[next] || !usable[std::size_t(cell + step.via1)] ||
            !usable[std::size_t(cell + step.via2)]) {
          continue;
        }
        distance[next] = longer;
        macro_steps[std::size_t(longer) % macro_steps.size()].push_back(int(next));
      }
    }
  }
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      distance_[std::size_t(row * grid.columns() + column)] =
          distance[std::size_t(index(column, row))] * float(grid.side());
    }
  }
}

void GridDistance::fill_blocked_cells() {
  const ObstacleGrid& grid = *grid_;
  for (int layer = 0; layer < 2; ++layer) {
    const std::vector<float> before = distance_;
    for (int row = 0; row < grid.rows(); ++row) {
      for (int column = 0; column < grid.columns(); ++column) {
        const int cell = row * grid.columns() + column;
        if (before[std::size_t(cell)] != kUnreachable || !grid.blocked(column, row)) continue;
        for (int r = std::max(row - 1, 0); r <= std::min(row + 1, grid.rows() - 1); ++r) {
          for (int c = std::max(column - 1, 0); c <= std::min(column + 1, grid.columns() - 1);
               ++c) {
            const float neighbour = before[std::size_t(r * grid.columns() + c)];
            distance_[std::size_t(cell)] =
                std::min(distance_[std::size_t(cell)], neighbour + float(grid.side()));
          }
        }
      }
    }
  }
}

}  // namespace mvtp
