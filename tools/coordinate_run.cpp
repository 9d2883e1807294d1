#include "tools/coordinate_run.hpp"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>

#include "coordinator/audit.hpp"
#include "coordinator/coordinator.hpp"
#include "coordinator/free_flow.hpp"
#include "coordinator/lateral_limits.hpp"
#include "coordinator/report.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/run_recorder.hpp"
#include "tools/version.hpp"
#include "traci_bridge/configuration.hpp"
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
    report_.begin = traffic_->time();
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
    for (const char* name :
         {"summary.json", "vehicles.csv", "replans.csv", "events.csv", "view.html"}) {
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
    area_ = std::make_unique<DrivableArea>(network_);
    audit_ = std::make_unique<Audit>(*area_, traffic_->step_length());
    const std::set<std::string> junctions = coordinated_junctions();
    recorder_ = std::make_unique<RunRecorder>(options_, network_, junctions, report_);
    if (options_.controller == "sumo") return;

    ZoneOptions zone;
    zone.radius = options_.zone_radius;
    zone.max_lateral_accel = options_.max_lateral_accel;
    zone.margins = {options_.margin_along, options_.margin_across};
    zone_ = std::make_unique<Zone>(network_, *area_, junctions, zone);
    CoordinatorOptions coordinator;
    coordinator.escot.seed = options_.seed;
    coordinator.escot.crossing.tries = options_.tries;
    if (options_.replan_budget_ms >= 0.0) coordinator.replan_budget_ms = options_.replan_budget_ms;
    coordinator.budget_from = options_.replan_budget_from;
    coordinator_ = std::make_unique<Coordinator>(*traffic_, *zone_, coordinator);
    coordinator_->prepare();
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
    if (coordinator_) {
      coordinator_->step();
    } else {
      traffic_->step();
    }
    for (const std::string& id : traffic_->departed()) routes_[id] = traffic_->route(id);
    std::vector<Sighting> sightings;
    bool moving = false;
    for (const VehicleState& v : traffic_->vehicles()) {
      const bool ours = coordinator_ && coordinator_->drives(v.id);
      sightings.push_back({&v, &type_of(v.type), ours});
      if (ours) coordinated_.insert(v.id);
      moving = moving || v.speed > 0.1;
    }
    if (moving || sightings.empty()) last_motion_ = traffic_->time();
    audit_->observe(traffic_->time(), sightings);
    recorder_->observe(traffic_->time(), sightings, *audit_);
    report_.sumo_collisions += traffic_->collisions();
  }

  void write_files() {
    report_.audit = audit_->figures();
    report_.events = audit_->events();
    if (coordinator_) {
      report_.replans = coordinator_->replans();
      report_.wrong_lane_sightings = coordinator_->wrong_lane_sightings();
    }
    report_.vehicles = vehicle_records();
    write_text_file(path("summary.json"), summary_json(report_));
    write_text_file(path("vehicles.csv"), vehicles_csv(report_));
    write_text_file(path("replans.csv"), replans_csv(report_));
    write_text_file(path("events.csv"), events_csv(report_));
    if (!options_.no_view) write_text_file(path("view.html"), recorder_->page(report_));
  }

  [[nodiscard]] std::vector<VehicleRecord> vehicle_records() {
    for (const auto& [lane, speed] : network_limited_) network_.lanes.at(lane).speed_limit = speed;
    std::vector<VehicleRecord> records;
    for (const Trip& trip : read_trips(path("tripinfo.xml"))) {
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
  std::unique_ptr<Zone> zone_;
  std::unique_ptr<Coordinator> coordinator_;
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
