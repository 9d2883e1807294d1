#include "coordinator/reference_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace mvtp {
namespace {

/// How a path swings to the outside (positive) or inside of one turn, before and behind it.
struct Swing {
  double in = 0.0;        ///< [m] at the widest place before the turn
  double out = 0.0;       ///< [m] behind it
  double lead_in = 8.0;   ///< [m] from the widest place to the turn
  double lead_out = 8.0;  ///< [m] from the turn to the widest place behind it
};

/// How a path departs from the lanes' centre line.
struct Shape {
  double sigma = 2.5;         ///< [m] of the smoothing
  double follow = 0.0;        ///< [m] ahead of the rear axle lies the point that keeps to the curve
  std::vector<Swing> swings;  ///< one per turn
};

/// What the search may change in each turn, how far, and in what steps at first.
struct Knob {
  double Swing::*value;
  double low;
  double high;
  double step;
};
constexpr std::array<Knob, 4> kKnobs = {{{&Swing::out, -4.0, 4.0, 1.0},
                                         {&Swing::in, -2.0, 4.0, 1.0},
                                         {&Swing::lead_out, 4.0, 18.0, 3.0},
                                         {&Swing::lead_in, 4.0, 18.0, 3.0}}};

/// The place of a sharpest bend [m], and its direction: 1 to the left, -1 to the right.
struct Turn {
  double s = 0.0;
  double side = 1.0;
};

/// The sharpest places of all bends that may need a wider path.
std::vector<Turn> turns_of(const GuidePath& path) {
  constexpr double kSlight = 0.02;  // [1/m]
  constexpr double kApart = 4.0;    // [m] of straight path between two turns to one side
  std::vector<Turn> turns;
  double sharpest = 0.0;
  double bent_until = 0.0;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const double s = double(i) * GuidePath::kSpacing;
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

/// The base path pushed to the outside of its turns before and behind them, and smoothed again.
GuidePath shaped(const GuidePath& base, std::span<const Turn> turns, const Shape& shape) {
  std::vector<Point> points;
  points.reserve(base.samples());
  for (std::size_t i = 0; i < base.samples(); ++i) {
    const double s = double(i) * GuidePath::kSpacing;
    double aside = 0.0;  // to the right
    for (std::size_t t = 0; t < turns.size(); ++t) {
      const Swing& swing = shape.swings[t];
      if (swing.in == 0.0 && swing.out == 0.0) continue;
      aside += turns[t].side *
               (swing.in * bump(s - (turns[t].s - swing.lead_in), 0.6 * swing.lead_in) +
                swing.out * bump(s - (turns[t].s + swing.lead_out), 0.6 * swing.lead_out));
    }
    const Pose p = compose(base.sample(i), {0.0, -aside, 0.0});
    points.push_back({p.x, p.y});
  }
  points = smooth(points, shape.sigma);
  return GuidePath(shape.follow > 0.1 ? drawn_behind(points, shape.follow) : points);
}

/// What the rear axle drives of a path [m].
struct Stretch {
  double from = 0.0;
  double to = 0.0;
};

/// How much of the footprint leaves the road around the turns; 0 if it never does.
double off_road(const GuidePath& path, const Stretch& driven, std::span<const Turn> turns,
                const Vehicle& body, const DrivableArea& area) {
  constexpr double kReach = 30.0;
  double sum = 0.0;
  double looked_at = driven.from;
  for (const Turn& turn : turns) {
    const double last = std::min(turn.s + kReach, driven.to);
    for (double s = std::max(turn.s - kReach, looked_at); s <= last; s += 1.0) {
      sum += area.share_outside(path.at(s), body, 0.0);
      looked_at = s + 1.0;
    }
  }
  return sum;
}

/// Searches the shape of a path that can be steered and keeps the footprint on the road.
class ShapeSearch {
 public:
  ShapeSearch(std::span<const Point> centre_line, const Stretch& driven, const Vehicle& body,
              const DrivableArea& area)
      : base_(smooth(centre_line, 1.0)),
        driven_(driven),
        turns_(turns_of(base_)),
        body_(body),
        area_(area) {
    best_.swings.resize(turns_.size());
    evaluations_left_ = 40 + 40 * int(turns_.size());
  }

  GuidePath best() {
    // Most bodies are short enough for a path that hugs the centre line.
    for (const double share : {0.0, 0.5, 1.0}) {
      for (const double sigma : {2.5, 1.5, 4.0}) {
        Shape shape{.sigma = sigma, .follow = share * body_.front, .swings = {}};
        shape.swings.resize(turns_.size());
        if (improve_to(shape) && good_enough()) return shaped(base_, turns_, best_);
      }
    }
    for (double scale = 1.0; scale > 0.1 && !done(); scale *= 0.5) {
      while (!done() && improve_once(scale)) {
      }
    }
    return shaped(base_, turns_, best_);
  }

  /// Can the best path be steered, with the footprint where it should be?
  [[nodiscard]] bool good_enough() const { return badness_ < kTolerable; }

 private:
  [[nodiscard]] bool done() const { return good_enough() || evaluations_left_ <= 0; }

  bool improve_once(double scale) {
    bool better = false;
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      for (const Knob& knob : kKnobs) {
        for (const double sign : {1.0, -1.0}) {
          Shape shape = best_;
          double& value = shape.swings[t].*knob.value;
          value = std::clamp(value + sign * scale * knob.step, knob.low, knob.high);
          better = improve_to(shape) || better;
          if (done()) return better;
        }
      }
    }
    for (const double sign : {1.0, -1.0}) {
      Shape shape = best_;
      shape.sigma = std::clamp(shape.sigma + sign * scale, 1.5, 6.0);
      better = improve_to(shape) || better;
      shape = best_;
      shape.follow = std::clamp(shape.follow + sign * scale * 3.0, 0.0, 12.0);
      better = improve_to(shape) || better;
      if (done()) return better;
    }
    return better;
  }

  bool improve_to(const Shape& shape) {
    --evaluations_left_;
    const GuidePath path = shaped(base_, turns_, shape);
    const double sharp = path.max_abs_curvature() / (kReserve * body_.max_curvature()) - 1.0;
    // A bend that cannot be steered is worse than anything that sticks out.
    double badness = std::max(0.0, sharp) * 1000.0 + off_road(path, driven_, turns_, body_, area_);
    for (const Swing& swing : shape.swings) {
      badness += 1e-6 * (std::abs(swing.in) + std::abs(swing.out));
    }
    if (badness >= badness_) return false;
    badness_ = badness;
    best_ = shape;
    return true;
  }

  static constexpr double kReserve = 0.98;    ///< share of the largest curvature that is used
  static constexpr double kTolerable = 1e-4;  ///< badness of swings alone

  GuidePath base_;
  Stretch driven_;
  std::vector<Turn> turns_;
  const Vehicle& body_;
  const DrivableArea& area_;
  Shape best_;
  double badness_ = 1e300;
  int evaluations_left_ = 0;
};

}  // namespace

GuidePath make_reference_path(std::span<const Point> centre_line, double from, double to,
                              const Vehicle& body, const DrivableArea& own,
                              const DrivableArea& area) {
  ShapeSearch on_its_side(centre_line, {from, to}, body, own);
  GuidePath path = on_its_side.best();
  return on_its_side.good_enough() ? path : ShapeSearch(centre_line, {from, to}, body, area).best();
}

}  // namespace mvtp
