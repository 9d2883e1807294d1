#include "tools/cli/run_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "planner/problem/input_error.hpp"
#include "tests/temporary_directory.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

std::string message_of_opening(const std::string& folder) {
  try {
    const RunFolder again(folder, "--output-dir");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RunFolder, FilesGetTheirNamesAtTheEnd) {
  const TemporaryDirectory directory;
  const std::string out = directory.path("out");
  RunFolder folder(out, "--output-dir");
  folder.write("summary.json", "{}");
  folder.write("summary.json", "{1}");
  EXPECT_FALSE(fs::exists(out + "/summary.json"));
  folder.commit();
  EXPECT_EQ(content_of(out + "/summary.json"), "{1}");
  EXPECT_FALSE(fs::exists(out + "/summary.json.part"));
}

TEST(RunFolder, WhatIsNotFinishedIsRemoved) {
  const TemporaryDirectory directory;
  const std::string out = directory.path("out");
  {
    RunFolder folder(out, "--output-dir");
    folder.write("summary.json", "{}");
  }
  EXPECT_TRUE(fs::is_empty(out));
}

TEST(RunFolder, OldResultsAreRemovedBeforeTheRun) {
  const TemporaryDirectory directory;
  for (const char* name : {"summary.json", "fcd.xml", "lot.svg", "lot2.svg", "tripinfo.xml.part"}) {
    (void)directory.file(name, "old");
  }
  (void)directory.file("notes.txt", "mine");
  RunFolder folder(directory.path(""), "--output-dir");
  EXPECT_FALSE(fs::exists(directory.path("tripinfo.xml.part")));
  EXPECT_EQ(directory.size(), 5) << "whether the input of the run is good is not known yet";
  folder.remove_old_results();
  EXPECT_EQ(directory.size(), 1);
  EXPECT_TRUE(fs::exists(directory.path("notes.txt")));
}

TEST(RunFolder, BelongsToOneRunAtATime) {
  const TemporaryDirectory directory;
  const std::string out = directory.path("out");
  {
    RunFolder folder(out, "--output-dir");
    folder.write("summary.json", "{}");
    EXPECT_EQ(message_of_opening(out), out +
                                           ": another run writes into it; choose another "
                                           "--output-dir");
    EXPECT_TRUE(fs::exists(out + "/summary.json.part"));
  }
  EXPECT_EQ(message_of_opening(out), "");
}

TEST(RunFolder, ACrashedRunIsCompletedFromItsCheckpoint) {
  const TemporaryDirectory directory;
  (void)directory.file("summary.json.part", R"({"status": "failed", "vehicles": 3})");
  (void)directory.file("vehicles.csv.part", "id\na\n");
  (void)directory.file("sumo.log.part", "Warning: x\nsumo: MSLane.cpp:7: Assertion `y' failed.\n");
  (void)directory.file(
      "fcd.xml.part",
      "<?xml version=\"1.0\"?>\n\n<!-- made\n<configuration>\n</configuration>\n"
      "-->\n\n<fcd-export a=\"b\">\n    <timestep time=\"0.00\"/>\n"
      "    <timestep time=\"0.10\">\n        <vehicle id=\"a\"/>\n    </timestep>\n"
      "    <timestep time=\"0.20\">\n        <vehicle id=\"a\"/>\n        <veh");
  EXPECT_TRUE(complete_crashed_run(directory.path(""), "the simulation crashed"));
  const auto summary = nlohmann::json::parse(content_of(directory.path("summary.json")));
  EXPECT_EQ(summary["status"], "failed");
  EXPECT_EQ(summary["message"],
            "the simulation crashed: sumo: MSLane.cpp:7: Assertion `y' failed.");
  EXPECT_EQ(summary["vehicles"], 3);
  EXPECT_EQ(content_of(directory.path("vehicles.csv")), "id\na\n");
  EXPECT_THAT(content_of(directory.path("fcd.xml")),
              testing::EndsWith("        <vehicle id=\"a\"/>\n    </timestep>\n</fcd-export>\n"));
  EXPECT_EQ(directory.size(), 4);
}

TEST(RunFolder, ACrashBeforeTheFirstCheckpointLeavesNoSummary) {
  const TemporaryDirectory directory;
  EXPECT_FALSE(complete_crashed_run(directory.path(""), "the simulation crashed"));
  EXPECT_EQ(directory.size(), 0);
  (void)directory.file("summary.json", "of another run");
  (void)directory.file("sumo.log.part", "Assertion\n");
  EXPECT_FALSE(complete_crashed_run(directory.path(""), "the simulation crashed"));
  EXPECT_FALSE(fs::exists(directory.path("summary.json")));
  EXPECT_EQ(content_of(directory.path("sumo.log")), "Assertion\n");
}

}  // namespace
}  // namespace mvtp
