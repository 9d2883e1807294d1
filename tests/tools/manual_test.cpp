#include <CLI/CLI.hpp>
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "planner/problem/input_error.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/manual/command_help.hpp"
#include "tools/manual/completion.hpp"
#include "tools/manual/man_page.hpp"
#include "tools/manual/markdown_page.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

OptionHelp option(const std::string& name, const std::string& value) {
  return {.names = {name}, .value = value, .description = "What it does", .group = "Options"};
}

CommandHelp command(const std::string& name, const std::vector<OptionHelp>& options) {
  return {.name = name, .summary = "Does things", .options = options};
}

TEST(CommandHelp, IsReadOffTheOptions) {
  CLI::App app("A program", "prog");
  std::string text;
  bool flag = false;
  std::vector<std::string> files;
  CLI::App* sub = app.add_subcommand("go", "Goes");
  sub->add_option("-s,--speed", text, "How fast")
      ->check(CLI::IsMember({"slow", "quick"}))
      ->required()
      ->group("Motion");
  sub->add_flag("--loud", flag, "With noise");
  sub->add_option("FILES", files, "Where to")->type_name("FILE");
  app.add_subcommand("secret", "Is not told")->group("");

  const CommandHelp help = help_of(app);
  EXPECT_EQ(help.name, "prog");
  ASSERT_EQ(help.commands.size(), 1U);
  const CommandHelp& go = help.commands[0];
  EXPECT_EQ(go.name, "prog go");
  ASSERT_EQ(go.options.size(), 4U);  // --help is the first
  EXPECT_THAT(go.options[1].names, ElementsAre("-s", "--speed"));
  EXPECT_THAT(choices_of(go.options[1]), testing::UnorderedElementsAre("slow", "quick"));
  EXPECT_TRUE(go.options[1].required);
  EXPECT_EQ(go.options[1].group, "Motion");
  EXPECT_EQ(go.options[2].value, "");
  EXPECT_TRUE(go.options[3].positional);
  EXPECT_TRUE(go.options[3].repeated);
}

TEST(CommandHelp, SurvivesItsFile) {
  CommandHelp help = command("prog", {option("--speed", "a|b")});
  help.commands = {command("prog go", {})};
  EXPECT_EQ(help_of_json(to_json(help), "help.json"), help);
  EXPECT_THROW((void)help_of_json("{}", "help.json"), InputError);
}

TEST(CommandHelp, ACommandOfAnotherProgramReplacesTheEmptyOne) {
  CommandHelp first = command("prog", {});
  first.commands = {command("prog go", {option("--speed", "N")}), command("prog far", {})};
  CommandHelp second = command("prog", {});
  second.commands = {command("prog far", {option("--path", "FILE"), option("--help", "")})};
  const auto merged = merge_programs({first, second, command("other", {})});
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_EQ(merged[0].commands[0], first.commands[0]);
  EXPECT_EQ(merged[0].commands[1], second.commands[0]);
}

TEST(CommandHelp, ListsOfNumbersAreNoChoice) {
  EXPECT_THAT(choices_of(option("--ids", "ID,ID,...")), IsEmpty());
  EXPECT_THAT(choices_of(option("--with", "a,b")), ElementsAre("a", "b"));
}

TEST(ManPage, PrintsTextThatTroffWouldTakeForCommands) {
  CommandHelp help = command("prog", {});
  help.footer = ".TH of a \\ and a-b\n'quoted\n  an example";
  EXPECT_THAT(man_page(help, nullptr, "1.0.0"),
              HasSubstr(".SH DESCRIPTION\n\\&.TH of a \\e and a\\-b\n\\&'quoted\n"
                        ".PP\n.EX\n  an example\n.EE\n"));
}

TEST(MarkdownReference, PrintsTextThatMarkdownWouldTakeForMarkup) {
  CommandHelp go = command("prog go", {option("--path", "a|b")});
  go.options[0].description = "One of *these*\nor <none>";
  go.options[0].default_value = "a";
  CommandHelp program = command("prog", {});
  program.commands = {go};
  const std::string page = markdown_reference(program);
  EXPECT_THAT(page, HasSubstr("## prog go\n"));
  EXPECT_THAT(page, HasSubstr("| <code>--path</code> <code>a&#124;b</code> | "
                              "One of \\*these\\*<br>or &lt;none> \\[a] |\n"));
}

TEST(ManPage, NamesItselfAndThatAboveIt) {
  const CommandHelp above = command("prog", {});
  const std::string page = man_page(command("prog go", {option("--speed", "N")}), &above, "1.0.0");
  EXPECT_THAT(page, HasSubstr(".TH PROG-GO 1 \"\" \"mvtp 1.0.0\""));
  EXPECT_THAT(page, HasSubstr("prog\\-go \\- Does things\n"));
  EXPECT_THAT(page, HasSubstr(".TP\n\\fB\\-\\-speed\\fR \\fIN\\fR\nWhat it does\n"));
  EXPECT_THAT(page, HasSubstr(".SH SEE ALSO\n\\fBprog\\fR(1)\n"));
}

/// What was generated from the built programs.
class Manual : public Program {
 protected:
  static std::string file(const std::string& name) { return std::string(MVTP_MANUAL) + "/" + name; }
  static bool installed(const std::string& shell) {
    return std::system(("command -v " + shell + " >/dev/null").c_str()) == 0;
  }
  /// The words that bash offers for the last of `words`.
  [[nodiscard]] std::string bash(const std::string& words) const {
    const Outcome outcome = shell("bash -c '. \"" + file("bash/mvtp") + "\"; COMP_WORDS=(" + words +
                                  "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _mvtp; "
                                  "echo ${COMPREPLY[@]}'");
    EXPECT_THAT(outcome.err, IsEmpty());
    return outcome.out;
  }
  /// Every --option in `text`.
  static std::set<std::string> options_in(const std::string& text) {
    static const std::regex kOption("--[a-z][a-z-]+");
    return {std::sregex_token_iterator(text.begin(), text.end(), kOption),
            std::sregex_token_iterator()};
  }
};

TEST_F(Manual, HasAPageForEveryCommandWithEveryOption) {
  for (const std::string command : {"solve", "coordinate", "toio export", "bench merge"}) {
    if (command == "coordinate" && run("coordinate --help").exit_code != 0) continue;
    const std::string page = file("man1/" + page_name("mvtp " + command) + ".1.gz");
    const std::string text = shell("gzip -dc '" + page + "' | sed 's/\\\\-/-/g'").out;
    for (const std::string& option : options_in(run(command + " --help").out)) {
      EXPECT_THAT(text, HasSubstr(option)) << page;
    }
  }
}

TEST_F(Manual, BashCompletesCommandsOptionsChoicesAndFiles) {
  (void)directory_.file("plan.yaml", "");
  fs::create_directory(directory_.path("folder"));
  EXPECT_EQ(bash("mvtp sol"), "solve\n");
  EXPECT_EQ(bash("mvtp toio ex"), "export\n");
  EXPECT_EQ(bash("mvtp solve --time"), "--time-limit\n");
  EXPECT_EQ(bash("mvtp solve --algorithm escot-"), "escot-star\n");
  EXPECT_EQ(bash("mvtp solve -i pl"), "plan.yaml\n");
  EXPECT_EQ(bash("mvtp view pl"), "plan.yaml\n");
  EXPECT_EQ(bash("mvtp report --output-dir \"\""), "folder\n");
  EXPECT_EQ(bash("mvtp solve --seed \"\""), "\n");
}

TEST_F(Manual, FishCompletes) {
  if (!installed("fish")) GTEST_SKIP() << "no fish";
  const auto fish = [this](const std::string& line) {
    const Outcome outcome = shell("HOME=$PWD fish --no-config -c 'source \"" +
                                  file("fish/mvtp.fish") + "\"; complete -C \"" + line + "\"'");
    EXPECT_THAT(outcome.err, IsEmpty());
    return outcome.out;
  };
  EXPECT_EQ(fish("mvtp sol"), "solve\tSolve one standalone instance\n");
  EXPECT_THAT(fish("mvtp solve --time"), HasSubstr("--time-limit\t"));
  EXPECT_THAT(fish("mvtp solve --algorithm escot-"), HasSubstr("escot-star"));
  EXPECT_THAT(fish("mvtp toio ex"), HasSubstr("export\t"));
  EXPECT_THAT(fish("mvtp toio --time"), Not(HasSubstr("--time-limit")));
}

// zsh completes at a terminal only; its module zpty makes one. In place of the program a function
// says what it would have been given. Each line is typed once the prompt is there.
TEST_F(Manual, ZshCompletes) {
  if (!installed("zsh")) GTEST_SKIP() << "no zsh";
  const std::string setup = "fpath=('" + file("zsh") +
                            "' $fpath); autoload -U compinit; compinit -u -D; "
                            "zstyle ':completion:*' insert-tab false; "
                            "mvtp() { print \"<$*>\" }; PS1='RE''ADY> '\n";
  (void)directory_.file("setup.zsh", setup);
  (void)directory_.file("complete.zsh",
                        "zmodload zsh/zpty\n"
                        "zpty shell zsh -f -i\n"
                        "zpty -w shell '. ./setup.zsh'\n"
                        "for line in 'mvtp sol' 'mvtp toio expo' 'mvtp solve --time' "
                        "'mvtp solve --algorithm escot-'; do\n"
                        "  zpty -r -m shell text '*READY> *'; print -r -- $text\n"
                        "  zpty -w shell $line$'\\t'\n"
                        "done\n"
                        "zpty -r -m shell text '*READY> *'; print -r -- $text\n");
  const std::string text = shell("HOME=$PWD timeout 20 zsh -f complete.zsh").out;
  for (const char* completed :
       {"<solve>", "<toio export>", "<solve --time-limit>", "<solve --algorithm escot-star>"}) {
    EXPECT_THAT(text, HasSubstr(completed));
  }
}

}  // namespace
}  // namespace mvtp
