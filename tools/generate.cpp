#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "planner/problem/instance_file.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/commands.hpp"
#include "tools/generate/random_instance.hpp"
#include "tools/generate/suite.hpp"
#include "tools/option_types.hpp"
#include "tools/output_folder.hpp"
#include "tools/progress.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

struct GenerateCommand {
  Suite suite = Suite::kTypical;
  std::string folder;
  CellChoice choice;
  GenerateOptions options;
  bool quiet = false;
};

int generate(const GenerateCommand& command) {
  const std::vector<Cell> cells = choose_cells(command.suite, command.choice);
  make_output_folder(command.folder, "--output-dir");
  const auto path = [&](const Cell& cell, int i) {
    return (fs::path(command.folder) / file_name(cell, i)).string();
  };
  check_writable(path(cells.front(), 0));

  Progress progress("generate", command.quiet);
  double total = 0.0;  // in robots, which is about the work
  for (const Cell& cell : cells) total += double(cell.robots) * cell.instances;
  double done = 0.0;
  for (const Cell& cell : cells) {
    for (int i = 0; i < cell.instances; ++i) {
      const GeneratedInstance made = generate_instance(cell, command.options, i);
      write_instance(made.instance, path(cell, i),
                     {.name_vehicle = true, .description = made.description});
      done += cell.robots;
      progress.update(done / total, file_name(cell, i));
    }
  }
  return kDone;
}

}  // namespace

Action declare_generate(CLI::App& app) {
  const auto command = std::make_shared<GenerateCommand>();
  app.footer(
      "typical: 2, 4 and 8 robots on a circle, each with its goal straight across\n"
      "sparse:  2 to 10 robots among 20 obstacles on 50 x 50 m, 60 instances for each number\n"
      "dense:   5 to 120 robots on 50 x 50 and 100 x 100 m, without obstacles and with 20 or 40;\n"
      "         60 instances in each of 29 cells\n"
      "crowd:   60 to 1000 robots on 50 x 50 to 300 x 300 m, 10 instances in each of 14 cells;\n"
      "         with --size and --robots also other cells\n"
      "Each robot has a way to its goal if the others are absent. The same options give the same\n"
      "files, byte for byte, and each file is the same whatever else is generated.");
  add_choice<Suite>(app, "suite", command->suite,
                    {{"typical", Suite::kTypical},
                     {"sparse", Suite::kSparse},
                     {"dense", Suite::kDense},
                     {"crowd", Suite::kCrowd}},
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
  app.add_option("--seed", command->options.seed, "Of all random choices [0]")
      ->check(whole_number_between(0, std::numeric_limits<std::int64_t>::max()))
      ->type_name("N")
      ->group("Instances");
  app.add_option("--vehicle", command->options.vehicle,
                 "Vehicle preset, written into the files [escot]")
      ->check([](const std::string& name) {
        const bool known = vehicle_preset(name).has_value();
        return known ? std::string() : "is \"" + name + "\"; choose escot or cl-cbs";
      })
      ->type_name("escot|cl-cbs")
      ->group("Instances");
  add_choice<Bounds>(app, "--bounds", command->options.bounds,
                     {{"axle", Bounds::kAxle}, {"footprint", Bounds::kFootprint}},
                     "What must stay inside the map on the way, written into the files [axle]")
      ->group("Instances");
  return [command] { return generate(*command); };
}

}  // namespace mvtp
