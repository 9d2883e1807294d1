#include "tools/view/replay_tubes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/view/replay.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using Values = std::vector<std::int64_t>;

/// What the columns hold, one after the other, as the page reads them.
std::string columns(const std::vector<Values>& all) {
  std::string bytes;
  for (const Values& values : all) {
    ReplayColumn column;
    for (const std::int64_t value : values) column.push(value);
    bytes += column.bytes();
  }
  return bytes;
}

ReplayTube passing(double least, double most) {
  return {.fork = 3, .passes = true, .reaches = {{{least, most}, {2.0 * least, 2.0 * most}}}};
}

ReplayTube waiting(double to_line) {
  return {.fork = 3, .passes = false, .reaches = {{{0.0, to_line}, {0.0, to_line}}}};
}

//   frame   0    1        2..6     7
//   tube    none  waits   passes   none
TEST(ReplayTubes, KeepsOneWhereItChangesAndOfThosePassingOneEverySecond) {
  ReplayTubes tubes;
  tubes.push(0, 0, std::nullopt);
  tubes.push(0, 500, waiting(12.4));
  for (int i = 0; i < 5; ++i) tubes.push(0, 1000 + 500 * i, passing(3.6 + i, 7.2 + i));
  tubes.push(0, 3500, std::nullopt);
  EXPECT_EQ(tubes.bytes(1), columns({{4},
                                     {1, 1, 5, 1},
                                     {0, 7, 8, 0},  // 1 + 2 * 3, and 1 more if it passes
                                     {0, 3, 5, 7},  // [m] in 2 s: of frames 1, 2, 4 and 6
                                     {12, 8, 10, 12},
                                     {0, 3, 5, 7},  // [2 m] in 4 s
                                     {6, 8, 10, 12}}));
}

TEST(ReplayTubes, ALineThatIsWaitedForIsKeptOnce) {
  ReplayTubes tubes;
  for (int i = 0; i < 100; ++i) tubes.push(0, 500 * i, waiting(50.0 - i));
  EXPECT_EQ(tubes.bytes(1), columns({{1}, {100}, {7}, {0}, {50}, {0}, {25}}));
}

TEST(ReplayTubes, TracksWithoutAnyHaveOneRunOrNone) {
  ReplayTubes tubes;
  tubes.push(0, 0, std::nullopt);
  tubes.push(2, 0, passing(1.0, 2.0));
  EXPECT_EQ(tubes.bytes(4), columns({{1, 0, 1, 0}, {1, 1}, {0, 8}, {1}, {2}, {1}, {2}}));
}

TEST(ReplayTubes, OnlyReplaysThatHaveSomeSpeakOfThem) {
  const auto replay_with = [](const std::optional<ReplayTube>& tube) {
    ReplayRecorder recorder({.title = "test"}, {}, 0.0);
    recorder.add_vehicle({.id = "a"});
    const std::size_t path = recorder.tubes().add_path({{0, 0}, {10, 0}});
    EXPECT_EQ(recorder.tubes().add_fork({path}), 0U);
    ReplayVehicleState state{0, {}, 0.0, {}};
    state.tube = tube;
    recorder.add_frame(0.0, std::vector{state});
    return nlohmann::json::parse(recorder.finish().header);
  };
  EXPECT_TRUE(replay_with(std::nullopt)["tubes"].is_null());
  const auto header = replay_with(ReplayTube{.fork = 0, .passes = true, .reaches = {}})["tubes"];
  EXPECT_THAT(header["later"], ElementsAre(2.0, 4.0));
  EXPECT_THAT(header["units"], ElementsAre(1.0, 2.0));
  EXPECT_THAT(header["paths"].at(0), ElementsAre(0.0, 0.0, 10.0, 0.0));
  EXPECT_THAT(header["forks"].at(0), ElementsAre(0));
}

//   20 human drivers for half an hour, half of the time near a signal: at 10 m/s in 2 s, a little
//   else at every step.
TEST(ReplayTubes, AddLittleToALongRun) {
  const auto size = [](bool with_tubes) {
    ReplayRecorder recorder({.title = "test"}, {}, 0.5);
    for (int i = 0; i < 20; ++i) recorder.add_vehicle({.id = std::to_string(i)});
    for (int k = 0; k < 18000; ++k) {
      std::vector<ReplayVehicleState> states;
      for (std::size_t i = 0; i < 20; ++i) {
        const double wave = 0.01 * ((k * 7919 + int(i) * 104729) % 97);
        states.push_back({i, {0.1 * k + wave, wave, wave}, 10.0 + wave, {}});
        if (with_tubes && k / 300 % 2 == 0) {
          states.back().tube = passing(18.0 + wave, 22.0 + 2.0 * wave);
        }
      }
      recorder.add_frame(0.1 * k, states);
    }
    const Replay replay = recorder.finish();
    return double(replay.header.size() + replay.frames.size());
  };
  EXPECT_LT(size(true), 1.35 * size(false)) << "before compression";
}

}  // namespace
}  // namespace mvtp
