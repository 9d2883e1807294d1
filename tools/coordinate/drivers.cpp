#include "tools/coordinate/drivers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ranges>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/junctions/tolerate.hpp"
#include "planner/problem/input_error.hpp"
#include "tools/cli/output_folder.hpp"
#include "tools/cli/suggest.hpp"
#include "tools/coordinate/fault_options.hpp"
#include "tools/coordinate/lot_options.hpp"

namespace mvtp {
namespace {

constexpr double kWidestMargin = 1.3;  ///< [m] across, as of --margin-across

void check_junctions(const CoordinateOptions& options, const RoadNetwork& network) {
  for (const std::string& id : options.junctions) {
    if (network.junctions.contains(id)) continue;
    std::vector<std::string> known;
    for (const auto& [name, junction] : network.junctions) {
      if (junction.has_conflicts) known.push_back(name);
    }
    throw InputError("--junction " + (id.empty() ? "\"\"" : id),
                     "the network has no junction with this id; " + suggestion(id, known));
  }
}

/// Do all movements through a junction lead from and to lanes of parking lots?
bool belongs_to_lots(const Junction& junction, std::span<const ParkingLot> lots,
                     const RoadNetwork& network) {
  const auto is_lots = [&](const std::string& lane) {
    const std::string& edge = network.lanes.at(lane).edge;
    const auto names_it = [&](const LotLane& l) { return network.lanes.at(l.lane).edge == edge; };
    return std::ranges::any_of(lots, [&](const ParkingLot& lot) {
      return std::ranges::any_of(lot.entries, names_it) || std::ranges::any_of(lot.exits, names_it);
    });
  };
  return std::ranges::all_of(junction.connections, [&](const Connection& c) {
    return is_lots(c.from_lane) && is_lots(c.to_lane);
  });
}

/// @throws InputError for a vehicle type that the scenario does not have, or that is named twice
void check_types(const CoordinateOptions& options, const Traffic& traffic) {
  const std::vector<std::string> known = traffic.types();
  const auto check = [&](const char* option, const std::vector<std::string>& types) {
    for (const std::string& type : types) {
      if (type.starts_with("DEFAULT_") || std::ranges::count(known, type) > 0) continue;
      throw InputError(fmt::format("{} {}", option, type),
                       "the scenario has no vehicle type with this id; " + suggestion(type, known));
    }
  };
  check("--coordinate-types", options.coordinate_types);
  check("--human-types", options.human_types);
  check("--priority-types", options.priority_types);
  for (const std::string& type : options.human_types) {
    if (std::ranges::count(options.coordinate_types, type) == 0) continue;
    throw InputError("--human-types " + type,
                     "is named in --coordinate-types too; leave it out of one of them");
  }
}

/// @throws InputError if more noise is assumed than lanes have room for
void check_margins(const CoordinateOptions& options, const Margins& margins) {
  if (margins.across <= kWidestMargin) return;
  throw InputError("--assume-noise " + options.assume_noise,
                   fmt::format("takes {:.2f} m between two vehicles side by side, and lanes leave "
                               "{} m; assume less noise",
                               margins.across, kWidestMargin));
}

CoordinatorOptions coordinator_options(const CoordinateOptions& options,
                                       const std::set<std::string>& junctions,
                                       const Traffic& traffic) {
  CoordinatorOptions coordinator;
  coordinator.corridors.takeover = options.zone_radius;
  coordinator.limits.max_lateral_accel = options.max_lateral_accel;
  coordinator.limits.margins = {options.margin_along, options.margin_across};
  tolerate(declared_tolerance(options, traffic), traffic.network(), traffic.step_length(),
           coordinator);
  check_margins(options, coordinator.limits.margins);
  coordinator.late_share = read_faults(options.faults).late_share;
  coordinator.priority.types = {options.priority_types.begin(), options.priority_types.end()};
  coordinator.junctions.assign(junctions.begin(), junctions.end());
  coordinator.escot.seed = options.seed;
  coordinator.share = controlled_share(options);
  coordinator.intent = options.intent == "known"  ? KnownIntent::kRoute
                       : options.intent == "lane" ? KnownIntent::kLane
                                                  : KnownIntent::kNone;
  coordinator.signals =
      options.signal_timing == "instant" ? SignalTiming::instant() : SignalTiming::real();
  coordinator.escot.crossing.tries = options.tries;
  coordinator.escot.threads = options.threads;
  coordinator.replan_budget_ms =
      options.replan_budget_ms >= 0.0 ? options.replan_budget_ms : 1000.0 * coordinator.decision;
  coordinator.budget_from = options.replan_budget_from;
  return coordinator;
}

}  // namespace

FaultTolerance declared_tolerance(const CoordinateOptions& options, const Traffic& traffic) {
  double longest = 4.0;  // [m] of a car, ahead of its rear axle
  for (const std::string& id : traffic.types()) {
    longest = std::max(longest, traffic.type(id).body.front);
  }
  const FaultModel declared = read_assumed(options.assume_noise, read_faults(options.faults));
  return tolerance_of(declared, traffic.step_length(), longest);
}

ControlledShare controlled_share(const CoordinateOptions& options) {
  return {.penetration = options.penetration,
          .coordinate_types = {options.coordinate_types.begin(), options.coordinate_types.end()},
          .human_types = {options.human_types.begin(), options.human_types.end()},
          .seed = options.seed};
}

std::string note_without_effect(const CoordinateOptions& options) {
  if (!controller_named("--controller", options.controller).drives) return "";
  if (options.assume_noise == "faults" && options.faults.empty()) {
    return "--assume-noise faults: without --faults there are none";
  }
  if (!controlled_share(options).is_whole()) return "";
  std::vector<std::string> without;
  if (options.human_faults > 0.0) without.emplace_back("--human-faults");
  if (options.intent != "known") without.emplace_back("--intent " + options.intent);
  if (options.signal_timing != "real") {
    without.emplace_back("--signal-timing " + options.signal_timing);
  }
  if (without.empty()) return "";
  return fmt::format(
      "{}: everybody is taken over; say with --penetration or --human-types who keeps a human "
      "driver",
      fmt::join(without, ", "));
}

std::string note_on_missing_lights(const CoordinateOptions& options, const RoadNetwork& network,
                                   const std::set<std::string>& junctions) {
  constexpr std::size_t kMostNamed = 3;
  const bool drives = controller_named("--controller", options.controller).drives;
  if (!drives || controlled_share(options).is_whole()) return "";
  std::vector<std::string> without;
  for (const std::string& id : junctions) {
    if (!network.junctions.at(id).type.starts_with("traffic_light")) without.push_back(id);
  }
  if (without.empty()) return "";
  const std::size_t named = std::min(without.size(), kMostNamed);
  const std::string more =
      without.size() > named ? fmt::format(" and {} more", without.size() - named) : "";
  return fmt::format(
      "no traffic light at {}{}: human drivers pass there when told to, which carries more than "
      "lights do; tools/networks/signals.py makes a twin of the scenario with lights",
      fmt::join(std::span(without).first(named), ", "), more);
}

std::set<std::string> coordinated_junctions(const CoordinateOptions& options,
                                            const RoadNetwork& network,
                                            std::span<const ParkingLot> lots) {
  check_junctions(options, network);
  std::set<std::string> junctions(options.junctions.begin(), options.junctions.end());
  if (!junctions.empty()) return junctions;
  for (const auto& [id, junction] : network.junctions) {
    if (junction.has_conflicts && !belongs_to_lots(junction, lots, network)) junctions.insert(id);
  }
  if (junctions.empty() && lots.empty() &&
      controller_named("--controller", options.controller).drives) {
    throw InputError(options.configuration,
                     "the network has no junction with conflicting connections; name one with "
                     "--junction");
  }
  return junctions;
}

Drivers::Drivers(const CoordinateOptions& options, Traffic& traffic, const DrivableArea& area,
                 const std::set<std::string>& junctions, std::span<const ParkingLot> lots,
                 const InterruptionPoint& point) {
  const ControllerKind& kind = controller_named("--controller", options.controller);
  if (kind.make == nullptr && lots.empty()) {
    throw InputError("--controller " + options.controller,
                     "is for parking lots, and the scenario has none; choose escot or sumo");
  }
  if (!options.breakdowns.empty() && lots.empty()) {
    throw InputError("--break-down " + options.breakdowns.front(),
                     "is for parking lots, and the scenario has none; leave it out");
  }
  check_types(options, traffic);
  if (!options.dump_instances.empty()) {
    if (!kind.drives || junctions.empty()) {
      throw InputError("--dump-instances",
                       "dumps decisions at junctions, and none is coordinated here; leave it out");
    }
    make_output_folder(options.dump_instances, "--dump-instances");
  }
  for (const ParkingLot& lot : lots) {
    if (!kind.on_lots) break;
    point();
    auto controller = std::make_unique<LotCoordinator>(traffic, lot, lot_options(options));
    lots_.push_back(std::make_unique<LotRecorder>(*controller));
    controllers_.push_back(std::move(controller));
  }
  if (kind.make == nullptr || junctions.empty()) return;
  point();
  std::unique_ptr<Controller> controller =
      kind.make({traffic, area, coordinator_options(options, junctions, traffic)});
  coordinator_ = dynamic_cast<const Coordinator*>(controller.get());
  if (!options.dump_instances.empty() && coordinator_ != nullptr) {
    dump_.emplace(*coordinator_, area,
                  InstanceDumpOptions{
                      .folder = options.dump_instances,
                      .every = options.dump_every,
                      .origin = fmt::format("{}, seed {}", options.configuration, options.seed),
                      .dt = traffic.step_length()});
  }
  controllers_.push_back(std::move(controller));
}

std::vector<Controller*> Drivers::all() const {
  std::vector<Controller*> all;
  for (const auto& controller : controllers_) all.push_back(controller.get());
  all.insert(all.end(), guests_.begin(), guests_.end());
  return all;
}

void Drivers::join(Simulation& simulation) {
  for (Controller* controller : all()) simulation.add(*controller);
  for (const auto& lot : lots_) {
    simulation.add([&lot = *lot](const Snapshot& now) { lot.observe(now.time); });
  }
  if (dump_) simulation.add([this](const Snapshot&) { dump_->observe(); });
}

std::vector<std::string> Drivers::describe_zones() const {
  constexpr std::size_t kMostZones = 20;
  constexpr std::size_t kMostJunctions = 8;
  std::vector<ZoneFigures> zones;
  for (const auto& controller : controllers_) {
    for (ZoneFigures& zone : controller->zones()) zones.push_back(std::move(zone));
  }
  std::vector<std::string> lines;
  for (const ZoneFigures& zone : zones) {
    const std::size_t all = zone.junctions.size();
    const std::size_t named = std::min(all, kMostJunctions);
    const std::string more = all > named ? fmt::format(" and {} more", all - named) : "";
    lines.push_back(fmt::format("control zone {} of {}: {} {}{}; {} movements", lines.size() + 1,
                                zones.size(), all == 1 ? "junction" : "junctions",
                                fmt::join(std::span(zone.junctions).first(named), ", "), more,
                                zone.corridors));
    if (lines.size() == kMostZones && zones.size() > kMostZones) {
      lines.push_back(fmt::format("{} more control zones: see zones in summary.json",
                                  zones.size() - kMostZones));
      break;
    }
  }
  return lines;
}

void Drivers::report_to(RunReport& report) const {
  report.replans.clear();
  report.zones.clear();
  report.left_to_sumo.clear();
  const auto append = [](auto& to, const auto& more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  for (const Controller* controller : all()) {
    append(report.replans, controller->replans());
    append(report.zones, controller->zones());
    append(report.left_to_sumo, controller->left_to_sumo());
  }
  std::ranges::stable_sort(report.replans, {}, &Replan::time);
  if (!coordinator_) return;
  report.detours = coordinator_->detours();
  report.lane_swaps = coordinator_->lane_swaps();
  report.left_to_sumo_sightings = coordinator_->guest_sightings();
  if (report.faults) report.faults->given_up = coordinator_->losses();
  if (const People* people = coordinator_->people()) report.people_greens = people->greens();
  if (const HumanDrivers* humans = coordinator_->humans()) {
    report.humans = {.greens = humans->greens(),
                     .tube_misses = humans->tube_misses(),
                     .unplanned_passages = humans->unplanned_passages()};
  }
}

void Drivers::report_lots(RunReport& report, const TripLog& log, std::span<const Trip> trips,
                          const FreeFlow& free_flow, Simulation& simulation) const {
  report.lots.clear();
  const auto type = [&](const std::string& id) { return simulation.type_of(id); };
  for (const auto& lot : lots_) {
    report.lots.push_back(
        lot->report(log.times_at_gate(trips, free_flow, report.end, lot->lot(), type)));
  }
}

void Drivers::write_lot_files(const RunReport& report, RunFolder& folder) const {
  if (lots_.empty()) return;
  folder.write("visits.csv", parking_events_csv(report.lots, report.end));
  folder.write("occupancy.csv", occupancy_csv(report.lots));
  for (std::size_t i = 0; i < lots_.size(); ++i) {
    const std::string name = i == 0 ? "lot.svg" : fmt::format("lot{}.svg", i + 1);
    folder.write(name, lots_[i]->picture());
  }
}

}  // namespace mvtp
