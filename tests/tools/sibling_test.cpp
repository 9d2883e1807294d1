#include "tools/cli/sibling.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "planner/problem/input_error.hpp"
#include "tools/cli/program.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

/// A shell script in the place of the sibling of this test's executable, for one test.
class Sibling : public testing::Test {
 protected:
  Sibling() : name_("sibling-" + std::to_string(::getpid())), path_(sibling_path(name_)) {
    fs::create_directories(path_.parent_path());
  }
  ~Sibling() override { fs::remove(path_); }

  int run(const std::string& script) {
    std::ofstream(path_) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(path_, fs::perms::owner_all);
    std::string program = "mvtp";
    std::string command = "coordinate";
    std::string argument = "7";
    char* arguments[] = {program.data(), command.data(), argument.data(), nullptr};
    return run_sibling(name_, 3, arguments);
  }

  std::string name_;
  fs::path path_;
};

TEST_F(Sibling, LiesBesideTheDirectoryOfTheProgram) {
  EXPECT_EQ(path_.parent_path().filename(), "mvtp");
  EXPECT_EQ(path_.parent_path().parent_path().filename(), "libexec");
}

TEST_F(Sibling, GetsTheArgumentsAndGivesItsExitCode) {
  EXPECT_EQ(run("[ \"$1\" = coordinate ] && exit $2"), 7);
}

TEST_F(Sibling, ACrashIsALineAndNotACrash) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(run("kill -SEGV $$"), kNotAchieved);
  EXPECT_EQ(
      testing::internal::GetCapturedStderr(),
      "mvtp: coordinate: the simulation crashed (Segmentation fault); it had not got far enough "
      "to leave results\n");
}

TEST_F(Sibling, ASignalToTheParentReachesTheChild) {
  EXPECT_EQ(run("trap 'exit 9' INT; kill -INT $PPID; for i in 1 2 3 4 5 6 7; do sleep 0.5; done"),
            9);
}

TEST_F(Sibling, AChildThatDiesOfAnInterruptCountsAsInterrupted) {
  EXPECT_EQ(run("kill -INT $$; sleep 5"), kInterrupted);
}

TEST_F(Sibling, AMissingOneIsToldAsBadInput) {
  char* arguments[] = {nullptr};
  EXPECT_THROW((void)run_sibling("no-such-program", 0, arguments), InputError);
}

}  // namespace
}  // namespace mvtp
