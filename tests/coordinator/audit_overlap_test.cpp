// What the audit says of overlaps, against rectangles that are cut by each other, at a thousand
// moments of each step.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "coordinator/audit/audit.hpp"
#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMoments = 1000;  ///< of a step

class Draws {
 public:
  explicit Draws(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * double(engine_() >> 11) * 0x1p-53;
  }
  int below(int count) { return int(between(0.0, count)); }

 private:
  std::mt19937_64 engine_;
};

/// The corners of a footprint, made smaller by `less` [m] on each side; counterclockwise.
Polygon rectangle(const Pose& rear_axle, const Vehicle& body, double less = 0.0) {
  const double front = body.front - less;
  const double rear = -body.rear + less;
  const double side = body.width / 2.0 - less;
  Polygon corners;
  for (const Point& p : {Point{rear, -side}, {front, -side}, {front, side}, {rear, side}}) {
    const Pose corner = compose(rear_axle, {p.x, p.y, 0.0});
    corners.push_back({corner.x, corner.y});
  }
  return corners;
}

Polygon disc(const Point& center, double radius) {
  constexpr int kCorners = 120;  // 0.1 mm inside a circle of 0.3 m
  Polygon corners;
  for (int k = 0; k < kCorners; ++k) {
    const double angle = 2.0 * kPi * k / kCorners;
    corners.push_back({center.x + radius * std::cos(angle), center.y + radius * std::sin(angle)});
  }
  return corners;
}

/// What is left of a convex polygon on the left of a line.
Polygon left_of(const Point& a, const Point& b, const Polygon& polygon) {
  const auto beside = [&](const Point& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  };
  Polygon rest;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& p = polygon[i];
    const Point& q = polygon[(i + 1) % polygon.size()];
    const double at_p = beside(p);
    const double at_q = beside(q);
    if (at_p >= 0.0) rest.push_back(p);
    if ((at_p < 0.0) == (at_q < 0.0)) continue;
    const double f = at_p / (at_p - at_q);
    rest.push_back({p.x + f * (q.x - p.x), p.y + f * (q.y - p.y)});
  }
  return rest;
}

double area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& p = polygon[i];
    const Point& q = polygon[(i + 1) % polygon.size()];
    twice += p.x * q.y - p.y * q.x;
  }
  return twice / 2.0;
}

/// Have two convex polygons an area in common?
bool overlap(const Polygon& a, const Polygon& b) {
  Polygon rest = a;
  for (std::size_t i = 0; i < b.size() && !rest.empty(); ++i) {
    rest = left_of(b[i], b[(i + 1) % b.size()], rest);
  }
  return area(rest) > 1e-12;
}

Polygon shifted(Polygon polygon, double x, double y) {
  for (Point& p : polygon) p = {p.x + x, p.y + y};
  return polygon;
}

/// Is `depth` [m] the length of the shortest shift that parts the two, but for 0.01 mm?
bool is_depth(const Polygon& a, const Polygon& b, double depth) {
  bool parts = false;
  const auto look = [&](const Point& along) {
    const auto overlap_after = [&](double shift) {
      return overlap(a, shifted(b, shift * along.x, shift * along.y));
    };
    parts |= !overlap_after(depth + 1e-5);
    return overlap_after(depth - 1e-5);
  };
  for (const Polygon* polygon : {&a, &b}) {  // away from each side
    for (std::size_t i = 0; i < 4; ++i) {
      const Point& p = (*polygon)[i];
      const Point& q = (*polygon)[(i + 1) % 4];
      const double length = std::hypot(q.x - p.x, q.y - p.y);
      if (!look({(q.y - p.y) / length, (p.x - q.x) / length})) return false;
    }
  }
  for (int k = 0; k < 90; ++k) {
    if (!look({std::cos(2.0 * kPi * k / 90), std::sin(2.0 * kPi * k / 90)})) return false;
  }
  return parts;
}

/// How a vehicle moves in one step.
struct Drive {
  Vehicle body;
  Pose from;
  double length = 0.0;     ///< [m]
  double curvature = 0.0;  ///< [1/m]
  double spin = 0.0;       ///< [rad] on the spot

  [[nodiscard]] Pose at(double t) const {
    const Pose pose = drive(from, t * length, curvature);
    return {pose.x, pose.y, wrap_to_pi(pose.theta + t * spin)};
  }
};

/// Cars, lorries, buses and motorcycles that drive, reverse, stand, or are turned on the spot.
Drive any_drive(Draws& draw) {
  const std::vector<Vehicle> bodies = {{.front = 3.6, .rear = 0.9, .width = 1.8},
                                       {.front = 12.5, .rear = 4.0, .width = 2.55},
                                       {.front = 9.0, .rear = 3.0, .width = 2.5},
                                       {.front = 1.8, .rear = 0.4, .width = 0.9}};
  Drive result{.body = bodies[std::size_t(draw.below(int(bodies.size())))],
               .from = {draw.between(-15, 15), draw.between(-15, 15), draw.between(-kPi, kPi)}};
  switch (draw.below(6)) {
    case 0:
      break;
    case 1:
      result.spin = draw.between(-0.8, 0.8);
      break;
    case 2:
      result.length = draw.between(-1.0, 4.0);
      break;
    default:
      result.length = draw.between(-1.0, 4.0);
      result.curvature = draw.between(-0.3, 0.3);
  }
  return result;
}

/// Do the two, made smaller by `less` on each side, overlap at one of so many moments of the step?
bool ever_overlap(const Drive& a, const Drive& b, double less, int moments = kMoments) {
  if (2.0 * less >= std::min(a.body.width, b.body.width)) return false;  // nothing left of one
  for (int k = 0; k <= moments; ++k) {
    const double t = double(k) / moments;
    if (overlap(rectangle(a.at(t), a.body, less), rectangle(b.at(t), b.body, less))) return true;
  }
  return false;
}

/// Puts `b` where it grazes `a` during the step, up to 4 mm deep or apart.
void graze(Draws& draw, const Drive& a, Drive& b) {
  const double angle = draw.between(-kPi, kPi);
  const auto put = [&](double away) {
    b.from.x = a.from.x + away * std::cos(angle);
    b.from.y = a.from.y + away * std::sin(angle);
  };
  double near = 0.0;
  double far = 50.0;
  while (far - near > 1e-5) {
    put((near + far) / 2.0);
    (ever_overlap(a, b, 0.0, 40) ? near : far) = (near + far) / 2.0;
  }
  put(far + draw.between(-4e-3, 4e-3));
}

class AuditOverlap : public testing::Test {
 protected:
  static constexpr double kStep = 0.1;  // [s]

  /// The audit of one step of the two vehicles, which are nobody else's.
  Audit audited(const Drive& a, const Drive& b) {
    Audit audit(area, kStep);
    const VehicleType type_a{.body = a.body};
    const VehicleType type_b{.body = b.body};
    for (const double t : {0.0, 1.0}) {
      const VehicleState state_a{.id = "a", .pose = a.at(t)};
      const VehicleState state_b{.id = "b", .pose = b.at(t)};
      const std::vector<Observation> seen = {{&state_a, &type_a, true}, {&state_b, &type_b, true}};
      audit.observe(kStep * t, seen);
    }
    return audit;
  }

  void expect_right_event(const Audit& audit, const Drive& a, const Drive& b) {
    const auto event =
        std::ranges::find(audit.events(), AuditEventKind::kOverlap, &AuditEvent::kind);
    ASSERT_NE(event, audit.events().end());
    const double t = event->time / kStep;
    EXPECT_TRUE(is_depth(rectangle(a.at(t), a.body), rectangle(b.at(t), b.body), event->depth));
  }

  RoadNetwork network = make_crossroads();
  DrivableArea area = DrivableArea(network);
};

TEST_F(AuditOverlap, IsThatOfRectanglesCutByEachOther) {
  Draws draw(1);
  int overlaps = 0;
  int between_steps = 0;
  int grazed = 0;
  for (int pair = 0; pair < 1000; ++pair) {
    const Drive a = any_drive(draw);
    Drive b = any_drive(draw);
    if (pair % 2 == 0) graze(draw, a, b);
    const Audit audit = audited(a, b);
    const bool seen = audit.figures().overlap_pairs > 0;
    // 1.2 mm deep at least, and found for certain; less than 1 mm, and not reported.
    const bool is_deep = ever_overlap(a, b, 0.6e-3);
    SCOPED_TRACE(pair);
    ASSERT_TRUE(seen || !is_deep);
    grazed += !seen && ever_overlap(a, b, -2e-3) ? 1 : 0;
    if (!seen) continue;
    ASSERT_TRUE(ever_overlap(a, b, 0.3e-3));
    expect_right_event(audit, a, b);
    const double depth = -audit.figures().min_clearance;
    ASSERT_FALSE(ever_overlap(a, b, 0.505 * depth + 0.1e-3));  // none is deeper
    ++overlaps;
    between_steps += ever_overlap(a, b, 0.0, 1) ? 0 : 1;
  }
  EXPECT_GT(overlaps, 170);
  EXPECT_GT(between_steps, 35);
  EXPECT_GT(grazed, 35);
}

TEST_F(AuditOverlap, OfAPersonIsThatOfADiscCutByARectangle) {
  Draws draw(2);
  int touched = 0;
  for (int pair = 0; pair < 500; ++pair) {
    Drive a = any_drive(draw);
    a.from.x = a.from.y = 0.0;
    const Point before{draw.between(-6, 6), draw.between(-4, 4)};
    const Point walk{draw.between(-0.3, 0.3), draw.between(-0.3, 0.3)};
    Audit audit(area, kStep);
    const VehicleType type{.body = a.body};
    std::vector<Pedestrian> people = {{.id = "p", .position = before, .speed = 2.0}};
    for (const double t : {0.0, 1.0}) {
      const VehicleState state{.id = "a", .pose = a.at(t), .speed = 40.0};
      const std::vector<Observation> seen = {{&state, &type, pair % 2 == 0}};
      people[0].position = {before.x + t * walk.x, before.y + t * walk.y};
      audit.observe(kStep * t, seen, people);
    }
    const auto ever_touch = [&](double more) {
      constexpr int kLooks = 400;
      for (int k = 0; k <= kLooks; ++k) {
        const double t = double(k) / kLooks;
        const Point p{before.x + t * walk.x, before.y + t * walk.y};
        if (overlap(disc(p, people[0].radius + more), rectangle(a.at(t), a.body))) return true;
      }
      return false;
    };
    SCOPED_TRACE(pair);
    const bool seen = audit.figures().people_touched_all > 0;
    ASSERT_EQ(audit.figures().people_touched > 0, seen && pair % 2 == 0);
    ASSERT_TRUE(seen ? ever_touch(0.03) : !ever_touch(-1.2e-3));
    touched += seen ? 1 : 0;
  }
  EXPECT_GT(touched, 100);
  EXPECT_LT(touched, 1200);
}

}  // namespace
}  // namespace mvtp
