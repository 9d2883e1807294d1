#include <fmt/format.h>
#include <sys/wait.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/cli/child_process.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/instance_options.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_files.hpp"
#include "tools/export/formats.hpp"
#include "tools/export/recording.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

enum class Format { kCsv, kCommonRoad, kOpenScenario, kFcd };

struct ExportRequest {
  RecordingRequest request;
  Format format = Format::kCsv;
  std::string output;
  std::string network;
  CommonRoadRequest commonroad;
  double begin = -std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();
};

/// The OpenDRIVE file beside an OpenSCENARIO file.
std::string road_file_beside(const std::string& output) {
  return fs::path(output).replace_extension(".xodr").string();
}

/// A SUMO network as OpenDRIVE, made by SUMO's netconvert. It gets its name by keep(): without that
/// nothing is left of it.
class RoadFile {
 public:
  /// @throws InputError
  RoadFile(const std::string& network, const std::string& path)
      : path_(path), part_(path + ".part") {
    if (convert(network)) return;
    remove(part_);
    throw InputError(network,
                     "netconvert cannot write it as OpenDRIVE; is SUMO installed, and is "
                     "this a SUMO network?");
  }
  ~RoadFile() { remove(part_); }
  RoadFile(const RoadFile&) = delete;
  RoadFile& operator=(const RoadFile&) = delete;

  void keep() const { fs::rename(part_, path_); }

 private:
  [[nodiscard]] bool convert(const std::string& network) const {
    Job job;
    job.arguments = {"/usr/bin/env",       "netconvert", "--sumo-net-file",  network,
                     "--opendrive-output", part_,        "--xml-validation", "never"};
    job.messages = path_ + ".log";
    int status = 0;
    const bool complete = run_jobs(std::span(&job, 1), 1, [&](std::size_t, int end) {
      status = end;
      return true;
    });
    remove(job.messages);
    return complete && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  static void remove(const std::string& path) {
    std::error_code ignored;
    fs::remove(path, ignored);
  }

  std::string path_;
  std::string part_;  ///< as it is written
};

/// What must not be overwritten: a run is read from two files of its folder.
std::vector<std::string> inputs_of(const RecordingRequest& request) {
  if (!fs::is_directory(request.input)) return {request.instance, request.input};
  const fs::path folder = request.input;
  return {(folder / "fcd.xml").string(), (folder / "view.html").string()};
}

/// With the roads of `network` beside it. @throws InputError
void write_with_roads(const ExportRequest& options, const Recording& recording,
                      const std::string& network) {
  const std::string road_file = road_file_beside(options.output);
  if (fs::exists(options.output) && !fs::is_regular_file(options.output)) {
    throw InputError(options.output, "is no file that roads could go beside; give a file");
  }
  std::vector<std::string> inputs = inputs_of(options.request);
  inputs.push_back(network);
  check_output_files({options.output, road_file}, inputs);
  const RoadFile roads(network, road_file);
  write_text_file(options.output,
                  to_openscenario(recording, fs::path(road_file).filename().string()));
  roads.keep();
}

void write_openscenario(const ExportRequest& options, const Recording& recording) {
  const std::string& given = options.network;
  const std::string& network = given.empty() ? recording.network : given;
  if (!network.empty() && (!given.empty() || fs::exists(network))) {
    return write_with_roads(options, recording, network);
  }
  write_text_file(options.output, to_openscenario(recording, ""));
  if (network.empty()) return;
  fmt::print(stderr, "mvtp: export: no roads: {} is not there any more; give --network\n", network);
}

/// Tells how many break the one rule of the schema that recorded traffic breaks.
void write_commonroad(const ExportRequest& options, const Recording& recording) {
  const CommonRoadScenario scenario = to_commonroad(recording, options.commonroad);
  write_text_file(options.output, scenario.text);
  if (scenario.late == 0) return;
  fmt::print(stderr,
             "mvtp: export: {} of {} obstacles enter after time step 0, which CommonRoad's schema "
             "forbids and its reader takes; --obstacle-start-at-zero leaves them out\n",
             scenario.late, scenario.obstacles);
}

void write(const ExportRequest& options, const Recording& recording) {
  switch (options.format) {
    case Format::kCsv:
      return write_text_file(options.output, to_csv(recording));
    case Format::kFcd:
      return write_text_file(options.output, to_fcd(recording));
    case Format::kCommonRoad:
      return write_commonroad(options, recording);
    case Format::kOpenScenario:
      return write_openscenario(options, recording);
  }
}

void check(const ExportRequest& options) {
  check_output_files({options.output}, inputs_of(options.request));
  if (options.format != Format::kCommonRoad) {
    if (!options.commonroad.ego.empty()) throw InputError("--ego", "is for --to commonroad");
    if (options.commonroad.obstacle_start_at_zero) {
      throw InputError("--obstacle-start-at-zero", "is for --to commonroad");
    }
  }
  if (!options.network.empty() && options.format != Format::kOpenScenario) {
    throw InputError("--network", "is for --to openscenario");
  }
}

int export_recording(const ExportRequest& options) {
  check(options);
  Recording recording = read_recording(options.request);
  if (recording.vehicles.empty()) throw InputError(options.request.input, "has no vehicle");
  cut(recording, options.begin, options.end);
  if (recording.vehicles.empty()) {
    throw InputError(options.request.input,
                     "has no vehicle in that time; choose --begin and --end");
  }
  write(options, recording);
  return kDone;
}

void add_output_options(CLI::App& app, ExportRequest& options) {
  add_choice<Format>(app, "--to", options.format,
                     {{"csv", Format::kCsv},
                      {"commonroad", Format::kCommonRoad},
                      {"openscenario", Format::kOpenScenario},
                      {"fcd", Format::kFcd}},
                     "What to write: a table t,id,x,y,yaw,v,steer; CommonRoad 2020a; OpenSCENARIO "
                     "1.2; SUMO's floating car data")
      ->required()
      ->group("Output");
  app.add_option("-o,--output", options.output, "File to write")
      ->required()
      ->type_name("FILE")
      ->group("Output");
  const auto add_time = [&](const char* name, double& target, const char* description) {
    app.add_option(name, target, description)
        ->check(number_between(0.0, 1e9))
        ->type_name("S")
        ->group("Output");
  };
  add_time("--begin", options.begin, "Leave out what was before [s] [all]");
  add_time("--end", options.end, "Leave out what was after [s] [all]");
  app.add_option("--ego", options.commonroad.ego,
                 "CommonRoad: vehicle that becomes the planning problem [none: all are obstacles]")
      ->type_name("ID")
      ->group("Output");
  app.add_flag("--obstacle-start-at-zero", options.commonroad.obstacle_start_at_zero,
               "CommonRoad: leave out vehicles that enter after time step 0, which its schema "
               "forbids and its reader takes")
      ->group("Output");
  app.add_option("--network", options.network,
                 "OpenSCENARIO: SUMO network that goes beside it as OpenDRIVE [that of the run]")
      ->type_name("FILE")
      ->group("Output");
}

}  // namespace

Action declare_export(CLI::App& app) {
  const auto options = std::make_shared<ExportRequest>();
  app.footer(
      "Trajectories for other tools; what the files hold is in docs/file-formats.md. E.g.\n"
      "  mvtp export plan.yaml --to csv -o plan.csv\n"
      "  mvtp export out --to openscenario -o run.xosc");
  app.add_option("INPUT", options->request.input, "Plan, or folder of a run of mvtp coordinate")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  app.add_option("-i,--instance", options->request.instance,
                 "Instance of the plan: its map, and its vehicles if the plan lacks them [none]")
      ->type_name("FILE")
      ->group("Input");
  add_instance_options(app, options->request.reading);
  add_output_options(app, *options);
  return [options] { return export_recording(*options); };
}

}  // namespace mvtp
