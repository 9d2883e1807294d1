#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/cli/child_process.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/instance_options.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_files.hpp"
#include "tools/cli/progress.hpp"
#include "tools/runs/temporary_folder.hpp"
#include "tools/view/browser.hpp"
#include "tools/view/load.hpp"
#include "tools/view/page.hpp"
#include "tools/view/svg.hpp"
#include "tools/view/video.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

struct ViewOptions {
  ViewRequest request;
  std::string output = "view.html";
  std::optional<double> at;
  std::string video;
  VideoRequest film;
  bool quiet = false;
};

/// The bytes of a PNG of a drawing.
std::string png_of(const std::string& svg) {
  const auto program = find_program("rsvg-convert");
  if (!program) {
    throw InputError("--output",
                     "a PNG needs rsvg-convert; install librsvg2-bin, or give a name that ends in "
                     ".svg");
  }
  const TemporaryFolder folder;
  const std::string from = (folder.path() / "moment.svg").string();
  const std::string to = (folder.path() / "moment.png").string();
  write_text_file(from, svg);
  const Job job{.arguments = {program->string(), from, "--output", to}};
  int status = -1;
  const bool complete = run_jobs(std::span(&job, 1), 1, [&](std::size_t, int end) {
    status = end;
    return true;
  });
  if (!complete || status != 0) throw InputError("--output", "rsvg-convert made no PNG of it");
  std::ifstream file(to, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The bytes of the output: a page, or the drawing of one moment.
std::string output_of(const ViewOptions& options) {
  const std::vector<Replay> replays = load_replays(options.request);
  if (!options.at) return to_html(replays);
  if (replays.size() != 1) {
    throw InputError(
        "--at", "draws one replay; give one file instead of " + std::to_string(replays.size()));
  }
  const std::string svg = to_svg(replays.front(), *options.at, options.request.files.front());
  return options.output.ends_with(".png") ? png_of(svg) : svg;
}

void check_names(const ViewOptions& options) {
  std::vector<std::string> inputs = options.request.files;
  inputs.insert(inputs.end(), options.request.instances.begin(), options.request.instances.end());
  check_output_files({options.video.empty() ? options.output : options.video}, inputs);
  if (!options.video.empty()) {
    if (options.video.ends_with(".webm")) return;
    throw InputError("--video", "is " + options.video + "; give a name that ends in .webm");
  }
  const bool is_drawing = options.output.ends_with(".svg") || options.output.ends_with(".png");
  if (options.at.has_value() == is_drawing) return;
  throw InputError("--output", "is " + options.output +
                                   "; give a name that ends in .svg or .png with --at, and only "
                                   "then");
}

int make_video(const ViewOptions& options) {
  const auto program = Browser::find();
  if (!program) {
    throw InputError("--video",
                     "needs a browser; install chromium-headless-shell or chromium, or open the "
                     "page without --video");
  }
  const NotedInterrupt interrupt;
  const TemporaryFolder folder;
  const std::string page = (folder.path() / "view.html").string();
  write_text_file(page, to_html(load_replays(options.request)));
  Browser browser(*program, options.film.size);
  Progress progress("view --video", options.quiet);
  const std::string video = to_video(
      browser, page, options.film, [&](double done) { progress.update(done); }, interrupt.seen());
  if (video.empty()) return kInterrupted;
  write_text_file(options.video, video);
  return kDone;
}

/// A folder of a run stands for the page in it. @throws InputError if it holds none
std::string page_in(const std::string& file) {
  std::error_code ignored;
  if (!fs::is_directory(file, ignored)) return file;
  const fs::path page = fs::path(file) / "view.html";
  if (fs::exists(page, ignored)) return page.string();
  throw InputError(page.string(),
                   "is missing; give a page, a plan, or the folder of a run without "
                   "--no-view");
}

int view(ViewOptions options) {
  std::ranges::transform(options.request.files, options.request.files.begin(), page_in);
  check_names(options);
  if (!options.video.empty()) return make_video(options);
  write_text_file(options.output, output_of(options));
  return kDone;
}

/// @return --video
CLI::Option* add_video_options(CLI::App& app, const std::shared_ptr<ViewOptions>& options) {
  const char* group = "Video";
  CLI::Option* video = app.add_option("--video", options->video,
                                      "Write this video (*.webm) instead of a page; needs Chromium")
                           ->type_name("FILE")
                           ->group(group);
  const auto add = [&](const char* name, auto& value, const char* meaning, const char* type) {
    return app.add_option(name, value, meaning)->type_name(type)->needs(video)->group(group);
  };
  VideoRequest& film = options->film;
  add("--from", film.from, "Where it begins in the run [when somebody is there first]", "S")
      ->check(number_between(-1e9, 1e9));
  add("--to", film.to, "Where it ends in the run [its end]", "S")->check(number_between(-1e9, 1e9));
  add("--speed", film.speed, "Seconds of the run per second", "X")
      ->check(number_between(0.01, 1000.0))
      ->capture_default_str();
  add("--colour", film.colour, "Of the vehicles: state, speed, co2, penetration, type, ...",
      "MODE");
  add("--width", film.size.width, "Of the picture [pixels]", "N")
      ->check(whole_number_between(64, 4096))
      ->capture_default_str();
  add("--height", film.size.height, "Of the picture [pixels]", "N")
      ->check(whole_number_between(64, 4096))
      ->capture_default_str();
  app.add_flag("-q,--quiet", options->quiet, "Say nothing about progress")->group(group);
  return video;
}

}  // namespace

Action declare_view(CLI::App& app) {
  const auto options = std::make_shared<ViewOptions>();
  ViewRequest& request = options->request;
  app.footer(
      "Several files play side by side and in step, e.g. two plans of one instance:\n"
      "  mvtp view escot.yaml pbcr.yaml --instance cross.yaml\n"
      "or two runs, from the pages in the folders that `mvtp coordinate` wrote:\n"
      "  mvtp view light coordinated --label light --label coordinated\n"
      "A video of two minutes in twelve seconds:\n"
      "  mvtp view out --video out.webm --from 60 --to 180 --speed 10");
  app.add_option("files", request.files,
                 "Plans, instances alone, or pages of replays (*.html) or folders with one")
      ->required()
      ->type_name("FILE");
  app.add_option("-i,--instance", request.instances,
                 "Instance of the plans; give it once for all plans, or once for each")
      ->type_name("FILE")
      ->expected(1)
      ->take_all()
      ->group("Input");
  add_instance_options(app, request.reading);
  CLI::Option* at =
      app.add_option("--at", options->at,
                     "Draw this moment alone [s], as FILE.svg or FILE.png of --output")
          ->type_name("S")
          ->check(number_between(0.0, 1e9))
          ->group("Output");
  app.add_option("-o,--output", options->output, "The page to write, or the drawing")
      ->type_name("FILE")
      ->capture_default_str()
      ->group("Output");
  app.add_option("--label", request.labels, "Short name of a replay; give it once for each")
      ->type_name("TEXT")
      ->expected(1)
      ->take_all()
      ->group("Output");
  app.add_option("--title", request.title, "Title of plans and instances [the file's name]")
      ->type_name("TEXT")
      ->group("Output");
  add_video_options(app, options)->excludes(at);
  return [options] { return view(*options); };
}

}  // namespace mvtp
