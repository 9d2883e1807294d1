#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "planner/problem/input_error.hpp"
#include "tests/temporary_directory.hpp"
#include "tools/bench/instance_paths.hpp"
#include "tools/bench/results.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ResultRow row(const std::string& instance, std::uint64_t seed = 0) {
  ResultRow result;
  result.instance = instance;
  result.algorithm = "escot";
  result.seed = seed;
  result.status = "timeout";
  result.lower_bound = 12.5;
  result.runtime = 60.25;
  result.peak_rss = 10.5;
  result.version = "0.1.0";
  return result;
}

ResultRow solved_row(const std::string& instance) {
  ResultRow result = row(instance);
  result.status = "solved";
  result.valid = true;
  result.makespan_steps = 13;
  result.makespan = 13.0;
  result.flowtime = 20.0625;
  result.first_solution = 0.125;
  result.solved_seed = 4;
  return result;
}

template <class F>
std::string message(const F& f) {
  try {
    f();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// ---- the format

TEST(Results, HaveTheColumnsThatScriptsRelyOn) {
  EXPECT_EQ(results_header(),
            "instance,algorithm,seed,status,valid,makespan_steps,makespan_s,flowtime_s,"
            "lower_bound_s,first_solution_s,runtime_s,peak_rss_mb,solved_seed,version\n");
  EXPECT_EQ(to_csv(solved_row("a.yaml")),
            "a.yaml,escot,0,solved,true,13,13.0000,20.0625,12.5000,0.1250,60.2500,10.5,4,0.1.0\n");
  EXPECT_EQ(to_csv(row("a.yaml", 7)),
            "a.yaml,escot,7,timeout,false,,,,12.5000,,60.2500,10.5,,0.1.0\n");
}

TEST(Results, FieldsAreQuotedAsRfc4180Wants) {
  EXPECT_THAT(to_csv(row("a,\"b\"\nc.yaml")), testing::StartsWith("\"a,\"\"b\"\"\nc.yaml\",escot"));
}

TEST(Results, ReadBackWhatWasWritten) {
  const std::vector<ResultRow> rows = {solved_row("a.yaml"), row("b,\"c\"\n,\r\nd", 5)};
  EXPECT_EQ(parse_results(results_header() + to_csv(rows[0]) + to_csv(rows[1]), "r.csv"), rows);
}

TEST(Results, OthersEndsOfLineWillDo) {
  std::string text = results_header() + to_csv(solved_row("a"));
  for (std::size_t i = 0; (i = text.find('\n', i)) != std::string::npos; i += 2) {
    text.insert(i, "\r");
  }
  EXPECT_THAT(parse_results(text, "r.csv"), ElementsAre(solved_row("a")));
}

TEST(Results, BadLinesAreNamed) {
  const auto refusal = [](const std::string& line) {
    return message([&] {
      (void)parse_results(results_header() + to_csv(row("a\nb")) + line + "\n", "r.csv");
    });
  };
  EXPECT_EQ(refusal("a"), "r.csv:4: has 1 fields in place of 14; is it a results.csv?");
  EXPECT_EQ(refusal("a,escot,x,solved,true,1,1,1,1,1,1,1,,v"),
            "r.csv:4: seed: is \"x\"; give a whole number");
  EXPECT_EQ(refusal("a,escot,1,solved,yes,1,1,1,1,1,1,1,,v"),
            "r.csv:4: valid: is \"yes\"; give true or false");
  EXPECT_EQ(refusal("a,escot,1,solved,true,1.5,1,1,1,1,1,1,,v"),
            "r.csv:4: makespan_steps: is \"1.5\"; give a whole number");
  EXPECT_EQ(refusal("a,escot,1,solved,true,1,nan,1,1,1,1,1,,v"),
            "r.csv:4: makespan_s: is \"nan\"; give a finite number >= 0");
  EXPECT_EQ(refusal("a,escot,1,solved,true,1,1,1,1,1,,1,,v"),
            "r.csv:4: runtime_s: is \"\"; give a number");
  EXPECT_EQ(refusal(",escot,1,solved,true,1,1,1,1,1,1,1,,v"),
            "r.csv:4: instance: is \"\"; give text");
  EXPECT_EQ(refusal("\"a"), "r.csv: has an incomplete last line; continue the run with --resume");
}

TEST(Results, OtherColumnsAreRefused) {
  EXPECT_THAT(message([] { (void)parse_results("instance,algorithm\na,b\n", "r.csv"); }),
              HasSubstr("r.csv:1: has not the columns of a results.csv (instance,algorithm,seed,"));
  EXPECT_THAT(message([] { (void)parse_results("x", "r.csv"); }), HasSubstr("is no results.csv"));
}

TEST(Results, MergingKeepsEachRunOnceAndOrdersThem) {
  ResultRow again = row("b");
  again.runtime = 1.0;
  EXPECT_THAT(merge_results({{row("b"), row("a", 3)}, {again, row("a", 1)}, {}}),
              ElementsAre(row("a", 1), row("a", 3), row("b")));
}

// ---- the file

class ResultFileTest : public testing::Test {
 protected:
  void write(ResultFile::Mode mode, const std::vector<ResultRow>& rows) const {
    ResultFile file(path_, mode);
    for (const ResultRow& r : rows) file.append(r);
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_.path("r.csv");
};

TEST_F(ResultFileTest, RowsAreThereAtOnce) {
  ResultFile file(path_, ResultFile::Mode::kCreate);
  EXPECT_EQ(content_of(path_), results_header());
  file.append(row("a"));
  EXPECT_EQ(content_of(path_), results_header() + to_csv(row("a")));
}

TEST_F(ResultFileTest, ResumingKeepsRowsAndKnowsThem) {
  write(ResultFile::Mode::kResume, {row("a")});  // nothing to resume: begins
  ResultFile file(path_, ResultFile::Mode::kResume);
  EXPECT_THAT(file.done(), ElementsAre(RunKey("a", "escot", 0)));
  file.append(row("b"));
  EXPECT_THAT(read_results(path_), ElementsAre(row("a"), row("b")));
}

//   Wherever a machine stopped while it wrote, whole rows stay and the rest goes.
TEST_F(ResultFileTest, ATornLineIsRepairedWhereverItWasTorn) {
  const std::string whole = results_header() + to_csv(row("a")) + to_csv(solved_row("\"b\n,"));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    (void)directory_.file("r.csv", whole.substr(0, length));
    write(ResultFile::Mode::kResume, {row("z")});
    std::vector<ResultRow> expected = {row("z")};
    if (length >= (results_header() + to_csv(row("a"))).size()) {
      expected.insert(expected.begin(), row("a"));
    }
    ASSERT_EQ(read_results(path_), expected) << length;
  }
}

TEST_F(ResultFileTest, NothingIsOverwritten) {
  write(ResultFile::Mode::kCreate, {row("a")});
  EXPECT_THAT(message([&] { ResultFile(path_, ResultFile::Mode::kCreate); }),
              HasSubstr("r.csv: exists; continue it with --resume, or choose another --output"));
  const std::string other = directory_.file("notes.txt", "instance of beauty\n");
  EXPECT_THAT(message([&] { ResultFile(other, ResultFile::Mode::kResume); }),
              HasSubstr("notes.txt: is no results.csv; choose another --output"));
  EXPECT_EQ(content_of(other), "instance of beauty\n");
  EXPECT_EQ(read_results(path_).size(), 1U);
}

TEST_F(ResultFileTest, OnlyOneMayWrite) {
  const ResultFile file(path_, ResultFile::Mode::kCreate);
  EXPECT_THAT(message([&] { ResultFile(path_, ResultFile::Mode::kResume); }),
              HasSubstr("is written by another mvtp bench"));
}

TEST_F(ResultFileTest, UnwritablePlacesAreRefused) {
  for (const char* path : {"/proc/none", "/no/such/r.csv", "/"}) {
    EXPECT_THAT(message([&] { ResultFile(path, ResultFile::Mode::kCreate); }),
                HasSubstr("cannot be written: "));
  }
  EXPECT_THAT(message([] { ResultFile("/dev/full", ResultFile::Mode::kCreate); }),
              testing::AnyOf(HasSubstr("is no regular file"), HasSubstr("cannot be written")));
}

// ---- which instances

class InstancePaths : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name,
                                 const std::string& content = "agents:\n") const {
    std::filesystem::create_directories(std::filesystem::path(directory_.path(name)).parent_path());
    return directory_.file(name, content);
  }
  [[nodiscard]] std::vector<std::string> names(const std::vector<std::string>& paths) const {
    std::vector<std::string> result;
    for (const InstancePath& path : find_instances(paths)) result.push_back(path.name);
    return result;
  }

  TemporaryDirectory directory_;
};

TEST_F(InstancePaths, NumbersAreOrderedByTheirValue) {
  for (const char* name :
       {"a10/ex1.yaml", "a9/ex10.yaml", "a9/ex2.yaml", "a09/ex2.yaml", "a.yml"}) {
    (void)file(name);
  }
  EXPECT_THAT(names({directory_.path("")}),
              ElementsAre("a.yml", "a09/ex2.yaml", "a9/ex2.yaml", "a9/ex10.yaml", "a10/ex1.yaml"));
}

TEST_F(InstancePaths, PlansHiddenFilesAndOthersAreLeftOut) {
  (void)file("i.yaml", "# schedule: none\nagents:\n");
  (void)file("i.json", "{}");
  (void)file("p.yaml", "statistics:\n  cost: 1\nschedule: {}\n");
  (void)file("q.yaml", "# ours\nschedule: {}\n");
  (void)file("r.csv");
  (void)file(".i.yaml");
  (void)file(".git/i.yaml");
  EXPECT_THAT(names({directory_.path("")}), ElementsAre("i.json", "i.yaml"));
}

TEST_F(InstancePaths, NamesBeginBelowWhatAllPathsShare) {
  const std::string one = file("s/a/one.yaml");
  (void)file("s/b/two.yaml");
  EXPECT_THAT(names({one}), ElementsAre("one.yaml"));
  EXPECT_THAT(names({directory_.path("s/b"), one, directory_.path("s/../s/a")}),
              ElementsAre("a/one.yaml", "b/two.yaml"));
}

TEST_F(InstancePaths, WhatIsNotThereIsRefused) {
  (void)file("empty/readme.txt");
  EXPECT_THAT(message([&] { (void)names({directory_.path("none")}); }),
              HasSubstr("none: cannot be read: No such file or directory; check the path"));
  EXPECT_THAT(message([&] { (void)names({directory_.path("empty")}); }),
              HasSubstr("empty: holds no instance (*.yaml, *.json); give another folder"));
}

}  // namespace
}  // namespace mvtp
