#include "planner/motion/motion_primitives.hpp"

#include <limits>

#include "planner/geometry/polygon.hpp"

namespace mvtp {
namespace {

constexpr int kSlow = 3;  ///< slow motion primitives get so many times less far

}  // namespace

Clearance::Clearance(const Map& map, const Obstacles& obstacles, const Deadline& deadline) {
  if (obstacles.empty()) return;
  side_ = std::max(kSide, std::sqrt(map.width * map.height / 4e6));
  columns_ = int(std::ceil(map.width / side_));
  rows_ = int(std::ceil(map.height / side_));
  distance_.assign(std::size_t(columns_ * rows_), float(kFar));
  const double diagonal = side_ * std::numbers::sqrt2 / 2;

  const auto lower = [&](const Extent& e, auto&& distance) {
    const auto cell = [&](double v, int n) {
      return std::clamp(int(std::clamp(v / side_, -1.0, 1e6)), 0, n - 1);
    };
    for (int row = cell(e.min_y - kFar, rows_); row <= cell(e.max_y + kFar, rows_); ++row) {
      for (int col = cell(e.min_x - kFar, columns_); col <= cell(e.max_x + kFar, columns_); ++col) {
        float& entry = distance_[std::size_t(row * columns_ + col)];
        const double d = distance(Point{(col + 0.5) * side_, (row + 0.5) * side_}) - diagonal;
        entry = std::min(entry, float(std::max(d, 0.0)));
      }
    }
  };
  for (const Circle& c : map.circles) {
    lower({c.x - c.radius, c.y - c.radius, c.x + c.radius, c.y + c.radius},
          [&](const Point& p) { return std::hypot(p.x - c.x, p.y - c.y) - c.radius; });
  }
  for (const Polygon& polygon : map.polygons) {
    if (deadline.expired()) break;
    const auto [left, right] = std::ranges::minmax(polygon, {}, &Point::x);
    const auto [bottom, top] = std::ranges::minmax(polygon, {}, &Point::y);
    lower({left.x, bottom.y, right.x, top.y}, [&](const Point& p) {
      if (contains(polygon, p)) return 0.0;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const OrientedBox edge = segment(polygon[i], polygon[(i + 1) % polygon.size()]);
        nearest = std::min(nearest, separation(edge, p));
      }
      return nearest;
    });
  }
  if (deadline.expired()) *this = unknown();
}

float Clearance::at(double x, double y) const {
  if (distance_.empty()) return float(kFar);
  const double column = x / side_;
  const double row = y / side_;
  if (!(column >= 0.0 && row >= 0.0 && column < columns_ && row < rows_)) return 0.0F;
  return distance_[std::size_t(int(row) * columns_ + int(column))];
}

MotionPrimitives::MotionPrimitives(const Vehicle& vehicle, TimeGrid time, const Map& map,
                                   const Obstacles& obstacles, const Clearance& clearance,
                                   const Exemptions* exemptions)
    : vehicle_(vehicle),
      time_(time),
      map_(&map),
      obstacles_(&obstacles),
      clearance_(&clearance),
      exemptions_(exemptions),
      shape_(box_shape(vehicle, time.dt)),
      reach_(shape_.half_diagonal() + shape_.travel * float(time.macro_step - time.macro_step / 2)),
      turn_(vehicle.max_speed * time.macro_step_duration() * vehicle.max_curvature() / kSlow) {
  const double length = vehicle.max_speed * time.macro_step_duration();
  const double k = vehicle.max_curvature();
  std::vector<Arc> arcs = {{length, 0.0}, {length, k},   {length, -k}, {-length, 0.0},
                           {-length, k},  {-length, -k}, {0.0, 0.0}};
  for (int a = 0; a < kWait; ++a) {
    arcs.push_back({arcs[std::size_t(a)].length / kSlow, arcs[std::size_t(a)].curvature});
  }
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    Primitive& primitive = primitives_[a];
    primitive.arc = arcs[a];
    primitive.turn = int(std::lround(arcs[a].length * arcs[a].curvature / turn_));
    primitive.end = arc_end(arcs[a]);
    if (arcs[a].length != 0.0) {
      primitive.travel = arcs[a].curvature == 0.0 ? float(step_length()) : shape_.travel;
    }
    for (int t = 0; t <= time.macro_step; ++t) {
      const Arc part{arcs[a].length * t / time.macro_step, arcs[a].curvature};
      primitive.boxes.push_back(box_pose(vehicle, drive(Pose{}, part)));
    }
    primitive.swept = swept_box(primitive.boxes.data(), shape_, time.macro_step);
    const BoxPose& middle = primitive.boxes[std::size_t(time.macro_step / 2)];
    for (const BoxPose& box : primitive.boxes) {
      primitive.radius = std::max(primitive.radius, std::hypot(box.x - middle.x, box.y - middle.y));
    }
    primitive.radius += shape_.half_diagonal();
    const float driven = std::hypot(middle.x - float(ahead()), middle.y);
    reach_of_all_ = std::max(reach_of_all_, driven + primitive.radius);
  }
}

const MotionPrimitives::Primitive* MotionPrimitives::beginning_of(const Arc& arc) const {
  const auto* const begin = primitives_.begin();
  const auto* const end = begin + kWait;
  const auto* const found = std::find_if(begin, end, [&](const Primitive& primitive) {
    return primitive.arc.curvature == arc.curvature && primitive.arc.length * arc.length > 0.0;
  });
  return found == end ? nullptr : found;
}

bool MotionPrimitives::in_bounds(const Pose& from, const Arc& arc) const {
  const Extent e =
      map_->bounds == Bounds::kAxle ? axle_extent(from, arc) : body_extent(vehicle_, from, arc);
  constexpr double kRounding = 1e-9;
  return e.min_x >= -kRounding && e.min_y >= -kRounding && e.max_x <= map_->width + kRounding &&
         e.max_y <= map_->height + kRounding;
}

bool MotionPrimitives::is_clear(const Pose& from, const Arc& arc) const {
  const Sweep sweep(vehicle_, from, arc);
  if (!obstacles_->hit(sweep)) return true;
  return exemptions_ != nullptr && exemptions_->allow(*obstacles_, sweep, from, arc);
}

bool MotionPrimitives::is_free(const Pose& from, const Arc& arc) const {
  return in_bounds(from, arc) && is_clear(from, arc);
}

bool MotionPrimitives::is_free(const Pose& from, const Arc& arc, const BoxPose& halfway) const {
  const double margin = double(reach_) + std::abs(vehicle_.front - vehicle_.rear) / 2;
  const bool well_inside = halfway.x >= margin && halfway.y >= margin &&
                           halfway.x <= map_->width - margin && halfway.y <= map_->height - margin;
  if (!well_inside && !in_bounds(from, arc)) return false;
  if (clearance_->at(double(halfway.x), double(halfway.y)) >= reach_) return true;
  return is_clear(from, arc);
}

}  // namespace mvtp
