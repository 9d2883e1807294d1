#include "tools/coordinate/run_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/coordinate/drawn_path.hpp"
#include "tools/coordinate/drivers.hpp"
#include "tools/view/page.hpp"
#include "tools/view/scene.hpp"

namespace mvtp {
namespace {

/// The outline of a slot, from the aisle round its back to the aisle again.
std::vector<Point> outline(const ParkingSlot& slot) {
  std::vector<Point> points;
  for (const auto& [x, y] : {std::pair{-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}}) {
    const Pose corner = compose(slot.middle, {x * slot.length, y * slot.width, 0.0});
    points.push_back({corner.x, corner.y});
  }
  return points;
}

ReplayScene scene_of(const RoadNetwork& network, const std::set<std::string>& junctions,
                     std::span<const ParkingLot> lots) {
  ReplayScene scene = scene_of(network);
  for (const std::string& id : junctions) {
    const Polygon& shape = network.junctions.at(id).shape;
    if (shape.size() >= 3) scene.zones.push_back(shape);
  }
  for (const ParkingLot& lot : lots) {
    scene.junctions.push_back(lot.ground);
    scene.polygons.insert(scene.polygons.end(), lot.obstacles.begin(), lot.obstacles.end());
    for (const ParkingSlot& slot : lot.slots) scene.slots.push_back(outline(slot));
  }
  return scene;
}

ReplayState state_of(const Observation& s, bool rests) {
  if (rests) return ReplayState::kParked;
  if (!s.coordinated) return ReplayState::kCarFollowing;
  return s.state->speed < 0.1 ? ReplayState::kWaiting : ReplayState::kCoordinated;
}

ReplayEventKind kind_of(AuditEventKind kind) {
  switch (kind) {
    case AuditEventKind::kOverlap:
      return ReplayEventKind::kOverlap;
    case AuditEventKind::kPersonTouched:
      return ReplayEventKind::kPersonTouched;
    case AuditEventKind::kOffRoad:
      return ReplayEventKind::kOffRoad;
    case AuditEventKind::kJump:
      return ReplayEventKind::kJump;
    case AuditEventKind::kAcceleration:
      return ReplayEventKind::kAcceleration;
    case AuditEventKind::kHardBraking:
      return ReplayEventKind::kHardBraking;
  }
  return ReplayEventKind::kNote;
}

/// The control zone of the junction that is nearest to a stop line.
int zone_at(const Pose& line, const std::vector<ZoneFigures>& zones, const RoadNetwork& network) {
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t z = 0; z < zones.size(); ++z) {
    for (const std::string& id : zones[z].junctions) {
      const Point& p = network.junctions.at(id).position;
      const double distance = std::hypot(p.x - line.x, p.y - line.y);
      if (distance >= least) continue;
      least = distance;
      nearest = int(z);
    }
  }
  return nearest;
}

}  // namespace

RunRecorder::RunRecorder(const CoordinateOptions& options, const Traffic& traffic,
                         const std::set<std::string>& junctions, std::span<const ParkingLot> lots,
                         const Coordinator* coordinator, const RunReport& report)
    : options_(options),
      traffic_(traffic),
      coordinator_(coordinator),
      recorder_({.title = options.configuration,
                 .label = options.controller,
                 .command = report.command,
                 .version = "mvtp " + report.mvtp_version + ", " + report.sumo_version,
                 .seed = std::to_string(report.seed)},
                scene_of(traffic.network(), junctions, lots)),
      tubes_(coordinator, traffic.step_length()),
      share_(controlled_share(options)),
      drives_(controller_named("--controller", options.controller).drives) {
  for (const auto& [id, lights] : traffic.network().signals) (void)recorder_.add_signal(id);
}

std::size_t RunRecorder::index_of(const Observation& s) {
  const auto known = indices_.find(s.state->id);
  if (known != indices_.end()) return known->second;
  const Vehicle& body = s.type->body;
  ReplayVehicle vehicle{.id = s.state->id,
                        .kind = s.state->type,
                        .length = body.length(),
                        .width = body.width,
                        .front = body.front};
  vehicle.automated = drives_ && share_.contains(s.state->id, s.state->type);
  return indices_.emplace(s.state->id, recorder_.add_vehicle(vehicle)).first->second;
}

std::size_t RunRecorder::index_of(const Pedestrian& person) {
  const auto known = people_.find(person.id);
  if (known != people_.end()) return known->second;
  ReplayVehicle disc{.id = person.id,
                     .kind = "person",
                     .length = 2.0 * person.radius,
                     .width = 2.0 * person.radius,
                     .front = person.radius};
  disc.person = true;
  disc.automated = false;
  return people_.emplace(person.id, recorder_.add_vehicle(disc)).first->second;
}

std::map<std::string, RunRecorder::Member> RunRecorder::members() const {
  std::map<std::string, Member> members;
  if (coordinator_ == nullptr) return members;
  std::map<std::int64_t, const std::string*> id_of;
  for (const auto& [id, driven] : coordinator_->driven()) id_of[driven.key] = &id;
  std::map<std::int64_t, std::int64_t> rank_of;  // over all groups
  for (const JointPlan::Entry& entry : coordinator_->plan().entries) {
    rank_of.emplace(entry.key, std::int64_t(rank_of.size()));
  }
  for (std::vector<std::int64_t> group : coordinator_->groups()) {
    std::erase_if(group, [&](std::int64_t key) {
      return !id_of.contains(key) || !indices_.contains(*id_of[key]) || !rank_of.contains(key);
    });
    if (group.size() < 2) continue;
    const std::size_t first = indices_.at(*id_of[group.front()]);
    std::ranges::sort(group, {}, [&](std::int64_t key) { return rank_of[key]; });
    int rank = 0;
    for (const std::int64_t key : group) members[*id_of[key]] = {first, ++rank};
  }
  return members;
}

void RunRecorder::observe(const Snapshot& now, const Audit& audit) {
  std::size_t signal = 0;
  for (const auto& [id, lights] : traffic_.network().signals) {
    recorder_.add_lights(now.time, signal++, traffic_.shown(id));
  }
  std::vector<ReplayVehicleState> states;
  const bool is_due = recorder_.is_due(now.time);
  for (std::size_t i = 0; i < now.vehicles.size(); ++i) {
    const Observation& s = now.vehicles[i];
    const bool rests = now.resting[i] != 0;
    if (is_due) co2_[s.state->id] = traffic_.co2(s.state->id);
    states.push_back({index_of(s), s.state->pose, s.state->speed, state_of(s, rests)});
    states.back().co2 = co2_[s.state->id];
    states.back().tube = tubes_.tube_of(*s.state, recorder_.tubes());
  }
  const std::map<std::string, Member> grouped = members();
  for (std::size_t i = 0; i < now.vehicles.size(); ++i) {
    const auto member = grouped.find(now.vehicles[i].state->id);
    if (member == grouped.end()) continue;
    states[i].group = member->second.group;
    states[i].rank = member->second.rank;
  }
  for (const Pedestrian& p : now.people) {
    const Pose pose{p.position.x, p.position.y, p.theta};
    states.push_back({index_of(p), pose, p.speed, ReplayState::kWalking});
  }
  recorder_.add_frame(now.time, states, audit.latest_clearance());
  observe_corridors();
  observe_events(audit);
}

void RunRecorder::observe_events(const Audit& audit) {
  for (; events_seen_ < audit.events().size(); ++events_seen_) {
    const AuditEvent& e = audit.events()[events_seen_];
    ReplayEvent event{.kind = kind_of(e.kind), .time = e.time, .place = e.where};
    event.value = -e.depth;
    for (const std::string& id : e.who) {
      const auto vehicle = indices_.find(id);
      if (vehicle != indices_.end()) {
        event.vehicles.push_back(vehicle->second);
      } else if (const auto person = people_.find(id); person != people_.end()) {
        event.vehicles.push_back(person->second);
      }
    }
    if (e.kind == AuditEventKind::kJump) event.text = e.what;
    recorder_.add_event(event);
  }
}

/// Corridors on which somebody is driven, each once however many types of vehicles have it; the
/// coordinator forgets them in time.
void RunRecorder::observe_corridors() {
  if (coordinator_ == nullptr) return;
  const CorridorMap& corridors = coordinator_->corridors();
  for (const auto& [id, driven] : coordinator_->driven()) {
    if (!seen_corridors_.insert(driven.corridor).second) continue;
    const Corridor& corridor = corridors[driven.corridor];
    if (corridor.lines.empty()) continue;
    std::vector<std::pair<int, int>> lanes;
    for (const CorridorPiece& piece : corridor.course.pieces) {
      lanes.emplace_back(piece.lane, piece.target);
    }
    const auto [drawn, is_new] = corridors_.try_emplace(std::move(lanes));
    if (!is_new) continue;
    const ReferencePath& path = corridors.library().path(corridor.path);
    const double line = corridor.lines.front();
    drawn->second = {path.at(line), drawn_path(path, std::max(0.0, line - options_.zone_radius),
                                               corridor.s_handback)};
  }
}

std::string RunRecorder::page(const RunReport& r) {
  const auto figure = [&](const char* label, double value, const char* unit, int digits) {
    recorder_.add_figure({label, fmt::format("{:.{}f}", value, digits), unit});
  };
  for (const VehicleRecord& v : r.vehicles) {
    const auto known = indices_.find(v.id);
    if (known != indices_.end()) recorder_.vehicle(known->second).movement = v.movement;
  }
  for (const auto& [lanes, corridor] : corridors_) {
    const int zone = zone_at(corridor.line, r.zones, traffic_.network());
    recorder_.add_corridor({.zone = zone, .shape = corridor.shape});
  }
  const Headline h = headline(r);
  recorder_.add_figure({"status", r.status, ""});
  figure("mean delay", h.mean_delay, "s", 2);
  figure("95 % delay", h.p95_delay, "s", 1);
  figure("throughput", h.throughput, "veh/h", 0);
  figure("arrived", double(h.completed), "", 0);
  figure("overlaps", double(r.audit.overlap_pairs), "", 0);
  if (!people_.empty()) {
    figure("people touched", double(r.audit.people_touched_all), "", 0);
  }
  if (!r.replans.empty()) figure("replan p95", h.replan_p95, "ms", 2);
  const Replay replay = recorder_.finish();
  return to_html({&replay, 1});
}

}  // namespace mvtp
