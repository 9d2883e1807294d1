#include "planner/problem/plain_yaml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <string>

#include "planner/problem/plan_file.hpp"
#include "tests/temporary_directory.hpp"

namespace mvtp {
namespace {

/// The tree of a document in one line, to compare two.
std::string text_of(const Value& value) {
  std::string text;
  switch (value.kind()) {
    case Value::Kind::kNull:
      return "null";
    case Value::Kind::kScalar:
      return "'" + value.text() + "'";
    case Value::Kind::kList:
      for (std::size_t i = 0; i < value.size(); ++i) text += text_of(value[i]) + " ";
      return "[ " + text + "]";
    case Value::Kind::kMap:
      for (std::size_t i = 0; i < value.size(); ++i) {
        text += std::string(value[i].key()) + ": " + text_of(value[i]) + " ";
      }
      return "{ " + text + "}";
  }
  return text;
}

/// nullopt where the plain parser leaves the text to the complete one.
std::optional<std::string> plain(const std::string& text) {
  DocumentBuilder builder("plain");
  if (!parse_plain_yaml(builder, text)) return std::nullopt;
  const Document document = builder.finish();
  return text_of(document.root());
}

/// What the complete parser reads; a directive is beyond the plain one.
std::string complete(const std::string& text) {
  try {
    const Document document =
        Document::parse("complete", "%YAML 1.2\n---\n" + text, {""}, "anything");
    return text_of(document.root());
  } catch (const InputError& error) {
    return error.what();
  }
}

const std::string kText = R"(# a comment
vehicle: {preset: cl-cbs, width: 1.5}
dt: 0.5
version: "1.0: [# x], 'y'"
"quoted key": ["", "null", "2"]
agents:
  - start: [16.36, -5.32, 2.22]
    name: agent0
    list:
    - a
    -   {b: [], c: {}}
  - {name: agent1, start: [30, .5, 1e-07]}
empty:
map:
  dimensions: [50,60]
  obstacles:
  - [18.61, [25.64, 0.50]]
schedule:
  agent0:
    - x: 1
      t: 0

    - x: 2
      deep:
        deeper:
          deepest: 1.0
  agent1: [ 1 ,2, 3 ]
)";

TEST(PlainYaml, ReadsWhatTheCompleteParserReads) {
  ASSERT_TRUE(plain(kText).has_value());
  EXPECT_EQ(*plain(kText), complete(kText));
  EXPECT_THAT(*plain(kText), testing::HasSubstr("empty: null map: "));
}

TEST(PlainYaml, LeavesTheRestToTheCompleteParser) {
  for (const char* text : {"",
                           "word",
                           "[1, 2]",
                           "a: \"b\" c",
                           "a: \"b\\n\"",
                           "a: \"b",
                           "a: \"b\n  c\"",
                           "a: \"\xc3\xa4\"",
                           "a: \"b\tc\"",
                           "a: 'b'",
                           "a: b c",
                           "a: &x b",
                           "a: *x",
                           "a: !t b",
                           "a: |",
                           "a: b # c",
                           "a: b\n  c",
                           "a: [1,\n 2]",
                           "a: [1, 2,]",
                           "a: {b: }",
                           "a: {b:1}",
                           "? a",
                           "- - a",
                           "a: null",
                           "a: ~",
                           "---\na: b",
                           "...",
                           "a: b\n...",
                           "a: -",
                           "a: ---",
                           "-",
                           "a: b\n - c",
                           "a: b\n  c: d",
                           "a: [1] 2",
                           "a: 1\na: 2",
                           " a: 1\nb: 2",
                           "- a\nb: 1",
                           "a:\tb",
                           "a: {b: 1, b: 2}"}) {
    EXPECT_EQ(plain(text), std::nullopt) << text;
  }
}

//   Else every plan would take the complete parser, 16 times as long.
TEST(PlainYaml, ReadsPlansAsTheyAreWritten) {
  Plan plan{.names = {"agent0"},
            .trajectories = {Trajectory({{{1, 2, 3}}, {{2, 2, 3}, 1.0, 0.1}})}};
  plan.statistics = {.status = "solved", .algorithm = "escot"};
  plan.statistics.version = "1.0.0";
  plan.statistics.initial_overlaps = {"start of agent1 in obstacles[0] by 0.05 m"};
  plan.vehicles = {Vehicle{}};
  const TemporaryDirectory directory;
  write_plan(plan, directory.path("plan.yaml"));
  const std::string text = content_of(directory.path("plan.yaml"));
  ASSERT_TRUE(plain(text)) << text;
  EXPECT_EQ(*plain(text), complete(text));
}

/// The law of the plain parser, on texts that are mostly just beyond it.
TEST(PlainYaml, NeverReadsAnythingElseThanTheCompleteParser) {
  std::mt19937 random(7);
  const std::string alphabet = "[]{}:,- \n\n  abn0.#'\"\"\\";
  int read = 0;
  for (int round = 0; round < 5000; ++round) {
    std::string text = kText;
    for (unsigned edit = 0; edit <= random() % 4; ++edit) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = alphabet[random() % alphabet.size()];
          break;
        case 1:
          text.erase(at, 1 + random() % 4);
          break;
        default:
          text.insert(at, 1, alphabet[random() % alphabet.size()]);
          break;
      }
    }
    const auto found = plain(text);
    if (!found) continue;
    ++read;
    ASSERT_EQ(*found, complete(text)) << text;
  }
  EXPECT_GT(read, 500);
}

}  // namespace
}  // namespace mvtp
