#include "planner/problem/validate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "planner/problem/initial_overlap.hpp"
#include "planner/problem/referee_geometry.hpp"

namespace mvtp {
namespace {

using referee::Arc;
using referee::Box;
using referee::Disc;
using referee::Motion;

constexpr double kGoalTolerance = 0.1;    ///< [m] and [rad]
constexpr double kStartTolerance = 1e-3;  ///< [m] and [rad]; peers write six digits
constexpr double kFarthest = 1e6;         ///< [m]; beyond, double loses the millimetre

/// How far a step may end from the arc that its v and phi say [m] and [rad].
constexpr double kStatedArcTolerance = 1e-4;
/// The same for a step without v and phi: room for poses that were written with six digits, and in
/// length [m] and turn [rad] against the limits of the vehicle.
constexpr double kJoiningArcTolerance = 1.5e-3;
constexpr double kLimitTolerance = 1e-6;  ///< relative, of speed and curvature

// ---- one step of one vehicle

bool states_its_arc(const Waypoint& waypoint) {
  return !std::isnan(waypoint.v) && !std::isnan(waypoint.phi);
}

Arc claimed_arc(const Vehicle& vehicle, const Pose& from, const Waypoint& to, double dt) {
  if (!states_its_arc(to)) return referee::joining_arc(from, to.pose);
  return {to.v * dt, std::tan(to.phi) / vehicle.wheelbase};
}

/// From where the arc ends to where the plan says that the step ends, in the world frame.
Pose drift(const Pose& from, const Arc& arc, const Pose& to) {
  const Pose end = drive(from, arc.length, arc.curvature);
  return {to.x - end.x, to.y - end.y, wrap_to_pi(to.theta - end.theta)};
}

/// False for NaN too.
bool is_small(const Pose& difference, double tolerance) {
  return std::hypot(difference.x, difference.y) <= tolerance &&
         std::abs(difference.theta) <= tolerance;
}

/// The motion that the referee follows: the claimed arc if it leads to the next pose, else the arc
/// that joins the poses, else the straight line.
Motion motion_of(const Vehicle& vehicle, const Pose& from, const Waypoint& to, double dt) {
  const double tolerance = states_its_arc(to) ? kStatedArcTolerance : kJoiningArcTolerance;
  const Arc claimed = claimed_arc(vehicle, from, to, dt);
  const Pose rest = drift(from, claimed, to.pose);
  if (is_small(rest, tolerance)) return {from, claimed.length, claimed.curvature, rest};

  const Arc joining = referee::joining_arc(from, to.pose);
  const Pose joining_rest = drift(from, joining, to.pose);
  if (is_small(joining_rest, kJoiningArcTolerance)) {
    return {from, joining.length, joining.curvature, joining_rest};
  }
  return {from, 0.0, 0.0, drift(from, {}, to.pose)};
}

bool is_finite(const Pose& pose) {
  return std::abs(pose.x) <= kFarthest && std::abs(pose.y) <= kFarthest &&
         std::isfinite(pose.theta);
}

// ---- the protocol

/// Collects broken rules; the same one by the same parties in successive steps is one entry.
class Protocol {
 public:
  /// @param subject index of the agent (of the trajectory for kAgentUnknown).
  /// @param object the other agent, or the obstacle; 0 where the rule needs none.
  /// @param step the whole step at whose end it is seen; `when` the moment itself.
  void add(Rule rule, std::size_t subject, std::size_t object, std::size_t step, double when,
           double amount, double turn = 0.0) {
    const auto [open, is_new] = open_.try_emplace({rule, subject, object}, entries_.size());
    if (!is_new && entries_[open->second].last_step + 1 >= step) {
      Entry& entry = entries_[open->second];
      entry.last_step = step;
      entry.amount = std::max(entry.amount, amount);
      entry.turn = std::max(entry.turn, turn);
      return;
    }
    open->second = entries_.size();
    entries_.push_back({rule, subject, object, step, when, amount, turn});
  }

  /// Nothing has moved since the step before: what was broken then still is.
  void prolong(Rule rule, std::size_t subject, std::size_t object, std::size_t step) {
    const auto open = open_.find({rule, subject, object});
    if (open == open_.end()) return;
    Entry& entry = entries_[open->second];
    if (entry.last_step + 1 == step) entry.last_step = step;
  }

  struct Entry {
    Rule rule;
    std::size_t subject;
    std::size_t object;
    std::size_t last_step;
    double when;
    double amount;
    double turn;  ///< [rad], for kStart, kGoal and kArc
  };

  /// In the order of the rules, then of the parties, then of time.
  [[nodiscard]] std::vector<Entry> entries() const {
    std::vector<Entry> sorted = entries_;
    const auto key = [](const Entry& e) { return std::tuple(e.rule, e.subject, e.object, e.when); };
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](const Entry& a, const Entry& b) { return key(a) < key(b); });
    return sorted;
  }

 private:
  std::vector<Entry> entries_;
  std::map<std::tuple<Rule, std::size_t, std::size_t>, std::size_t> open_;  ///< the latest entry
};

// ---- the referee

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

class Referee {
 public:
  Referee(const Instance& instance, const Plan& plan, CollisionRule rule)
      : instance_(instance),
        plan_(plan),
        rule_(rule),
        obstacles_(referee::discs_of_obstacles(instance.map)) {}

  [[nodiscard]] std::vector<Violation> judge() {
    match_agents();
    find_exemptions();
    for (const std::size_t i : present_) {
      judge_ends(i);
      judge_kinematics(i);
    }
    judge_space();
    std::vector<Violation> violations;
    for (const Protocol::Entry& entry : protocol_.entries()) {
      violations.push_back(to_violation(entry));
    }
    return violations;
  }

 private:
  const Agent& agent(std::size_t i) const { return instance_.agents[i]; }
  const Trajectory& trajectory(std::size_t i) const { return *trajectories_[i]; }

  void match_agents();
  void find_exemptions();
  /// How deeply the two overlap at a whole step [m]; negative if they are apart.
  [[nodiscard]] double depth_at(const OverlappingPlace& place, std::size_t step) const;
  /// How deeply the two may overlap during the phase that ends with this step [m].
  [[nodiscard]] double allowed_depth(Rule rule, std::size_t i, std::size_t object,
                                     std::size_t step) const;
  void judge_ends(std::size_t i);
  void judge_kinematics(std::size_t i);
  void judge_limits(std::size_t i, std::size_t step, const Arc& arc, bool is_stated);
  void judge_space();
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

  [[nodiscard]] Box box(std::size_t i, double s) const {
    return referee::footprint(agent(i).vehicle, phases_[i].motion.at(s));
  }
  [[nodiscard]] Violation to_violation(const Protocol::Entry& entry) const;
  [[nodiscard]] std::string message(const Protocol::Entry& entry) const;

  const Instance& instance_;
  const Plan& plan_;
  CollisionRule rule_;
  Protocol protocol_;
  std::vector<const Trajectory*> trajectories_;  ///< by agent; nullptr if it has none
  std::vector<std::size_t> present_;             ///< agents with a trajectory that can be judged
  std::vector<Phase> phases_;                    ///< by agent
  referee::DiscsByX obstacles_;
  std::map<std::tuple<Rule, std::size_t, std::size_t>, std::vector<Exemption>> exemptions_;
};

void Referee::match_agents() {
  std::unordered_map<std::string_view, std::size_t> index;
  for (std::size_t i = 0; i < instance_.agents.size(); ++i) index.emplace(agent(i).name, i);
  trajectories_.assign(instance_.agents.size(), nullptr);
  for (std::size_t k = 0; k < plan_.names.size(); ++k) {
    const auto found = index.find(plan_.names[k]);
    if (found == index.end() || trajectories_[found->second] != nullptr) {
      protocol_.add(Rule::kAgentUnknown, k, 0, 0, 0.0, 0.0);
    } else {
      trajectories_[found->second] = &plan_.trajectories[k];
    }
  }
  for (std::size_t i = 0; i < instance_.agents.size(); ++i) {
    if (trajectories_[i] == nullptr) {
      protocol_.add(Rule::kAgentMissing, i, 0, 0, 0.0, 0.0);
      continue;
    }
    const std::vector<Waypoint>& waypoints = trajectory(i).waypoints();
    const auto bad = std::find_if(waypoints.begin(), waypoints.end(),
                                  [](const Waypoint& w) { return !is_finite(w.pose); });
    if (bad == waypoints.end()) {
      present_.push_back(i);
    } else {
      const auto step = static_cast<std::size_t>(bad - waypoints.begin());
      protocol_.add(Rule::kNotFinite, i, 0, step, double(step), 0.0);
    }
  }
}

double Referee::depth_at(const OverlappingPlace& place, std::size_t step) const {
  const auto box_at = [&](std::size_t i) {
    return referee::footprint(agent(i).vehicle, trajectory(i).at(step).pose);
  };
  const Box box = box_at(place.agent);
  if (place.with == OverlappingPlace::With::kAgent) {
    return -referee::separation(box, box_at(place.object), 0.0);
  }
  const Map& map = instance_.map;
  const std::size_t circles = map.circles.size();
  return place.object < circles
             ? -referee::separation(box, map.circles[place.object], 0.0)
             : -referee::separation(box, map.polygons[place.object - circles], 0.0);
}

void Referee::find_exemptions() {
  if (instance_.initial_overlap == InitialOverlap::kRefuse) return;
  for (const OverlappingPlace& place : find_overlapping_places(instance_)) {
    const bool of_two = place.with == OverlappingPlace::With::kAgent;
    const auto is_judged = [&](std::size_t i) { return std::ranges::count(present_, i) > 0; };
    if (!is_judged(place.agent) || (of_two && !is_judged(place.object))) continue;
    const auto overlap_at = [&](std::size_t step) {
      return depth_at(place, step) > kTouchTolerance;
    };
    std::size_t end = trajectory(place.agent).makespan();
    if (of_two) end = std::max(end, trajectory(place.object).makespan());
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

double Referee::allowed_depth(Rule rule, std::size_t i, std::size_t object,
                              std::size_t step) const {
  double depth = 0.0;
  const auto found = exemptions_.find({rule, i, object});
  if (found == exemptions_.end()) return depth;
  for (const Exemption& e : found->second) {
    if (e.first <= step && step <= e.last) depth = std::max(depth, e.depth);
  }
  return depth;
}

void Referee::judge_ends(std::size_t i) {
  const auto judge = [&](Rule rule, const Pose& wanted, std::size_t step, double tolerance) {
    const Pose& is = trajectory(i).at(step).pose;
    const double turn = std::abs(wrap_to_pi(is.theta - wanted.theta));
    const double away = distance(is, wanted);
    if (away <= tolerance && turn <= tolerance) return;
    protocol_.add(rule, i, 0, step, double(step), away, turn);
  };
  judge(Rule::kStart, agent(i).start, 0, kStartTolerance);
  judge(Rule::kGoal, agent(i).goal, trajectory(i).makespan(), kGoalTolerance);
}

void Referee::judge_kinematics(std::size_t i) {
  const std::vector<Waypoint>& waypoints = trajectory(i).waypoints();
  for (std::size_t step = 1; step < waypoints.size(); ++step) {
    const Pose& from = waypoints[step - 1].pose;
    const Waypoint& to = waypoints[step];
    const bool is_stated = states_its_arc(to);
    const Arc arc = claimed_arc(agent(i).vehicle, from, to, plan_.statistics.dt);
    const Pose rest = drift(from, arc, to.pose);
    if (!is_small(rest, is_stated ? kStatedArcTolerance : kJoiningArcTolerance)) {
      protocol_.add(Rule::kArc, i, 0, step, double(step), std::hypot(rest.x, rest.y),
                    std::abs(rest.theta));
    }
    judge_limits(i, step, arc, is_stated);
  }
}

void Referee::judge_limits(std::size_t i, std::size_t step, const Arc& arc, bool is_stated) {
  const Vehicle& vehicle = agent(i).vehicle;
  const double dt = plan_.statistics.dt;
  const double slack = is_stated ? 0.0 : kJoiningArcTolerance;
  const double length = std::abs(arc.length);
  const double longest = vehicle.max_speed * dt * (1.0 + kLimitTolerance) + slack;
  if (!(length <= longest)) {
    protocol_.add(Rule::kSpeed, i, 0, step, double(step), length / dt);
  }
  const double turn = length * std::abs(arc.curvature);
  const double sharpest = length * vehicle.max_curvature() * (1.0 + kLimitTolerance) + slack;
  const double phi = trajectory(i).at(step).phi;
  const bool beyond_right_angle =
      is_stated && length > 0.0 && !(std::abs(phi) < 0.5 * std::numbers::pi);
  if (!(turn <= sharpest) || beyond_right_angle) {
    protocol_.add(Rule::kCurvature, i, 0, step, double(step), std::abs(arc.curvature));
  }
}

void Referee::judge_space() {
  phases_.resize(instance_.agents.size());
  std::size_t steps = 0;
  for (const std::size_t i : present_) steps = std::max(steps, trajectory(i).makespan());
  for (std::size_t step = 0; step <= steps; ++step) judge_phase(step);
}

void Referee::judge_phase(std::size_t step) {
  for (const std::size_t i : present_) phases_[i] = phase_of(i, step);
  judge_pairs(step);
  for (const std::size_t i : present_) {
    judge_obstacles(i, step);
    judge_bounds(i, step);
  }
}

Phase Referee::phase_of(std::size_t i, std::size_t step) const {
  const Vehicle& vehicle = agent(i).vehicle;
  const Waypoint& now = trajectory(i).at(step);
  Phase phase;
  if (step == 0 || rule_ == CollisionRule::kSteps) {
    phase.motion = {now.pose, 0.0, 0.0, {}};
    phase.changed = step == 0 || now.pose != trajectory(i).at(step - 1).pose;
  } else if (step > trajectory(i).makespan()) {
    phase.motion = {now.pose, 0.0, 0.0, {}};
    phase.changed = false;
  } else {
    phase.motion = motion_of(vehicle, trajectory(i).at(step - 1).pose, now, plan_.statistics.dt);
    phase.rate = phase.motion.speed_bound(referee::reach(vehicle));
    phase.changed = phase.rate > 0.0;
  }
  const Box middle = referee::footprint(vehicle, phase.motion.at(0.5));
  phase.disc = {middle.center,
                std::hypot(middle.half_length, middle.half_width) + 0.5 * phase.rate};
  return phase;
}

template <class Separation>
void Referee::follow(Rule rule, std::size_t i, std::size_t object, std::size_t step, double rate,
                     const Separation& separation) {
  const double level = -kTouchTolerance - allowed_depth(rule, i, object, step);
  const auto found = referee::first_below(separation, level, rate);
  if (!found) return;
  constexpr int kSamples = 64;  // for the message only: how deep it gets
  double deepest = separation(*found, 0.0);
  for (int k = 0; rate > 0.0 && k <= kSamples; ++k) {
    deepest = std::min(deepest, separation(double(k) / kSamples, 0.0));
  }
  const double when = rate > 0.0 ? double(step) - 1.0 + *found : double(step);
  protocol_.add(rule, i, object, step, when, -deepest);
}

void Referee::judge_pairs(std::size_t step) {
  std::vector<Disc> discs;
  for (const std::size_t i : present_) discs.push_back(phases_[i].disc);
  for (const auto& [a, b] : referee::near_pairs(discs)) {
    judge_pair(present_[a], present_[b], step);
  }
}

void Referee::judge_pair(std::size_t i, std::size_t j, std::size_t step) {
  if (!phases_[i].changed && !phases_[j].changed) {
    protocol_.prolong(Rule::kRobotOverlap, i, j, step);
    return;
  }
  follow(
      Rule::kRobotOverlap, i, j, step, phases_[i].rate + phases_[j].rate,
      [&](double s, double enough) { return referee::separation(box(i, s), box(j, s), enough); });
}

void Referee::judge_obstacles(std::size_t i, std::size_t step) {
  const std::size_t circles = instance_.map.circles.size();
  for (const std::size_t k : obstacles_.near(phases_[i].disc)) {
    if (!phases_[i].changed) {
      protocol_.prolong(Rule::kObstacleOverlap, i, k, step);
    } else if (k < circles) {
      follow(Rule::kObstacleOverlap, i, k, step, phases_[i].rate, [&](double s, double enough) {
        return referee::separation(box(i, s), instance_.map.circles[k], enough);
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
void Referee::judge_polygon(std::size_t i, std::size_t p, std::size_t step) {
  const Phase& phase = phases_[i];
  const Polygon& polygon = instance_.map.polygons[p];
  const std::size_t object = instance_.map.circles.size() + p;
  const std::vector<Edge> near = edges_near(polygon, phase.disc);
  const Box start = box(i, 0.0);
  // From outside, a footprint gets inside only through an edge; so the start of the phase suffices.
  const double inner = referee::contains(polygon, start.center)
                           ? -std::min(start.half_length, start.half_width)
                           : phase.disc.radius;
  follow(Rule::kObstacleOverlap, i, object, step, phase.rate, [&](double s, double enough) {
    const Box now = box(i, s);
    double least = inner;
    for (const auto& [a, b] : near) {
      least = std::min(least, referee::separation(now, a, b, enough));
    }
    return least;
  });
}

void Referee::judge_bounds(std::size_t i, std::size_t step) {
  const Phase& phase = phases_[i];
  if (!phase.changed) {
    protocol_.prolong(Rule::kBounds, i, 0, step);
    return;
  }
  const Map& map = instance_.map;
  const double largest = referee::reach(agent(i).vehicle);
  if (referee::margin_inside(map, phase.disc.center) > phase.disc.radius + largest) return;
  if (map.bounds == Bounds::kFootprint) {
    follow(Rule::kBounds, i, 0, step, phase.rate,
           [&](double s, double) { return referee::margin_inside(map, box(i, s)); });
    return;
  }
  follow(Rule::kBounds, i, 0, step, phase.motion.speed_bound(0.0), [&](double s, double) {
    const Pose axle = phase.motion.at(s);
    return referee::margin_inside(map, Point{axle.x, axle.y});
  });
}

// ---- words

/// "at step 3.25", or "from step 3.25 to step 7" if it lasts.
std::string span(const Protocol::Entry& entry) {
  if (double(entry.last_step) - entry.when < 1.0) return fmt::format("at step {:.4g}", entry.when);
  return fmt::format("from step {:.4g} to step {}", entry.when, entry.last_step);
}

std::string Referee::message(const Protocol::Entry& entry) const {
  const double x = entry.amount;
  const auto car = [&]() -> const Agent& { return agent(entry.subject); };
  const auto off = [&] { return fmt::format("{:.4f} m and {:.4f} rad", x, entry.turn); };
  switch (entry.rule) {
    case Rule::kAgentMissing:
      return fmt::format("{}: has no trajectory", car().name);
    case Rule::kAgentUnknown:
      return fmt::format("{}: is no agent of the instance, or occurs twice",
                         plan_.names[entry.subject]);
    case Rule::kNotFinite:
      return fmt::format("{}: {}: the pose is not finite, or farther than {} m", car().name,
                         span(entry), kFarthest);
    case Rule::kStart:
      return fmt::format("{}: begins {} from its start", car().name, off());
    case Rule::kGoal:
      return fmt::format("{}: ends {} from its goal; {} m and {} rad are allowed", car().name,
                         off(), kGoalTolerance, kGoalTolerance);
    case Rule::kArc:
      return fmt::format("{}: {}: the step ends {} from where its arc leads", car().name,
                         span(entry), off());
    case Rule::kCurvature:
      return fmt::format("{}: {}: turns with a radius of {:.4f} m; at least {:.4f} m is allowed",
                         car().name, span(entry), 1.0 / x, car().vehicle.min_turning_radius);
    case Rule::kSpeed:
      return fmt::format("{}: {}: drives at {:.4f} m/s; at most {:.4f} m/s is allowed", car().name,
                         span(entry), x, car().vehicle.max_speed);
    case Rule::kRobotOverlap:
      return fmt::format("{} and {}: overlap by {:.4f} m {}", car().name, agent(entry.object).name,
                         x, span(entry));
    case Rule::kObstacleOverlap:
      return fmt::format("{}: overlaps {} by {:.4f} m {}", car().name,
                         obstacle_name(instance_.map, entry.object), x, span(entry));
    case Rule::kBounds:
      return fmt::format("{}: the {} is {:.4f} m outside the map {}", car().name,
                         instance_.map.bounds == Bounds::kAxle ? "rear axle" : "footprint", x,
                         span(entry));
  }
  return "";
}

Violation Referee::to_violation(const Protocol::Entry& entry) const {
  std::vector<std::string> agents = {entry.rule == Rule::kAgentUnknown ? plan_.names[entry.subject]
                                                                       : agent(entry.subject).name};
  if (entry.rule == Rule::kRobotOverlap) agents.push_back(agent(entry.object).name);
  return {entry.rule, std::move(agents), entry.when, entry.amount, message(entry)};
}

}  // namespace

const char* to_string(Rule rule) {
  switch (rule) {
    case Rule::kAgentMissing:
      return "agent missing";
    case Rule::kAgentUnknown:
      return "agent unknown";
    case Rule::kNotFinite:
      return "not finite";
    case Rule::kStart:
      return "start";
    case Rule::kGoal:
      return "goal";
    case Rule::kArc:
      return "arc";
    case Rule::kCurvature:
      return "curvature";
    case Rule::kSpeed:
      return "speed";
    case Rule::kRobotOverlap:
      return "robot overlap";
    case Rule::kObstacleOverlap:
      return "obstacle overlap";
    case Rule::kBounds:
      return "bounds";
  }
  return "";
}

std::vector<Violation> find_violations(const Instance& instance, const Plan& plan,
                                       CollisionRule rule) {
  return Referee(instance, plan, rule).judge();
}

}  // namespace mvtp
