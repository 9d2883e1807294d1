#include "coordinator/network/polyline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mvtp {
namespace {

Point lerp(const Point& a, const Point& b, double f) {
  return {a.x + f * (b.x - a.x), a.y + f * (b.y - a.y)};
}

/// From 0 to 1 with no slope and no curvature at either end.
double smootherstep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10.0 + x * (6.0 * x - 15.0));
}

}  // namespace

double distance(const Point& a, const Point& b) { return std::hypot(b.x - a.x, b.y - a.y); }

double heading(const Point& a, const Point& b) { return std::atan2(b.y - a.y, b.x - a.x); }

Point nearest(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double squared = dx * dx + dy * dy;
  const double f =
      squared > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
  return {a.x + f * dx, a.y + f * dy};
}

double length_of(std::span<const Point> line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) length += distance(line[i - 1], line[i]);
  return length;
}

Point point_at(std::span<const Point> line, double s) {
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double step = distance(line[i - 1], line[i]);
    if (s <= step || i + 1 == line.size()) {
      return lerp(line[i - 1], line[i], step > 0.0 ? std::clamp(s / step, 0.0, 1.0) : 0.0);
    }
    s -= step;
  }
  return line.back();
}

double distance_to(std::span<const Point> line, const Pose& place) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Point& a = line[i - 1];
    const Point d{line[i].x - a.x, line[i].y - a.y};
    const double along = (place.x - a.x) * d.x + (place.y - a.y) * d.y;
    const double share = std::clamp(along / std::max(1e-12, d.x * d.x + d.y * d.y), 0.0, 1.0);
    least = std::min(least, std::hypot(a.x + share * d.x - place.x, a.y + share * d.y - place.y));
  }
  return least;
}

std::vector<Point> stretch_of(std::span<const Point> line, double from, double to) {
  std::vector<Point> points = {point_at(line, from)};
  double s = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    s += distance(line[i - 1], line[i]);
    if (s > from && s < to) points.push_back(line[i]);
  }
  points.push_back(point_at(line, to));
  return points;
}

void BrokenLine::append(std::span<const Point> more) {
  for (const Point& p : more) {
    const bool fresh = points.empty() || (!jumps.empty() && jumps.back().first == points.size());
    const double step = fresh ? 0.0 : distance(points.back(), p);
    if (!fresh && step <= 1e-3) continue;
    length += step;
    points.push_back(p);
  }
}

std::vector<Point> without_jumps(const BrokenLine& line) {
  if (line.jumps.empty()) return line.points;
  std::vector<Point> moved;
  const auto add = [&](const Point& p, const Point& ahead, std::size_t segment, double s) {
    double left = 0.0;
    for (const BrokenLine::Jump& jump : line.jumps) {
      const double share = smootherstep((s - jump.begin) / (jump.end - jump.begin));
      left += segment < jump.first ? jump.left * share : jump.left * (share - 1.0);
    }
    const double length = std::max(1e-9, std::hypot(ahead.x, ahead.y));
    moved.push_back({p.x - left * ahead.y / length, p.y + left * ahead.x / length});
  };
  double s = 0.0;
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    if (std::ranges::find(line.jumps, i, &BrokenLine::Jump::first) != line.jumps.end()) continue;
    const Point& a = line.points[i - 1];
    const Point& b = line.points[i];
    const double step = distance(a, b);
    const int n = std::max(1, int(std::ceil(step)));
    const Point ahead{b.x - a.x, b.y - a.y};
    const bool last =
        i + 1 == line.points.size() ||
        std::ranges::find(line.jumps, i + 1, &BrokenLine::Jump::first) != line.jumps.end();
    for (int k = 0; k < n + (last ? 1 : 0); ++k) {
      add(lerp(a, b, double(k) / n), ahead, i, s + step * k / n);
    }
    s += step;
  }
  std::vector<Point> line_without;
  for (const Point& p : moved) {
    if (line_without.empty() || distance(line_without.back(), p) > 1e-3) line_without.push_back(p);
  }
  return line_without;
}

std::vector<Point> trimmed(std::vector<Point> line, double length) {
  std::size_t first = 0;
  while (first + 2 < line.size() && length >= distance(line[first], line[first + 1])) {
    length -= distance(line[first], line[first + 1]);
    ++first;
  }
  line.erase(line.begin(), line.begin() + std::ptrdiff_t(first));
  line[0] = lerp(line[0], line[1], std::min(length / distance(line[0], line[1]), 0.99));
  return line;
}

std::vector<Point> shortened(std::vector<Point> line, double length) {
  if (length <= 0.0) return line;
  std::ranges::reverse(line);
  line = trimmed(std::move(line), length);
  std::ranges::reverse(line);
  return line;
}

}  // namespace mvtp
