#include "tools/coordinate/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>

#include "coordinator/audit.hpp"
#include "coordinator/coordinator.hpp"
#include "coordinator/free_flow.hpp"
#include "coordinator/lateral_limits.hpp"
#include "coordinator/lot_coordinator.hpp"
#include "coordinator/report.hpp"
#include "coordinator/simulation.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/coordinate/lot_options.hpp"
#include "tools/coordinate/lot_recorder.hpp"
#include "tools/coordinate/run_recorder.hpp"
#include "tools/version.hpp"
#include "traci_bridge/configuration.hpp"
#include "traci_bridge/parking_file.hpp"
#include "traci_bridge/sumo_traffic.hpp"
#include "traci_bridge/trips.hpp"

namespace mvtp {
namespace {

volatile std::sig_atomic_t interrupted = 0;

constexpr double kStuckAfter = 300.0;  ///< [s] without any motion

/// The run: SUMO, the road, who drives, and who watches.
class Run {
 public:
  Run(const CoordinateOptions& options, const std::string& command)
      : options_(options), directory_(options.output_dir) {
    report_.controller = options.controller;
    report_.command = command;
    report_.seed = options.seed;
    report_.mvtp_version = version();
    report_.sumo_version = sumo_version();
    prepare_directory();
    open_traffic();
  }

  int drive() {
    const auto begin = std::chrono::steady_clock::now();
    report_.begin = last_motion_ = traffic_->time();
    report_.status = "finished";
    while (traffic_->running()) {
      if (interrupted) report_.status = "interrupted";
      if (options_.end && traffic_->time() >= *options_.end) report_.status = "end reached";
      if (traffic_->time() - last_motion_ > kStuckAfter) report_.status = "stuck";
      if (report_.status != "finished") break;
      step();
    }
    report_.end = traffic_->time();
    report_.wall_time =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    traffic_->close();
    write_files();
    return exit_code();
  }

 private:
  void prepare_directory() {
    if (options_.output_dir.empty()) throw InputError("--output-dir", "is empty; give a folder");
    std::error_code error;
    std::filesystem::create_directories(directory_, error);
    if (error) {
      throw InputError(options_.output_dir, "cannot make this folder (" + error.message() +
                                                "); choose another --output-dir");
    }
    for (const char* name : {"summary.json", "vehicles.csv", "replans.csv", "events.csv",
                             "view.html", "visits.csv", "occupancy.csv", "lot.svg"}) {
      check_writable(path(name));
    }
  }

  void open_traffic() {
    SumoOptions sumo;
    sumo.configuration = options_.configuration;
    sumo.seed = options_.seed;
    sumo.gui = options_.gui;
    if (!options_.no_fcd) sumo.fcd_output = path("fcd.xml");
    sumo.tripinfo_output = path("tripinfo.xml");
    sumo.extra = options_.sumo;
    traffic_ = open_sumo(sumo);
    network_ = traffic_->network();
    if (options_.max_lateral_accel > 0.0) {
      for (const auto& [lane, speed] : bend_speed_limits(network_, options_.max_lateral_accel)) {
        traffic_->limit_speed(lane, speed);
        network_limited_[lane] = speed;
      }
    }
    lots_ =
        read_parking_lots(read_configuration(options_.configuration).additional_files, network_);
    area_ = std::make_unique<DrivableArea>(network_, lots_);
    audit_ = std::make_unique<Audit>(*area_, traffic_->step_length());
    const std::set<std::string> junctions =
        lots_.empty() ? coordinated_junctions() : std::set<std::string>();
    recorder_ = std::make_unique<RunRecorder>(options_, network_, junctions, lots_, report_);
    check_controller();
    if (options_.controller == "sumo") {
      controller_ = std::make_unique<OwnDrivers>(*traffic_);
    } else if (lots_.empty()) {
      open_zone();
    } else {
      open_lot();
    }
    simulation_ = std::make_unique<Simulation>(*traffic_);
    simulation_->add(*controller_);
  }

  void check_controller() const {
    const bool for_lots =
        options_.controller == "one-at-a-time" || options_.controller == "prioritized";
    if (for_lots && lots_.empty()) {
      throw InputError("--controller " + options_.controller,
                       "is for parking lots, and the scenario has none; choose escot or sumo");
    }
    if (lots_.size() > 1 && options_.controller != "sumo") {
      throw InputError(options_.configuration,
                       fmt::format("has {} parking lots ({}, {}, ...); one can be coordinated, so "
                                   "leave the others' parking.ground out",
                                   lots_.size(), lots_[0].id, lots_[1].id));
    }
  }

  void open_zone() {
    CoordinatorOptions coordinator;
    coordinator.corridors.takeover = options_.zone_radius;
    coordinator.limits.max_lateral_accel = options_.max_lateral_accel;
    coordinator.limits.margins = {options_.margin_along, options_.margin_across};
    coordinator.junctions = options_.junctions;
    coordinator.escot.seed = options_.seed;
    coordinator.escot.crossing.tries = options_.tries;
    if (options_.replan_budget_ms >= 0.0) coordinator.replan_budget_ms = options_.replan_budget_ms;
    coordinator.budget_from = options_.replan_budget_from;
    auto crossing = std::make_unique<Coordinator>(*traffic_, *area_, coordinator);
    coordinator_ = crossing.get();
    controller_ = std::move(crossing);
  }

  void open_lot() {
    auto lot = std::make_unique<LotCoordinator>(*traffic_, lots_.front(), lot_options(options_));
    lot_recorder_ = std::make_unique<LotRecorder>(*lot);
    controller_ = std::move(lot);
  }

  [[nodiscard]] std::set<std::string> coordinated_junctions() const {
    std::set<std::string> junctions(options_.junctions.begin(), options_.junctions.end());
    for (const std::string& id : junctions) {
      if (!network_.junctions.contains(id)) {
        throw InputError("--junction " + id, "the network has no junction with this id");
      }
    }
    if (!junctions.empty()) return junctions;
    for (const auto& [id, junction] : network_.junctions) {
      if (junction.has_conflicts) junctions.insert(id);
    }
    if (junctions.empty()) {
      throw InputError(options_.configuration,
                       "the network has no junction with conflicting connections; name one with "
                       "--junction");
    }
    return junctions;
  }

  void step() {
    simulation_->step();
    for (const std::string& id : traffic_->departed()) routes_[id] = traffic_->route(id);
    std::vector<Sighting> sightings;
    bool moving = false;
    for (const VehicleState& v : traffic_->vehicles()) {
      const bool ours = controller_->drives(v.id);
      sightings.push_back({&v, &type_of(v.type), ours});
      if (ours) coordinated_.insert(v.id);
      moving = moving || v.speed > 0.1;
    }
    if (moving || all_rest()) last_motion_ = traffic_->time();
    audit_->observe(traffic_->time(), sightings, traffic_->pedestrians());
    if (lot_recorder_) lot_recorder_->observe(traffic_->time());
    recorder_->observe(traffic_->time(), sightings, *audit_);
    report_.sumo_collisions += traffic_->collisions();
  }

  [[nodiscard]] bool all_rest() const {
    return std::ranges::all_of(traffic_->vehicles(),
                               [this](const VehicleState& v) { return controller_->rests(v.id); });
  }

  void write_files() {
    report_.audit = audit_->figures();
    report_.events = audit_->events();
    report_.replans = controller_->replans();
    if (coordinator_) report_.wrong_lane_sightings = coordinator_->wrong_lane_sightings();
    const std::vector<Trip> trips = read_trips(path("tripinfo.xml"));
    report_.vehicles = vehicle_records(trips);
    if (lot_recorder_) {
      report_.lot = lot_recorder_->report(times_at_gate(trips));
      write_text_file(path("visits.csv"), visits_csv(*report_.lot, report_.end));
      write_text_file(path("occupancy.csv"), occupancy_csv(*report_.lot));
      write_text_file(path("lot.svg"), lot_recorder_->picture());
    }
    write_text_file(path("summary.json"), summary_json(report_));
    write_text_file(path("vehicles.csv"), vehicles_csv(report_));
    write_text_file(path("replans.csv"), replans_csv(report_));
    write_text_file(path("events.csv"), events_csv(report_));
    if (!options_.no_view) write_text_file(path("view.html"), recorder_->page(report_));
  }

  /// When each vehicle would have been at the gate if nobody had been before it [s].
  [[nodiscard]] std::map<std::string, double> times_at_gate(const std::vector<Trip>& trips) {
    std::map<std::string, double> times;
    for (const Trip& trip : trips) {
      const auto route = routes_.find(trip.id);
      const double intended = trip.depart.value_or(report_.end) - trip.depart_delay;
      if (route == routes_.end()) {
        times[trip.id] = intended;  // it never got onto the road
        continue;
      }
      for (const LotLane& entry : lots_.front().entries) {
        const auto edge = std::ranges::find(route->second, network_.lanes.at(entry.lane).edge);
        if (edge == route->second.end()) continue;
        const VehicleType& type = type_of(trip.type);
        times[trip.id] =
            intended + free_flow_duration(network_, std::span(route->second.begin(), edge + 1),
                                          trip.depart_lane, trip.depart_position,
                                          entry.offset + type.body.length(), trip.speed_factor,
                                          type.body.max_speed);
      }
    }
    return times;
  }

  [[nodiscard]] std::vector<VehicleRecord> vehicle_records(const std::vector<Trip>& trips) {
    for (const auto& [lane, speed] : network_limited_) network_.lanes.at(lane).speed_limit = speed;
    std::vector<VehicleRecord> records;
    for (const Trip& trip : trips) {
      VehicleRecord v;
      v.id = trip.id;
      v.type = trip.type;
      v.intended_departure = trip.depart.value_or(report_.end) - trip.depart_delay;
      v.departure = trip.depart;
      v.arrival = trip.arrival;
      v.time_loss = trip.time_loss;
      v.waiting_time = trip.waiting_time;
      v.speed_factor = trip.speed_factor;
      v.coordinated = coordinated_.contains(trip.id);
      if (const auto c = audit_->clearances().find(trip.id); c != audit_->clearances().end()) {
        v.min_clearance = c->second;
      }
      if (const auto r = routes_.find(trip.id); r != routes_.end()) {
        const double last = network_.lanes.at(network_.edges.at(r->second.back()).front()).length;
        v.free_flow =
            free_flow_duration(network_, r->second, trip.depart_lane, trip.depart_position,
                               trip.arrival ? trip.arrival_position : last, trip.speed_factor,
                               type_of(trip.type).body.max_speed);
      }
      records.push_back(std::move(v));
    }
    std::ranges::sort(records, {}, &VehicleRecord::id);
    return records;
  }

  [[nodiscard]] int exit_code() const {
    if (report_.status == "interrupted") return 130;
    if (succeeded(report_)) return 0;
    const auto missing = std::ranges::count_if(
        report_.vehicles, [](const VehicleRecord& v) { return !v.arrival.has_value(); });
    if (report_.audit.overlap_pairs_coordinated > 0) {
      std::cerr << "mvtp: " << report_.audit.overlap_pairs_coordinated
                << " pairs with a coordinated vehicle overlapped; see " << path("view.html")
                << "\n";
    }
    if (report_.audit.people_touched > 0) {
      std::cerr << "mvtp: " << report_.audit.people_touched << " people were touched; see "
                << path("events.csv") << "\n";
    }
    if (missing > 0) {
      std::cerr << "mvtp: " << missing << " of " << report_.vehicles.size()
                << " vehicles had not arrived at t = " << report_.end << " s (" << report_.status
                << ")\n";
    }
    return 1;
  }

  const VehicleType& type_of(const std::string& id) {
    const auto known = types_.find(id);
    return known != types_.end() ? known->second
                                 : types_.emplace(id, traffic_->type(id)).first->second;
  }

  [[nodiscard]] std::string path(const char* name) const { return (directory_ / name).string(); }

  const CoordinateOptions& options_;
  std::filesystem::path directory_;
  RunReport report_;
  std::unique_ptr<SumoTraffic> traffic_;
  RoadNetwork network_;
  std::map<std::string, double> network_limited_;
  std::unique_ptr<DrivableArea> area_;
  std::unique_ptr<Audit> audit_;
  std::unique_ptr<RunRecorder> recorder_;
  std::vector<ParkingLot> lots_;
  std::unique_ptr<Controller> controller_;
  std::unique_ptr<Simulation> simulation_;
  Coordinator* coordinator_ = nullptr;  ///< the controller, if it is that of a zone
  std::unique_ptr<LotRecorder> lot_recorder_;
  std::map<std::string, std::vector<std::string>> routes_;
  std::map<std::string, VehicleType> types_;
  std::set<std::string> coordinated_;
  double last_motion_ = 0.0;
};

}  // namespace

int run_coordinate(const CoordinateOptions& options, const std::string& command) {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = 1; });
  set_sumo_home();
  Run run(options, command);
  return run.drive();
}

}  // namespace mvtp
