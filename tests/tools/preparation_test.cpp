// What comes before the first step of a run.
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>

#include "planner/problem/interruption.hpp"
#include "tests/temporary_directory.hpp"
#include "tools/coordinate/run.hpp"

namespace mvtp {
namespace {

class Preparation : public testing::Test {
 protected:
  /// Opens a run whose host is interrupted from this look at it on.
  /// @return how often it was looked at before the preparation ended or was given up
  int open(int interrupted_from) {
    CoordinateOptions options;
    options.configuration = std::string(MVTP_SCENARIOS) + "/crossroads/crossroads.sumocfg";
    options.output_dir = directory_.path("out");
    options.quiet = true;
    RunFolder folder(options.output_dir, "--output-dir");
    int looks = 0;
    given_up_ = false;
    try {
      const SumoRun run(options, "", folder,
                        {.say = [](const std::string&) {},
                         .interrupted = [&] { return ++looks >= interrupted_from; }});
    } catch (const Interruption&) {
      given_up_ = true;
    }
    return looks;
  }

  TemporaryDirectory directory_;
  bool given_up_ = false;
};

TEST_F(Preparation, EndsWhereverItIsInterrupted) {
  constexpr int kNever = 1'000'000'000;
  const int looks = open(kNever);
  EXPECT_FALSE(given_up_);
  EXPECT_GT(looks, 100);  // in the demand, the network and the drivable area, and between the parts
  for (int part = 0; part < 12; ++part) {
    // The last looks are those after SUMO has been opened.
    const int at = part < 6 ? 1 + looks * part / 6 : looks - (part - 6);
    (void)directory_.file("out/summary.json", "old");
    EXPECT_EQ(open(at), at);
    EXPECT_TRUE(given_up_) << at << " of " << looks;
    EXPECT_EQ(content_of(directory_.path("out/summary.json")), "old") << at << " of " << looks;
    std::ptrdiff_t files = 0;
    for (const auto& file : std::filesystem::directory_iterator(directory_.path("out"))) {
      files += file.exists() ? 1 : 0;
    }
    EXPECT_EQ(files, 1) << at << " of " << looks;
  }
}

}  // namespace
}  // namespace mvtp
