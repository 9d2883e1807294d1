#include "coordinator/drivers/straddling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace mvtp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// [m] that a driver leaves beside a body: as much as plans keep, for it could not be planned away
/// from one who stands nearer;
constexpr double kMargin = 0.4;
constexpr double kBeside = 0.1;      ///< [m] and who is beside it already, as little as he needs
constexpr double kNear = 2.0;        ///< [m] beside it a body may be there soon
constexpr double kRoom = 5.0;        ///< [m] that those who change lanes keep ahead and behind
constexpr double kTailRange = 60.0;  ///< [m] behind a tail in which drivers matter
constexpr double kInside = 20.0;     ///< [m] between two inside a junction that may meet
constexpr double kStanding = 0.1;    ///< [m/s]
constexpr double kSample = 1.0;      ///< [m] between two points of a body's side

/// Where a point is beside a lane.
struct Beside {
  double along = 0.0;  ///< [m] from the start of the lane
  double aside = 0.0;  ///< [m] from its middle
};

/// nullopt: before its start or behind its end.
std::optional<Beside> beside(const Lane& lane, const Point& p) {
  std::optional<Beside> nearest;
  double before = 0.0;
  for (std::size_t i = 1; i < lane.shape.size(); ++i) {
    const Point& a = lane.shape[i - 1];
    const Point& b = lane.shape[i];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    if (length <= 0.0) continue;
    const double along = ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length;
    const double at = std::clamp(along, 0.0, length);
    const double f = at / length;
    const double aside = std::hypot(p.x - a.x - f * (b.x - a.x), p.y - a.y - f * (b.y - a.y));
    const bool is_off = (i == 1 && along < 0.0) || (i + 1 == lane.shape.size() && along > length);
    if (!is_off && (!nearest || aside < nearest->aside)) nearest = Beside{before + at, aside};
    before += length;
  }
  return nearest;
}

/// Points along both sides of a body.
std::vector<Point> sides(const Pose& pose, const Vehicle& body) {
  std::vector<Point> points;
  const int pieces = std::max(1, int(std::ceil(body.length() / kSample)));
  for (int i = 0; i <= pieces; ++i) {
    const double x = -body.rear + body.length() * i / pieces;
    for (const double y : {-body.width / 2.0, body.width / 2.0}) {
      const Pose p = compose(pose, {x, y, 0.0});
      points.push_back({p.x, p.y});
    }
  }
  return points;
}

}  // namespace

Straddling::Straddling(Traffic& traffic, LaneKeeping& keeping, const LaneGraph& graph,
                       PosesSoon poses_soon, Reaction reaction, TypeOf type_of, CameFrom came_from)
    : traffic_(traffic),
      keeping_(keeping),
      graph_(graph),
      poses_soon_(std::move(poses_soon)),
      reaction_(std::move(reaction)),
      type_of_(std::move(type_of)),
      came_from_(std::move(came_from)) {}

/// Is all of the body within the lane of its front, or beyond the lane that it comes from? Quick.
bool Straddling::is_clear(const Pose& pose, const Vehicle& body, int lane, int from) const {
  constexpr double kInLane = 0.3;  // [m] from the middle of the lane: still within it
  if (lane != from) {
    const Point& end = graph_.lane(from).shape.back();
    return std::hypot(pose.x - end.x, pose.y - end.y) > body.length();
  }
  if (graph_.lanes_of(graph_.edge_of(lane)).size() < 2) return true;
  return std::ranges::all_of(std::array{-body.rear, body.front}, [&](double x) {
    const Pose p = compose(pose, {x, 0.0, 0.0});
    const std::optional<Beside> place = beside(graph_.lane(lane), {p.x, p.y});
    return place && place->aside < kInLane;
  });
}

void Straddling::find_tails(const VehicleState& v, const PlannedPose& at) {
  const int lane = graph_.find_lane(v.lane);  // none where it swings out between two
  const bool inside = lane == LaneGraph::kNone || graph_.edge_of(lane) == LaneGraph::kNone;
  const int from = inside ? came_from_(v.id) : lane;
  const Vehicle& shape = type_of_(v.type).body;
  if (from == LaneGraph::kNone || is_clear(at.pose, shape, lane, from)) return;
  const std::vector<Point> body = sides(at.pose, shape);
  for (const int other : graph_.lanes_of(graph_.edge_of(from))) {
    if (other != lane) add_body(body, other, at.speed);
  }
}

/// A body on or near a lane. Who moves over has but its nose there: drivers keep behind all of it,
/// not beside it.
void Straddling::add_body(const std::vector<Point>& body, int lane, double speed) {
  std::vector<Tail> tails;
  Tail rear{.along = kInfinity, .aside = kInfinity, .speed = speed};
  for (const Point& p : body) {
    const std::optional<Beside> place = beside(graph_.lane(lane), p);
    if (!place || place->aside >= kNear) continue;
    rear.along = std::min(rear.along, place->along);
    rear.aside = std::min(rear.aside, place->aside);
    sides_[graph_.lane(lane).id].push_back(place->along);
    tails.push_back({.along = place->along, .aside = place->aside, .speed = speed});
  }
  if (tails.empty()) return;
  tails.push_back(rear);
  for (Tail& tail : tails) tail.rear = rear.along;
  std::vector<Tail>& all = tails_[graph_.lane(lane).id];
  all.insert(all.end(), tails.begin(), tails.end());
}

/// Those that it would touch if it went on in its lane, seen from its front bumper.
std::vector<Straddling::Tail> Straddling::tails_ahead(const VehicleState& driver) const {
  std::vector<Tail> ahead;
  const auto tails = tails_.find(driver.lane);
  if (tails == tails_.end()) return ahead;
  const double half = type_of_(driver.type).body.width / 2.0;
  for (Tail tail : tails->second) {
    tail.along -= driver.lane_position;
    tail.rear -= driver.lane_position;
    const double needs = half + (tail.rear > 0.0 ? kMargin : kBeside);
    if (tail.along > 0.0 && tail.aside < needs) ahead.push_back(tail);
  }
  return ahead;
}

/// From which the driver can stop behind it, braking as it does [Krauss 1998].
double Straddling::safe_speed(const VehicleState& driver, const Tail& tail) const {
  const VehicleType& type = type_of_(driver.type);
  const double gap = std::max(0.0, tail.along - type.min_gap);
  const double lost = type.body.max_decel * reaction_(driver);
  return std::sqrt(lost * lost + tail.speed * tail.speed + 2.0 * type.body.max_decel * gap) - lost;
}

/// The speed at which it may go at most; infinity: nobody's tail is ahead of it.
double Straddling::most_speed(const VehicleState& driver) const {
  double most = kInfinity;
  for (const Tail& tail : tails_ahead(driver)) {
    if (tail.along < kTailRange) most = std::min(most, safe_speed(driver, tail));
  }
  return most;
}

std::optional<double> Straddling::stop_position(const VehicleState& driver) const {
  double most = kInfinity;
  for (const Tail& tail : tails_ahead(driver)) {
    if (tail.speed <= kStanding) most = std::min(most, tail.along);
  }
  if (most == kInfinity) return std::nullopt;
  return driver.lane_position + std::max(0.0, most - type_of_(driver.type).min_gap);
}

/// Is it inside a junction, or may it be after the next step? Not who stands at the line: there
/// somebody may still have to change to a lane that leads where it goes.
bool Straddling::enters_junction(const VehicleState& driver, int lane) const {
  if (graph_.edge_of(lane) == LaneGraph::kNone) return true;
  if (driver.speed <= kStanding) return false;
  const double step = traffic_.step_length();
  const double reach = (driver.speed + type_of_(driver.type).body.max_accel * step) * step;
  return driver.lane_position + reach >= graph_.lane(lane).length;
}

bool Straddling::is_near_one(const VehicleState& driver) const {
  return std::ranges::any_of(controlled_, [&](const Pose& other) {
    return std::hypot(other.x - driver.pose.x, other.y - driver.pose.y) < kInside;
  });
}

/// Is somebody level with it on or near another lane of its edge? Inside a junction, where lanes
/// side by side may be changed too, but lead apart: is somebody near?
bool Straddling::is_beside_one(const VehicleState& driver) const {
  const int lane = graph_.find_lane(driver.lane);
  if (lane == LaneGraph::kNone) return false;
  if (enters_junction(driver, lane) && is_near_one(driver)) return true;
  if (graph_.edge_of(lane) == LaneGraph::kNone) return false;
  const double front = driver.lane_position + kRoom;
  const double rear = driver.lane_position - type_of_(driver.type).body.length() - kRoom;
  return std::ranges::any_of(graph_.lanes_of(graph_.edge_of(lane)), [&](int other) {
    const auto sides = sides_.find(graph_.lane(other).id);
    return other != lane && sides != sides_.end() &&
           std::ranges::any_of(sides->second, [&](double s) { return s > rear && s < front; });
  });
}

void Straddling::show() {
  tails_.clear();
  sides_.clear();
  controlled_.clear();
  std::vector<const VehicleState*> drivers;
  for (const VehicleState& v : traffic_.vehicles()) {
    const std::vector<PlannedPose> soon = poses_soon_(v.id);
    if (soon.empty()) {
      drivers.push_back(&v);
      continue;
    }
    controlled_.push_back(v.pose);
    find_tails(v, {v.pose, v.speed});
    // Nobody is planned into a lane but where its driver can stop. He has to begin to.
    for (const PlannedPose& at : soon) find_tails(v, at);
  }
  if (controlled_.empty() && capped_.empty()) {
    return keeping_.keep_only({}, LaneKeeping::Reason::kBeside);
  }
  std::set<std::string> capped;
  std::set<std::string> kept;
  for (const VehicleState* v : drivers) {
    const double most = most_speed(*v);
    if (most < kInfinity || capped_.contains(v->id)) traffic_.cap_speed(v->id, most);
    if (most < kInfinity) capped.insert(v->id);
    if (is_beside_one(*v)) kept.insert(v->id);
  }
  keeping_.keep_only(std::move(kept), LaneKeeping::Reason::kBeside);
  capped_ = std::move(capped);
}

}  // namespace mvtp
