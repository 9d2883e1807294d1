#include "planner/road/road_world.hpp"

#include <algorithm>
#include <memory>
#include <numeric>

namespace mvtp {

static_assert(GroupWorld<RoadWorld> && LocalWorld<RoadWorld>);

RoadStepWorld::RoadStepWorld(const RoadPairs& pairs, const JointPlan& complete,
                             const ProfileOptions& options, bool complete_plans)
    : pairs_(pairs), complete_(complete), options_(options), complete_plans_(complete_plans) {
  const std::size_t n = pairs.scene().vehicles.size();
  near_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (i != j && !pairs.between(i, j).contact->never()) near_[i].push_back(int(j));
    }
  }
}

namespace {

/// Could the vehicle stop before a line, but not any longer after this decision? Then it has to be
/// stopped.
bool runs_over_a_line(const RoadVehicle& v, const Vehicle& body, const InertialState& from,
                      const InertialState& to) {
  const auto line =
      std::ranges::lower_bound(v.stop_lines, from.s + stopping_distance(from.v, body.max_decel));
  return line != v.stop_lines.end() && to.s + stopping_distance(to.v, body.max_decel) > *line;
}

}  // namespace

std::vector<RoadStepWorld::Motion> RoadStepWorld::candidates(int i, const State& state) const {
  const RoadVehicle& v = vehicle(i);
  const Vehicle& body = scene().body(v);
  const double h = scene().grid.decision();
  const WaitTest wait(pairs_, v, complete_.entries, options_);
  const std::int64_t then = scene().step + scene().grid.steps_per_decision;
  const bool can_stop_before = wait.leaves_passages_free(then, safe_stop(i, state).to);
  std::vector<Motion> clear;
  std::vector<Motion> inside;  // clear, but where nobody is to come to rest
  std::vector<Motion> blocking;
  for (const double a :
       {body.max_accel, 0.5 * body.max_accel, 0.0, -0.5 * body.max_decel, -body.max_decel}) {
    const Motion m{state, a, advance(state, a, h)};
    if (a > -body.max_decel && m.to.v > v.envelope->at(m.to.s)) continue;
    if (a > -body.max_decel && complete_plans_ && runs_over_a_line(v, body, state, m.to)) continue;
    if (a > -body.max_decel && !wait.clear_of_forecasts(state, a, m.to)) continue;
    // Who stands where somebody passes who does not yield is run into; who cannot stop before it
    // drives on if that gets away from him.
    const auto is_safe_there = [&] {
      return can_stop_before ? wait.leaves_passages_free(then, m.to) : wait.gets_away(then, m.to);
    };
    if (a > -body.max_decel && !is_safe_there()) continue;
    const double rest = m.to.s + stopping_distance(m.to.v, body.max_decel);
    const bool keeps_clear =
        wait.stands_clear(then, m.to) &&
        (complete_plans_ ? is_clear_of_those_without_plan(i, rest) : is_clear_of_earlier(i, rest));
    const bool may_rest = !complete_plans_ || wait.can_wait(then, m.to);
    (!keeps_clear ? blocking : may_rest ? clear : inside).push_back(m);
  }
  clear.insert(clear.end(), inside.begin(), inside.end());
  clear.insert(clear.end(), blocking.begin(), blocking.end());
  return clear;
}

/// Does it rest off all that those of higher priority, but for its leaders, have still before
/// them? So no circle of vehicles waits for each other on a junction.
bool RoadStepWorld::is_clear_of_earlier(int i, double rest) const {
  for (const int j : near(i)) {
    if (j >= i || pairs_.leads(std::size_t(j), std::size_t(i))) continue;
    const RoadVehicle& other = vehicle(j);
    const ContactView contact = pairs_.between(std::size_t(i), std::size_t(j));
    if (contact.table().blocks(rest, other.now.s, other.s_end)) return false;
  }
  return true;
}

/// Does it rest off all that others without a plan have still before them, but for those whom it
/// blocks already? Two that creep on stand nose to nose for ever.
bool RoadStepWorld::is_clear_of_those_without_plan(int i, double rest) const {
  return std::ranges::none_of(near(i), [&](int j) {
    const RoadVehicle& other = vehicle(j);
    const bool is_blocked = pairs_.leads(std::size_t(i), std::size_t(j));
    if (is_blocked || complete_.find(other.key) != nullptr) return false;
    const ContactView contact = pairs_.between(std::size_t(i), std::size_t(j));
    return contact.table().blocks(rest, other.now.s, other.s_end);
  });
}

RoadStepWorld::Motion RoadStepWorld::safe_stop(int i, const State& state) const {
  const double b = scene().body(vehicle(i)).max_decel;
  return {state, -b, advance(state, -b, scene().grid.decision())};
}

bool RoadStepWorld::conflict(int i, const Motion& a, int j, const Motion& b) const {
  if (i > j) return conflict(j, b, i, a);
  const RoadContact& contact = *pairs_.between(std::size_t(i), std::size_t(j)).contact;
  const double reach_a = a.to.s + stopping_distance(a.to.v, scene().body(vehicle(i)).max_decel);
  const double reach_b = b.to.s + stopping_distance(b.to.v, scene().body(vehicle(j)).max_decel);
  if (!contact.seen_from_a().reaches(a.from.s, reach_a, b.from.s, reach_b)) return false;
  const double dt = scene().grid.dt;
  const bool lenient = contact.is_close(a.from, b.from);
  const auto position_a = [&](int k) { return advance(a.from, a.acceleration, k * dt).s; };
  const auto position_b = [&](int k) { return advance(b.from, b.acceleration, k * dt).s; };
  const int steps = scene().grid.steps_per_decision;
  const bool they_brake = lenient && a == safe_stop(i, a.from) && b == safe_stop(j, b.from);
  const bool touch = they_brake
                         ? contact.touch_though_they_brake(position_a, position_b, steps, lenient)
                         : contact.touch(position_a, position_b, steps, lenient);
  return touch || contact.touch_braking(a.to, b.to, lenient);
}

RoadWorld::RoadWorld(const RoadPairs& pairs, std::vector<std::int64_t> keys, JointPlan incumbent,
                     const RoadEscotOptions& options, std::uint64_t seed, WorkBudget work)
    : pairs_(pairs),
      keys_(std::move(keys)),
      incumbent_(std::move(incumbent)),
      options_(options),
      seed_(seed),
      work_(work),
      steps_(pairs, found_.plan, options.crossing.profile, options.plans_groups) {}

std::vector<RoadWorld::State> RoadWorld::states() const {
  std::vector<State> states;
  for (const RoadVehicle& v : scene().vehicles) states.push_back(v.now);
  return states;
}

std::vector<Group> RoadWorld::group_robots(const std::vector<State>& q) const {
  Group all(q.size());
  std::iota(all.begin(), all.end(), 0);
  return {all};
}

std::vector<int> RoadWorld::order(const std::vector<State>& q) const {
  std::vector<int> order(q.size());
  std::iota(order.begin(), order.end(), 0);
  return order;
}

std::vector<std::optional<RoadWorld::Motion>> RoadWorld::get_opt_traj(
    const std::vector<State>& /*q*/, const Group& group) {
  found_ = plan_crossing(pairs_, keys_, incumbent_, options_.crossing, seed_, work_);
  std::vector<std::optional<Motion>> motions;
  for (const int i : group) {
    const SpeedProfile* t = found_.plan.find(scene().vehicles[std::size_t(i)].key);
    motions.push_back(t != nullptr ? std::optional(first_motion(*t)) : std::nullopt);
  }
  return motions;
}

bool RoadWorld::keeps_plans(const std::vector<Motion>& motions) const {
  return std::ranges::all_of(found_.plan.entries, [&](const JointPlan::Entry& e) {
    return motions[pairs_.index(e.key)] == first_motion(*e.profile);
  });
}

RoadWorld::Motion RoadWorld::first_motion(const SpeedProfile& profile) const {
  const DecisionGrid& grid = scene().grid;
  const std::int64_t step = scene().step;
  const InertialState from = profile.at(step);
  // One that leaves within the decision counts as if it drove on at the same acceleration.
  const std::int64_t last =
      std::min(step + grid.steps_per_decision, std::max(step, profile.end() - 1));
  const InertialState to = profile.at(last);
  const double h = double(last - step) * grid.dt;
  const double a = h > 0.0 ? held_acceleration(from, to, h) : 0.0;
  return {from, a, advance(from, a, grid.decision())};
}

}  // namespace mvtp
