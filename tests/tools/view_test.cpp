#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "planner/problem/input_error.hpp"
#include "tools/view/page.hpp"
#include "tools/view/plan_replay.hpp"
#include "tools/view/read_replay.hpp"
#include "tools/view/replay.hpp"
#include "tools/view/scene.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kPi = std::numbers::pi;

/// The columns of a replay, read back as the page does it.
class Reader {
 public:
  explicit Reader(const Replay& replay) : bytes_(replay.frames) {}

  std::vector<std::int64_t> column(std::size_t count) {
    std::vector<std::int64_t> values;
    std::int64_t difference = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t second = number();
      difference = i == 1 ? second : difference + second;
      values.push_back((values.empty() ? 0 : values.back()) + difference);
    }
    return values;
  }

  [[nodiscard]] bool at_end() const { return position_ == bytes_.size(); }

 private:
  std::int64_t number() {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes_.at(position_++));
      value |= std::uint64_t{byte & 0x7fU} << shift;
      if (byte < 0x80) break;
    }
    return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
  }

  std::string bytes_;
  std::size_t position_ = 0;
};

nlohmann::json header_of(const Replay& replay) { return nlohmann::json::parse(replay.header); }

ReplayRecorder recorder_of_one_car(double interval) {
  ReplayRecorder recorder({.title = "test"}, {}, interval);
  recorder.add_vehicle({.id = "a"});
  return recorder;
}

void add(ReplayRecorder& recorder, double time, const ReplayVehicleState& state) {
  recorder.add_frame(time, std::vector{state});
}

TEST(ReplayColumn, SpendsOneByteOnValuesThatChangeEvenly) {
  ReplayColumn column;
  for (int i = 0; i < 1000; ++i) column.push(1'000'000 + 137 * i);
  EXPECT_LE(column.bytes().size(), 1000 + 8);
}

TEST(ReplayColumn, GivesBackExtremeValues) {
  const std::vector<std::int64_t> values = {0, -1, 1'000'000'000, -1'000'000'000, 63, 64, -64, -65};
  ReplayColumn column;
  for (const std::int64_t value : values) column.push(value);
  EXPECT_EQ(Reader({"", "", column.bytes()}).column(values.size()), values);
}

TEST(ReplayRecorder, KeepsPosesToACentimetreAndATenthOfADegree) {
  ReplayRecorder recorder = recorder_of_one_car(0.0);
  std::vector<ReplayVehicleState> driven;
  for (int i = 0; i < 200; ++i) {  // more than two turns to the left, across the seam at pi
    driven.push_back({0, drive({-812.3456, 77.7, 3.0}, 0.37 * i, 0.2), 13.8888 - 0.1 * i,
                      i < 50 ? ReplayState::kCarFollowing : ReplayState::kCoordinated});
    add(recorder, 0.1 * i, driven.back());
  }
  const Replay replay = recorder.finish();

  Reader reader(replay);
  const auto times = reader.column(driven.size());
  const auto x = reader.column(driven.size());
  const auto y = reader.column(driven.size());
  const auto heading = reader.column(driven.size());
  const auto speed = reader.column(driven.size());
  for (std::size_t i = 0; i < driven.size(); ++i) {
    EXPECT_NEAR(double(times[i]) / 1000.0, 0.1 * double(i), 5.1e-4);
    EXPECT_NEAR(double(x[i]) / 100.0, driven[i].pose.x, 5.1e-3);
    EXPECT_NEAR(double(y[i]) / 100.0, driven[i].pose.y, 5.1e-3);
    const double error = wrap_to_pi(double(heading[i]) * kPi / 1800.0 - driven[i].pose.theta);
    EXPECT_NEAR(error, 0.0, 0.051 * kPi / 180.0);
    EXPECT_NEAR(double(speed[i]) * 0.02, driven[i].speed, 0.0101);
  }
  EXPECT_THAT(reader.column(4), ElementsAre(50, 0, 150, 1));
  EXPECT_TRUE(reader.at_end());
}

TEST(ReplayRecorder, KeepsEveryIntervalAndTheLastFrame) {
  ReplayRecorder recorder = recorder_of_one_car(0.5);
  for (int i = 0; i <= 13; ++i) add(recorder, 0.1 * i, {0, {}, 0.0, {}});
  const Replay replay = recorder.finish();
  EXPECT_THAT(Reader(replay).column(4), ElementsAre(0, 500, 1000, 1300));
  EXPECT_EQ(header_of(replay)["frames"], 4);
}

TEST(ReplayRecorder, KeepsTheFrameOfAnEvent) {
  ReplayRecorder recorder = recorder_of_one_car(0.5);
  for (int i = 0; i <= 10; ++i) {
    add(recorder, 0.1 * i, {0, {}, 0.0, {}});
    if (i == 3) recorder.add_event({.kind = ReplayEventKind::kOverlap, .time = 0.1 * i});
  }
  EXPECT_THAT(Reader(recorder.finish()).column(4), ElementsAre(0, 300, 500, 1000));
}

TEST(ReplayRecorder, KeepsTheLeastClearanceBetweenFrames) {
  ReplayRecorder recorder = recorder_of_one_car(0.5);
  for (const auto& [time, clearance] : {std::pair{0.0, 3.0}, {0.2, 0.25}, {0.5, 4.0}, {1.0, 5.0}}) {
    recorder.add_frame(time, {}, clearance);
  }
  Reader reader(recorder.finish());
  EXPECT_THAT(reader.column(3), ElementsAre(0, 500, 1000));
  EXPECT_THAT(reader.column(3), ElementsAre(300, 25, 500));
}

//   frame     0  1  2  3  4
//   vehicle   x  x     x  x      two tracks of two frames
TEST(ReplayRecorder, AVehicleThatComesBackStartsANewTrack) {
  ReplayRecorder recorder = recorder_of_one_car(0.0);
  for (int i = 0; i < 5; ++i) {
    if (i == 2) {
      recorder.add_frame(i, {});
    } else {
      add(recorder, i, {0, {}, 0.0, {}});
    }
  }
  EXPECT_EQ(header_of(recorder.finish())["tracks"], nlohmann::json({{0, 0, 2}, {0, 3, 2}}));
}

TEST(ReplayRecorder, LeavesOutStatesThatAreNoNumbersAndDoubles) {
  ReplayRecorder recorder = recorder_of_one_car(0.0);
  recorder.add_vehicle({.id = "b"});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  add(recorder, 0.0, {0, {nan, 0.0, 0.0}, 0.0, {}});
  add(recorder, 1.0, {0, {0.0, 0.0, 0.0}, infinity, {}});
  recorder.add_frame(2.0, std::vector<ReplayVehicleState>{{1, {}, 0.0, {}}, {1, {}, 0.0, {}}});
  EXPECT_EQ(header_of(recorder.finish())["tracks"], nlohmann::json({{1, 2, 1}}));
}

TEST(ReplayRecorder, RefusesTimesThatDoNotIncreaseAndUnknownVehicles) {
  ReplayRecorder recorder = recorder_of_one_car(0.0);
  add(recorder, 1.0, {0, {}, 0.0, {}});
  EXPECT_THROW(add(recorder, 1.0, {0, {}, 0.0, {}}), std::invalid_argument);
  EXPECT_THROW(add(recorder, std::nan(""), {0, {}, 0.0, {}}), std::invalid_argument);
  EXPECT_THROW(add(recorder, 2.0, {1, {}, 0.0, {}}), std::invalid_argument);
}

TEST(ReplayRecorder, ReportsAnOverlapThatLastsAsOneEventWithItsDepth) {
  ReplayRecorder recorder({.title = "test"}, {});
  const auto overlap = [&](double time, double value) {
    recorder.add_event({.kind = ReplayEventKind::kOverlap, .time = time, .value = value});
  };
  overlap(1.0, -0.1);
  overlap(1.1, -0.4);
  overlap(1.2, -0.2);
  overlap(9.0, -0.3);
  const auto events = header_of(recorder.finish())["events"];
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0]["end"], 1.2);
  EXPECT_EQ(events[0]["value"], -0.4);
  EXPECT_EQ(events[1]["time"], 9.0);
}

const std::string kHostile = "</script><img src=x onerror=alert(1)>{{replays}}\"'&";

Replay hostile_replay() {
  ReplayRecorder recorder({.title = kHostile, .label = kHostile, .command = kHostile}, {});
  recorder.add_vehicle({.id = kHostile, .kind = kHostile});
  recorder.add_figure({kHostile, kHostile, kHostile});
  recorder.add_event({.time = 0.0, .vehicles = {0}, .text = kHostile});
  add(recorder, 0.0, {0, {}, 0.0, {}});
  return recorder.finish();
}

TEST(ReplayPage, TextFromOutsideIsNeverMarkup) {
  const std::string html = to_html(std::vector{hostile_replay()});
  EXPECT_THAT(html, Not(HasSubstr("<img")));
  EXPECT_THAT(html, HasSubstr("<title>&lt;/script&gt;&lt;img src=x"));
  EXPECT_EQ(replays_of(html, "x").size(), 1U) << "a mark of the template inside a title is text";
}

TEST(ReplayPage, NamesNoOtherHost) {
  const std::string html = to_html(std::vector{hostile_replay()});
  EXPECT_THAT(html, Not(HasSubstr("http://")));
  EXPECT_THAT(html, Not(HasSubstr("https://")));
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
}

TEST(ReplayPage, TextThatIsNotUtf8BecomesTextThatIs) {
  ReplayRecorder recorder({.title = "\xff\xfe"}, {});
  recorder.add_vehicle({.id = "\x80"});
  EXPECT_EQ(header_of(recorder.finish())["vehicles"][0]["id"], "\xef\xbf\xbd");
}

TEST(ReplayPage, GivesBackTheReplaysItWasMadeOf) {
  ReplayRecorder recorder = recorder_of_one_car(0.0);
  for (int i = 0; i < 100; ++i) add(recorder, i, {0, {1.0 * i, 2.0, 0.1}, 1.0, {}});
  const std::vector replays = {recorder.finish(), hostile_replay()};
  const std::vector<Replay> again = replays_of(to_html(replays), "x");
  ASSERT_EQ(again.size(), 2U);
  EXPECT_EQ(again[0].header, replays[0].header);
  EXPECT_EQ(again[0].frames, replays[0].frames);
  EXPECT_EQ(again[1].title, kHostile);
  EXPECT_EQ(to_html(again), to_html(replays));
}

TEST(ReplayPage, SaysWhyAFileIsNoPage) {
  const auto message = [](const std::string& html) -> std::string {
    try {
      (void)replays_of(html, "run.html");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("<html></html>"),
            "run.html: holds no replay; give a page written by `mvtp coordinate` or `mvtp view`");
  const std::string damaged = "run.html: replay 1 in the page is damaged; write the page again";
  const std::string opening = "<script type=\"application/x-mvtp-replay\">";
  EXPECT_EQ(message(opening), damaged);
  EXPECT_EQ(message(opening + "</script>"), damaged);
  EXPECT_EQ(message(opening + "@@@@</script>"), damaged);
  EXPECT_EQ(message(opening + "AAAAAAAA</script>"), damaged);

  std::string html = to_html(std::vector{hostile_replay()});
  html.erase(html.find(opening) + opening.size() + 200, 40);
  EXPECT_EQ(message(html), damaged);
}

TEST(ReplayPage, AnEmptyRunIsAPageToo) {
  const Replay empty = ReplayRecorder({}, {}).finish();
  EXPECT_EQ(replays_of(to_html(std::vector{empty}), "x").size(), 1U);
}

//   40 vehicles on ring roads with waving speeds, for 1800 s of steps of 0.1 s
TEST(ReplayPage, HalfAnHourOfFortyVehiclesStaysBelowOneAndAHalfMegabytes) {
  ReplayRecorder recorder({.title = "ring"}, {});
  std::vector<ReplayVehicleState> states;
  for (std::size_t i = 0; i < 40; ++i) {
    recorder.add_vehicle({.id = std::to_string(i)});
    states.push_back({i, {10.0 * double(i), 0.0, 0.0}, 0.0, ReplayState::kCoordinated});
  }
  for (int k = 0; k < 18000; ++k) {
    for (ReplayVehicleState& state : states) {
      state.speed = 7.0 + 6.0 * std::sin(0.01 * k + double(state.vehicle));
      const double curvature = 0.01 * (1.0 + std::sin(0.003 * k + 2.0 * double(state.vehicle)));
      state.pose = drive(state.pose, 0.1 * state.speed, curvature);
    }
    recorder.add_frame(0.1 * k, states, 1.0 + std::sin(0.02 * k));
  }
  EXPECT_LT(to_html(std::vector{recorder.finish()}).size(), 1'500'000U);
}

//   a: drives 1 m, waits, drives 1 m in reverse, rests;   b: a quarter circle at once
Instance two_robots() {
  return {.agents = {{"a", {}, {5, 5, 0}, {5, 5, 0}}, {"b", {}, {9, 9, 0}, {11, 11, kPi / 2}}},
          .map = {.width = 20, .height = 20, .circles = {{1, 1, 0.8}}, .polygons = {}},
          .dt = 2.0};
}

Plan plan_of_two_robots() {
  Trajectory a(std::vector<Waypoint>{{{5, 5, 0}}, {{6, 5, 0}}, {{6, 5, 0}}, {{5, 5, 0}}});
  Trajectory b(std::vector<Waypoint>{{{9, 9, 0}}, {drive({9, 9, 0}, kPi, 0.5)}});
  Statistics statistics;
  statistics.dt = 2.0;
  return {.statistics = statistics, .names = {"b", "a"}, .trajectories = {b, a}};
}

TEST(ReplayOfPlan, ShowsStepsWaitsReverseAndArrival) {
  const Replay replay = replay_of(two_robots(), plan_of_two_robots(), {}, {}, "plan.yaml");
  Reader reader(replay);
  EXPECT_THAT(reader.column(4), ElementsAre(0, 2000, 4000, 6000));
  EXPECT_THAT(reader.column(4), ElementsAre(500, 600, 600, 500));  // a: x
  (void)reader.column(4);
  (void)reader.column(4);
  EXPECT_THAT(reader.column(4), ElementsAre(0, 25, 0, -25));  // a: 0.5 m/s
  EXPECT_THAT(reader.column(8),
              ElementsAre(1, 1, 1, 2, 1, 1, 1, 3));  // a: drive, wait, drive, arrived
  EXPECT_THAT(reader.column(4), ElementsAre(900, 1100, 1100, 1100));
  (void)reader.column(4);
  (void)reader.column(4);
  EXPECT_THAT(reader.column(4), ElementsAre(0, 79, 0, 0));  // b: pi metres in 2 s
}

TEST(ReplayOfPlan, AViolationIsAnEventAtItsPlace) {
  const std::vector<Violation> violations = {
      {Rule::kRobotOverlap, {"b", "a"}, 1.25, 0.3, "a and b overlap"}};
  const auto header = header_of(replay_of(two_robots(), plan_of_two_robots(), violations, {}, "p"));
  const auto& event = header["events"].at(0);
  EXPECT_EQ(event["kind"], "overlap");
  EXPECT_EQ(event["time"], 2.5);
  EXPECT_EQ(event["vehicles"], nlohmann::json({0, 1}));
  EXPECT_EQ(event["x"], 6.0);
  EXPECT_EQ(event["value"], -0.3);
}

TEST(ReplayOfPlan, AnInstanceAloneIsOneFrame) {
  EXPECT_EQ(header_of(replay_of(two_robots(), {}))["frames"], 1);
}

TEST(ReplayOfPlan, RefusesThePlanOfAnotherInstance) {
  Plan plan = plan_of_two_robots();
  plan.names = {"b", "c"};
  EXPECT_THROW((void)replay_of(two_robots(), plan, {}, {}, "plan.yaml"), InputError);
  plan = plan_of_two_robots();
  plan.names.push_back("c");
  plan.trajectories.push_back(plan.trajectories.back());
  EXPECT_THROW((void)replay_of(two_robots(), plan, {}, {}, "plan.yaml"), InputError);
}

TEST(ReplayRecorder, KeepsGroupsRanksAndEmissionsIfThereAreAny) {
  ReplayRecorder recorder = recorder_of_one_car(0.0);
  recorder.add_vehicle({.id = "b"});
  ReplayVehicleState a{0, {}, 0.0, {}};
  ReplayVehicleState b{1, {}, 0.0, {}};
  recorder.add_frame(0.0, std::vector{a, b});
  a.group = b.group = 0;
  a.rank = 2;
  b.rank = 1;
  b.co2 = 1.234;
  recorder.add_frame(1.0, std::vector{a, b});
  const Replay replay = recorder.finish();

  const ReplayFrames frames = frames_of(replay, "r");
  EXPECT_EQ(frames.states[0][0].group, std::nullopt);
  EXPECT_EQ(frames.states[1][0].group, 0U);
  EXPECT_EQ(frames.states[1][1].group, 0U);
  EXPECT_EQ(frames.states[1][0].rank, 2);
  EXPECT_EQ(frames.states[1][1].rank, 1);
  EXPECT_NEAR(frames.states[1][1].co2.value_or(-1.0), 1.2, 1e-9);
  EXPECT_FALSE(header_of(ReplayRecorder({}, {}).finish())["groups"]);
}

TEST(ReplayRecorder, KeepsWhenASignalChanges) {
  ReplayRecorder recorder = recorder_of_one_car(0.5);
  const std::size_t signal = recorder.add_signal("C");
  for (int i = 0; i < 40; ++i) recorder.add_lights(0.1 * i, signal, i < 25 ? "Gr" : "yr");
  const Replay replay = recorder.finish();
  EXPECT_EQ(header_of(replay)["signals"][0]["shown"].size(), 2U);
  EXPECT_THAT(lights_at(replay, 2.4, "r"), ElementsAre("Gr"));
  EXPECT_THAT(lights_at(replay, 2.5, "r"), ElementsAre("yr"));
}

//     |  in, a signal for two turns  >| j |  out  >
TEST(SceneOfRoadNetwork, ShowsWhoEachLaneIsForAndWhereLightsStand) {
  RoadNetwork network;
  network.lanes["in"].shape = {{0, 0}, {10, 0}};
  network.lanes["out"].shape = {{20, 0}, {30, 0}};
  network.lanes["path"].shape = {{0, 5}, {10, 5}};
  network.lanes["path"].drivable = network.lanes["path"].road = false;
  network.lanes["path"].footpath = true;
  network.lanes["bus"].shape = {{0, 9}, {10, 9}};
  network.lanes["bus"].drivable = false;
  network.signals["s"] = 2;
  Junction& junction = network.junctions["j"];
  junction.shape = {{10, -3}, {20, -3}, {20, 3}};
  junction.incoming_lanes = {"in"};
  junction.connections = {{.from_lane = "in", .to_lane = "out", .signal = "s", .signal_index = 1},
                          {.from_lane = "in", .to_lane = "out", .signal = "s", .signal_index = 0}};
  junction.has_conflicts = true;
  const ReplayScene scene = scene_of(network);
  ASSERT_EQ(scene.lanes.size(), 4U);  // in the order of their ids
  EXPECT_EQ(scene.lanes[0].kind, ReplayLaneKind::kBuses);
  EXPECT_TRUE(scene.lanes[1].stop_line);
  EXPECT_FALSE(scene.lanes[2].stop_line);
  EXPECT_EQ(scene.lanes[3].kind, ReplayLaneKind::kFoot);
  EXPECT_EQ(scene.junctions.size(), 1U);

  ASSERT_EQ(scene.lights.size(), 2U);  // beside each other, the first on the right
  EXPECT_EQ(scene.lights[0].index, 0);
  EXPECT_NEAR(scene.lights[0].from.y, -1.6, 1e-9);
  EXPECT_NEAR(scene.lights[0].to.y, 0.0, 1e-9);
  EXPECT_NEAR(scene.lights[1].to.y, 1.6, 1e-9);
  EXPECT_NEAR(scene.lights[1].to.x, 9.7, 1e-9);
}

}  // namespace
}  // namespace mvtp
