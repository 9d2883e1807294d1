#include "planner/problem/referee_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "planner/problem/initial_overlap.hpp"
#include "planner/problem/referee_geometry.hpp"
#include "planner/problem/referee_step.hpp"

namespace mvtp::referee {
namespace {

/// A vehicle during one phase: at rest at a whole step, or along one step.
struct Phase {
  Motion motion;
  double rate = 0.0;    ///< no point of the body is faster [m per step]
  Disc disc;            ///< covers the footprint during the whole phase
  bool changed = true;  ///< false: the vehicle rests where it was judged in the phase before
};

/// Two that may overlap during the phases that end with the steps `first` to `last`.
struct Exemption {
  std::size_t first = 0;
  std::size_t last = 0;
  double depth = 0.0;  ///< no more deeply than this [m]
};

/// Follows all vehicles side by side, phase by phase.
class SpaceReferee {
 public:
  SpaceReferee(const JudgedPlan& plan, CollisionRule rule, Protocol& protocol)
      : plan_(plan),
        rule_(rule),
        protocol_(protocol),
        phases_(plan.instance().agents.size()),
        obstacles_(discs_of_obstacles(plan.instance().map)) {
    find_exemptions();
  }

  void judge();

 private:
  void find_exemptions();
  /// How deeply the two overlap at a whole step [m]; negative if they are apart.
  [[nodiscard]] double depth_at(const OverlappingPlace& place, std::size_t step) const;
  /// How deeply the two may overlap during the phase that ends with this step [m].
  [[nodiscard]] double allowed_depth(Rule rule, std::size_t i, std::size_t object,
                                     std::size_t step) const;
  void judge_phase(std::size_t step);
  [[nodiscard]] Phase phase_of(std::size_t i, std::size_t step) const;
  void judge_pairs(std::size_t step);
  void judge_pair(std::size_t i, std::size_t j, std::size_t step);
  void judge_obstacles(std::size_t i, std::size_t step);
  void judge_polygon(std::size_t i, std::size_t p, std::size_t step);
  void judge_bounds(std::size_t i, std::size_t step);

  /// Follows `separation(s, enough)` over the phase; enters the rule as broken if it falls below a
  /// touch.
  template <class Separation>
  void follow(Rule rule, std::size_t i, std::size_t object, std::size_t step, double rate,
              const Separation& separation);

  [[nodiscard]] const Map& map() const { return plan_.instance().map; }
  [[nodiscard]] Box box(std::size_t i, double s) const {
    return footprint(plan_.agent(i).vehicle, phases_[i].motion.at(s));
  }

  const JudgedPlan& plan_;
  CollisionRule rule_;
  Protocol& protocol_;
  std::vector<Phase> phases_;  ///< by agent
  DiscsByX obstacles_;
  std::map<std::tuple<Rule, std::size_t, std::size_t>, std::vector<Exemption>> exemptions_;
};

void SpaceReferee::find_exemptions() {
  if (plan_.instance().initial_overlap == InitialOverlap::kRefuse) return;
  for (const OverlappingPlace& place : find_overlapping_places(plan_.instance())) {
    const bool of_two = place.with == OverlappingPlace::With::kAgent;
    const auto is_judged = [&](std::size_t i) {
      return std::ranges::count(plan_.present(), i) > 0;
    };
    if (!is_judged(place.agent) || (of_two && !is_judged(place.object))) continue;
    const auto overlap_at = [&](std::size_t step) {
      return depth_at(place, step) > kTouchTolerance;
    };
    std::size_t end = plan_.trajectory(place.agent).makespan();
    if (of_two) end = std::max(end, plan_.trajectory(place.object).makespan());
    Exemption exemption{0, end, place.depth};
    if (place.at_goal) {
      exemption.first = end;
      while (exemption.first > 0 && overlap_at(exemption.first - 1)) --exemption.first;
      exemption.last = std::numeric_limits<std::size_t>::max();
    } else {
      exemption.last = 0;
      while (exemption.last < end && overlap_at(exemption.last)) ++exemption.last;
    }
    const auto key = of_two ? std::tuple(Rule::kRobotOverlap, place.object, place.agent)
                            : std::tuple(Rule::kObstacleOverlap, place.agent, place.object);
    exemptions_[key].push_back(exemption);
  }
}

double SpaceReferee::depth_at(const OverlappingPlace& place, std::size_t step) const {
  const auto box_at = [&](std::size_t i) {
    return footprint(plan_.agent(i).vehicle, plan_.trajectory(i).at(step).pose);
  };
  const Box box = box_at(place.agent);
  if (place.with == OverlappingPlace::With::kAgent) {
    return -separation(box, box_at(place.object), 0.0);
  }
  const std::size_t circles = map().circles.size();
  return place.object < circles ? -separation(box, map().circles[place.object], 0.0)
                                : -separation(box, map().polygons[place.object - circles], 0.0);
}

double SpaceReferee::allowed_depth(Rule rule, std::size_t i, std::size_t object,
                                   std::size_t step) const {
  double depth = 0.0;
  const auto found = exemptions_.find({rule, i, object});
  if (found == exemptions_.end()) return depth;
  for (const Exemption& e : found->second) {
    if (e.first <= step && step <= e.last) depth = std::max(depth, e.depth);
  }
  return depth;
}

void SpaceReferee::judge() {
  std::size_t steps = 0;
  for (const std::size_t i : plan_.present())
    steps = std::max(steps, plan_.trajectory(i).makespan());
  for (std::size_t step = 0; step <= steps; ++step) judge_phase(step);
}

void SpaceReferee::judge_phase(std::size_t step) {
  for (const std::size_t i : plan_.present()) phases_[i] = phase_of(i, step);
  judge_pairs(step);
  for (const std::size_t i : plan_.present()) {
    judge_obstacles(i, step);
    judge_bounds(i, step);
  }
}

Phase SpaceReferee::phase_of(std::size_t i, std::size_t step) const {
  const Vehicle& vehicle = plan_.agent(i).vehicle;
  const Waypoint& now = plan_.trajectory(i).at(step);
  Phase phase;
  if (step == 0 || rule_ == CollisionRule::kSteps) {
    phase.motion = {now.pose, 0.0, 0.0, {}};
    phase.changed = step == 0 || now.pose != plan_.trajectory(i).at(step - 1).pose;
  } else if (step > plan_.trajectory(i).makespan()) {
    phase.motion = {now.pose, 0.0, 0.0, {}};
    phase.changed = false;
  } else {
    phase.motion = motion_of(vehicle, plan_.trajectory(i).at(step - 1).pose, now, plan_.dt());
    phase.rate = phase.motion.speed_bound(reach(vehicle));
    phase.changed = phase.rate > 0.0;
  }
  const Box middle = footprint(vehicle, phase.motion.at(0.5));
  phase.disc = {middle.center,
                std::hypot(middle.half_length, middle.half_width) + 0.5 * phase.rate};
  return phase;
}

template <class Separation>
void SpaceReferee::follow(Rule rule, std::size_t i, std::size_t object, std::size_t step,
                          double rate, const Separation& separation) {
  const double level = -kTouchTolerance - allowed_depth(rule, i, object, step);
  const auto found = first_below(separation, level, rate);
  if (!found) return;
  constexpr int kSamples = 64;  // for the message only: how deep it gets
  double deepest = separation(*found, 0.0);
  for (int k = 0; rate > 0.0 && k <= kSamples; ++k) {
    deepest = std::min(deepest, separation(double(k) / kSamples, 0.0));
  }
  const double when = rate > 0.0 ? double(step) - 1.0 + *found : double(step);
  protocol_.add(rule, i, object, step, when, -deepest);
}

void SpaceReferee::judge_pairs(std::size_t step) {
  std::vector<Disc> discs;
  for (const std::size_t i : plan_.present()) discs.push_back(phases_[i].disc);
  for (const auto& [a, b] : near_pairs(discs)) {
    judge_pair(plan_.present()[a], plan_.present()[b], step);
  }
}

void SpaceReferee::judge_pair(std::size_t i, std::size_t j, std::size_t step) {
  if (!phases_[i].changed && !phases_[j].changed) {
    protocol_.prolong(Rule::kRobotOverlap, i, j, step);
    return;
  }
  follow(Rule::kRobotOverlap, i, j, step, phases_[i].rate + phases_[j].rate,
         [&](double s, double enough) { return separation(box(i, s), box(j, s), enough); });
}

void SpaceReferee::judge_obstacles(std::size_t i, std::size_t step) {
  const std::size_t circles = map().circles.size();
  for (const std::size_t k : obstacles_.near(phases_[i].disc)) {
    if (!phases_[i].changed) {
      protocol_.prolong(Rule::kObstacleOverlap, i, k, step);
    } else if (k < circles) {
      follow(Rule::kObstacleOverlap, i, k, step, phases_[i].rate, [&](double s, double enough) {
        return separation(box(i, s), map().circles[k], enough);
      });
    } else {
      judge_polygon(i, k - circles, step);
    }
  }
}

using Edge = std::pair<Point, Point>;

/// The edges whose bounding box the disc's bounding box overlaps.
std::vector<Edge> edges_near(const Polygon& polygon, const Disc& disc) {
  std::vector<Edge> near;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point& a = polygon[j];
    const Point& b = polygon[i];
    const bool is_far = std::max(a.x, b.x) < disc.center.x - disc.radius ||
                        std::min(a.x, b.x) > disc.center.x + disc.radius ||
                        std::max(a.y, b.y) < disc.center.y - disc.radius ||
                        std::min(a.y, b.y) > disc.center.y + disc.radius;
    if (!is_far) near.emplace_back(a, b);
  }
  return near;
}

/// The footprint overlaps a polygon where it overlaps an edge, or lies inside altogether.
void SpaceReferee::judge_polygon(std::size_t i, std::size_t p, std::size_t step) {
  const Phase& phase = phases_[i];
  const Polygon& polygon = map().polygons[p];
  const std::size_t object = map().circles.size() + p;
  const std::vector<Edge> near = edges_near(polygon, phase.disc);
  const Box start = box(i, 0.0);
  // From outside, a footprint gets inside only through an edge; so the start of the phase suffices.
  const double inner = contains(polygon, start.center)
                           ? -std::min(start.half_length, start.half_width)
                           : phase.disc.radius;
  follow(Rule::kObstacleOverlap, i, object, step, phase.rate, [&](double s, double enough) {
    const Box now = box(i, s);
    double least = inner;
    for (const auto& [a, b] : near) {
      least = std::min(least, separation(now, a, b, enough));
    }
    return least;
  });
}

void SpaceReferee::judge_bounds(std::size_t i, std::size_t step) {
  const Phase& phase = phases_[i];
  if (!phase.changed) {
    protocol_.prolong(Rule::kBounds, i, 0, step);
    return;
  }
  const double largest = reach(plan_.agent(i).vehicle);
  if (margin_inside(map(), phase.disc.center) > phase.disc.radius + largest) return;
  if (map().bounds == Bounds::kFootprint) {
    follow(Rule::kBounds, i, 0, step, phase.rate,
           [&](double s, double) { return margin_inside(map(), box(i, s)); });
    return;
  }
  follow(Rule::kBounds, i, 0, step, phase.motion.speed_bound(0.0), [&](double s, double) {
    const Pose axle = phase.motion.at(s);
    return margin_inside(map(), Point{axle.x, axle.y});
  });
}

}  // namespace

void judge_space(const JudgedPlan& plan, CollisionRule rule, Protocol& protocol) {
  SpaceReferee(plan, rule, protocol).judge();
}

}  // namespace mvtp::referee
