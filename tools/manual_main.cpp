#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/cli/version.hpp"
#include "tools/manual/command_help.hpp"
#include "tools/manual/completion.hpp"
#include "tools/manual/man_page.hpp"
#include "tools/manual/markdown_page.hpp"

// Writes the manual pages and the shells' completion from what the programs say of themselves
// ("PROGRAM describe"). Used while building; not installed.

namespace mvtp {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTextBytes = 100'000'000;

void write(const fs::path& folder, const std::string& name, const std::string& text) {
  fs::create_directories(folder);
  write_text_file((folder / name).string(), text);
}

void write_pages(const fs::path& folder, const CommandHelp& command, const CommandHelp* above) {
  write(folder, page_name(command.name) + ".1", man_page(command, above, version()));
  for (const CommandHelp& below : command.commands) write_pages(folder, below, &command);
}

void write_all(const std::vector<std::string>& inputs, const fs::path& folder) {
  std::vector<CommandHelp> programs;
  for (const std::string& input : inputs) {
    programs.push_back(help_of_json(read_text_file(input, kMaxTextBytes), input));
  }
  fs::remove_all(folder);
  std::string reference = "# Commands\nMade from the options of the programs.\n\n";
  for (const CommandHelp& program : merge_programs(programs)) {
    write_pages(folder / "man1", program, nullptr);
    write(folder / "bash", program.name, bash_completion(program));
    write(folder / "zsh", "_" + program.name, zsh_completion(program));
    write(folder / "fish", program.name + ".fish", fish_completion(program));
    reference += markdown_reference(program);
  }
  write(folder / "markdown", "commands.md", reference);
}

int run(int argc, char** argv) {
  CLI::App app("Writes manual pages, shell completion and the reference of the docs",
               "mvtp-manual");
  std::vector<std::string> inputs;
  std::string folder;
  app.add_option("DESCRIPTION", inputs, "What \"PROGRAM describe\" printed")->required();
  app.add_option("-o,--output-dir", folder, "Folder to write; what it held is removed")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    write_all(inputs, folder);
    return 0;
  } catch (const InputError& error) {
    fmt::print(stderr, "mvtp-manual: {}\n", error.what());
    return 2;
  }
}

}  // namespace
}  // namespace mvtp

int main(int argc, char** argv) { return mvtp::run(argc, argv); }
