#include "tools/coordinate/run.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "coordinator/faults/faulty_traffic.hpp"
#include "coordinator/report/report.hpp"
#include "coordinator/report/trip_log.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/interruption.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/program.hpp"
#include "tools/cli/progress.hpp"
#include "tools/cli/run_folder.hpp"
#include "tools/cli/version.hpp"
#include "tools/coordinate/closing.hpp"
#include "tools/coordinate/drivers.hpp"
#include "tools/coordinate/misbehaviour.hpp"
#include "tools/coordinate/run_recorder.hpp"
#include "tools/coordinate/scenario.hpp"
#include "tools/coordinate/traffic.hpp"
#include "traci_bridge/parking_file.hpp"
#include "traci_bridge/trips.hpp"

namespace mvtp {
namespace {

constexpr double kCheckpointEvery = 60.0;      ///< [s] simulated
constexpr double kAfterLastDeparture = 120.0;  ///< [s] that a run goes on about, for the progress

/// How many threads a run may use at a time.
std::size_t threads_of(const CoordinateOptions& options) {
  const int cores = tbb::info::default_concurrency();
  return std::size_t(options.threads > 0 ? std::min(options.threads, cores) : cores);
}

}  // namespace

class SumoRun::Impl {
 public:
  Impl(const CoordinateOptions& options, const std::string& command, RunFolder& folder,
       RunHost host)
      : options_(options),
        folder_(folder),
        host_(std::move(host)),
        threads_(tbb::global_control::max_allowed_parallelism, threads_of(options)),
        point_([this] {
          if (host_.interrupted()) throw Interruption();
        }),
        scenario_(plan_run(options, folder, point_)),
        traffic_(open_traffic(options, scenario_)),
        lots_((point_(),
               read_parking_lots(scenario_.configuration.additional_files, traffic_->network()))),
        junctions_((point_(), coordinated_junctions(options, traffic_->network(), lots_))),
        area_(traffic_->network(), lots_, "", point_),
        audit_(area_, traffic_->step_length(), traffic_->network(), lots_),
        log_(*traffic_),
        free_flow_(traffic_->network()),
        safety_(traffic_->network(), traffic_->step_length()),
        faulty_(make_faulty(options, *traffic_)),
        drivers_(options, seen_by_drivers(), area_, junctions_, lots_, point_),
        misbehaviour_(make_misbehaviour(options, *traffic_, junctions_)),
        simulation_(*traffic_),
        priority_{{options.priority_types.begin(), options.priority_types.end()}} {
    report_.controller = options.controller;
    report_.command = command;
    report_.seed = options.seed;
    report_.penetration =
        controller_named("--controller", options.controller).drives ? options.penetration : 0.0;
    report_.mvtp_version = version();
    report_.sumo_version = sumo_version();
    report_.begin = report_.end = traffic_->time();
    if (faulty_ || !options.assume_noise.empty()) {
      report_.faults = {.simulated = options.faults,
                        .assumed = options.assume_noise,
                        .tolerance = declared_tolerance(options, *traffic_),
                        .step_length = traffic_->step_length(),
                        .figures = {},
                        .given_up = {}};
    }
    point_();
    if (!options_.no_view) {
      recorder_ = std::make_unique<RunRecorder>(options_, *traffic_, junctions_, lots_,
                                                drivers_.coordinator(), report_);
    }
    point_();
    folder_.remove_old_results();
    for (const std::string& note : scenario_.notes) say("note: " + note);
    for (const std::string& note : notes_on(*traffic_)) say("note: " + note);
    for (const std::string& note :
         {note_without_effect(options_),
          note_on_missing_lights(options_, traffic_->network(), junctions_)}) {
      if (!note.empty()) say("note: " + note);
    }
    if (options_.quiet) return;
    for (const std::string& zone : drivers_.describe_zones()) say(zone);
  }

  [[nodiscard]] SumoTraffic& traffic() { return *traffic_; }

  void plug_in(Controller& controller, const std::string& name) {
    if (begun_) throw std::logic_error("a controller is plugged in before the first step");
    drivers_.plug_in(controller);
    report_.controller = name;
    report_.penetration = options_.penetration;
  }

  bool step() {
    if (!begun_) begin();
    status_ = simulation_.end_by({.end = scenario_.end, .interrupted = host_.interrupted});
    if (status_) return false;
    simulation_.step();
    return true;
  }

  [[nodiscard]] double fraction() const {
    const double last = scenario_.demand.last_departure.value_or(report_.begin);
    const double end = scenario_.end.value_or(last + kAfterLastDeparture);
    return std::clamp((report_.end - report_.begin) / std::max(end - report_.begin, 1.0), 0.0,
                      0.99);
  }

  const RunReport& report_so_far() {
    report_.status = to_string(RunStatus::kInterrupted);
    judge(log_.trips());
    return report_;
  }

  const RunReport& finish(const std::string& failure) {
    if (!begun_) begin();
    report_.message = failure;
    const RunStatus status =
        failure.empty() ? status_.value_or(RunStatus::kInterrupted) : RunStatus::kFailed;
    progress_.reset();
    report_.status = to_string(status);
    report_.wall_time = std::chrono::duration<double>(Clock::now() - start_).count();
    const std::vector<Trip> trips = close(status);
    judge(trips);
    try {
      write_files();
    } catch (const InputError&) {
      folder_.discard();  // no summary: nothing says what the rest is worth
      throw;
    }
    return report_;
  }

  /// Runs to the end and tells the user what came of it. Returns the exit code.
  int drive() {
    std::string failure;
    try {
      while (step()) {
      }
    } catch (const InputError& error) {
      if (report_.end == report_.begin) throw;  // the scenario is broken from the start
      failure = error.what();
    } catch (const std::exception& error) {
      failure = fmt::format("internal error: {}", error.what());
    }
    try {
      (void)finish(failure);
    } catch (const InputError& error) {  // a full disk, a folder that was deleted
      say(error.what());
      return kNotAchieved;
    }
    return conclude();
  }

 private:
  [[nodiscard]] Traffic& seen_by_drivers() {
    if (faulty_) return *faulty_;
    return *traffic_;
  }

  using Clock = std::chrono::steady_clock;

  void say(const std::string& line) const { host_.say(line); }

  void begin() {
    begun_ = true;
    start_ = Clock::now();
    next_checkpoint_ = report_.begin + kCheckpointEvery;
    watch();
  }

  /// Who looks at every step.
  void watch() {
    drivers_.join(simulation_);
    if (misbehaviour_) misbehaviour_->join(simulation_);
    if (faulty_) simulation_.add(faulty_->radio());
    progress_.emplace("coordinate", options_.quiet);
    simulation_.add([this](const Snapshot& now) {
      report_.end = now.time;
      report_.sumo_collisions += traffic_->collisions();
      log_.observe(now);
      style_.observe(now.time, now.vehicles, now.resting);
      people_.observe(now);
      tbb::parallel_invoke([&] { safety_.observe(now.time, now.vehicles); },
                           [&] { audit_.observe(now.time, now.vehicles, now.people); });
      if (misbehaviour_) misbehaviour_->observe(now, audit_);
      if (recorder_) recorder_->observe(now, audit_);
      if (now.time >= next_checkpoint_) checkpoint();
      tell_progress(now);
    });
  }

  /// What is known so far, in case that the process does not get any further.
  void checkpoint() {
    next_checkpoint_ += kCheckpointEvery;
    report_.status = to_string(RunStatus::kFailed);
    judge(log_.trips());
    folder_.write("vehicles.csv", vehicles_csv(report_));
    folder_.write("replans.csv", replans_csv(report_));
    folder_.write("events.csv", events_csv(report_));
    folder_.write("summary.json", summary_json(report_));  // last: where it is, the others are
  }

  void tell_progress(const Snapshot& now) {
    progress_->update(fraction(),
                      fmt::format("t = {:.0f} s, {} vehicles", now.time, now.vehicles.size()));
  }

  /// Ends SUMO; its record of the trips, or ours if it leaves none.
  std::vector<Trip> close(RunStatus status) {
    if (status == RunStatus::kFailed) traffic_->keep_outputs();
    try {
      // SUMO tells nothing after its end, and its trips name the types of those, too, who departed
      // in the last step or never.
      for (const std::string& id : traffic_->types()) (void)simulation_.type_of(id);
      traffic_->close();
      if (scenario_.sumo.remote) return log_.trips();
      return read_trips(folder_.path("tripinfo.xml"));
    } catch (const InputError& error) {
      fail(error.what());
      cut_off_ = true;
    }
    return log_.trips();
  }

  void fail(const std::string& message) {
    report_.status = to_string(RunStatus::kFailed);
    if (report_.message.empty()) report_.message = message;
  }

  void judge(const std::vector<Trip>& trips) {
    report_.audit = audit_.figures();
    report_.events = audit_.events();
    report_.pet = safety_.post_encroachment();
    report_.ttc = safety_.to_collision();
    report_.people = people_.figures();
    if (faulty_) report_.faults->figures = faulty_->figures();
    drivers_.report_to(report_);
    if (misbehaviour_) report_.human_faults = misbehaviour_->figures();
    report_.vehicles = log_.records(
        trips, free_flow_, report_.end,
        [this](const std::string& type) { return simulation_.type_of(type).body.max_speed; },
        audit_.clearances());
    const std::map<std::string, DrivingFigures> driving = style_.figures();
    for (VehicleRecord& v : report_.vehicles) {
      if (const auto known = driving.find(v.id); known != driving.end()) v.driving = known->second;
      if (!simulation_.knows(v.type)) continue;
      v.vehicle_class = simulation_.type_of(v.type).vehicle_class;
      v.priority = priority_.kind_of(simulation_.type_of(v.type));
    }
    drivers_.report_lots(report_, log_, trips, free_flow_, simulation_);
  }

  void write_files() {
    const SumoWarnings warnings = traffic_->warnings();
    report_.sumo_warnings = warnings.count;
    if (warnings.count == 0) folder_.drop("sumo.log");
    drivers_.write_lot_files(report_, folder_);
    folder_.write("summary.json", summary_json(report_));
    folder_.write("vehicles.csv", vehicles_csv(report_));
    folder_.write("replans.csv", replans_csv(report_));
    folder_.write("events.csv", events_csv(report_));
    if (recorder_) write_page();
    folder_.commit();
    if (cut_off_) finish_parts(options_.output_dir);
    for (const std::string& note : copy_outputs(scenario_, options_.configuration)) {
      say("note: " + note);
    }
    if (!report_.left_to_sumo.empty()) {
      const LeftToTraffic& first = report_.left_to_sumo.front();
      say(fmt::format("note: turns left to SUMO: {}, see left_to_sumo in {}; first: {}: {}",
                      report_.left_to_sumo.size(), folder_.path("summary.json"), first.what,
                      first.why));
    }
    if (warnings.untold == 0) return;
    say(fmt::format("note: SUMO warned {} times, see {}; first: {}", warnings.untold,
                    folder_.path("sumo.log"), fmt::join(warnings.first, " | ")));
  }

  /// The largest file by far: what else there is does not depend on it.
  void write_page() {
    try {
      folder_.write("view.html", recorder_->page(report_));
    } catch (const InputError& error) {
      say(error.what());
      folder_.drop("view.html");
      page_is_missing_ = true;
    }
  }

  [[nodiscard]] int conclude() {
    if (!options_.quiet) fmt::print("{}", closing_table(report_, options_.output_dir));
    if (report_.status == to_string(RunStatus::kInterrupted)) return kInterrupted;
    if (succeeded(report_)) return page_is_missing_ ? kNotAchieved : kDone;
    for (const std::string& line :
         complaints(report_, options_.configuration, folder_.path("events.csv"))) {
      say(line);
    }
    return kNotAchieved;
  }

  const CoordinateOptions& options_;
  RunFolder& folder_;
  RunHost host_;
  tbb::global_control threads_;
  InterruptionPoint
      point_;  ///< of the preparation: there is no run yet whose results could be kept
  Scenario scenario_;
  std::unique_ptr<SumoTraffic> traffic_;
  std::vector<ParkingLot> lots_;
  std::set<std::string> junctions_;
  DrivableArea area_;
  Audit audit_;
  TripLog log_;
  PeopleLog people_;
  FreeFlow free_flow_;
  DrivingStyle style_;
  SurrogateSafety safety_;
  std::unique_ptr<FaultyTraffic> faulty_;  ///< none: nothing goes wrong
  Drivers drivers_;
  std::unique_ptr<Misbehaviour> misbehaviour_;  ///< none: every human driver keeps to the rules
  Simulation simulation_;
  Priority priority_;
  RunReport report_;
  std::unique_ptr<RunRecorder> recorder_;  ///< none: nobody wants the page
  std::optional<Progress> progress_;
  bool begun_ = false;
  Clock::time_point start_{};
  std::optional<RunStatus> status_;  ///< none: it goes on
  double next_checkpoint_ = 0.0;     ///< [s] simulated
  bool cut_off_ = false;             ///< SUMO's own files lack their ends
  bool page_is_missing_ = false;     ///< it could not be written
};

SumoRun::SumoRun(const CoordinateOptions& options, const std::string& command, RunFolder& folder,
                 RunHost host)
    : impl_(std::make_unique<Impl>(options, command, folder, std::move(host))) {}
SumoRun::~SumoRun() = default;

SumoTraffic& SumoRun::traffic() { return impl_->traffic(); }
void SumoRun::plug_in(Controller& controller, const std::string& name) {
  impl_->plug_in(controller, name);
}
bool SumoRun::step() { return impl_->step(); }
double SumoRun::fraction() const { return impl_->fraction(); }
const RunReport& SumoRun::report_so_far() { return impl_->report_so_far(); }
const RunReport& SumoRun::finish(const std::string& failure) { return impl_->finish(failure); }
int SumoRun::drive() { return impl_->drive(); }

int run_coordinate(const CoordinateOptions& options, const std::string& command) {
  const NotedInterrupt interrupt;
  (void)controller_named("--controller", options.controller);
  RunFolder folder(options.output_dir, "--output-dir");
  announce_run_folder(options.output_dir);
  const auto say = [](const std::string& line) { fmt::print(stderr, "mvtp: {}\n", line); };
  try {
    return SumoRun(options, command, folder,
                   {.say = say, .interrupted = [&] { return interrupt.seen().load(); }})
        .drive();
  } catch (const Interruption&) {
    return kInterrupted;
  }
}

}  // namespace mvtp
