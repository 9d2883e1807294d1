#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/commands.hpp"
#include "tools/instance_options.hpp"
#include "tools/option_types.hpp"
#include "tools/output_files.hpp"
#include "tools/view/load.hpp"
#include "tools/view/page.hpp"
#include "tools/view/svg.hpp"

namespace mvtp {
namespace {

struct ViewOptions {
  ViewRequest request;
  std::string output = "view.html";
  std::optional<double> at;
};

bool is_svg(const std::string& path) { return path.ends_with(".svg"); }

/// The text of the output: a page, or the drawing of one moment.
std::string text_of(const ViewOptions& options) {
  const std::vector<Replay> replays = load_replays(options.request);
  if (!options.at) return to_html(replays);
  if (replays.size() != 1) {
    throw InputError(
        "--at", "draws one replay; give one file instead of " + std::to_string(replays.size()));
  }
  return to_svg(replays.front(), *options.at, options.request.files.front());
}

int view(const ViewOptions& options) {
  std::vector<std::string> inputs = options.request.files;
  inputs.insert(inputs.end(), options.request.instances.begin(), options.request.instances.end());
  check_output_files({options.output}, inputs);
  if (options.at.has_value() != is_svg(options.output)) {
    throw InputError("--output", "is " + options.output +
                                     "; give a name that ends in .svg with "
                                     "--at, and only then");
  }
  write_text_file(options.output, text_of(options));
  return kDone;
}

}  // namespace

Action declare_view(CLI::App& app) {
  const auto options = std::make_shared<ViewOptions>();
  ViewRequest& request = options->request;
  app.footer(
      "Several files play side by side and in step, e.g. two plans of one instance:\n"
      "  mvtp view escot.yaml pbcr.yaml --instance cross.yaml\n"
      "or two runs, from the pages that `mvtp coordinate` wrote:\n"
      "  mvtp view light/view.html coordinated/view.html --label light --label coordinated");
  app.add_option("files", request.files, "Plans, instances alone, or pages of replays (*.html)")
      ->required()
      ->type_name("FILE");
  app.add_option("-i,--instance", request.instances,
                 "Instance of the plans; give it once for all plans, or once for each")
      ->type_name("FILE")
      ->expected(1)
      ->take_all()
      ->group("Input");
  add_instance_options(app, request.reading);
  app.add_option("--at", options->at, "Draw this moment alone [s], as FILE.svg of --output")
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
  return [options] { return view(*options); };
}

}  // namespace mvtp
