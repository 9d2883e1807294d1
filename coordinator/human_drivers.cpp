#include "coordinator/human_drivers.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "planner/motion/inertial_car.hpp"
#include "planner/road/whole_trajectory.hpp"

namespace mvtp {
namespace {

constexpr double kMiss = 0.2;  ///< [m] outside its tube that count
/// [s] that new plans keep ahead of a driver: two decisions, since one surprise must not break a
/// plan before the next is made.
constexpr double kSlackBefore = 1.0;
constexpr double kSlackBehind = 0.5;  ///< [s] and behind him: one decision
constexpr double kLeaders = 80.0;     ///< [m] ahead in which others are followed
constexpr double kKeepLane = 45.0;    ///< [m] before its line a driver keeps his lane

double way(const PathTrajectory& t, std::int64_t k) {
  return std::min(t.at(k).s, t.states.back().s) - t.states.front().s;
}

}  // namespace

HumanDrivers::HumanDrivers(Traffic& traffic, const LaneGraph& graph, CorridorMap& corridors,
                           Predictor& predictor, const std::vector<bool>& coordinated,
                           SignalHeads& heads, const DecisionGrid& grid, PlanOf plan_of)
    : traffic_(traffic),
      graph_(graph),
      corridors_(corridors),
      predictor_(predictor),
      coordinated_(coordinated),
      grid_(grid),
      heads_(heads),
      plan_of_(std::move(plan_of)) {}

/// The connections from its lane to the next edge of its route.
std::vector<int> HumanDrivers::links_of(const CourseQuery& query) const {
  std::vector<int> links;
  if (query.edges.size() < 2 || graph_.edge_of(query.lane) == LaneGraph::kNone) return links;
  for (const int k : graph_.links_from(query.lane)) {
    if (graph_.edge_of(graph_.link(k).to) == query.edges[1]) links.push_back(k);
  }
  return links;
}

bool HumanDrivers::decides_for(const CourseQuery& query) const {
  const bool inside = graph_.edge_of(query.lane) == LaneGraph::kNone;
  if (!heads_.owns_any()) return false;
  for (const int edge : query.edges.subspan(std::min<std::size_t>(inside, query.edges.size()))) {
    const int junction = graph_.junction_behind(edge);
    if (junction == LaneGraph::kNone) return false;
    if (!coordinated_[std::size_t(junction)]) continue;
    return std::ranges::any_of(graph_.lanes_of(edge), [&](int lane) {
      return std::ranges::any_of(graph_.links_from(lane), [&](int k) { return heads_.owns(k); });
    });
  }
  return false;
}

void HumanDrivers::begin(std::int64_t step) {
  step_ = step;
  for (auto& [id, agent] : agents_) agent.seen = false;
  remember_lanes();
}

/// From which lane everybody comes.
void HumanDrivers::remember_lanes() {
  std::map<std::string, std::string> origins;
  for (const VehicleState& v : traffic_.vehicles()) {
    const int lane = graph_.find_lane(v.lane);
    const bool inside = lane == LaneGraph::kNone || graph_.edge_of(lane) == LaneGraph::kNone;
    const auto known = origins_.find(v.id);
    origins[v.id] = inside && known != origins_.end() ? known->second : v.lane;
  }
  origins_ = std::move(origins);
}

void HumanDrivers::see(const VehicleState& v, const CourseQuery& query, double to_line,
                       const VehicleType& type) {
  const int edge = graph_.edge_of(query.lane);
  const bool inside = edge == LaneGraph::kNone;
  if (!inside && !coordinated_[std::size_t(graph_.junction_behind(edge))]) return;
  const std::optional<Predictor::Placed> placed = predictor_.place(v, query, type.body);
  if (!placed) return;
  const auto [found, is_new] = agents_.try_emplace(v.id);
  Agent& agent = found->second;
  if (is_new) agent.came = step_;
  if (!is_new) check_tube(agent, v.pose);
  const std::vector<int> links = links_of(query);
  const bool turned = !is_new && !inside && !agent.inside && links != agent.links;
  const bool next_line = agent.inside && !inside;
  if (turned || next_line) {
    if (agent.granted) drop(agent);
    agent.granted = false;
    agent.came = next_line ? step_ : agent.came;
  }
  agent.id = v.id;
  agent.lane = v.lane;
  if (!inside) agent.links = links;
  agent.to_line = inside ? 0.0 : to_line;
  agent.position = v.lane_position;
  agent.speed = v.speed;
  agent.pose = v.pose;
  agent.length = type.body.length();
  agent.inside = inside;
  agent.granted |= inside;
  agent.seen = true;
  agent.corridor = placed->corridor;
  set_driver(agent, placed->road, v.speed_factor, type);
  if (inside) return;
  if (!agent.granted) {
    const double wanted = SpeedEnvelope(agent.driver.limits, 1e9).at(placed->road.now.s);
    agent.waited += grid_.decision() * std::max(0.0, 1.0 - v.speed / std::max(0.1, wanted));
  }
  traffic_.keep_lane(v.id, !agent.links.empty() && to_line < kKeepLane);
}

/// What bounds its motion, and where its tail is clear of the junction.
void HumanDrivers::set_driver(Agent& agent, const RoadVehicle& road, double speed_factor,
                              const VehicleType& type) const {
  const Corridor& corridor = corridors_[agent.corridor];
  agent.driver = {.road = road,
                  .limits = corridor.lane_limits,
                  .max_accel = type.body.max_accel,
                  .max_decel = type.body.max_decel,
                  .line = road.now.s + agent.to_line};
  agent.driver.road.min_gap = type.min_gap;
  agent.driver.road.tau = type.tau;
  for (double& limit : agent.driver.limits) {
    limit = std::min(limit * speed_factor, type.body.max_speed);
  }
  agent.s_clear = agent.driver.line;
  for (std::size_t i = 0; i < corridor.course.pieces.size(); ++i) {
    const bool normal = graph_.edge_of(corridor.course.pieces[i].lane) != LaneGraph::kNone;
    if (!normal || corridor.stations[i] < agent.driver.line - 0.1) continue;
    agent.s_clear = corridor.stations[i] + agent.length;
    break;
  }
}

/// Did it stay inside what was expected of it at the last decision?
void HumanDrivers::check_tube(Agent& agent, const Pose& pose) {
  if (!agent.expected || !agent.granted) return;
  const double moved = std::hypot(pose.x - agent.pose.x, pose.y - agent.pose.y);
  const auto [least, most] = *agent.expected;
  if (moved < least - kMiss || moved > most + kMiss) ++tube_misses_;
  agent.expected.reset();
}

void HumanDrivers::end() {
  for (auto it = agents_.begin(); it != agents_.end();) {
    if (!it->second.seen) drop(it->second);
    it = it->second.seen ? std::next(it) : agents_.erase(it);
  }
  predict_all();
  for (auto& [id, agent] : agents_) {
    const double needs = stopping_distance(agent.speed, agent.driver.max_decel);
    if (agent.granted || needs <= agent.to_line) continue;
    agent.granted = true;  // it cannot stop any more, whatever it is shown
    ++unplanned_;
  }
}

/// Those ahead first: whoever follows is bounded by what they do.
void HumanDrivers::predict_all() {
  std::vector<Agent*> order;
  for (auto& [id, agent] : agents_) order.push_back(&agent);
  std::ranges::stable_sort(
      order, {}, [](const Agent* a) { return a->inside ? -1e3 - a->position : a->to_line; });
  for (Agent* agent : order) agent->forecast = {};
  for (Agent* agent : order) predict(*agent);
}

void HumanDrivers::predict(Agent& agent) {
  Tube tube = predict_tube(agent.driver, leaders_of(agent), grid_, step_);
  const std::int64_t next = step_ + grid_.steps_per_decision;
  agent.expected = {way(tube.latest, next), way(tube.earliest, next)};
  agent.forecast = {.vehicle = agent.driver.road,
                    .trajectory = std::move(tube.earliest),
                    .latest = std::move(tube.latest),
                    .yields = false,
                    .relies = true,
                    .slack_before = slack_before(),
                    .slack_behind = slack_behind()};
}

int HumanDrivers::slack_before() const { return int(std::lround(kSlackBefore / grid_.dt)); }
int HumanDrivers::slack_behind() const { return int(std::lround(kSlackBehind / grid_.dt)); }

/// How far the front bumper of another vehicle is ahead of that of a driver, if he follows it [m]:
/// on the lanes that he drives, or beside them on another way from his lane.
std::optional<double> HumanDrivers::lead_of(const Agent& agent, const VehicleState& v) const {
  const int lane = graph_.find_lane(v.lane);
  if (lane == LaneGraph::kNone) return std::nullopt;
  const double front = agent.driver.road.now.s;  // stations are those of its rear axle
  if (const auto s = corridors_[agent.corridor].station(lane, v.lane_position, front)) {
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
  const bool is_clear = behind_line > length_of(v.type) + agent.driver.road.min_gap;
  return is_clear ? std::nullopt : std::optional(agent.to_line + behind_line);
}

std::vector<TubeLeader> HumanDrivers::leaders_of(const Agent& agent) const {
  std::vector<TubeLeader> leaders;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (v.id == agent.id || distance(v.pose, agent.pose) > kLeaders) continue;
    const std::optional<double> lead = lead_of(agent, v);
    if (!lead) continue;
    const double length = length_of(v.type);
    TubeLeader leader{.gap = *lead - length, .speed = v.speed};
    // Where it turns elsewhere it is followed until its tail has left the common lane.
    const int lane = graph_.find_lane(v.lane);
    const bool inside = graph_.edge_of(lane) == LaneGraph::kNone;
    const double to_clear = agent.to_line + length + agent.driver.road.min_gap - *lead;
    const auto other = agents_.find(v.id);
    const bool parts = other != agents_.end() && other->second.links != agent.links;
    if (parts && (!inside || !agent.inside)) leader.until = std::max(0.0, to_clear);
    if (other != agents_.end()) {
      if (!other->second.forecast.latest) continue;
      leader.earliest = &other->second.forecast.trajectory;
      leader.latest = &*other->second.forecast.latest;
    } else if (const PathTrajectory* plan = plan_of_(v.id)) {
      leader.latest = plan;  // a new plan may be faster
    }
    leaders.push_back(leader);
  }
  return leaders;
}

bool HumanDrivers::passes(const std::string& id) const {
  const auto agent = agents_.find(id);
  return agent != agents_.end() && agent->second.granted;
}

const Forecast* HumanDrivers::passage(const std::string& id) const {
  const auto agent = agents_.find(id);
  return agent == agents_.end() ? nullptr : &agent->second.forecast;
}

/// Would it begin to brake for red before the next decision?
bool HumanDrivers::is_due(const Agent& agent) const {
  const double brakes_at =
      stopping_distance(agent.speed, agent.driver.max_decel) + agent.driver.road.tau * agent.speed;
  return agent.to_line <= brakes_at + agent.speed * grid_.decision() + agent.driver.road.min_gap;
}

/// Is nobody ahead of it in its lane but drivers who have green?
bool HumanDrivers::is_first(const Agent& agent) const {
  return std::ranges::none_of(traffic_.vehicles(), [&](const VehicleState& v) {
    return v.lane == agent.lane && v.lane_position > agent.position && !passes(v.id);
  });
}

bool HumanDrivers::may_have_green(const Agent& agent) const {
  return std::ranges::all_of(agent.links, [&](int k) {
    if (!heads_.owns(k)) return false;
    if (heads_.light(k) == Light::kYellow || heads_.is_called_before(k, agent.came)) return false;
    if (heads_.light(k) == Light::kGreen) return heads_.shown_for(k) < heads_.timing().most_green;
    return heads_.may_turn_green(k);
  });
}

/// Is there room for it behind the junction, should everybody there stop?
bool HumanDrivers::has_room_behind(const Agent& agent) const {
  const Corridor& corridor = corridors_[agent.corridor];
  const double gap = agent.driver.road.min_gap;
  double needed = agent.s_clear + gap;
  for (const auto& [id, other] : agents_) {
    const bool shares = other.granted && other.id != agent.id && other.links == agent.links;
    if (shares) needed += other.length + gap;
  }
  return std::ranges::none_of(traffic_.vehicles(), [&](const VehicleState& v) {
    if (distance(v.pose, agent.pose) > 2.0 * kLeaders || passes(v.id)) return false;
    const int lane = graph_.find_lane(v.lane);
    if (lane == LaneGraph::kNone || graph_.edge_of(lane) == LaneGraph::kNone) return false;
    const std::optional<double> s = corridor.station(lane, v.lane_position, agent.s_clear);
    if (!s || *s < agent.s_clear - agent.length) return false;
    const double rest = *s - length_of(v.type) + stopping_distance(v.speed, agent.driver.max_decel);
    return rest < needed;
  });
}

bool HumanDrivers::come_from_one_lane(const Agent& a, const Agent& b) const {
  return !a.links.empty() && !b.links.empty() &&
         graph_.link(a.links.front()).from == graph_.link(b.links.front()).from;
}

bool HumanDrivers::may_meet(const Agent& a, const Agent& b) const {
  if (come_from_one_lane(a, b)) return false;
  const int path_a = a.forecast.vehicle.path;
  const int path_b = b.forecast.vehicle.path;
  return mvtp::may_meet(corridors_.library().contacts(path_a, path_b), tube_of(a), a.s_clear,
                        tube_of(b), b.s_clear, step_);
}

/// Where will it be when its light turns yellow in so many seconds, and can it stop then?
bool HumanDrivers::can_stop_after(const Agent& agent, double seconds) const {
  const auto steps = std::int64_t(std::ceil(seconds / grid_.dt));
  const InertialState then = agent.forecast.trajectory.at(step_ + steps);
  return then.s + stopping_distance(then.v, agent.driver.max_decel) + then.v * grid_.dt <
         agent.driver.line;
}

/// When it is over its line at the latest, from now on [s].
double HumanDrivers::latest_at_line(const Agent& agent) const {
  const PathTrajectory& latest = *agent.forecast.latest;
  const std::int64_t over = arrival_step(latest, agent.driver.line);
  return double(over - step_) * grid_.dt;
}

/// Those who pass if the first gets green: it and whoever follows it so closely that he could not
/// stop when the light turns yellow at the earliest.
std::vector<const HumanDrivers::Agent*> HumanDrivers::with_followers(const Agent& first) const {
  std::vector<const Agent*> group = {&first};
  std::vector<std::pair<double, const Agent*>> behind;  // nullptr: no agent
  for (const VehicleState& v : traffic_.vehicles()) {
    if (v.lane != first.lane || v.lane_position >= first.position) continue;
    const auto agent = agents_.find(v.id);
    behind.emplace_back(-v.lane_position, agent == agents_.end() ? nullptr : &agent->second);
  }
  std::ranges::sort(behind);
  double green = std::max(heads_.timing().least_green, latest_at_line(first));
  for (const auto& [place, agent] : behind) {
    // Whoever turns elsewhere stands at red, and all behind it.
    const bool goes_along = agent != nullptr && !agent->granted && agent->links == first.links;
    if (!goes_along || can_stop_after(*agent, green)) break;
    group.push_back(agent);
    green = std::max(green, latest_at_line(*agent));
  }
  return group;
}

std::vector<std::vector<std::string>> HumanDrivers::propose() {
  std::vector<const Agent*> candidates;
  std::vector<const Agent*> passing;
  for (const auto& [id, agent] : agents_) {
    if (agent.granted) {
      passing.push_back(&agent);
    } else if (!agent.inside && !agent.links.empty() && is_due(agent) && is_first(agent) &&
               may_have_green(agent) && has_room_behind(agent)) {
      candidates.push_back(&agent);
    }
  }
  // Greens that are shown already go on first; then whoever came first.
  std::ranges::stable_sort(candidates, {}, [&](const Agent* a) {
    return std::pair(heads_.light(a->links.front()) != Light::kGreen, a->came);
  });
  std::vector<std::vector<std::string>> proposals;
  for (const Agent* first : candidates) {
    const std::vector<const Agent*> group = with_followers(*first);
    const bool clear = std::ranges::all_of(group, [&](const Agent* a) {
      return std::ranges::none_of(passing, [&](const Agent* p) {
        return (!p->granted && cross(*a, *p)) || may_meet(*a, *p);
      });
    });
    if (!clear) continue;
    std::vector<std::string>& ids = proposals.emplace_back();
    for (const Agent* a : group) ids.push_back(a->id);
    passing.insert(passing.end(), group.begin(), group.end());
  }
  return proposals;
}

/// Would their lights exclude each other? Two who get green at once may not cross at all.
bool HumanDrivers::cross(const Agent& a, const Agent& b) const {
  return std::ranges::any_of(a.links, [&](int k) {
    return std::ranges::any_of(b.links, [&](int l) { return heads_.cross(k, l); });
  });
}

bool HumanDrivers::is_crossed_by(const std::string& id, int light) const {
  return std::ranges::any_of(agents_.at(id).links, [&](int k) { return heads_.cross(k, light); });
}

void HumanDrivers::grant(const std::string& id) {
  Agent& agent = agents_.at(id);
  agent.granted = true;
  for (const int k : agent.links) heads_.turn_green(k);
}

double HumanDrivers::worth(const std::vector<std::string>& ids) const {
  double worth = 0.0;
  for (const std::string& id : ids) {
    const auto found = agents_.find(id);
    if (found == agents_.end()) continue;
    const Agent& agent = found->second;
    worth += agent.waited + 0.5 * agent.speed / agent.driver.max_decel +
             0.5 * agent.speed / agent.driver.max_accel;
  }
  return worth;
}

bool HumanDrivers::may_meet(const std::vector<std::string>& ids, int path,
                            const PathTrajectory& plan) const {
  return std::ranges::any_of(ids, [&](const std::string& id) {
    const auto found = agents_.find(id);
    if (found == agents_.end()) return false;
    const Agent& agent = found->second;
    const ContactTable& contacts = corridors_.library().contacts(agent.forecast.vehicle.path, path);
    return mvtp::may_meet(contacts, tube_of(agent), agent.s_clear, {plan, plan},
                          PathTrajectory::kGone / 2.0, step_, slack_before(), slack_behind());
  });
}

/// Vehicles near that come from elsewhere: they have no green, or plans around him.
std::vector<std::string> HumanDrivers::who_waits_for(const Agent& agent) const {
  std::vector<std::string> ids;
  const auto own = origins_.find(agent.id);
  for (const VehicleState& v : traffic_.vehicles()) {
    if (v.id == agent.id || distance(v.pose, agent.pose) > 2.0 * kLeaders) continue;
    const auto origin = origins_.find(v.id);
    const bool same =
        origin != origins_.end() && own != origins_.end() && origin->second == own->second;
    if (!same) ids.push_back(v.id);
  }
  return ids;
}

/// Is there a driver without a planned passage who could not stop any more at the next decision?
/// Behind a vehicle under control there may be: a green is shorter then than it should be.
bool HumanDrivers::must_end(int link) const {
  return std::ranges::any_of(agents_, [&](const auto& entry) {
    const Agent& agent = entry.second;
    return !agent.granted && std::ranges::count(agent.links, link) > 0 &&
           !can_stop_after(agent, grid_.decision());
  });
}

void HumanDrivers::settle() {
  for (const auto& [id, agent] : agents_) {
    if (agent.granted) traffic_.rely_on_signal(id, who_waits_for(agent));
  }
  std::set<int> needed;
  for (const auto& [id, agent] : agents_) {
    if (agent.granted && !agent.inside) needed.insert(agent.links.begin(), agent.links.end());
  }
  for (int k = 0; k < graph_.links(); ++k) {
    if (!heads_.owns(k) || heads_.light(k) != Light::kGreen || needed.contains(k)) continue;
    const bool is_over = heads_.shown_for(k) >= heads_.timing().least_green - 1e-6;
    if (is_over || must_end(k)) heads_.end_green(k);
  }
}

double HumanDrivers::length_of(const std::string& type) const {
  const auto known = lengths_.find(type);
  if (known != lengths_.end()) return known->second;
  return lengths_[type] = traffic_.type(type).body.length();
}

void HumanDrivers::drop(const Agent& agent) {
  traffic_.rely_on_signal(agent.id, {});
  traffic_.keep_lane(agent.id, false);
}

void HumanDrivers::release_all() {
  for (const auto& [id, agent] : agents_) {
    if (!agent.granted) drop(agent);  // whoever has green goes on as planned
  }
  agents_.clear();
}

}  // namespace mvtp
