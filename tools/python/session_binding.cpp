#include <fmt/format.h>
#include <fmt/ranges.h>

#include <atomic>
#include <memory>
#include <utility>

#include "coordinator/report/report.hpp"
#include "planner/problem/input_error.hpp"
#include "tools/coordinate/run.hpp"
#include "tools/python/bindings.hpp"
#include "tools/python/outside_controller.hpp"
#include "tools/python/words.hpp"

namespace mvtp {
namespace {

using namespace py::literals;

/// SUMO's libraries hold one simulation per process.
class OnlyOne {
 public:
  OnlyOne() {
    if (taken_.exchange(true)) {
      throw InputError("simulation",
                       "another one is open in this process; finish() it first, or run the two in "
                       "processes of their own");
    }
  }
  OnlyOne(const OnlyOne&) = delete;
  OnlyOne& operator=(const OnlyOne&) = delete;
  ~OnlyOne() { taken_ = false; }

 private:
  inline static std::atomic<bool> taken_ = false;
};

CoordinateOptions read_options(const std::vector<std::string>& words, bool separate_process) {
  CoordinateOptions options;
  parse_words("coordinate", words,
              [&](CLI::App& app) { declare_coordinate_options(app, options); });
  (void)controller_named("--controller", options.controller);
  options.separate_process = separate_process;
  options.quiet = true;
  return options;
}

/// One run of a scenario, which Python steps.
class Session {
 public:
  Session(const std::vector<std::string>& words, bool separate_process)
      : options_(read_options(words, separate_process)),
        folder_(std::make_unique<RunFolder>(options_.output_dir, "--output-dir")),
        run_(std::make_unique<SumoRun>(
            options_, fmt::format("mvtp.Simulation {}", fmt::join(words, " ")), *folder_,
            RunHost{.say = [this](const std::string& line) { notes_.push_back(line); }})),
        door_(std::make_shared<TrafficDoor>(run_->traffic())) {}
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() { door_->close(); }

  void plug_in(OutsideController& controller, const std::string& name) {
    controller.plug_into(door_);
    run().plug_in(controller, name);
  }
  [[nodiscard]] std::shared_ptr<TrafficDoor> traffic() const { return door_; }
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  [[nodiscard]] double fraction() { return run().fraction(); }
  [[nodiscard]] bool step() { return run().step(); }
  [[nodiscard]] std::string summary_so_far() { return summary_json(run().report_so_far()); }

  /// Ends the run and lets go of SUMO and of the folder, also if its files cannot be written.
  [[nodiscard]] std::string finish(const std::string& failure) {
    (void)run();
    door_->close();
    const auto only = std::exchange(only_, nullptr);
    const auto folder = std::exchange(folder_, nullptr);
    const auto ending = std::exchange(run_, nullptr);
    return summary_json(ending->finish(failure));
  }

 private:
  [[nodiscard]] SumoRun& run() {
    (void)door_->open();
    return *run_;
  }

  std::unique_ptr<OnlyOne> only_ = std::make_unique<OnlyOne>();
  CoordinateOptions options_;
  std::vector<std::string> notes_;
  std::unique_ptr<RunFolder> folder_;
  std::unique_ptr<SumoRun> run_;
  std::shared_ptr<TrafficDoor> door_;
};

}  // namespace

void bind_session(py::module_& module) {
  using Released = py::call_guard<py::gil_scoped_release>;
  py::class_<Session>(module, "Session")
      .def(py::init<const std::vector<std::string>&, bool>(), "words"_a, "separate_process"_a)
      .def("plug_in", &Session::plug_in, "controller"_a, "name"_a, py::keep_alive<1, 2>())
      .def_property_readonly("traffic", &Session::traffic)
      .def_property_readonly("notes", &Session::notes)
      .def_property_readonly("fraction", &Session::fraction)
      .def("step", &Session::step, Released())
      .def("summary_so_far", &Session::summary_so_far, Released())
      .def("finish", &Session::finish, "failure"_a, Released());
}

}  // namespace mvtp
