#include "coordinator/drivers/human_drivers.hpp"

#include <algorithm>

#include "coordinator/drivers/lane_keeping.hpp"
#include "coordinator/signals/phase_choice.hpp"
#include "planner/road.hpp"

namespace mvtp {
namespace {

constexpr double kKeepLane = 45.0;  ///< [m] before its line a driver keeps his lane

}  // namespace

HumanDrivers::HumanDrivers(Traffic& traffic, LaneKeeping& keeping, const LaneGraph& graph,
                           CorridorMap& corridors, Predictor& predictor,
                           const std::vector<bool>& coordinated, SignalHeads& heads,
                           const DecisionGrid& grid, KnownIntent intent, PlanOf plan_of)
    : traffic_(traffic),
      keeping_(keeping),
      graph_(graph),
      corridors_(corridors),
      predictor_(predictor),
      coordinated_(coordinated),
      grid_(grid),
      heads_(heads),
      intent_(intent),
      plan_of_(std::move(plan_of)) {
  if (!heads.timing().has_yellow) return;
  const auto is_controlled = [this](const std::string& id) { return plan_of_(id) != nullptr; };
  phases_ = std::make_unique<PhaseChoice>(traffic, graph, heads, is_controlled);
  if (phases_->phases().signals().empty()) phases_.reset();  // programs that nobody knows
}

HumanDrivers::~HumanDrivers() = default;

bool HumanDrivers::is_inside(int lane) const { return graph_.is_inside(lane, coordinated_); }

/// The connection by which it goes on to the next edge of its route: from its lane, if one leads
/// there, and onto a lane from which it can go on; LaneGraph::kNone: none.
int HumanDrivers::link_ahead(const CourseQuery& query) const {
  int best = LaneGraph::kNone;
  int most = -1;
  for (const int lane : graph_.lanes_of(query.edges[0])) {
    for (const int k : graph_.links_between(lane, query.edges[1])) {
      const bool leads_on = query.edges.size() < 3 ||
                            !graph_.links_between(graph_.link(k).to, query.edges[2]).empty();
      const int worth = (lane == query.lane ? 2 : 0) + (leads_on ? 1 : 0);
      if (worth > most) best = k;
      most = std::max(most, worth);
    }
  }
  return best;
}

/// As it will be on the last edge before its line, from where it is on its route now. Whose lane
/// does not lead there changes to one that does.
CourseQuery HumanDrivers::before_line(const CourseQuery& query) const {
  CourseQuery there = query;
  if (is_inside(query.lane)) return there;
  if (graph_.edge_of(query.lane) == LaneGraph::kNone) {
    there.lane = graph_.link(graph_.links_over(query.lane).front()).to;
    there.edges = there.edges.subspan(1);
  }
  while (there.edges.size() > 1 &&
         !coordinated_[std::size_t(graph_.junction_behind(there.edges[0]))]) {
    const int link = link_ahead(there);
    if (link == LaneGraph::kNone) break;
    there.lane = graph_.link(link).to;
    there.edges = there.edges.subspan(1);
  }
  return there;
}

/// The connections by which it may go on from its lane, as far as that is known.
std::vector<int> HumanDrivers::links_of(const CourseQuery& query) const {
  if (query.edges.size() < 2 || graph_.edge_of(query.lane) == LaneGraph::kNone) return {};
  if (intent_ == KnownIntent::kRoute) return graph_.links_between(query.lane, query.edges[1]);
  const std::span<const int> links = graph_.links_from(query.lane);
  return {links.begin(), links.end()};
}

/// The connections in question by which it may go on: those of its lane; and while it may change
/// lanes, one to each edge to which only others lead. Inside the junction it shows.
std::vector<int> HumanDrivers::links_in_question(const CourseQuery& query, double to_line) const {
  const int edge = graph_.edge_of(query.lane);
  if (intent_ == KnownIntent::kRoute || edge == LaneGraph::kNone) return {};
  const std::span<const int> own = graph_.links_from(query.lane);
  std::vector<int> links(own.begin(), own.end());
  if (intent_ != KnownIntent::kNone || to_line < kKeepLane) return links;
  const auto edge_behind = [&](int k) { return graph_.edge_of(graph_.link(k).to); };
  for (const int lane : graph_.lanes_of(edge)) {
    if (lane == query.lane) continue;
    for (const int k : graph_.links_from(lane)) {
      const bool is_known = std::ranges::count(links, edge_behind(k), edge_behind) > 0;
      if (!is_known) links.push_back(k);
    }
  }
  return links;
}

/// What it may drive: its route, or each movement that is in question. None if it is on no
/// corridor.
std::vector<HumanDrivers::Movement> HumanDrivers::movements_of(const VehicleState& v,
                                                               const CourseQuery& query,
                                                               double to_line,
                                                               const VehicleType& type) const {
  std::vector<Movement> movements;
  const auto add = [&](const CourseQuery& along, std::vector<int> links) {
    const std::optional<Predictor::Placed> placed = predictor_.place(v, along, type.body);
    if (!placed) return;
    Movement& movement = movements.emplace_back();
    movement.links = std::move(links);
    movement.corridor = placed->corridor;
    set_driver(movement, placed->road, to_line, v, type);
  };
  for (const int k : links_in_question(query, to_line)) {
    const LaneGraph::Link& link = graph_.link(k);
    const bool is_own = link.from == query.lane;
    const std::vector<int> edges = {graph_.edge_of(query.lane), graph_.edge_of(link.to)};
    add({.lane = query.lane,
         .position = query.position,
         .edges = edges,
         .length = query.length,
         .vehicle_class = query.vehicle_class,
         .previous_lane = query.previous_lane,
         .next_lane = is_own ? link.to : LaneGraph::kNone},
        is_own ? std::vector<int>{k} : std::vector<int>());
  }
  if (!movements.empty()) return movements;
  add(query, {});
  return movements;
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
  if (phases_) phases_->decide();
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
  const bool inside = is_inside(query.lane);
  const CourseQuery at_line = before_line(query);
  const bool is_there = inside || at_line.lane == query.lane;
  // Where it goes from another edge is known only if its route is.
  if (!is_there && intent_ != KnownIntent::kRoute) return;
  std::vector<Movement> movements = movements_of(v, query, inside ? 0.0 : to_line, type);
  if (movements.empty()) return;
  const auto [found, is_new] = agents_.try_emplace(v.id);
  Agent& agent = found->second;
  if (is_new) agent.came = step_;
  const Pose front = compose(v.pose, {type.body.front, 0.0, 0.0});
  if (!is_new) check_tube(agent, front);
  const std::vector<int> links = links_of(at_line);
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
  if (inside && intent_ != KnownIntent::kRoute) {
    const std::span<const int> over = graph_.links_over(query.lane);
    std::erase_if(agent.links, [&](int k) { return std::ranges::count(over, k) == 0; });
  }
  agent.to_line = inside ? 0.0 : to_line;
  agent.position = v.lane_position;
  agent.speed = v.speed;
  agent.pose = v.pose;
  agent.front = front;
  agent.length = type.body.length();
  agent.inside = inside;
  agent.granted |= inside;
  agent.seen = true;
  agent.movements = std::move(movements);
  if (agent.movements.size() == 1) agent.movements.front().links = agent.links;
  if (inside) return;
  if (!agent.granted) {
    const double wanted = SpeedEnvelope(agent.driver().limits, 1e9).at(agent.driver().road.now.s);
    agent.waited += grid_.decision() * std::max(0.0, 1.0 - v.speed / std::max(0.1, wanted));
  }
  keeping_.keep(v.id, LaneKeeping::Reason::kSignal,
                is_there && !agent.links.empty() && to_line < kKeepLane);
}

/// What bounds its motion, and where its tail is clear of the junction.
void HumanDrivers::set_driver(Movement& movement, const RoadVehicle& road, double to_line,
                              const VehicleState& v, const VehicleType& type) const {
  const Corridor& corridor = corridors_[movement.corridor];
  movement.driver = {.road = road,
                     .limits = corridor.lane_limits,
                     .max_accel = type.body.max_accel,
                     .max_decel = type.body.max_decel,
                     .line = road.now.s + to_line};
  movement.driver.road.min_gap = type.min_gap;
  movement.driver.road.tau = type.tau;
  for (double& limit : movement.driver.limits) {
    limit = std::min({limit * v.speed_factor, type.body.max_speed, v.top_speed});
  }
  const std::vector<CorridorPiece>& pieces = corridor.course.pieces;
  const auto is_inside = [&](std::size_t i) {
    return graph_.edge_of(pieces[i].lane) == LaneGraph::kNone;
  };
  for (std::size_t i = 1; i < pieces.size(); ++i) {
    const bool waits_there = is_inside(i - 1) && is_inside(i);
    if (waits_there) movement.driver.waiting_places.push_back(corridor.stations[i]);
  }
  movement.s_clear = movement.driver.line;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (is_inside(i) || corridor.stations[i] < movement.driver.line - 0.1) continue;
    movement.s_clear = corridor.stations[i] + type.body.length();
    break;
  }
}

void HumanDrivers::end() {
  for (auto it = agents_.begin(); it != agents_.end();) {
    if (!it->second.seen) drop(it->second);
    it = it->second.seen ? std::next(it) : agents_.erase(it);
  }
  predict_all();
  for (auto& [id, agent] : agents_) {
    const double needs = braking_gap(agent.speed, agent.driver().max_decel, grid_.dt);
    // Whose lane does not lead on stops at its end, however hard.
    if (agent.granted || agent.links.empty() || needs <= agent.to_line) continue;
    agent.granted = true;  // it cannot stop any more, whatever it is shown
    ++unplanned_;
  }
  take_back_greens();
}

bool HumanDrivers::passes(const std::string& id) const {
  const auto agent = agents_.find(id);
  return agent != agents_.end() && agent->second.granted;
}

std::vector<Forecast> HumanDrivers::passages(const std::string& id) const {
  std::vector<Forecast> all;
  const auto agent = agents_.find(id);
  if (agent == agents_.end()) return all;
  for (const Movement& movement : agent->second.movements) all.push_back(movement.forecast);
  return all;
}

void HumanDrivers::drop(const Agent& agent) {
  traffic_.rely_on_signal(agent.id, {});
  keeping_.keep(agent.id, LaneKeeping::Reason::kSignal, false);
}

void HumanDrivers::release_all() {
  for (const auto& [id, agent] : agents_) {
    // Whoever has green goes on as planned.
    if (!agent.granted) traffic_.rely_on_signal(id, {});
    keeping_.keep(id, LaneKeeping::Reason::kSignal, false);
  }
  agents_.clear();
}

}  // namespace mvtp
