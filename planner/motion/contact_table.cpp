#include "planner/motion/contact_table.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

/// A rectangle by centre, unit heading and half extents.
struct Box {
  double x, y, c, s, half_length, half_width;
};

/// Half of each margin goes to each of the two bodies of a pair.
Box box_of(const Pose& p, const Vehicle& body, const Margins& margins) {
  const double c = std::cos(p.theta);
  const double s = std::sin(p.theta);
  const double ahead = (body.front - body.rear) / 2.0;
  return {p.x + ahead * c,
          p.y + ahead * s,
          c,
          s,
          (body.length() + margins.along) / 2.0,
          (body.width + margins.across) / 2.0};
}

/// Separating-axis test over the axes of both boxes.
bool overlap(const Box& a, const Box& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double dot = std::abs(a.c * b.c + a.s * b.s);
  const double cross = std::abs(a.c * b.s - a.s * b.c);
  const double a_along = b.half_length * dot + b.half_width * cross;
  const double a_across = b.half_length * cross + b.half_width * dot;
  const double b_along = a.half_length * dot + a.half_width * cross;
  const double b_across = a.half_length * cross + a.half_width * dot;
  return std::abs(dx * a.c + dy * a.s) <= a.half_length + a_along &&
         std::abs(dy * a.c - dx * a.s) <= a.half_width + a_across &&
         std::abs(dx * b.c + dy * b.s) <= b.half_length + b_along &&
         std::abs(dy * b.c - dx * b.s) <= b.half_width + b_across;
}

std::vector<Box> boxes_along(const GuidePath& path, const Vehicle& body, const Margins& margins) {
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    boxes.push_back(box_of(path.sample(i), body, margins));
  }
  return boxes;
}

}  // namespace

ContactTable::ContactTable(const GuidePath& path_a, const Vehicle& body_a, const GuidePath& path_b,
                           const Vehicle& body_b, const Margins& margins) {
  const std::vector<Box> as = boxes_along(path_a, body_a, margins);
  const std::vector<Box> bs = boxes_along(path_b, body_b, margins);
  // Between two samples of B its centre moves at most this far: the lever arm swings at bends.
  const double arm = std::abs(body_b.front - body_b.rear) / 2.0;
  const double stride = GuidePath::kSpacing * (1.0 + arm * path_b.max_abs_curvature()) + 1e-9;
  const double reach = std::hypot(as[0].half_length, as[0].half_width) +
                       std::hypot(bs[0].half_length, bs[0].half_width);
  const double half = GuidePath::kSpacing / 2.0;

  begin_.push_back(0);
  for (std::size_t i = 0; i < as.size(); ++i) {
    bool inside = false;
    for (std::size_t j = 0; j < bs.size();) {
      const double d = std::hypot(bs[j].x - as[i].x, bs[j].y - as[i].y);
      const bool touching = d <= reach && overlap(as[i], bs[j]);
      const double s_b = double(j) * GuidePath::kSpacing;
      if (touching && !inside) intervals_.push_back({float(s_b - half), 0.0F});
      if (touching) intervals_.back().high = float(s_b + half);
      inside = touching;
      // Far away, jump over the samples that cannot be near yet.
      j += d > reach ? std::max<std::size_t>(1, std::size_t((d - reach) / stride)) : 1;
    }
    begin_.push_back(std::uint32_t(intervals_.size()));
    if (begin_[i + 1] == begin_[i]) continue;
    const double s_a = double(i) * GuidePath::kSpacing;
    first_ = std::min(first_, s_a - half);
    last_ = std::max(last_, s_a + half);
    highest_ = std::max(highest_, double(intervals_.back().high));
  }
}

}  // namespace mvtp
