#include "planner/motion/reference_path.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace mvtp {
namespace {

double distance(const Point& a, const Point& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  return std::sqrt(dx * dx + dy * dy);  // several times quicker than std::hypot, and near enough
}

Point lerp(const Point& a, const Point& b, double f) {
  return {a.x + f * (b.x - a.x), a.y + f * (b.y - a.y)};
}

/// Point i of evenly spaced `points`, continued straight beyond both ends.
Point continued(std::span<const Point> points, int i) {
  const int n = int(points.size());
  if (i < 0) return lerp(points[0], points[1], double(i));
  if (i < n) return points[std::size_t(i)];
  return lerp(points[std::size_t(n - 2)], points[std::size_t(n - 1)], double(i - n + 2));
}

/// Points on the polyline, each exactly `spacing` from the one before: a vehicle that advances
/// evenly from one to the next drives at an even speed.
std::vector<Point> even_chords(std::span<const Point> polyline, double spacing) {
  std::vector<Point> points = {polyline[0]};
  for (std::size_t i = 1; i < polyline.size();) {
    const Point& from = points.back();
    if (distance(from, polyline[i]) < spacing) {
      ++i;
      continue;
    }
    // The polyline leaves the circle around `from` between its points i - 1 and i.
    const Point& a = polyline[i - 1];
    const Point& b = polyline[i];
    const Point d{b.x - a.x, b.y - a.y};
    const Point e{a.x - from.x, a.y - from.y};
    const double dd = d.x * d.x + d.y * d.y;
    const double de = d.x * e.x + d.y * e.y;
    const double ee = e.x * e.x + e.y * e.y;
    const double root = std::sqrt(std::max(0.0, de * de - dd * (ee - spacing * spacing)));
    points.push_back(lerp(a, b, (root - de) / dd));
  }
  return points;
}

}  // namespace

std::vector<Point> resample(std::span<const Point> polyline, double spacing) {
  assert(polyline.size() >= 2);
  std::vector<Point> points = {polyline[0]};
  double walked = 0.0;  // since the last point that was kept
  for (std::size_t i = 1; i < polyline.size(); ++i) {
    const double length = distance(polyline[i - 1], polyline[i]);
    double s = spacing - walked;
    for (; s < length; s += spacing)
      points.push_back(lerp(polyline[i - 1], polyline[i], s / length));
    walked = length - (s - spacing);
  }
  if (distance(points.back(), polyline.back()) > 1e-6) points.push_back(polyline.back());
  return points;
}

std::vector<Point> smooth(std::span<const Point> polyline, double sigma) {
  double length = 0.0;
  for (std::size_t i = 1; i < polyline.size(); ++i)
    length += distance(polyline[i - 1], polyline[i]);
  constexpr double kFine = 0.1;  // [m]: well below the spacing of a path
  const double spacing = length / std::ceil(length / kFine) * (1.0 - 1e-12);
  return smooth_even(resample(polyline, spacing), spacing, sigma);
}

std::vector<Point> smooth_even(std::span<const Point> in, double spacing, double sigma) {
  const int reach = int(std::ceil(3.0 * sigma / spacing));
  std::vector<double> weights;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    const double z = k * spacing / sigma;
    weights.push_back(std::exp(-0.5 * z * z));
    sum += weights.back();
  }
  // Coordinate by coordinate, and weight by weight over all points: loops without branches.
  const std::size_t n = in.size();
  std::vector<double> x;
  std::vector<double> y;
  for (int i = -reach; i < int(n) + reach; ++i) {
    const Point q = continued(in, i);
    x.push_back(q.x);
    y.push_back(q.y);
  }
  std::vector<double> out_x(n, 0.0);
  std::vector<double> out_y(n, 0.0);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double w = weights[k] / sum;
    for (std::size_t i = 0; i < n; ++i) out_x[i] += w * x[i + k];
    for (std::size_t i = 0; i < n; ++i) out_y[i] += w * y[i + k];
  }
  std::vector<Point> out;
  out.reserve(n);
  for (std::size_t i = 0; i < n; ++i) out.push_back({out_x[i], out_y[i]});
  return out;
}

ReferencePath::ReferencePath(std::span<const Point> points) {
  const std::vector<Point> even = even_chords(points, kSpacing);
  const std::size_t n = even.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point& a = even[i == 0 ? 0 : i - 1];
    const Point& b = even[std::min(i + 1, n - 1)];
    poses_.push_back({even[i].x, even[i].y, std::atan2(b.y - a.y, b.x - a.x)});
  }
  set_curvatures();
}

ReferencePath::ReferencePath(std::vector<Pose> poses) : poses_(std::move(poses)) {
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    const double step = std::hypot(poses_[i].x - poses_[i - 1].x, poses_[i].y - poses_[i - 1].y);
    longest_step_ = std::max(longest_step_, step);
  }
  set_curvatures();
}

void ReferencePath::set_curvatures() {
  const std::size_t n = poses_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i == 0 ? 0 : i - 1;
    const std::size_t b = std::min(i + 1, n - 1);
    curvatures_.push_back(wrap_to_pi(poses_[b].theta - poses_[a].theta) /
                          (kSpacing * double(b - a)));
  }
}

Pose ReferencePath::at(double s) const {
  if (s <= 0.0) return drive(poses_.front(), s, 0.0);
  if (s >= length()) return drive(poses_.back(), s - length(), 0.0);
  const double cell = s / kSpacing;
  const auto i = std::size_t(cell);
  const Pose& a = poses_[i];
  const Pose& b = poses_[std::min(i + 1, poses_.size() - 1)];
  const double f = cell - double(i);
  // Between two samples the path is an arc: it bulges away from the chord, to the right in a left
  // turn. On the chords alone a vehicle would jerk at every sample.
  const double turn = wrap_to_pi(b.theta - a.theta);
  const double aside = -0.5 * turn * f * (1.0 - f);
  return {a.x + f * (b.x - a.x) - aside * (b.y - a.y), a.y + f * (b.y - a.y) + aside * (b.x - a.x),
          wrap_to_pi(a.theta + f * turn)};
}

double ReferencePath::curvature(double s) const {
  if (s <= 0.0 || s >= length()) return 0.0;
  const double cell = s / kSpacing;
  const auto i = std::size_t(cell);
  const double f = cell - double(i);
  return (1.0 - f) * curvatures_[i] + f * curvatures_[std::min(i + 1, curvatures_.size() - 1)];
}

double ReferencePath::max_abs_curvature() const {
  double worst = 0.0;
  for (const double k : curvatures_) worst = std::max(worst, std::abs(k));
  return worst;
}

double ReferencePath::project(const Point& p, double from, double to) const {
  const double end = double(poses_.size() - 1);
  const auto first = std::size_t(std::clamp(from / kSpacing, 0.0, end));
  const auto last = std::size_t(std::clamp(to / kSpacing + 1.0, 0.0, end));
  const auto away = [&](std::size_t i) { return distance(p, {poses_[i].x, poses_[i].y}); };
  constexpr std::size_t kCoarse = 16;  // samples
  double bound = away(last);
  for (std::size_t i = first; i < last; i += kCoarse) bound = std::min(bound, away(i));
  // One that is much too far away has no near ones around it.
  std::size_t best = first;
  double best_distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i <= last;) {
    const double d = away(i);
    if (d < best_distance) best = i, best_distance = d;
    i += std::max(std::size_t{1}, std::size_t((d - std::min(bound, d)) / longest_step_));
  }
  // The foot of the perpendicular on the tangent at the nearest sample.
  const Pose& near = poses_[best];
  return double(best) * kSpacing + (p.x - near.x) * std::cos(near.theta) +
         (p.y - near.y) * std::sin(near.theta);
}

}  // namespace mvtp
