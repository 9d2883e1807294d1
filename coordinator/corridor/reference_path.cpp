#include "coordinator/corridor/reference_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "coordinator/audit/audit.hpp"
#include "coordinator/corridor/least_curvature.hpp"
#include "coordinator/corridor/path_shape.hpp"

namespace mvtp {
namespace {

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

/// A shape with the rear axle's path that it gives, coarsely: one entry per place of the base.
struct Candidate {
  PathShape shape;
  std::vector<Pose> poses;
  std::vector<double> bends;    ///< curvature [1/m]
  std::vector<double> outside;  ///< how much the footprint sticks out, where it matters
  double badness = 1e300;
};

/// Headings and curvatures along points.
void set_poses(std::span<const Point> points, Candidate& candidate) {
  const std::size_t n = points.size();
  candidate.poses.resize(n);
  candidate.bends.assign(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const Point& a = points[i == 0 ? 0 : i - 1];
    const Point& b = points[std::min(i + 1, n - 1)];
    candidate.poses[i] = {points[i].x, points[i].y, std::atan2(b.y - a.y, b.x - a.x)};
    if (i == 0 || i + 1 == n) continue;
    const Point u{points[i].x - a.x, points[i].y - a.y};
    const Point v{b.x - points[i].x, b.y - points[i].y};
    const double lengths = std::sqrt((u.x * u.x + u.y * u.y) * (v.x * v.x + v.y * v.y));
    const double sine = (u.x * v.y - u.y * v.x) / std::max(lengths, 1e-12);
    candidate.bends[i] =
        std::asin(std::clamp(sine, -1.0, 1.0)) / std::sqrt(std::max(lengths, 1e-12));
  }
}

/// Searches the shape of a path that can be steered and keeps the footprint on the road.
///
/// Candidates are looked at coarsely, and only where they differ from the best one so far.
class ShapeSearch {
 public:
  ShapeSearch(std::span<const Point> centre_line, const Stretch& driven, const Vehicle& body,
              const DrivableArea& own, const DrivableArea& area, double spacing)
      : spacing_(spacing),
        line_(smooth(centre_line, 1.0)),
        base_(line_, spacing),
        driven_(driven),
        turns_(turns_of(line_)),
        body_(body),
        own_(own),
        area_(area) {}

  ReferencePath best() {
    evaluations_left_ = evaluations();
    // Most bodies are short enough for a path that hugs the centre line.
    for (const double share : {0.0, 0.5, 1.0}) {
      for (const double sigma : {2.5, 1.5, 4.0}) {
        PathShape shape{.sigma = sigma, .follow = share * body_.front, .swings = {}};
        shape.swings.resize(turns_.size());
        if (!done()) improve_to(shape);
      }
    }
    return climbed();
  }

  [[nodiscard]] double follow() const { return best_.shape.follow; }

  /// Does the best path all but keep to its own side of the road?
  [[nodiscard]] bool keeps_to_own_side() const { return best_.badness < 1.0; }

  /// The best path that is found from this swing in all turns.
  /// @param follow  as of PathShape.
  ReferencePath best_from(const Swing& swing, double follow) {
    best_ = {};
    evaluations_left_ = evaluations();
    improve_to({.follow = follow, .swings = std::vector<Swing>(turns_.size(), swing)});
    return climbed();
  }

  /// Can the path that best() gave not be steered, or does it leave the road? It is judged as it is
  /// driven: between the places that the search looked at, too.
  [[nodiscard]] bool fails(const ReferencePath& path) const {
    const double last = std::min(driven_.to + best_.shape.follow, path.length());
    for (double s = driven_.from + best_.shape.follow; s <= last; s += kJudgedEvery) {
      if (std::abs(path.curvature(s)) > body_.max_curvature()) return true;
      if (leaves_road(path, s, body_, area_)) return true;
    }
    return false;
  }

 private:
  [[nodiscard]] int evaluations() const { return 40 + 40 * int(turns_.size()); }

  /// The best path that is found by small changes to the best so far.
  ReferencePath climbed() {
    for (double scale = 1.0; scale > 0.1 && !done(); scale *= 0.5) {
      while (!done() && improve_once(scale)) {
      }
    }
    return ReferencePath(shaped(ShapeBase(line_, kFine), turns_, best_.shape));
  }

  /// Can the best path be steered, with the footprint where it should be; or is it time to end?
  [[nodiscard]] bool done() const { return best_.badness < kTolerable || evaluations_left_ <= 0; }

  bool improve_once(double scale) {
    bool better = false;
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      if (!is_bad(t)) continue;
      for (const Knob& knob : kKnobs) {
        for (const double sign : {1.0, -1.0}) {
          PathShape shape = best_.shape;
          double& value = shape.swings[t].*knob.value;
          value = std::clamp(value + sign * scale * knob.step, knob.low, knob.high);
          better = improve_to(shape) || better;
          if (done()) return better;
        }
      }
    }
    for (const double sign : {1.0, -1.0}) {
      PathShape shape = best_.shape;
      shape.sigma = std::clamp(shape.sigma + sign * scale, 1.5, 6.0);
      better = improve_to(shape) || better;
      shape = best_.shape;
      shape.follow = std::clamp(shape.follow + sign * scale * 3.0, 0.0, 12.0);
      better = improve_to(shape) || better;
      if (done()) return better;
    }
    return better;
  }

  /// The place of the base that the rear axle is abreast of at entry i [m].
  [[nodiscard]] double place_of(std::size_t i, const PathShape& shape) const {
    return double(i) * spacing_ - shape.follow;
  }

  [[nodiscard]] bool is_driven(double place) const {
    return place >= driven_.from && place <= driven_.to;
  }

  [[nodiscard]] bool is_near_turn(double place) const {
    return std::ranges::any_of(
        turns_, [&](const SharpTurn& turn) { return std::abs(place - turn.s) <= kReach; });
  }

  /// Does the best path fail near this turn?
  [[nodiscard]] bool is_bad(std::size_t t) const {
    for (std::size_t i = 0; i < best_.poses.size(); ++i) {
      const double place = place_of(i, best_.shape);
      if (std::abs(place - turns_[t].s) > kReach) continue;
      if (best_.outside[i] > 0.0 || std::abs(best_.bends[i]) > sharpest()) return true;
    }
    return false;
  }

  [[nodiscard]] double sharpest() const { return kReserve * body_.max_curvature(); }

  /// How much a footprint sticks out: of its own side of the road, and, much worse, of the road.
  [[nodiscard]] double sticks_out(const Pose& pose) const {
    const double aside = own_.share_outside(pose, body_, 0.0);
    if (aside == 0.0) return 0.0;
    return aside + kOffRoad * area_.share_outside(pose, body_, kRoadTolerance);
  }

  /// Adds what sticks out around the turns, as far as the sum stays below that of the best.
  void add_outside(Candidate& candidate) const {
    constexpr double kUnknown = -1.0;
    candidate.outside.assign(candidate.poses.size(), 0.0);
    for (std::size_t i = 0; i < candidate.poses.size(); ++i) {
      const double place = place_of(i, candidate.shape);
      if (!is_driven(place) || !is_near_turn(place)) continue;
      const double before = place_of(i, best_.shape);
      const bool known = i < best_.poses.size() && is_same(candidate.poses[i], best_.poses[i]) &&
                         is_driven(before) && is_near_turn(before);
      candidate.outside[i] = known ? best_.outside[i] : kUnknown;
      if (known) candidate.badness += candidate.outside[i];
    }
    for (std::size_t i = 0; i < candidate.poses.size(); ++i) {
      if (candidate.outside[i] != kUnknown) continue;
      candidate.outside[i] = sticks_out(candidate.poses[i]);
      candidate.badness += candidate.outside[i];
      if (candidate.badness >= best_.badness) return;
    }
  }

  static bool is_same(const Pose& a, const Pose& b) {
    constexpr double kSame = 1e-5;  // [m], [rad]
    return std::abs(a.x - b.x) < kSame && std::abs(a.y - b.y) < kSame &&
           std::abs(a.theta - b.theta) < kSame;
  }

  bool improve_to(const PathShape& shape) {
    --evaluations_left_;
    Candidate candidate{.shape = shape};
    set_poses(shaped(base_, turns_, shape), candidate);
    double bend = 0.0;
    for (std::size_t i = 0; i < candidate.bends.size(); ++i) {
      if (is_driven(place_of(i, shape))) bend = std::max(bend, std::abs(candidate.bends[i]));
    }
    // A bend that cannot be steered is worse than anything that sticks out.
    candidate.badness = std::max(0.0, bend / sharpest() - 1.0) * 1000.0;
    for (const Swing& swing : shape.swings) {
      candidate.badness += 1e-6 * (std::abs(swing.in) + std::abs(swing.out));
    }
    if (candidate.badness >= best_.badness) return false;
    add_outside(candidate);
    if (candidate.badness >= best_.badness) return false;
    best_ = std::move(candidate);
    return true;
  }

  static constexpr double kFine = 0.1;      ///< [m] between places of the path made of the best
  static constexpr double kOffRoad = 20.0;  ///< badness beside that of the own side
  /// [m] beside the road: a little less than what the audit lets pass.
  static constexpr double kRoadTolerance = 0.8 * Audit::kRoadTolerance;
  static constexpr double kReach = 30.0;      ///< [m] from a turn to what it has a part in
  static constexpr double kReserve = 0.98;    ///< share of the largest curvature that is used
  static constexpr double kTolerable = 1e-4;  ///< badness of swings alone

  double spacing_;  ///< [m] between places of a candidate
  ReferencePath line_;
  ShapeBase base_;
  Stretch driven_;
  std::vector<SharpTurn> turns_;
  const Vehicle& body_;
  const DrivableArea& own_;
  const DrivableArea& area_;
  Candidate best_;
  int evaluations_left_ = 0;
};

}  // namespace

bool leaves_road(const ReferencePath& path, double s, const Vehicle& body,
                 const DrivableArea& area) {
  constexpr double kFinely = 0.05;    // [m]
  constexpr double kFinest = 0.005;   // [m], where it is close to leaving
  constexpr double kClose = 0.98;     // share of the tolerance from which on it is
  constexpr double kStraight = 1e-3;  // [1/m]
  const auto sticks_out = [&](double at, double share) {
    return area.share_outside(path.at(at), body, share * Audit::kRoadTolerance) > 0.0;
  };
  const auto is_off = [&](double at) {
    if (!sticks_out(at, kClose)) return false;
    for (double d = -0.5 * kFinely; d <= 0.5 * kFinely; d += kFinest) {
      if (sticks_out(at + d, 1.0)) return true;
    }
    return false;
  };
  if (is_off(s)) return true;
  bool bends = false;
  for (double d = -body.length(); d <= body.length(); d += 1.0) {
    bends = bends || std::abs(path.curvature(s + d)) > kStraight;
  }
  if (!bends) return false;
  for (double d = kFinely; d <= 0.5 * kJudgedEvery; d += kFinely) {
    if (is_off(s - d) || is_off(s + d)) return true;
  }
  return false;
}

ReferencePath make_reference_path(std::span<const Point> centre_line, double from, double to,
                                  const Vehicle& body, const DrivableArea& own,
                                  const DrivableArea& area) {
  // Where the search ends depends on where it looks, and from where: one that fails looks again,
  // from wide swings, since round a sharp corner a little swing is no better than none, and more
  // finely. A path over the lanes of others is not worth that: they and who drives it would wait
  // for each other.
  constexpr std::array<Swing, 4> kSwings = {
      {{0.0, 0.0, 5.0, 5.0}, {1.5, 1.5}, {3.0, 0.0, 11.0, 11.0}, {0.0, 1.5, 11.0, 11.0}}};
  std::optional<ReferencePath> first;
  for (const double spacing : {0.5, 0.3}) {
    ShapeSearch search(centre_line, {from, to}, body, own, area, spacing);
    ReferencePath path = search.best();
    if (!search.fails(path)) return path;
    if (!first) first = std::move(path);
    const double follow = search.follow();
    for (const Swing& swing : kSwings) {
      path = search.best_from(swing, follow);
      if (search.keeps_to_own_side() && !search.fails(path)) return path;
    }
  }
  return *std::move(first);
}

}  // namespace mvtp
