#include "coordinator/junctions/coordinator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/network/partition.hpp"
#include "planner/problem/draws.hpp"
#include "planner/road.hpp"

namespace mvtp {
namespace {

/// After so many refusals in a row a group gets its plan in spite of the referee: old plans end,
/// and whoever stands at the end of one blocks all others for good.
constexpr int kMostRefusals = 6;

}  // namespace

Coordinator::Coordinator(Traffic& traffic, const DrivableArea& area,
                         const CoordinatorOptions& options)
    : traffic_(traffic),
      options_(options),
      graph_(traffic.network()),
      coordinated_(select_junctions(graph_, options.junctions, options.corridors.chain)),
      finder_(graph_, coordinated_, options.corridors),
      corridors_(graph_, area, options.limits),
      area_(area),
      predictor_(graph_, finder_, corridors_),
      keeping_(traffic),
      gate_(traffic, keeping_,
            !options.greens && options.share.is_whole() ? Passage::kAll : Passage::kOneLine),
      straddling_(
          traffic, keeping_, graph_, [this](const std::string& id) { return poses_soon(id); },
          // Who is soon under control brakes at the last moment only.
          [this](const VehicleState& v) {
            const bool keeps_driver = !options_.share.contains(v.id, v.type) ||
                                      gate_.holds_guest(v.id) || gate_.passes(v.id);
            return keeps_driver ? type_of(v.type).tau : options_.decision;
          },
          [this](const std::string& type) -> const VehicleType& { return type_of(type); },
          [this](const std::string& id) { return came_from(id); }),
      exit_lanes_(
          traffic, keeping_, graph_, [this](const std::string& id) { return leaving(id); },
          [this](const std::string& type) -> const VehicleType& { return type_of(type); }),
      wrong_lanes_(traffic, graph_, [this](const std::string& id) { return drives(id); }) {
  find_zones();
  grid_.dt = traffic.step_length();
  grid_.steps_per_decision = std::max(1, int(std::lround(options.decision / grid_.dt)));
  if (options.greens) {
    greens_.emplace(traffic, graph_, finder_, corridors_, predictor_, grid_, *options.greens,
                    [this](const std::string& id) { return over_line(id); });
  }
  const bool owns_lights = !options.share.is_whole() && !greens_;
  if (!owns_lights && graph_.crossings() == 0) return;
  heads_.emplace(traffic, graph_, coordinated_, options.signals);
  if (graph_.crossings() > 0) {
    people_.emplace(traffic, graph_, corridors_.library(), *heads_, grid_);
  }
  if (!owns_lights) return;
  const auto plan_of = [this](const std::string& id) -> const SpeedProfile* {
    const auto driven = driven_.find(id);
    return driven == driven_.end() ? nullptr : plan_.find(driven->second.key);
  };
  humans_ = std::make_unique<HumanDrivers>(traffic, keeping_, graph_, corridors_, predictor_,
                                           coordinated_, *heads_, grid_, options.intent, plan_of);
}

Coordinator::~Coordinator() = default;

/// Where a plan has a vehicle at step k; at its end it stays.
InertialState Coordinator::state_at(const SpeedProfile& t, std::int64_t k) {
  return k < t.end() ? t.at(k) : t.states.back();
}

std::vector<ZoneFigures> Coordinator::zones() const {
  std::vector<ZoneFigures> zones;
  for (const ControlZone& zone : partition(graph_, coordinated_, options_.corridors.chain)) {
    ZoneFigures& figures = zones.emplace_back();
    for (const int j : zone.junctions) figures.junctions.push_back(graph_.junction(j).id);
    figures.corridors = zone.connections;
  }
  return zones;
}

std::vector<LeftToTraffic> Coordinator::left_to_sumo() const {
  std::vector<LeftToTraffic> left;
  for (const auto& [what, why] : undriven_) left.push_back({what, why});
  return left;
}

void Coordinator::decide() {
  taken_over_.clear();
  handed_back_.clear();
  forget_the_vanished();
  give_up_the_lost();
  follow_plans();
  if (greens_) greens_->observe();
  if (step_ % grid_.steps_per_decision == 0) {
    forget_corridors();
    remember_lanes();
    wrong_lanes_.look();
    predictor_.see(halted_queues());
    replan();
    if (owns_signals()) humans_->settle();
    if (greens_) greens_->settle();
  } else {
    static_cast<void>(leave_corridors(/*may_go_on=*/false));
    hold_departures();
    brake_for_surprises();
  }
}

void Coordinator::act() {
  place_all();
  straddling_.show();
  exit_lanes_.show();
  ++step_;
}

void Coordinator::follow_plans() {
  for (auto& [id, driven] : driven_) {
    driven.road.now = state_at(*plan_.find(driven.key), effective_step());
  }
}

/// Where its plan has the vehicle now.
InertialState Coordinator::here(const Driven& driven) const {
  return state_at(*plan_.find(driven.key), step_);
}

/// Of the moment when what is decided now takes effect.
RoadScene Coordinator::empty_scene() const {
  return {.library = &corridors_.library(),
          .grid = grid_,
          .step = effective_step(),
          .vehicles = {},
          .forecasts = {},
          .reaction = grid_.decision() + options_.tolerance.latency(grid_.dt)};
}

/// The traffic may take a vehicle off the road whenever it likes.
void Coordinator::forget_the_vanished() {
  std::erase_if(turned_away_,
                [&](const auto& entry) { return find_state(entry.first) == nullptr; });
  std::erase_if(driven_, [&](const auto& entry) {
    const auto& [id, driven] = entry;
    if (find_state(id) != nullptr && traffic_.is_taken_over(id)) return false;
    std::erase_if(plan_.entries, [&](const auto& e) { return e.key == driven.key; });
    return true;
  });
}

/// On large networks most corridors are driven once in a while: what nobody drives is found again.
void Coordinator::forget_corridors() {
  const auto kept = std::int64_t(std::lround(options_.corridors_kept / grid_.decision()));
  if (step_ / grid_.steps_per_decision % std::max<std::int64_t>(1, kept) != 0) return;
  for (const auto& [id, driven] : driven_) corridors_.use(driven.corridor);
  corridors_.forget_unused();
  predictor_.corridors_forgotten();
}

void Coordinator::replan() {
  notice_the_stuck();
  look_at_signals();
  std::map<std::string, Driven> arrivals = leave_corridors(/*may_go_on=*/true);
  const std::vector<Newcomer> newcomers = find_newcomers();
  if (planner_is_dead()) return hold_back(newcomers);
  if (newcomers.empty() && driven_.empty()) return admit_guests_freely();

  const auto begin = std::chrono::steady_clock::now();
  for (const Newcomer& n : newcomers) arrivals.emplace(n.state->id, admit(n, next_key_++));
  if (greens_) close_ground(arrivals);
  const std::vector<std::int64_t> upset = stagnating_groups();
  Trial trial = best_trial(arrivals, upset);
  Replan record{.time = traffic_.time(),
                .vehicles = int(driven_.size() + newcomers.size()),
                .newcomers = int(newcomers.size()),
                .forecasts = int(trial.forecasts.size()),
                .groups = trial.decision.groups,
                .stepped = trial.decision.stepped,
                .cost = trial.decision.cost};
  record.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  if (comes_late()) {
    trial.decision.late.resize(trial.decision.members.size());
    std::iota(trial.decision.late.begin(), trial.decision.late.end(), std::size_t{0});
  }
  trial.as_before = better_with_old_plans(trial, arrivals);
  record.fallback = !trial.decision.late.empty() || !trial.as_before.empty();
  replans_.push_back(record);
  accept(trial, arrivals);
}

/// How plans are made now. Where somebody was left without a plan, somebody mostly will be again,
/// whatever the work, and there will be further trials. With lights their costs are compared, which
/// takes as much work for each.
RoadEscotOptions Coordinator::escot() const {
  constexpr std::int64_t kLess = 8;
  RoadEscotOptions options = options_.escot;
  if (left_without_plan_ && !heads_) options.work /= kLess;
  if (traffic_.time() >= options_.budget_from) options.budget.ms = options_.replan_budget_ms;
  return options;
}

/// Makes a trial's plan what is executed, but for groups that are late, or whose vehicles would
/// touch and do better with their old plans: those go on as before, and the newcomers among them
/// are not taken over.
void Coordinator::accept(const Trial& trial, const std::map<std::string, Driven>& arrivals) {
  std::set<std::int64_t> keep;  // keys
  std::map<std::int64_t, int> refusals;
  for (std::size_t g = 0; g < trial.decision.members.size(); ++g) {
    const auto& members = trial.decision.members[g];
    const bool refused = std::ranges::binary_search(trial.as_before, g);
    int before = 0;
    for (const std::int64_t key : members) {
      const auto known = refusals_.find(key);
      if (known != refusals_.end()) before = std::max(before, known->second);
    }
    const bool late = std::ranges::binary_search(trial.decision.late, g);
    const bool obeyed = refused && before < kMostRefusals;
    if (late || obeyed) keep.insert(members.begin(), members.end());
    if (obeyed) {
      for (const std::int64_t key : members) refusals[key] = before + 1;
    }
  }
  refusals_ = std::move(refusals);
  JointPlan plan = trial.decision.plan;
  std::erase_if(plan.entries, [&](const auto& e) { return keep.contains(e.key); });
  for (const JointPlan::Entry& e : plan_.entries) {
    if (keep.contains(e.key)) plan.entries.push_back(e);
  }
  plan_ = std::move(plan);
  plan_touches_ = !trial.refused.empty();
  groups_ = trial.decision.members;
  forecasts_ = trial.forecasts;
  // A guest goes by the plans of all.
  if (trial.decision.late.empty()) {
    for (const std::string& guest : trial.guests) let_pass(guest);
  }
  for (const auto& [id, arrival] : arrivals) {
    const bool goes_on = driven_.contains(id);
    if (keep.contains(arrival.key) || trial.excluded.contains(id)) {
      if (goes_on) {
        stay(id);
      } else {
        gate_.hold(id);
        ++turned_away_[id];
      }
      continue;
    }
    driven_.insert_or_assign(id, arrival);
    turned_away_.erase(id);
    if (!goes_on) {
      gate_.release(id);
      traffic_.take_over(id);
      taken_over_.push_back(id);
    }
    announce(id, arrival);
  }
  commit(arrivals);
}

/// One of the decisions that are dropped at random.
bool Coordinator::comes_late() const {
  if (options_.late_share <= 0.0) return false;
  return Draws(options_.escot.seed * 1000003 + std::uint64_t(step_)).share() < options_.late_share;
}

/// The groups of the last decision that stand as they stood then plan anew, in another order.
std::vector<std::int64_t> Coordinator::stagnating_groups() {
  std::map<std::int64_t, InertialState> now;
  for (const auto& [id, driven] : driven_) now[driven.key] = driven.road.now;
  return stagnation_.duplicates(groups_, std::move(now),
                                options_.escot.seed + std::uint64_t(step_));
}

namespace {

/// Does a vehicle stand where one of these drivers, who stands too, has to pass, and he where it
/// has to?
bool stands_against_one(const RoadScene& scene, const RoadVehicle& road,
                        const std::vector<Forecast>& drivers) {
  return std::ranges::any_of(drivers, [&](const Forecast& driver) {
    const RoadVehicle& other = driver.vehicle;
    return other.now.v == 0.0 && RoadContact(scene, road, other, 0.0).block_each_other();
  });
}

}  // namespace

/// Who has stood for long without a complete plan, or blocking a driver who may not go because
/// of it, is stuck until the end of its corridor: its plan may be to wait for him.
void Coordinator::notice_the_stuck() {
  const RoadScene now = empty_scene();
  std::map<std::int64_t, int> standing;
  for (auto& [id, driven] : driven_) {
    RoadVehicle& road = driven.road;
    if (road.now.v != 0.0) continue;
    const bool waits = blocking_guests_.contains(driven.key) || !plan_.find(driven.key)->complete ||
                       (humans_ && stands_against_one(now, road, forecasts_));
    if (!waits) continue;
    const auto before = standing_.find(driven.key);
    const int decisions = before == standing_.end() ? 1 : before->second + 1;
    standing.emplace(driven.key, decisions);
    road.stuck |= decisions * grid_.decision() > kStuckAfter;
  }
  standing_ = std::move(standing);
  blocking_guests_.clear();
}

RoadScene Coordinator::scene() const {
  RoadScene scene = empty_scene();
  for (const auto& [id, driven] : driven_) scene.vehicles.push_back(driven.road);
  std::ranges::sort(scene.vehicles, {}, &RoadVehicle::key);
  scene.forecasts = forecasts_;
  return scene;
}

bool Coordinator::planner_is_dead() const {
  return options_.replan_budget_ms <= 0.0 && traffic_.time() >= options_.budget_from;
}

void Coordinator::place_all() {
  const auto kept = std::size_t(std::lround(options_.tolerance.age / grid_.dt)) + 1;
  for (auto& [id, driven] : driven_) {
    const PlannedPose next = planned_pose(driven, state_at(*plan_.find(driven.key), step_ + 1));
    traffic_.place(id, next.pose, next.speed);
    driven.past.push_front(next.pose);
    if (driven.past.size() > kept) driven.past.pop_back();
  }
  if (traffic_.wants_plans()) announce_plans();
}

/// Where a vehicle under control will be a decision from now, and where one without a complete plan
/// comes to rest; none: it has a driver.
std::vector<PlannedPose> Coordinator::poses_soon(const std::string& id) const {
  const auto driven = driven_.find(id);
  if (driven == driven_.end()) return {};
  const SpeedProfile& plan = *plan_.find(driven->second.key);
  std::vector<PlannedPose> poses = {
      planned_pose(driven->second, state_at(plan, step_ + grid_.steps_per_decision))};
  if (!plan.complete) poses.push_back(planned_pose(driven->second, plan.states.back()));
  return poses;
}

/// The lane behind a junction that a vehicle under control is about to drive onto, or is on with
/// its tail still inside; nullopt: it can stop before the junction, or has a driver.
std::optional<ExitLanes::Leaving> Coordinator::leaving(const std::string& id) const {
  const auto found = driven_.find(id);
  if (found == driven_.end()) return std::nullopt;
  const Corridor& corridor = corridors_[found->second.corridor];
  const std::vector<CorridorPiece>& pieces = corridor.course.pieces;
  const InertialState now = here(found->second);
  const Vehicle& body = corridors_.library().body(found->second.road.path);
  const double needs = now.v * grid_.decision() + stopping_distance(now.v, body.max_decel);
  for (std::size_t p = corridor.piece_at(now.s - body.length()); p + 1 < pieces.size(); ++p) {
    if (corridor.stations[p] > now.s + needs) break;
    const bool is_exit = graph_.edge_of(pieces[p].lane) == LaneGraph::kNone &&
                         graph_.edge_of(pieces[p + 1].lane) != LaneGraph::kNone;
    if (is_exit) return {{pieces[p + 1].lane, now.s - corridor.stations[p + 1], needs}};
  }
  return std::nullopt;
}

PlannedPose Coordinator::planned_pose(const Driven& driven, const InertialState& state) const {
  const Corridor& corridor = corridors_[driven.corridor];
  return {driven.approach.pose(path_of(driven), state.s),
          state.v / corridor.ratios[corridor.piece_at(state.s)]};
}

const ReferencePath& Coordinator::path_of(const Driven& driven) const {
  return corridors_.library().path(corridors_[driven.corridor].path);
}

const VehicleState* Coordinator::find_state(const std::string& id) const {
  const std::span<const VehicleState> states = traffic_.vehicles();
  const auto state = std::ranges::lower_bound(states, id, {}, &VehicleState::id);
  return state != states.end() && state->id == id ? &*state : nullptr;
}

const VehicleType& Coordinator::type_of(const std::string& id) {
  const auto known = types_.find(id);
  return known != types_.end() ? known->second
                               : types_.emplace(id, traffic_.type(id)).first->second;
}

}  // namespace mvtp
