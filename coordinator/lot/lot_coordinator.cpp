#include "coordinator/lot/lot_coordinator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace mvtp {
namespace {

constexpr double kRoom = 2.0;              ///< [m] between the lot's frame and the ground
constexpr double kSameSlot = 1.5;          ///< [m] between a vehicle's middle and its slot's
constexpr double kInside = 0.2;            ///< [m] of ground behind a vehicle that is let in
constexpr double kBeforeLaneEnd = 0.5;     ///< [m]
constexpr double kStanding = 0.1;          ///< [m/s]
constexpr int kDecisionsAfterFailure = 2;  ///< PreCheck: who found no path does not ask sooner,
constexpr int kMostDoublings = 3;          ///< each time twice as late, at most so often
constexpr double kSettle = 5.0;            ///< [s]
constexpr double kGateGap = 1.0;           ///< [m] behind a vehicle that comes in, for the next,
constexpr double kGateBraking = 2.0;       ///< [m/s^2] of that
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Pose moved(const Pose& pose, const Point& by) { return {pose.x - by.x, pose.y - by.y, pose.theta}; }
Point moved(const Point& point, const Point& by) { return {point.x - by.x, point.y - by.y}; }

Point corner_of(const Polygon& ground) {
  Point low{kInfinity, kInfinity};
  for (const Point& p : ground) low = {std::min(low.x, p.x), std::min(low.y, p.y)};
  return {low.x - kRoom, low.y - kRoom};
}

ParkingLot moved(ParkingLot lot, const Point& by) {
  for (Point& p : lot.ground) p = moved(p, by);
  for (Polygon& polygon : lot.obstacles) {
    for (Point& p : polygon) p = moved(p, by);
  }
  for (ParkingSlot& slot : lot.slots) slot.middle = moved(slot.middle, by);
  for (LotLane& lane : lot.entries) lane.begin = moved(lane.begin, by);
  for (LotLane& lane : lot.exits) lane.begin = moved(lane.begin, by);
  for (Footpath& path : lot.footpaths) {
    for (Point& p : path.line) p = moved(p, by);
  }
  return lot;
}

LotPlannerOptions planner_options(const LotOptions& options) {
  LotPlannerOptions planner = options.planner;
  planner.regroup = options.controller == LotController::kEscot;
  planner.plans_groups = options.controller != LotController::kPbcr;
  planner.decision = options.decision;
  return planner;
}

}  // namespace

LotCoordinator::LotCoordinator(Traffic& traffic, const ParkingLot& lot, const LotOptions& options)
    : traffic_(traffic),
      original_(lot),
      origin_(corner_of(lot.ground)),
      lot_(moved(lot, origin_)),
      options_(options),
      planner_(lot_, planner_options(options)),
      motion_(options.planner.limits) {
  steps_per_decision_ = std::max(1, int(std::lround(options.decision / traffic.step_length())));
}

Pose LotCoordinator::to_lot(const Pose& pose) const { return moved(pose, origin_); }
Pose LotCoordinator::from_lot(const Pose& pose) const {
  return {pose.x + origin_.x, pose.y + origin_.y, pose.theta};
}

bool LotCoordinator::drives(const std::string& id) const {
  const auto guest = guests_.find(id);
  return guest != guests_.end() && guest->second.taken_over;
}

bool LotCoordinator::rests(const std::string& id) const {
  const auto guest = guests_.find(id);
  return guest != guests_.end() && guest->second.phase == Phase::kParked &&
         !guest->second.wants_out;
}

Occupied LotCoordinator::occupied(double time) const {
  Occupied result{.time = time};
  for (const auto& [id, guest] : guests_) {
    result.parked += guest.phase == Phase::kParked ? 1 : 0;
    result.under_way += guest.phase == Phase::kUnderWay ? 1 : 0;
    result.at_gate += guest.phase == Phase::kAtGate && guest.held ? 1 : 0;
  }
  return result;
}

std::vector<LotObservation> LotCoordinator::observations(Phase phase) const {
  std::vector<LotObservation> result;
  for (const auto& [id, guest] : guests_) {
    if (guest.phase != phase) continue;
    result.push_back({id, guest.body, from_lot(guest.pose), guest.wants_out});
  }
  return result;
}

std::vector<LotObservation> LotCoordinator::under_way() const {
  return observations(Phase::kUnderWay);
}
std::vector<LotObservation> LotCoordinator::parked() const { return observations(Phase::kParked); }

const VehicleType& LotCoordinator::type_of(const std::string& id) {
  const auto known = types_.find(id);
  return known != types_.end() ? known->second
                               : types_.emplace(id, traffic_.type(id)).first->second;
}

void LotCoordinator::decide() {
  welcome();
  watch_the_gates();
  if (step_ % steps_per_decision_ == 0) replan();
  advance();
}

void LotCoordinator::act() {
  place_all();
  ++step_;
}

/// Those who come for the first time, and mean to park here.
void LotCoordinator::welcome() {
  for (const VehicleState& v : traffic_.vehicles()) {
    if (!seen_.insert(v.id).second) continue;
    const std::optional<ParkingStop> stop = traffic_.parking_stop(v.id);
    if (!stop || stop->area != lot_.id) continue;
    Guest guest;
    guest.key = next_key_++;
    guest.body = type_of(v.type).body;
    guest.pose = to_lot(v.pose);
    guest.stay = stop->duration;
    guest.until = stop->until;
    check_size(v.id, guest.body);
    ids_[guest.key] = v.id;
    events_[v.id].id = v.id;
    if (stop->parked) adopt_parked(v.id, guest);
    guests_.emplace(v.id, guest);
  }
}

void LotCoordinator::adopt_parked(const std::string& id, Guest& guest) {
  guest.phase = Phase::kParked;
  guest.until = std::max(guest.until, traffic_.time() + guest.stay);
  events_[id].parked = traffic_.time();
  events_[id].there_at_start = true;
  const Pose middle = compose(guest.pose, {(guest.body.front - guest.body.rear) / 2, 0.0, 0.0});
  double nearest = kSameSlot;
  for (std::size_t s = 0; s < lot_.slots.size(); ++s) {
    const double away = distance(middle, lot_.slots[s].middle);
    if (away >= nearest) continue;
    nearest = away;
    guest.slot = int(s);
    events_[id].slot = lot_.slots[s].id;
  }
}

/// Where those are who wait in the entry lanes; the front one of each may ask to be let in.
void LotCoordinator::watch_the_gates() {
  std::vector<const VehicleState*> front(lot_.entries.size(), nullptr);
  for (const VehicleState& v : traffic_.vehicles()) {
    const auto known = guests_.find(v.id);
    if (known == guests_.end() || known->second.phase != Phase::kAtGate) continue;
    Guest& guest = known->second;
    guest.entry = -1;
    if (traffic_.is_taken_over(v.id)) continue;  // another controller still drives it
    for (std::size_t e = 0; e < lot_.entries.size(); ++e) {
      if (lot_.entries[e].lane != v.lane) continue;
      if (!guest.held) {
        traffic_.drop_parking_stop(v.id);
        traffic_.hold(v.id, true);
        guest.held = true;
      }
      guest.pose = to_lot(v.pose);
      guest.speed = v.speed < kStanding ? 0.0 : v.speed;
      if (!front[e] || v.lane_position > front[e]->lane_position) front[e] = &v;
    }
  }
  for (std::size_t e = 0; e < front.size(); ++e) {
    if (!front[e]) continue;
    Guest& guest = guests_.at(front[e]->id);
    const LotLane& lane = lot_.entries[e];
    traffic_.cap_speed(front[e]->id, speed_behind_the_last(lane, guest));
    const double behind = front[e]->lane_position - guest.body.length() - lane.offset;
    if (behind < kInside) continue;
    const double room = lane.offset + lane.length - front[e]->lane_position - kBeforeLaneEnd;
    if (guest.speed > 0.0 && planner_.prefix_length(guest.speed) > room) continue;
    guest.entry = int(e);
    ParkingEvent& event = events_[front[e]->id];
    if (!event.asked_in) event.asked_in = traffic_.time();
  }
}

/// A car that comes in leaves its lane front first, and its driver's follower no longer sees it.
double LotCoordinator::speed_behind_the_last(const LotLane& lane, const Guest& guest) const {
  double free = kInfinity;  // [m] of lane
  for (const auto& [id, other] : guests_) {
    if (other.phase != Phase::kUnderWay && other.phase != Phase::kStoppedPermanently) continue;
    const BoxPose box = box_pose(other.body, relative(lane.begin, other.pose));
    const double half_length = other.body.length() / 2;
    const double half_width = other.body.width / 2;
    const double reach_x = std::abs(box.ux) * half_length + std::abs(box.uy) * half_width;
    const double reach_y = std::abs(box.uy) * half_length + std::abs(box.ux) * half_width;
    const bool aside = std::abs(box.y) > reach_y + guest.body.width / 2;
    if (aside || box.x - reach_x > lane.length + kGateGap) continue;
    free = std::min(free, box.x - reach_x);
  }
  const double front = relative(lane.begin, guest.pose).x + guest.body.front;
  return std::sqrt(2 * kGateBraking * std::max(0.0, free - front - kGateGap));
}

/// Cars parked at the start keep their places in the traffic's own books until all are there.
void LotCoordinator::take_over_the_parked() {
  for (auto& [id, guest] : guests_) {
    if (guest.phase != Phase::kParked || guest.taken_over) continue;
    const bool settled = traffic_.time() > *events_[id].parked + kSettle;
    if (!settled && traffic_.time() < guest.until - kSettle / 2) continue;
    traffic_.drop_parking_stop(id);
    take_over(id, guest);
  }
}

void LotCoordinator::end_parking() {
  for (auto& [id, guest] : guests_) {
    if (guest.phase != Phase::kParked || guest.wants_out) continue;
    if (traffic_.time() < guest.until || lot_.exits.empty()) continue;
    guest.wants_out = true;
    events_[id].wished_out = traffic_.time();
  }
}

void LotCoordinator::break_down() {
  for (const auto& [id, time] : options_.breakdowns) {
    const auto guest = guests_.find(id);
    if (traffic_.time() < time || guest == guests_.end() || events_[id].broken) continue;
    if (motion_.find(guest->second.key) < 0) continue;
    motion_.stop_permanently(guest->second.key);
    events_[id].broken = true;
    for (const std::int64_t key : motion_.stop_the_blocked_permanently())
      events_[ids_.at(key)].stopped_permanently = true;
  }
}

void LotCoordinator::take_over(const std::string& id, Guest& guest) {
  traffic_.take_over(id);
  traffic_.leave_road(id);
  guest.taken_over = true;
}

void LotCoordinator::replan() {
  ++decisions_;
  take_over_the_parked();
  end_parking();
  break_down();
  const std::vector<std::string> asking = those_who_ask();
  const bool alone = options_.controller == LotController::kOneAtATime;
  if (motion_.cars().empty() && asking.empty()) return;
  const auto begin = std::chrono::steady_clock::now();
  Replan record{.time = traffic_.time(), .newcomers = 0};
  int tries = options_.tries;
  for (const std::string& id : asking) {
    if (tries == 0 || (alone && !motion_.cars().empty())) break;
    Guest& guest = guests_.at(id);
    guest.asked = decisions_;
    const std::optional<LotAdmission> admission = ask(id, guest);
    guest.failures = admission ? 0 : guest.failures + 1;
    const int pause = kDecisionsAfterFailure << std::min(guest.failures, kMostDoublings);
    guest.next_try = decisions_ + (admission ? 0 : pause);
    if (admission) {
      ++record.newcomers;
      record.groups += admission->replanned > 0 ? 1 : 0;
    }
    --tries;
  }
  planner_.set_standing(solid({}, ""));
  record.groups += planner_.decide(motion_, in_place("")) > 0 ? 1 : 0;
  record.vehicles = int(motion_.cars().size());
  record.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  replans_.push_back(record);
}

std::vector<double> LotCoordinator::stopping_points() {
  std::vector<Pedestrian> people(traffic_.pedestrians().begin(), traffic_.pedestrians().end());
  for (Pedestrian& person : people) person.position = moved(person.position, origin_);
  std::vector<StandingCar> strangers;
  for (const VehicleState& v : traffic_.vehicles()) {
    const bool leaving =
        std::ranges::any_of(lot_.exits, [&](const LotLane& lane) { return lane.lane == v.lane; });
    if (leaving && !drives(v.id)) strangers.push_back({to_lot(v.pose), type_of(v.type).body});
  }
  const std::vector<double> turns = motion_.turns();
  std::vector<double> result;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    result.push_back(
        LotLookout::stopping_point(motion_, motion_.cars()[i], turns[i], {people, strangers}));
  }
  return result;
}

void LotCoordinator::advance() {
  std::vector<double> before;
  for (const LotCar& car : motion_.cars()) before.push_back(car.s);
  motion_.step(traffic_.step_length(), stopping_points());
  for (std::size_t i = 0; i < motion_.cars().size(); ++i) {
    const LotCar& car = motion_.cars()[i];
    ParkingEvent& event = events_[ids_.at(car.key)];
    event.distance += car.s - before[i];
    leave_slot(guests_.at(ids_.at(car.key)), car);
    if (car.v <= kStanding) event.waited += traffic_.step_length();
  }
}

/// A slot is free again once the vehicle has got out of it.
void LotCoordinator::leave_slot(Guest& guest, const LotCar& car) const {
  if (!guest.wants_out || guest.slot < 0) return;
  const ParkingSlot& slot = lot_.slots[std::size_t(guest.slot)];
  if (distance(car.pose(), slot.middle) > slot.length + car.body.length() / 2) guest.slot = -1;
}

void LotCoordinator::place_all() {
  for (const LotCar& car : motion_.cars()) {
    const std::string& id = ids_.at(car.key);
    guests_.at(id).pose = car.pose();
    traffic_.place(id, from_lot(car.pose()), car.v);
    if (car.stops() || car.s < car.path.length() - LotPlanner::kRunOut) continue;
    traffic_.enter_road(id, exit_at(car.goal));
  }
  for (const auto& [id, guest] : guests_) {
    if (!guest.taken_over || guest.phase == Phase::kUnderWay) continue;
    traffic_.place(id, from_lot(guest.pose), 0.0);
  }
}

/// The exit lane in which a vehicle has its goal.
const std::string& LotCoordinator::exit_at(const Pose& goal) const {
  const auto away = [&](const LotLane& lane) {
    const Pose local = relative(lane.begin, goal);
    return std::abs(local.y) + std::max({0.0, -local.x, local.x - lane.length});
  };
  return std::ranges::min_element(lot_.exits, {}, away)->lane;
}

void LotCoordinator::arrive() {
  std::vector<std::int64_t> finished;
  for (const LotCar& car : motion_.cars()) {
    if (car.at_end()) finished.push_back(car.key);
  }
  for (const std::int64_t key : finished) {
    const std::string id = ids_.at(key);
    const LotCar& car = motion_.cars()[std::size_t(motion_.find(key))];
    Guest& guest = guests_.at(id);
    ParkingEvent& event = events_[id];
    const bool leaves = !car.stops();
    guest.phase = car.stopped_permanently ? Phase::kStoppedPermanently : Phase::kParked;
    motion_.remove(key);
    if (leaves) {
      event.handed_back = traffic_.time();
      traffic_.hand_back(id);
      guests_.erase(id);
    } else if (guest.phase == Phase::kParked) {
      event.parked = traffic_.time();
      guest.until = std::max(guest.until, traffic_.time() + guest.stay);
    }
  }
}

}  // namespace mvtp
