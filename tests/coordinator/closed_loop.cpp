#include "tests/coordinator/closed_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "coordinator/network/partition.hpp"
#include "planner/problem/draws.hpp"

namespace mvtp {
namespace {

constexpr double kTouch = 1e-3;   ///< [m] that count as no contact
constexpr double kJump = 0.05;    ///< [m] that a placement may be off what its speed explains
constexpr int kLooks = 8;         ///< per step of the traffic
constexpr std::size_t kMost = 8;  ///< reports

std::array<Point, 4> corners(const Pose& p, const Vehicle& body) {
  const double c = std::cos(p.theta);
  const double s = std::sin(p.theta);
  const double half = body.width / 2.0;
  const std::array<Point, 4> local = {
      {{body.front, half}, {-body.rear, half}, {-body.rear, -half}, {body.front, -half}}};
  std::array<Point, 4> points;
  for (std::size_t i = 0; i < 4; ++i) {
    points[i] = {p.x + c * local[i].x - s * local[i].y, p.y + s * local[i].x + c * local[i].y};
  }
  return points;
}

}  // namespace

double overlap(const Pose& a, const Vehicle& body_a, const Pose& b, const Vehicle& body_b) {
  const std::array<Point, 4> of_a = corners(a, body_a);
  const std::array<Point, 4> of_b = corners(b, body_b);
  double least = 1e300;
  for (const double theta :
       {a.theta, a.theta + 1.5707963267948966, b.theta, b.theta + 1.5707963267948966}) {
    const Point axis{std::cos(theta), std::sin(theta)};
    const auto extent = [&](const std::array<Point, 4>& points) {
      std::array<double, 2> range = {1e300, -1e300};
      for (const Point& p : points) {
        const double x = p.x * axis.x + p.y * axis.y;
        range = {std::min(range[0], x), std::max(range[1], x)};
      }
      return range;
    };
    const auto ra = extent(of_a);
    const auto rb = extent(of_b);
    least = std::min(least, std::min(ra[1], rb[1]) - std::max(ra[0], rb[0]));
  }
  return least;
}

Pose between(const Pose& from, const Pose& to, double share) {
  const double turn = std::remainder(to.theta - from.theta, 6.283185307179586);
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  // On an arc: the chord of a part of it is shorter, and turned back.
  const double scale =
      std::abs(turn) < 1e-9 ? share : std::sin(share * turn / 2.0) / std::sin(turn / 2.0);
  const double back = -(1.0 - share) * turn / 2.0;
  return {from.x + scale * (dx * std::cos(back) - dy * std::sin(back)),
          from.y + scale * (dx * std::sin(back) + dy * std::cos(back)), from.theta + share * turn};
}

namespace {

/// Which routes through a shape a body can drive.
class Drivability {
 public:
  explicit Drivability(const RoadNetwork& network) : graph_(network), area_(network) {}

  bool operator()(const FakeTrip& trip) {
    const auto [known, is_new] = known_.try_emplace({trip.type, trip.edges}, false);
    if (is_new) known->second = find(trip);
    return known->second;
  }

 private:
  bool find(const FakeTrip& trip) {
    const Vehicle body = fake_type(trip.type).body;
    std::vector<int> route;
    for (const std::string& edge : trip.edges) route.push_back(graph_.find_edge(edge));
    CourseQuery query{.lane = graph_.lanes_of(route[0])[std::size_t(trip.lane)]};
    const double length = graph_.lane(query.lane).length;
    query.position = std::min(length, std::max(length - 79.0, body.length() + 4.0));
    query.edges = route;
    query.length = body.length();
    const std::optional<CorridorCourse> course = finder_.find(query);
    return course && corridors_[corridors_.corridor_for(*course, body)].undriven.empty();
  }

  LaneGraph graph_;
  DrivableArea area_;
  CourseFinder finder_{graph_, select_junctions(graph_, {}, CorridorOptions{}.chain), {}};
  CorridorMap corridors_{graph_, area_, {}};
  std::map<std::pair<std::string, std::vector<std::string>>, bool> known_;
};

}  // namespace

std::vector<FakeTrip> random_trips(const NetworkShape& shape, const Demand& demand) {
  Draws draws(demand.seed);
  const auto any = [&](std::size_t n) { return std::size_t(draws.between(0, int(n) - 1)); };
  Drivability is_drivable(shape.network);
  std::vector<FakeTrip> trips;
  for (int i = 0; i < demand.vehicles; ++i) {
    FakeTrip trip{.id = fmt::format("v{:03}", i), .depart = demand.duration * draws.share()};
    do {
      trip.from = shape.sources[any(shape.sources.size())];
      trip.to = shape.sinks[any(shape.sinks.size())];
      trip.edges = shortest_route(shape.network, trip.from, trip.to);
      trip.type = demand.types[any(demand.types.size())];
      trip.lane = int(any(shape.network.edges.at(trip.from).size()));
    } while (trip.edges.empty() || !(demand.guests || is_drivable(trip)));
    trips.push_back(trip);
  }
  return trips;
}

ClosedLoop::ClosedLoop(const NetworkShape& shape, std::vector<FakeTrip> trips, double step_length,
                       const CoordinatorOptions& options)
    : traffic(shape.network, trips, step_length, shape.programs),
      area(traffic.network()),
      coordinator(traffic, area, options),
      audit(area, step_length),
      number_of_trips(int(trips.size())) {
  simulation_.add(coordinator);
}

void ClosedLoop::run_until(double end) {
  while (traffic.running() && traffic.time() < end && broken.size() < kMost) step();
}

void ClosedLoop::step() {
  const std::size_t decisions = coordinator.replans().size();
  simulation_.step();
  taken_over += int(coordinator.taken_over().size());
  handed_back += int(coordinator.handed_back().size());
  if (coordinator.replans().size() > decisions) look_at_braking();
  look_at_hand_backs();
  look();
}

const Vehicle& ClosedLoop::body(const std::string& type) {
  const auto known = types_.find(type);
  return (known != types_.end() ? known : types_.emplace(type, fake_type(type)).first)->second.body;
}

void ClosedLoop::report(const std::string& what, const std::string& who, double value) {
  if (broken.size() >= kMost) return;
  broken.push_back(fmt::format("t = {:.2f} s: {}: {} {:.4f}", traffic.time(), who, what, value));
}

std::string ClosedLoop::words(const std::string& id, const Seen& seen) const {
  const std::string_view driver = seen.driven           ? "driven"
                                  : traffic.passes(id)  ? "let through"
                                  : traffic.is_held(id) ? "held"
                                                        : "on its own";
  return fmt::format("{} ({}, {}, on {} at {:.1f} m/s)", id, type_of_.at(id), driver, seen.lane,
                     seen.speed);
}

void ClosedLoop::look() {
  std::map<std::string, Seen> now;
  std::vector<Observation> observations;
  for (const VehicleState& v : traffic.vehicles()) {
    static_cast<void>(body(v.type));
    type_of_[v.id] = v.type;
    const bool driven = coordinator.drives(v.id);
    now[v.id] = {v.pose, v.speed, driven, v.lane};
    observations.push_back({&v, &types_.at(v.type), driven});
    const auto before = last_.find(v.id);
    if (before != last_.end()) look_at_motion(v, before->second, now[v.id]);
  }
  audit.observe(traffic.time(), observations, traffic.pedestrians());
  look_for_contacts(now);
  last_ = std::move(now);
}

/// Of a vehicle that was placed: its new place, and its acceleration.
void ClosedLoop::look_at_motion(const VehicleState& v, const Seen& before, const Seen& now) {
  if (!now.driven) return;
  const double dt = traffic.step_length();
  const Vehicle& b = body(v.type);
  const double moved = std::hypot(now.pose.x - before.pose.x, now.pose.y - before.pose.y);
  const double most = std::max(before.speed, now.speed) * dt + kJump;
  if (moved > most) report("jumps [m]", v.id, moved - most);
  if (!before.driven) return;
  const double outside = area.share_outside(now.pose, b, Audit::kRoadTolerance);
  if (outside > 0.0 && area.share_outside(before.pose, b, Audit::kRoadTolerance) == 0.0) {
    report("leaves the road with a share of", words(v.id, now), outside);
  }
  const double a = (now.speed - before.speed) / dt;
  if (a > b.max_accel + 1e-3 || a < -b.max_decel - 1e-3) report("accelerates [m/s^2]", v.id, a);
}

/// A driven vehicle with any other, at the end of the step and on the way there.
void ClosedLoop::look_for_contacts(const std::map<std::string, Seen>& now) {
  for (const auto& [id, a] : now) {
    if (!a.driven || !last_.contains(id)) continue;
    for (const auto& [other, b] : now) {
      if (id == other || (b.driven && other < id) || !last_.contains(other)) continue;
      if (std::hypot(a.pose.x - b.pose.x, a.pose.y - b.pose.y) > 50.0) continue;
      const Vehicle& body_a = body(type_of_.at(id));
      const Vehicle& body_b = body(type_of_.at(other));
      double deepest = -1e300;
      for (int k = 1; k <= kLooks; ++k) {
        const double t = double(k) / kLooks;
        deepest = std::max(deepest, overlap(between(last_.at(id).pose, a.pose, t), body_a,
                                            between(last_.at(other).pose, b.pose, t), body_b));
      }
      if (deepest > kTouch)
        report("overlap [m]", words(id, a) + " and " + words(other, b), deepest);
    }
  }
}

/// Where its front has come to the end of its last lane and it leaves the network [m along its
/// path]; infinity: it drives on.
double ClosedLoop::leaves_at(const Driven& driven) const {
  const Corridor& corridor = coordinator.corridors()[driven.corridor];
  if (!graph_.links_from(corridor.exit_lane).empty())
    return std::numeric_limits<double>::infinity();
  return corridor.s_exit + graph_.lane(corridor.exit_lane).length;
}

/// Everybody brakes from where the decision found him, in lock-step, until all stand.
void ClosedLoop::look_at_braking() {
  const RoadScene scene = coordinator.scene();
  struct Braking {
    const std::string* id;
    const Driven* driven;
    const RoadVehicle* road;
    const ReferencePath* path;
    const Vehicle* body;
    double leaves_at;
  };
  std::vector<Braking> all;
  double longest = 0.0;
  for (const auto& [id, driven] : coordinator.driven()) {
    const RoadVehicle& road = scene.vehicle(driven.key);
    const Vehicle& b = scene.body(road);
    longest = std::max(longest, road.now.v / b.max_decel);
    all.push_back({&id, &driven, &road, &scene.library->path(road.path), &b, leaves_at(driven)});
  }
  std::vector<std::optional<Pose>> poses(all.size());
  for (double tau = 0.0; tau < longest + 0.1; tau += 0.1) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double v = all[i].road->now.v;
      const double b = all[i].body->max_decel;
      const double t = std::min(tau, v / b);
      const double at = all[i].road->now.s + t * v - 0.5 * b * t * t;
      poses[i].reset();
      if (at < all[i].leaves_at) poses[i] = all[i].driven->approach.pose(*all[i].path, at);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (!poses[i] || !poses[j] || distance(*poses[i], *poses[j]) > 30.0) continue;
        const double deep = overlap(*poses[i], *all[i].body, *poses[j], *all[j].body);
        if (deep <= kTouch) continue;
        const std::string two = *all[i].id + " and " + *all[j].id;
        return report(fmt::format("touch {:.1f} s after all brake [m]", tau), two, deep);
      }
    }
  }
}

void ClosedLoop::look_at_hand_backs() {
  for (const std::string& id : coordinator.handed_back()) {
    const std::string& lane = last_.at(id).lane;
    if (traffic.network().lanes.at(lane).internal) report("is handed back on " + lane, id, 0.0);
  }
}

}  // namespace mvtp
