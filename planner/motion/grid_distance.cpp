#include "planner/motion/grid_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

#include "planner/motion/obstacles.hpp"

namespace mvtp {
namespace {

constexpr double kSide = 1.0;            // [m]
constexpr double kMaxCells = 2.5e5;      // huge maps get larger cells
constexpr double kFreeAroundGoal = 2.0;  // [m]; a goal close to an obstacle must be reachable
constexpr float kNoWay = std::numeric_limits<float>::infinity();

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
    : grid_(std::move(grid)), distance_(std::size_t(grid_->columns() * grid_->rows()), kNoWay) {
  search(goal);
  fill_blocked_cells();
}

void GridDistance::search(const Point& goal) {
  const ObstacleGrid& grid = *grid_;
  const auto usable = [&](int column, int row) {
    if (column < 0 || row < 0 || column >= grid.columns() || row >= grid.rows()) return false;
    return !grid.blocked(column, row) ||
           std::hypot((column + 0.5) * grid.side() - goal.x, (row + 0.5) * grid.side() - goal.y) <=
               kFreeAroundGoal;
  };
  static const std::array<Move, 16> kMoves = moves();
  using Entry = std::pair<float, int>;  // distance, cell
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const int source = grid.row_of(goal.y) * grid.columns() + grid.column_of(goal.x);
  distance_[std::size_t(source)] = 0.0F;
  open.emplace(0.0F, source);
  while (!open.empty()) {
    const auto [distance, cell] = open.top();
    open.pop();
    if (distance > distance_[std::size_t(cell)]) continue;
    const int column = cell % grid.columns();
    const int row = cell / grid.columns();
    for (const Move& move : kMoves) {
      if (!usable(column + move.dx, row + move.dy)) continue;
      if (!usable(column + move.via1_x, row + move.via1_y)) continue;
      if (!usable(column + move.via2_x, row + move.via2_y)) continue;
      const int next = (row + move.dy) * grid.columns() + column + move.dx;
      const float longer = distance + move.length * float(grid.side());
      if (longer < distance_[std::size_t(next)]) {
        distance_[std::size_t(next)] = longer;
        open.emplace(longer, next);
      }
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
        if (before[std::size_t(cell)] != kNoWay || !grid.blocked(column, row)) continue;
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
