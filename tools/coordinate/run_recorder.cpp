#include "tools/coordinate/run_recorder.hpp"

#include <fmt/format.h>

#include "tools/view/page.hpp"

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
  ReplayScene scene;
  for (const auto& [id, lane] : network.lanes) {
    if (!lane.drivable) continue;
    scene.lanes.push_back({lane.shape, lane.width, lane.internal, false});
  }
  for (const auto& [id, junction] : network.junctions) {
    if (junction.shape.size() < 3) continue;
    scene.junctions.push_back(junction.shape);
    if (junctions.contains(id)) scene.zones.push_back(junction.shape);
  }
  for (const ParkingLot& lot : lots) {
    scene.junctions.push_back(lot.ground);
    scene.polygons.insert(scene.polygons.end(), lot.obstacles.begin(), lot.obstacles.end());
    for (const ParkingSlot& slot : lot.slots) scene.zones.push_back(outline(slot));
  }
  return scene;
}

ReplayState state_of(const Sighting& s) {
  if (!s.coordinated) return ReplayState::kOwnDriver;
  return s.state->speed < 0.1 ? ReplayState::kWaiting : ReplayState::kCoordinated;
}

}  // namespace

RunRecorder::RunRecorder(const CoordinateOptions& options, const RoadNetwork& network,
                         const std::set<std::string>& junctions, std::span<const ParkingLot> lots,
                         const RunReport& report)
    : recorder_({.title = options.configuration,
                 .label = options.controller,
                 .command = report.command,
                 .version = "mvtp " + report.mvtp_version + ", " + report.sumo_version,
                 .seed = std::to_string(report.seed)},
                scene_of(network, junctions, lots)) {}

std::size_t RunRecorder::index_of(const Sighting& s) {
  const auto known = indices_.find(s.state->id);
  if (known != indices_.end()) return known->second;
  const Vehicle& body = s.type->body;
  const std::size_t index = recorder_.add_vehicle({.id = s.state->id,
                                                   .kind = s.state->type,
                                                   .length = body.length(),
                                                   .width = body.width,
                                                   .front = body.front});
  return indices_.emplace(s.state->id, index).first->second;
}

void RunRecorder::observe(double time, std::span<const Sighting> sightings, const Audit& audit) {
  std::vector<ReplayVehicleState> states;
  for (const Sighting& s : sightings) {
    states.push_back({index_of(s), s.state->pose, s.state->speed, state_of(s)});
  }
  recorder_.add_frame(time, states, audit.latest_clearance());
  for (; events_seen_ < audit.events().size(); ++events_seen_) {
    const AuditEvent& e = audit.events()[events_seen_];
    recorder_.add_event(
        {.kind = ReplayEventKind::kOverlap, .time = e.time, .place = e.where, .text = e.what});
  }
}

std::string RunRecorder::page(const RunReport& r) {
  const auto figure = [&](const char* label, double value, const char* unit, int digits) {
    recorder_.add_figure({label, fmt::format("{:.{}f}", value, digits), unit});
  };
  const Headline h = headline(r);
  figure("mean delay", h.mean_delay, "s", 2);
  figure("95 % delay", h.p95_delay, "s", 1);
  figure("throughput", h.throughput, "veh/h", 0);
  figure("arrived", double(h.completed), "", 0);
  figure("overlaps", double(r.audit.overlap_pairs), "", 0);
  figure("replan p95", h.replan_p95, "ms", 2);
  const Replay replay = recorder_.finish();
  return to_html({&replay, 1});
}

}  // namespace mvtp
