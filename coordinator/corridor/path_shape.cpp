#include "coordinator/corridor/path_shape.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

double bump(double x, double width) { return std::exp(-0.5 * x * x / (width * width)); }

/// The curve of a point that is drawn along behind `leader` at the distance `d`: how the rear axle
/// moves if a point ahead of it keeps to a line (a tractrix). The points are `spacing` apart.
std::vector<Point> drawn_behind(std::span<const Point> leader, double spacing, double d) {
  // Straightened by exp(-spacing / d) per step, as the true curve is.
  const double rope = spacing / std::expm1(spacing / d);
  const double first = std::hypot(leader[1].x - leader[0].x, leader[1].y - leader[0].y);
  Point tail{leader[0].x - rope * (leader[1].x - leader[0].x) / first,
             leader[0].y - rope * (leader[1].y - leader[0].y) / first};
  std::vector<Point> points;
  points.reserve(leader.size());
  for (const Point& p : leader) {
    const Point ahead{p.x - tail.x, p.y - tail.y};
    const double pull = 1.0 / std::sqrt(ahead.x * ahead.x + ahead.y * ahead.y);
    tail = {p.x - rope * pull * ahead.x, p.y - rope * pull * ahead.y};
    points.push_back({p.x - d * pull * ahead.x, p.y - d * pull * ahead.y});
  }
  return points;
}

}  // namespace

std::vector<SharpTurn> turns_of(const ReferencePath& path) {
  constexpr double kSlight = 0.02;  // [1/m]
  constexpr double kApart = 4.0;    // [m] of straight path between two turns to one side
  std::vector<SharpTurn> turns;
  double sharpest = 0.0;
  double bent_until = 0.0;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const double s = double(i) * ReferencePath::kSpacing;
    const double kappa = path.curvature(s);
    if (std::abs(kappa) < kSlight) continue;
    const double side = kappa > 0.0 ? 1.0 : -1.0;
    if (turns.empty() || turns.back().side != side || s - bent_until > kApart) {
      turns.push_back({s, side});
      sharpest = std::abs(kappa);
    } else if (std::abs(kappa) > sharpest) {
      turns.back().s = s;
      sharpest = std::abs(kappa);
    }
    bent_until = s;
  }
  return turns;
}

std::vector<Point> shaped(const ShapeBase& base, std::span<const SharpTurn> turns,
                          const PathShape& shape) {
  constexpr double kWidths = 4.0;  // beyond that a bump is below a millimetre
  std::vector<double> aside(base.places.size(), 0.0);
  const auto push = [&](double top, double width, double by) {
    if (by == 0.0) return;
    const double last = double(base.places.size() - 1);
    const auto index = [&](double s) {
      return std::size_t(std::clamp(s / base.spacing, 0.0, last));
    };
    const std::size_t behind = index(top + kWidths * width) + 1;
    for (std::size_t i = index(top - kWidths * width); i < behind; ++i) {
      aside[i] += by * bump(double(i) * base.spacing - top, width);
    }
  };
  for (std::size_t t = 0; t < turns.size(); ++t) {
    const Swing& swing = shape.swings[t];
    push(turns[t].s - swing.lead_in, 0.6 * swing.lead_in, turns[t].side * swing.in);
    push(turns[t].s + swing.lead_out, 0.6 * swing.lead_out, turns[t].side * swing.out);
  }
  std::vector<Point> points;
  points.reserve(base.places.size());
  for (std::size_t i = 0; i < base.places.size(); ++i) {
    const ShapeBase::Place& p = base.places[i];
    points.push_back({p.at.x + aside[i] * p.right.x, p.at.y + aside[i] * p.right.y});
  }
  points = smooth_even(points, base.spacing, shape.sigma);
  return shape.follow > 0.1 ? drawn_behind(points, base.spacing, shape.follow) : points;
}

}  // namespace mvtp
