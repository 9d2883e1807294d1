#include "coordinator/faults/faulty_traffic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "coordinator/drivers/controlled_share.hpp"
#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

constexpr double kMemory = 5.0;  ///< [s] of the errors of reports

// What the draws of a vehicle are for.
constexpr std::uint64_t kCommands = 1;
constexpr std::uint64_t kReports = 2;
constexpr std::uint64_t kStopping = 3;
constexpr std::uint64_t kIgnoring = 4;
constexpr std::uint64_t kDriving = 5;

}  // namespace

FaultyTraffic::FaultyTraffic(Traffic& world, FaultPlan plan)
    : world_(world), plan_(std::move(plan)) {
  receive_reports();
}

std::int64_t FaultyTraffic::steps(double seconds) const {
  return std::int64_t(std::ceil(seconds / world_.step_length() - 1e-9));
}

Draws FaultyTraffic::draws_for(const std::string& id, std::uint64_t purpose) const {
  return Draws(std::uint64_t(share_of_id(id, plan_.seed * 8 + purpose) * 0x1p53));
}

void FaultyTraffic::note(const std::string& id, const std::string& what) {
  figures_.events.push_back({step_, world_.time(), id, what});
}

void FaultyTraffic::take_over(const std::string& id) {
  links_.erase(id);
  links_.emplace(id, Link{.said = std::make_shared<Message>(),
                          .on_air = {},
                          .heard = nullptr,
                          .obeyed = nullptr,
                          .placed = {},
                          .vehicle = {},
                          .stopped = 0.0,
                          .draws = draws_for(id, kCommands)});
}

void FaultyTraffic::hand_back(const std::string& id) {
  const auto link = links_.find(id);
  if (link == links_.end()) return;
  Message message = *link->second.said;
  message.released = true;
  say(link->second, std::move(message));
}

bool FaultyTraffic::is_taken_over(const std::string& id) const {
  return links_.contains(id) || world_.is_taken_over(id);
}

void FaultyTraffic::drive_along(const std::string& id, std::span<const std::string> edges) {
  const auto link = links_.find(id);
  if (link == links_.end()) return;
  Message message = *link->second.said;
  message.edges.assign(edges.begin(), edges.end());
  say(link->second, std::move(message));
}

void FaultyTraffic::place(const std::string& id, const Pose& pose, double speed) {
  const auto link = links_.find(id);
  if (link != links_.end()) link->second.placed = {pose, speed};
}

void FaultyTraffic::announce_plan(const std::string& id, std::vector<PlannedPose> poses,
                                  bool complete) {
  const auto link = links_.find(id);
  if (link == links_.end()) return;
  Message message = *link->second.said;
  message.plan = std::make_shared<PlanMessage>(
      PlanMessage{.begin = step_, .poses = std::move(poses), .complete = complete});
  say(link->second, std::move(message));
}

/// After all controllers have said what they want: what is said goes on the air, and vehicles do
/// what they have heard.
void FaultyTraffic::command() {
  if (plan_.sumo_ends && world_.time() >= *plan_.sumo_ends) {
    throw InputError("--faults sumo-ends",
                     fmt::format("the traffic stopped at t = {:.2f} s, as asked for; leave it out "
                                 "for a whole run",
                                 world_.time()));
  }
  const std::span<const VehicleState> states = world_.vehicles();
  for (auto it = links_.begin(); it != links_.end();) {
    auto& [id, link] = *it;
    const auto state = std::ranges::lower_bound(states, id, {}, &VehicleState::id);
    const bool is_here = state != states.end() && state->id == id;
    if (is_here) send(link);
    const bool is_over = !is_here || drive(id, link, *state);
    it = is_over ? links_.erase(it) : std::next(it);
  }
  ++step_;
}

void FaultyTraffic::send(Link& link) {
  const bool lost = link.draws.share() < plan_.model.command.loss;
  ++figures_.commands;
  figures_.commands_lost += lost ? 1 : 0;
  if (!lost) link.on_air.push_back({step_ + steps(plan_.model.command.delay), link.said});
  while (!link.on_air.empty() && link.on_air.front().due <= step_) {
    link.heard = link.on_air.front().message;
    link.on_air.pop_front();
  }
}

bool FaultyTraffic::drive(const std::string& id, Link& link, const VehicleState& state) {
  if (!link.heard) return false;  // its car-following model drives it on
  const bool is_new = !world_.is_taken_over(id);
  if (link.heard->released &&
      (is_new || !link.vehicle || link.vehicle->will() == ConnectedVehicle::Will::kObeys)) {
    if (!is_new) world_.hand_back(id);
    return true;
  }
  const VehicleType type = world_.type(state.type);
  if (is_new) world_.take_over(id);
  if (!link.heard->plan) {
    if (link.placed) world_.place(id, link.placed->pose, link.placed->speed);
    return false;
  }
  if (!link.vehicle) {
    link.vehicle.emplace(state.pose, state.speed, type.body, plan_.model, step_length(),
                         draws_for(id, kDriving));
  }
  ConnectedVehicle& vehicle = *link.vehicle;
  misbehave(id, link, state);
  const bool obeys = vehicle.will() == ConnectedVehicle::Will::kObeys || !vehicle.has_plan();
  if (obeys && link.heard != link.obeyed) {
    link.obeyed = link.heard;
    vehicle.receive(link.heard->plan, step_);
    world_.drive_along(id, link.heard->edges);
  }
  const bool recovers = link.stopped > plan_.stop_duration;
  if (vehicle.is_through(step_) || recovers) {
    world_.hand_back(id);
    return true;
  }
  vehicle.drive(step_ + 1);
  if (vehicle.will() == ConnectedVehicle::Will::kObeys) {
    figures_.largest_deviation = std::max(figures_.largest_deviation, vehicle.deviation());
  }
  world_.place(id, vehicle.pose(), vehicle.speed());
  return false;
}

bool FaultyTraffic::goes_wrong(const std::string& id, VehicleFault::Kind kind, double share) const {
  const bool is_named = std::ranges::any_of(plan_.vehicles, [&](const VehicleFault& fault) {
    return fault.id == id && fault.kind == kind && world_.time() >= fault.time;
  });
  const bool stops = kind == VehicleFault::Kind::kStops;
  return is_named || share_of_id(id, plan_.seed * 8 + (stops ? kStopping : kIgnoring)) < share;
}

/// Inside a junction.
void FaultyTraffic::misbehave(const std::string& id, Link& link, const VehicleState& state) {
  ConnectedVehicle& vehicle = *link.vehicle;
  if (vehicle.will() == ConnectedVehicle::Will::kBrakes) {
    link.stopped += step_length();
    return;
  }
  const auto lane = world_.network().lanes.find(state.lane);
  const bool is_inside = lane != world_.network().lanes.end() && lane->second.internal;
  if (!is_inside || !vehicle.has_plan() || went_wrong_.contains(id)) return;
  if (goes_wrong(id, VehicleFault::Kind::kStops, plan_.stop_share)) {
    vehicle.set_will(ConnectedVehicle::Will::kBrakes);
    note(id, "stops dead");
  } else if (goes_wrong(id, VehicleFault::Kind::kIgnores, plan_.ignore_share)) {
    vehicle.set_will(ConnectedVehicle::Will::kHoldsSpeed);
    note(id, "ignores its plan");
  } else {
    return;
  }
  went_wrong_.insert(id);
}

void FaultyTraffic::receive_reports() {
  for (const VehicleState& state : world_.vehicles()) receive(state);
  std::erase_if(air_, [&](const auto& entry) { return entry.second.seen != step_; });
  reports_.clear();
  for (const auto& [id, reports] : air_) {
    if (!reports.newest) continue;
    reports_.push_back(*reports.newest);
    reports_.back().age = world_.time() - reports.newest->age;
  }
}

/// A report of where a vehicle is; `age` holds its time while it is on the air.
void FaultyTraffic::receive(const VehicleState& state) {
  const FaultModel& model = plan_.model;
  auto known = air_.find(state.id);
  if (known == air_.end()) {
    Draws draws = draws_for(state.id, kReports);
    const double memory = std::exp(-step_length() / kMemory);
    const auto noise = [&] { return Noise(memory, FaultModel::kMostDeviations, draws); };
    const Noise along = noise(), across = noise(), turn = noise();
    known = air_.emplace(state.id, Reports{draws, along, across, turn, {}, {}, step_}).first;
  }
  Reports& reports = known->second;
  for (Noise* noise : {&reports.along, &reports.across, &reports.turn}) {
    noise->advance(reports.draws);
  }
  VehicleState said = state;
  const double along = model.position * reports.along.value();
  said.pose = compose(state.pose, {along, model.position * reports.across.value(),
                                   model.heading * reports.turn.value()});
  if (const auto lane = world_.network().lanes.find(said.lane);
      lane != world_.network().lanes.end()) {
    said.lane_position = std::clamp(said.lane_position + along, 0.0, lane->second.length);
  }
  said.age = world_.time();
  const bool lost = reports.draws.share() < model.report.loss;
  ++figures_.reports;
  figures_.reports_lost += lost ? 1 : 0;
  if (!lost) reports.on_air.emplace_back(step_ + steps(model.report.delay), std::move(said));
  while (!reports.on_air.empty() && reports.on_air.front().first <= step_) {
    reports.newest = std::move(reports.on_air.front().second);
    reports.on_air.pop_front();
  }
  reports.seen = step_;
}

}  // namespace mvtp
