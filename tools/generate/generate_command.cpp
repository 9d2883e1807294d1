#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "planner/problem/instance_file.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_folder.hpp"
#include "tools/cli/progress.hpp"
#include "tools/generate/parking_instance.hpp"
#include "tools/generate/random_instance.hpp"
#include "tools/generate/suite.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

struct GenerateCommand {
  std::optional<Suite> suite;  ///< none: parking
  std::string folder;
  CellChoice choice;
  GenerateOptions options;
  ParkingCell parking;
  bool quiet = false;
};

/// One file to write.
struct Task {
  std::string name;
  double work = 1.0;  ///< in robots, which is about that
  std::function<GeneratedInstance()> make;
};

std::vector<Task> tasks_of_cells(const GenerateCommand& command) {
  std::vector<Task> tasks;
  for (const Cell& cell : choose_cells(*command.suite, command.choice)) {
    for (int i = 0; i < cell.instances; ++i) {
      tasks.push_back({file_name(cell, i), double(cell.robots), [cell, i, &command] {
                         return generate_instance(cell, command.options, i);
                       }});
    }
  }
  return tasks;
}

std::vector<Task> tasks_of_parking(const GenerateCommand& command) {
  ParkingCell cell = command.parking;
  if (command.choice.instances) cell.instances = *command.choice.instances;
  check_parking_cell(cell);
  std::vector<Task> tasks;
  for (int i = 0; i < cell.instances; ++i) {
    tasks.push_back({file_name(cell, i), 1.0, [cell, i, &command] {
                       return generate_parking(cell, command.options.seed, i);
                     }});
  }
  return tasks;
}

int generate(const GenerateCommand& command) {
  const std::vector<Task> tasks =
      command.suite ? tasks_of_cells(command) : tasks_of_parking(command);
  make_output_folder(command.folder, "--output-dir");
  const auto path = [&](const Task& task) {
    return (fs::path(command.folder) / task.name).string();
  };
  check_writable(path(tasks.front()));

  Progress progress("generate", command.quiet);
  double total = 0.0;
  for (const Task& task : tasks) total += task.work;
  double done = 0.0;
  for (const Task& task : tasks) {
    const GeneratedInstance made = task.make();
    write_instance(made.instance, path(task),
                   {.name_vehicle = command.suite.has_value(), .description = made.description});
    done += task.work;
    progress.update(done / total, task.name);
  }
  return kDone;
}

/// Options that the suite does not have are refused, not ignored.
void check_options(const CLI::App& app, const GenerateCommand& command) {
  const auto refuse = [&](const char* option, const char* remedy) {
    if (app.count(option) > 0) throw InputError(option, remedy);
  };
  if (command.suite) {
    for (const char* option : {"--in", "--out"})
      refuse(option, "is for parking only; leave it out");
  } else {
    for (const char* option : {"--size", "--obstacles", "--robots", "--vehicle", "--bounds"}) {
      refuse(option, "is not for parking; give --in and --out");
    }
  }
}

const char* const kSuites =
    "typical: 2, 4 and 8 robots on a circle, each with its goal straight across\n"
    "sparse:  2 to 10 robots among 20 obstacles on 50 x 50 m, 60 instances for each number\n"
    "dense:   5 to 120 robots on 50 x 50 and 100 x 100 m, without obstacles and with 20 or 40;\n"
    "         60 instances in each of 29 cells\n"
    "crowd:   60 to 1000 robots on 50 x 50 to 300 x 300 m, 10 instances in each of 14 cells;\n"
    "         with --size and --robots also other cells\n"
    "parking: cars that come to an open lot of 58 slots and cars that leave it, all at once, of\n"
    "         mixed sizes; 60 instances with 24 and 24\n"
    "Each robot has a path to its goal if the others are absent. The same options give the same\n"
    "files, byte for byte, and each file is the same whatever else is generated.";

}  // namespace

Action declare_generate(CLI::App& app) {
  const auto command = std::make_shared<GenerateCommand>();
  app.footer(kSuites);
  add_choice<std::optional<Suite>>(app, "suite", command->suite,
                                   {{"typical", Suite::kTypical},
                                    {"sparse", Suite::kSparse},
                                    {"dense", Suite::kDense},
                                    {"crowd", Suite::kCrowd},
                                    {"parking", std::nullopt}},
                                   "What to write")
      ->required()
      ->group("Input");
  app.add_option("-o,--output-dir", command->folder, "Folder of the instances; made if missing")
      ->required()
      ->type_name("DIR")
      ->group("Output");
  app.add_flag("-q,--quiet", command->quiet, "No progress on stderr")->group("Output");
  const char* cells = "Cells";
  CellChoice& choice = command->choice;
  add_numbers(app, "--size", choice.sides, 5, 10'000, "Only maps with these sides [m]")
      ->group(cells);
  add_numbers(app, "--obstacles", choice.obstacles, 0, 100'000,
              "Only maps with so many obstacles; 0: empty maps")
      ->group(cells);
  add_numbers(app, "--robots", choice.robots, 1, 10'000, "Only cells with so many robots")
      ->group(cells);
  app.add_option("--count", choice.instances, "Instances per cell [those of the suite]")
      ->check(whole_number_between(1, 100'000))
      ->type_name("N")
      ->group(cells);
  const char* lot = "Parking lot";
  app.add_option("--in", command->parking.in, "Cars that come [24]")
      ->check(whole_number_between(0, 1000))
      ->type_name("N")
      ->group(lot);
  app.add_option("--out", command->parking.out, "Cars that leave [24]")
      ->check(whole_number_between(0, 1000))
      ->type_name("N")
      ->group(lot);
  app.add_option("--seed", command->options.seed, "Of all random choices [0]")
      ->check(whole_number_between(0, std::numeric_limits<std::int64_t>::max()))
      ->type_name("N")
      ->group("Instances");
  app.add_option("--vehicle", command->options.vehicle,
                 "Vehicle preset, written into the files [escot]")
      ->check(one_of({"escot", "cl-cbs"}))
      ->type_name("escot|cl-cbs")
      ->group("Instances");
  add_choice<Bounds>(app, "--bounds", command->options.bounds,
                     {{"axle", Bounds::kAxle}, {"footprint", Bounds::kFootprint}},
                     "What must stay inside the map on the way, written into the files [axle]")
      ->group("Instances");
  return [command, &app] {
    check_options(app, *command);
    return generate(*command);
  };
}

}  // namespace mvtp
