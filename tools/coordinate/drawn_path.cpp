#include "tools/coordinate/drawn_path.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kFine = 0.05;  ///< [m] that a drawn path may be beside the true one

/// Does a point lie as far from the line through two others as drawing can leave out?
bool is_between(const Point& a, const Point& p, const Point& b) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  return std::abs((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) <= kFine * length;
}

}  // namespace

std::vector<Point> drawn_path(const ReferencePath& path, double from, double to) {
  std::vector<Point> kept;
  std::vector<Point> skipped;
  const auto steps = int(std::ceil((to - from) / ReferencePath::kSpacing));
  for (int i = 0; i <= steps; ++i) {
    const Pose pose = path.at(std::min(from + i * ReferencePath::kSpacing, to));
    const Point point{pose.x, pose.y};
    const bool bends = !kept.empty() && std::ranges::any_of(skipped, [&](const Point& p) {
      return !is_between(kept.back(), p, point);
    });
    if (kept.empty() || bends) {
      kept.push_back(skipped.empty() ? point : skipped.back());
      skipped.clear();
    }
    skipped.push_back(point);
  }
  if (!skipped.empty()) kept.push_back(skipped.back());
  return kept;
}

}  // namespace mvtp
