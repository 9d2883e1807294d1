// What human drivers at signals may do: their tubes.

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/signals/phase_choice.hpp"
#include "planner/road.hpp"

namespace mvtp {
namespace {

constexpr double kMiss = 0.2;      ///< [m] outside its tube that count
constexpr double kLeaders = 80.0;  ///< [m] ahead in which others are followed
/// [s] that new plans keep ahead of a driver: two decisions, since one surprise must not break a
/// plan before the next is made.
constexpr double kSlackBefore = 1.0;
constexpr double kSlackBehind = 0.5;  ///< [s] and behind him: one decision
constexpr double kWhile = 5.0;        ///< [s] in which movements are compared
constexpr double kLateYield = 1.0;    ///< [s] until one who has yielded goes on
constexpr double kSorting = 4.0;      ///< [s] that two need who yield to each other

double station(const SpeedProfile& t, std::int64_t k) {
  return std::min(t.at(k).s, t.states.back().s) - t.states.front().s;
}

}  // namespace

/// Did it stay inside what was expected of it at the last decision?
void HumanDrivers::check_tube(Agent& agent, const Pose& front) {
  if (!agent.expected || !agent.granted) return;
  const double moved = distance(front, agent.front);
  const auto [least, most] = *agent.expected;
  if (moved < least - kMiss || moved > most + kMiss) ++tube_misses_;
  agent.expected.reset();
}

/// Those ahead first: whoever follows is bounded by what they do.
void HumanDrivers::predict_all() {
  std::vector<Agent*> order;
  for (auto& [id, agent] : agents_) order.push_back(&agent);
  std::ranges::stable_sort(
      order, {}, [](const Agent* a) { return a->inside ? -1e3 - a->position : a->to_line; });
  for (Agent* agent : order) {
    for (Movement& movement : agent->movements) movement.forecast = {};
  }
  for (Agent* agent : order) predict(*agent);
  if (!phases_) return;
  std::vector<std::int64_t> until;
  for (const Agent* agent : order) {
    for (const Movement& movement : agent->movements)
      until.push_back(yields_until(*agent, movement));
  }
  auto next = until.begin();
  for (Agent* agent : order) {
    for (Movement& movement : agent->movements) movement.driver.yields_until = *next++;
  }
  for (Agent* agent : order) predict(*agent);
}

bool HumanDrivers::yields_to(const std::vector<int>& links, const std::vector<int>& others) const {
  return phases_ && std::ranges::any_of(links, [&](int k) {
           return std::ranges::any_of(others,
                                      [&](int l) { return phases_->phases().yields_to(k, l); });
         });
}

bool HumanDrivers::let_each_other_pass(const Agent& a, const Agent& b) const {
  return yields_to(a.links, b.links) || yields_to(b.links, a.links);
}

/// Has it green, or comes to one? Nobody comes from behind a vehicle under control that waits.
bool HumanDrivers::may_come(const Agent& agent) const {
  return agent.granted || (is_shown_green(agent) && !is_behind_one_who_waits(agent));
}

/// Does it wait for the other one, if it has to yield to him?
bool HumanDrivers::awaits(const Agent& agent, const Agent& other) const {
  return !agent.goes_before.contains(other.id) && may_come(other);
}

/// Inside the junction it goes before those for whom it does not wait, also if they come after all.
void HumanDrivers::pass_before_who_waits(Agent& agent) const {
  if (!agent.inside) return agent.goes_before.clear();
  for (const auto& [id, other] : agents_) {
    if (yields_to(agent.links, other.links) && !awaits(agent, other)) agent.goes_before.insert(id);
  }
}

/// The step until which it may have to wait for others; -1: for nobody. It waits for those to whom
/// it yields. Those who yield to it may turn before it all the same, where their tubes meet: SUMO's
/// drivers do so where a vehicle comes slowly, and it has to brake for them.
std::int64_t HumanDrivers::yields_until(const Agent& agent, const Movement& movement) const {
  std::int64_t until = -1;
  const double here = movement.driver.road.now.s;
  if (here >= movement.s_clear) return until;
  for (const auto& [id, other] : agents_) {
    if (id == agent.id || !may_come(other)) continue;
    for (const Movement& theirs : other.movements) {
      const double there = theirs.driver.road.now.s;
      const bool they_yield = yields_to(theirs.links, movement.links);
      const bool waits = yields_to(movement.links, theirs.links) && awaits(agent, other);
      const bool may_be_cut_off = agent.granted && they_yield;
      if (there >= theirs.s_clear || !(waits || may_be_cut_off)) continue;
      const ContactTable& contacts =
          corridors_.library().contacts(movement.driver.road.path, theirs.driver.road.path);
      if (contacts.empty() || !contacts.meets(here, movement.s_clear, there, theirs.s_clear))
        continue;
      const bool is_free = !waits && !mvtp::may_meet(contacts, tube_of(movement), movement.s_clear,
                                                     tube_of(theirs), theirs.s_clear, step_);
      if (is_free) continue;
      const double late = kLateYield + (they_yield ? kSorting : 0.0);
      until = std::max(until, arrival_step(*theirs.forecast.latest, theirs.s_clear) +
                                  std::int64_t(std::lround(late / grid_.dt)));
    }
  }
  return until;
}

void HumanDrivers::predict(Agent& agent) {
  const std::int64_t next = step_ + grid_.steps_per_decision;
  agent.expected.reset();
  for (Movement& w : agent.movements) {
    Tube tube = predict_tube(w.driver, leaders_of(agent, w), grid_, step_);
    const auto [least, most] =
        agent.expected.value_or(std::pair(std::numeric_limits<double>::infinity(), 0.0));
    agent.expected = {std::min(least, station(tube.latest, next)),
                      std::max(most, station(tube.earliest, next))};
    w.forecast = {.vehicle = w.driver.road,
                  .earliest = std::move(tube.earliest),
                  .latest = std::move(tube.latest),
                  .yields = false,
                  .relies = true,
                  .slack_before = slack_before(),
                  .slack_behind = slack_behind()};
  }
}

/// Of the movements that it may drive, the motion that comes furthest in a while,
const SpeedProfile& HumanDrivers::fastest(const Agent& agent) const {
  const std::int64_t then = step_ + std::int64_t(kWhile / grid_.dt);
  const auto best = std::ranges::max_element(
      agent.movements, {}, [&](const Movement& w) { return station(w.forecast.earliest, then); });
  return best->forecast.earliest;
}

/// and the one that comes least far.
const SpeedProfile& HumanDrivers::slowest(const Agent& agent) const {
  const std::int64_t then = step_ + std::int64_t(kWhile / grid_.dt);
  const auto best = std::ranges::min_element(
      agent.movements, {}, [&](const Movement& w) { return station(*w.forecast.latest, then); });
  return *best->forecast.latest;
}

int HumanDrivers::slack_before() const { return int(std::lround(kSlackBefore / grid_.dt)); }
int HumanDrivers::slack_behind() const { return int(std::lround(kSlackBehind / grid_.dt)); }

/// How far the front bumper of another vehicle is ahead of that of a driver, if he follows it [m]:
/// on the lanes that he drives, or beside them on another movement from his lane.
std::optional<double> HumanDrivers::lead_of(const Agent& agent, const Movement& movement,
                                            const VehicleState& v) const {
  const int lane = graph_.find_lane(v.lane);
  if (lane == LaneGraph::kNone) return std::nullopt;
  const double front = movement.driver.road.now.s;  // stations are those of its rear axle
  if (const auto s = corridors_[movement.corridor].station(lane, v.lane_position, front)) {
    return *s > front ? std::optional(*s - front) : std::nullopt;
  }
  const auto origin = origins_.find(v.id);
  const bool turned = !agent.inside && graph_.edge_of(lane) == LaneGraph::kNone &&
                      origin != origins_.end() && origin->second == agent.lane;
  if (!turned) return std::nullopt;
  double behind_line = v.lane_position;
  const LaneGraph::Link& link = graph_.link(graph_.links_over(lane).front());
  for (const int via : link.via) {
    if (via == lane) break;
    behind_line += graph_.lane(via).length;
  }
  const bool is_clear = behind_line > length_of(v.type) + agent.driver().road.min_gap;
  return is_clear ? std::nullopt : std::optional(agent.to_line + behind_line);
}

/// Does a vehicle ahead, under control, go on by another edge?
bool HumanDrivers::turns_elsewhere(const Agent& agent, const VehicleState& leader) const {
  const std::span<const std::string> route = traffic_.route_edges(leader.id);
  return route.size() > 1 && !agent.links.empty() &&
         graph_.lane(graph_.link(agent.links.front()).to).edge != route[1];
}

std::vector<TubeLeader> HumanDrivers::leaders_of(const Agent& agent,
                                                 const Movement& movement) const {
  std::vector<TubeLeader> leaders;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (v.id == agent.id || distance(v.pose, agent.pose) > kLeaders) continue;
    const std::optional<double> lead = lead_of(agent, movement, v);
    if (!lead) continue;
    const double length = length_of(v.type);
    TubeLeader leader{.gap = *lead - length, .speed = v.speed};
    // Where it turns elsewhere it is followed until its tail has left the common lane.
    const int lane = graph_.find_lane(v.lane);
    const bool inside = graph_.edge_of(lane) == LaneGraph::kNone;
    const double to_clear = agent.to_line + length + agent.driver().road.min_gap - *lead;
    const auto other = agents_.find(v.id);
    const bool parts = other != agents_.end()
                           ? other->second.links != agent.links ||
                                 other->second.movements.size() > 1 || agent.movements.size() > 1
                           : turns_elsewhere(agent, v);
    if (parts && (!inside || !agent.inside)) leader.until = std::max(0.0, to_clear);
    if (other != agents_.end()) {
      if (!other->second.movements.back().forecast.latest) continue;
      leader.earliest = &fastest(other->second);
      leader.latest = &slowest(other->second);
    } else if (const SpeedProfile* plan = plan_of_(v.id)) {
      leader.latest = plan;  // a new plan may be faster
    }
    leaders.push_back(leader);
  }
  return leaders;
}

/// Between its latest and its earliest motion; as long as it waits, anywhere before its line.
ExpectedGround::Reach HumanDrivers::reach_of(const Agent& agent, const Movement& movement,
                                             const Pose& where, std::int64_t then) const {
  constexpr double kAround = 15.0;  // [m] that it has driven since the decision, at most
  const double at_decision = movement.driver.road.now.s;
  const ReferencePath& path = corridors_.library().path(movement.driver.road.path);
  const double here = path.project({where.x, where.y}, at_decision, at_decision + kAround);
  const double driven = here - at_decision;
  if (!agent.granted) return {0.0, std::max(0.0, movement.driver.line - here)};
  const double most = std::max(0.0, station(movement.forecast.earliest, then) - driven);
  return {std::clamp(station(*movement.forecast.latest, then) - driven, 0.0, most), most};
}

std::optional<ExpectedGround> HumanDrivers::ground_of(const std::string& id, const Pose& where,
                                                      std::int64_t step,
                                                      std::span<const int> later) const {
  const auto known = agents_.find(id);
  if (known == agents_.end() || step - step_ > grid_.steps_per_decision) return std::nullopt;
  const Agent& agent = known->second;
  ExpectedGround ground{.passes = agent.granted, .paths = {}, .reaches = {}};
  for (const Movement& m : agent.movements) ground.paths.push_back(m.driver.road.path);
  for (const int steps : later) {
    ExpectedGround::Reach all{.least = std::numeric_limits<double>::infinity()};
    for (const Movement& m : agent.movements) {
      const ExpectedGround::Reach reach = reach_of(agent, m, where, step + steps);
      all = {std::min(all.least, reach.least), std::max(all.most, reach.most)};
    }
    ground.reaches.push_back(all);
  }
  return ground;
}

double HumanDrivers::length_of(const std::string& type) const {
  const auto known = lengths_.find(type);
  if (known != lengths_.end()) return known->second;
  return lengths_[type] = traffic_.type(type).body.length();
}

}  // namespace mvtp
