#include <algorithm>
#include <array>
#include <cmath>

#include "coordinator/zone.hpp"

namespace mvtp {
namespace {

/// How a guide path departs from the lane's centre line: by its smoothing, and by swings to the
/// outside (positive) or inside of the turn before and behind it.
struct Shape {
  double sigma = 2.5;      ///< [m] of the smoothing
  double swing_in = 0.0;   ///< [m] at the widest place
  double swing_out = 0.0;  ///< [m]
  double lead_in = 8.0;    ///< [m] from the widest place to the turn
  double lead_out = 8.0;   ///< [m] from the turn to the widest place behind it
  double follow = 0.0;     ///< [m] ahead of the rear axle lies the point that keeps to the curve
};

/// What the search may change, how far, and in what steps at first.
struct Knob {
  double Shape::*value;
  double low;
  double high;
  double step;
};
constexpr std::array<Knob, 6> kKnobs = {{{&Shape::follow, 0.0, 12.0, 3.0},
                                         {&Shape::swing_out, -4.0, 4.0, 1.0},
                                         {&Shape::swing_in, -2.0, 4.0, 1.0},
                                         {&Shape::sigma, 1.5, 6.0, 1.0},
                                         {&Shape::lead_out, 4.0, 18.0, 3.0},
                                         {&Shape::lead_in, 4.0, 18.0, 3.0}}};

/// The place of the sharpest bend [m], and its direction: 1 to the left, -1 to the right.
struct Turn {
  double s = 0.0;
  double side = 1.0;
};

Turn sharpest_turn(const GuidePath& path) {
  Turn turn;
  double sharpest = 0.0;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const double s = double(i) * GuidePath::kSpacing;
    const double kappa = path.curvature(s);
    if (std::abs(kappa) > sharpest) {
      sharpest = std::abs(kappa);
      turn = {s, kappa > 0.0 ? 1.0 : -1.0};
    }
  }
  return turn;
}

double bump(double x, double width) { return std::exp(-0.5 * x * x / (width * width)); }

/// The curve of a point that is drawn along behind `leader` at the distance `d`: how the rear axle
/// moves if a point ahead of it keeps to a line (a tractrix).
std::vector<Point> drawn_behind(std::span<const Point> leader, double d) {
  const double first = std::hypot(leader[1].x - leader[0].x, leader[1].y - leader[0].y);
  Point rear{leader[0].x - d * (leader[1].x - leader[0].x) / first,
             leader[0].y - d * (leader[1].y - leader[0].y) / first};
  std::vector<Point> points;
  for (const Point& p : leader) {
    const double pull = std::hypot(p.x - rear.x, p.y - rear.y);
    rear = {p.x + d * (rear.x - p.x) / pull, p.y + d * (rear.y - p.y) / pull};
    points.push_back(rear);
  }
  return points;
}

/// The base path pushed to the outside of its turn before and behind it, and smoothed again.
GuidePath widened(const GuidePath& base, const Turn& turn, const Shape& shape) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < base.samples(); ++i) {
    const double s = double(i) * GuidePath::kSpacing;
    const double aside =
        shape.swing_in * bump(s - (turn.s - shape.lead_in), 0.6 * shape.lead_in) +
        shape.swing_out * bump(s - (turn.s + shape.lead_out), 0.6 * shape.lead_out);
    const Pose p = compose(base.sample(i), {0.0, -turn.side * aside, 0.0});
    points.push_back({p.x, p.y});
  }
  points = smooth(points, shape.sigma);
  return GuidePath(shape.follow > 0.1 ? drawn_behind(points, shape.follow) : points);
}

/// How much of the footprint leaves the road along the path around its turn; 0 if it never does.
double off_road(const GuidePath& path, const Turn& turn, const Vehicle& body,
                const DrivableArea& area) {
  constexpr double kReach = 30.0;
  double sum = 0.0;
  const double last = std::min(turn.s + kReach, path.length());
  for (double s = std::max(0.0, turn.s - kReach); s <= last; s += 1.0) {
    sum += area.share_outside(path.at(s), body, 0.0);
  }
  return sum;
}

/// Searches the shape of a path that can be steered and keeps the footprint on the road.
class ShapeSearch {
 public:
  ShapeSearch(std::span<const Point> centre_line, const Vehicle& body, const DrivableArea& area)
      : base_(smooth(centre_line, 1.0)), turn_(sharpest_turn(base_)), body_(body), area_(area) {}

  GuidePath best() {
    // Most bodies are short enough for a path that hugs the centre line.
    for (const double share : {0.0, 0.5, 1.0}) {
      for (const double sigma : {2.5, 1.5, 4.0}) {
        const Shape shape{.sigma = sigma, .follow = share * body_.front};
        if (improve_to(shape) && good_enough()) return widened(base_, turn_, best_);
      }
    }
    for (double scale = 1.0; scale > 0.1 && !good_enough(); scale *= 0.5) {
      while (!good_enough() && improve_one_knob(scale)) {
      }
    }
    return widened(base_, turn_, best_);
  }

 private:
  [[nodiscard]] bool good_enough() const { return badness_ < kTolerable; }

  bool improve_one_knob(double scale) {
    bool better = false;
    for (const Knob& knob : kKnobs) {
      for (const double sign : {1.0, -1.0}) {
        Shape shape = best_;
        shape.*knob.value =
            std::clamp(shape.*knob.value + sign * scale * knob.step, knob.low, knob.high);
        better = improve_to(shape) || better;
        if (good_enough()) return true;
      }
    }
    return better;
  }

  bool improve_to(const Shape& shape) {
    const GuidePath path = widened(base_, turn_, shape);
    const double sharp = path.max_abs_curvature() / (kReserve * body_.max_curvature()) - 1.0;
    // A bend that cannot be steered is worse than anything that sticks out.
    const double badness = std::max(0.0, sharp) * 1000.0 + off_road(path, turn_, body_, area_) +
                           1e-6 * (std::abs(shape.swing_in) + std::abs(shape.swing_out));
    if (badness >= badness_) return false;
    badness_ = badness;
    best_ = shape;
    return true;
  }

  static constexpr double kReserve = 0.98;    ///< share of the largest curvature that is used
  static constexpr double kTolerable = 1e-4;  ///< badness of swings alone

  GuidePath base_;
  Turn turn_;
  const Vehicle& body_;
  const DrivableArea& area_;
  Shape best_;
  double badness_ = 1e300;
};

}  // namespace

GuidePath make_guide_path(std::span<const Point> centre_line, const Vehicle& body,
                          const DrivableArea& area) {
  return ShapeSearch(centre_line, body, area).best();
}

}  // namespace mvtp
