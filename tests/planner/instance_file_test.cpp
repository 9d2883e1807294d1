#include "planner/problem/instance_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tests/temporary_directory.hpp"

namespace mvtp {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kPi = std::numbers::pi;

/// The text of a file in the format of CL-CBS and CSDO, as their generators write it.
const std::string kPlain = R"(agents:
  - start: [16.36, 5.32, 2.22]
    name: agent0
    goal: [17.26, 29.92, -3.07]
  - start: [30, 5, 0]
    name: agent1
    goal: [40, 5, 0]
map:
  dimensions: [50, 60]
  obstacles:
  - [18.61, 25.64, 0.50]
  - [4.10, 45.66]
)";

class InstanceFile : public testing::Test {
 protected:
  Instance read(const std::string& text, const InstanceReadOptions& options = {},
                const std::string& name = "cross.yaml") {
    return read_instance(directory_.file(name, text), options);
  }

  /// What read() says against the text, without the directory.
  std::string error(const std::string& text, const std::string& name = "cross.yaml") {
    try {
      (void)read(text, {}, name);
    } catch (const InputError& e) {
      const std::string what = e.what();
      return what.substr(what.find(name));
    }
    return "no error";
  }

  TemporaryDirectory directory_;
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST_F(InstanceFile, ReadsThePlainFormat) {
  const Instance instance = read(kPlain);
  ASSERT_EQ(instance.agents.size(), 2u);
  EXPECT_EQ(instance.agents[0].name, "agent0");
  EXPECT_EQ(instance.agents[0].start, (Pose{16.36, 5.32, 2.22}));
  EXPECT_EQ(instance.agents[0].goal, (Pose{17.26, 29.92, -3.07}));
  EXPECT_EQ(instance.agents[0].vehicle, vehicle_preset("escot")->vehicle);
  EXPECT_EQ(instance.dt, 1.0);
  EXPECT_EQ(instance.map.width, 50.0);
  EXPECT_EQ(instance.map.height, 60.0);
  ASSERT_EQ(instance.map.circles.size(), 2u);
  EXPECT_EQ(instance.map.circles[0].radius, 0.5);
  EXPECT_EQ(instance.map.circles[1].radius, 0.8);  // the peers' default
}

TEST_F(InstanceFile, OnlyTheAxleMustStayInsideWithoutOurExtensions) {
  EXPECT_EQ(read(kPlain).map.bounds, Bounds::kAxle);
  const std::string own_vehicle = replaced(kPlain, "name: agent1", "vehicle: {width: 1.5}");
  const std::vector<std::string> extended = {kPlain + "  polygons: [[[1, 1], [2, 1], [2, 2]]]\n",
                                             "dt: 0.5\n" + kPlain,
                                             "vehicle: {preset: cl-cbs}\n" + kPlain, own_vehicle};
  for (const std::string& text : extended) {
    EXPECT_EQ(read(text).map.bounds, Bounds::kFootprint) << text;
    EXPECT_EQ(read(text + "  bounds: axle\n").map.bounds, Bounds::kAxle);
    EXPECT_EQ(read(text, {.bounds = Bounds::kAxle}).map.bounds, Bounds::kAxle);
  }
  EXPECT_EQ(read(kPlain, {.bounds = Bounds::kFootprint}).map.bounds, Bounds::kFootprint);
}

TEST_F(InstanceFile, AChoiceOfTheUserAloneDoesNotChangeTheBounds) {
  EXPECT_EQ(read(kPlain, {.vehicle_preset = "cl-cbs"}).map.bounds, Bounds::kAxle);
}

TEST_F(InstanceFile, ClockwiseYawIsTurnedRound) {
  const Instance instance = read(kPlain, {.yaw = YawSense::kClockwise});
  EXPECT_EQ(instance.agents[0].start.theta, -2.22);
  EXPECT_EQ(instance.agents[0].goal.theta, 3.07);
}

TEST_F(InstanceFile, YawIsWrapped) {
  EXPECT_NEAR(read(replaced(kPlain, "2.22", "4.0")).agents[0].start.theta, 4.0 - 2 * kPi, 1e-12);
}

TEST_F(InstanceFile, VehiclesComeFromPresetFieldsAndAgents) {
  const std::string text =
      "vehicle: {preset: cl-cbs, width: 1.5}\n" +
      replaced(kPlain, "name: agent1", "vehicle: {front: 4.0, rear: -0.5, max_accel: 2.0}");
  const Instance instance = read(text);
  Vehicle common = vehicle_preset("cl-cbs")->vehicle;
  common.width = 1.5;
  EXPECT_EQ(instance.agents[0].vehicle, common);
  common.front = 4.0;
  common.rear = -0.5;
  common.max_accel = 2.0;
  EXPECT_EQ(instance.agents[1].vehicle, common);
  EXPECT_EQ(instance.agents[1].name, "agent1");  // the default: by index
  EXPECT_EQ(instance.dt, vehicle_preset("cl-cbs")->dt);
}

TEST_F(InstanceFile, TheUsersPresetReplacesTheFilesButNotTheAgents) {
  const std::string text = "vehicle: {width: 1.5}\n" +
                           replaced(kPlain, "name: agent1", "vehicle: {preset: escot, width: 1.2}");
  const Instance instance = read(text, {.vehicle_preset = "cl-cbs"});
  EXPECT_EQ(instance.agents[0].vehicle, vehicle_preset("cl-cbs")->vehicle);
  EXPECT_EQ(instance.agents[1].vehicle.width, 1.2);
  EXPECT_EQ(instance.dt, vehicle_preset("cl-cbs")->dt);
}

TEST_F(InstanceFile, TheStepComesFromTheUserElseTheFileElseThePreset) {
  EXPECT_EQ(read(kPlain, {.vehicle_preset = "cl-cbs"}).dt, 3.0 * 0.706);
  EXPECT_EQ(read("dt: 0.25\n" + kPlain, {.vehicle_preset = "cl-cbs"}).dt, 0.25);
  EXPECT_EQ(read("dt: 0.25\n" + kPlain, {.dt = 0.5}).dt, 0.5);
}

TEST_F(InstanceFile, PolygonsMayRepeatTheirFirstPoint) {
  const std::string text = kPlain + "  polygons: [[[1, 1], [2, 1], [2, 1], [2, 2], [1, 1]]]\n";
  EXPECT_EQ(read(text).map.polygons.at(0), (Polygon{{1, 1}, {2, 1}, {2, 2}}));
}

TEST_F(InstanceFile, ReadsGuoAndYusJson) {
  const std::string text = R"({"xmax": 100, "ymax": 50, "obstacles": [[8.5, 19]],
    "starts": [[9, 11, 0], [20, 11, 1.5]], "goals": [[30, 14, 0], [40, 14, 4.71]]})";
  const Instance instance = read(text, {}, "agents_2.json");
  EXPECT_EQ(instance.map.width, 100.0);
  EXPECT_EQ(instance.map.height, 50.0);
  EXPECT_EQ(instance.map.bounds, Bounds::kAxle);
  EXPECT_EQ(instance.map.circles.at(0).radius, 0.8);
  ASSERT_EQ(instance.agents.size(), 2u);
  EXPECT_EQ(instance.agents[1].name, "agent1");
  EXPECT_EQ(instance.agents[1].start, (Pose{20, 11, 1.5}));
  EXPECT_EQ(read(text, {}, "without_extension").agents.size(), 2u);
}

TEST_F(InstanceFile, JsonMayHoldOurOwnFormatToo) {
  const std::string text =
      R"({"agents": [{"start": [9, 11, 0], "goal": [30, 14, 0]}], "map": {"dimensions": [50, 50]}})";
  EXPECT_EQ(read(text, {}, "a.json").agents.at(0).name, "agent0");
}

TEST_F(InstanceFile, AByteOrderMarkAndWindowsLinesDoNotMatter) {
  std::string text = "\xef\xbb\xbf";
  for (const char c : kPlain) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(read(text).agents.size(), 2u);
}

// ---- bad input, by its message

struct BadCase {
  const char* name;
  const char* replace;  ///< this in the plain file ...
  const char* by;       ///< ... by that
  const char* message;
};

class BadInstance : public InstanceFile, public testing::WithParamInterface<BadCase> {};

TEST_P(BadInstance, IsToldByPlaceValueAndRemedy) {
  const std::string message = error(replaced(kPlain, GetParam().replace, GetParam().by));
  EXPECT_EQ(message, std::string("cross.yaml: ") + GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BadInstance,
    testing::Values(
        BadCase{"NoNumber", "30, 5, 0", "30, five, 0",
                "agents[1].start[1]: is \"five\"; give a finite number [m]"},
        BadCase{"TrailingJunk", "30, 5, 0", "30, 5m, 0",
                "agents[1].start[1]: is \"5m\"; give a finite number [m]"},
        BadCase{"NaN", "30, 5, 0", "30, 5, .nan",
                "agents[1].start[2]: is \".nan\"; give a finite number [rad]"},
        BadCase{"PlainNaN", "30, 5, 0", "nan, 5, 0",
                "agents[1].start[0]: is \"nan\"; give a finite number [m]"},
        BadCase{"Infinity", "30, 5, 0", "30, inf, 0",
                "agents[1].start[1]: is \"inf\"; give a finite number [m]"},
        BadCase{"Overflow", "30, 5, 0", "30, 1e999, 0",
                "agents[1].start[1]: is \"1e999\"; give a finite number [m]"},
        BadCase{"Huge", "30, 5, 0", "30, 1e300, 0",
                "agents[1].start[1]: is 1e+300 m; give at most 1000000 m"},
        BadCase{"TwoNumbers", "[30, 5, 0]", "[30, 5]",
                "agents[1].start: is a list of 2; give a list like [x, y, yaw]"},
        BadCase{"NoList", "[30, 5, 0]", "30",
                "agents[1].start: is \"30\"; give a list like [x, y, yaw]"},
        BadCase{"Nothing", "[30, 5, 0]", "",
                "agents[1].start: is nothing; give a list like [x, y, yaw]"},
        BadCase{"NoGoal", "    goal: [40, 5, 0]\n", "", "agents[1].goal: is missing; add it"},
        BadCase{"SameName", "name: agent1", "name: agent0",
                "agents[1].name: \"agent0\" is the name of agents[0] too; rename one"},
        BadCase{"EmptyName", "name: agent1", "name: ''",
                "agents[1].name: is \"\"; give 1 to 200 characters in one line"},
        BadCase{"UnknownKey", "name: agent1", "nmae: agent1",
                "agents[1]: has the unknown key \"nmae\"; the known keys are name, start, goal, "
                "vehicle"},
        BadCase{"RepeatedKey", "name: agent1", "goal: [1, 2, 3]",
                "a map has the key \"goal\" twice; remove one"},
        BadCase{"NoWidth", "[50, 60]", "[0, 60]", "map.dimensions[0]: is 0 m; give a number > 0"},
        BadCase{"NegativeHeight", "[50, 60]", "[50, -60]",
                "map.dimensions[1]: is -60 m; give a number > 0"},
        BadCase{"NegativeRadius", "0.50]", "-0.50]",
                "map.obstacles[0][2]: is -0.5 m; give a number > 0"},
        BadCase{"ObstacleOfOne", "[4.10, 45.66]", "[4.10]",
                "map.obstacles[1]: is a list of 1; give a list like [x, y] or [x, y, r]"},
        BadCase{"NoMap", "map:", "maps:",
                "has the unknown key \"maps\"; the known keys are agents, map, vehicle, dt, name, "
                "description"},
        BadCase{"UnknownPreset", "name: agent1", "vehicle: {preset: tank}",
                "agents[1].vehicle.preset: is the unknown preset \"tank\"; choose escot or cl-cbs"},
        BadCase{"NoVehicleWidth", "name: agent1", "vehicle: {width: 0}",
                "agents[1].vehicle.width: is 0 m; give a number > 0"},
        BadCase{"NoLength", "name: agent1", "vehicle: {front: 1, rear: -1}",
                "agents[1].vehicle: front 1 m + rear -1 m is no positive length; both are counted "
                "outwards from the rear axle"},
        BadCase{"PolygonOfTwo", "map:", "map:\n  polygons: [[[1, 1], [2, 1]]]",
                "map.polygons[0]: has 2 different points; give at least 3"},
        BadCase{"FlatPolygon", "map:", "map:\n  polygons: [[[1, 1], [2, 1], [3, 1]]]",
                "map.polygons[0]: has the area 0 m2; give an outline that encloses something"},
        BadCase{"CrossedPolygon", "map:", "map:\n  polygons: [[[0, 0], [4, 4], [4, 0], [0, 3]]]",
                "map.polygons[0]: its edges 0 and 2 cross; list the corners in the order of the "
                "outline"},
        BadCase{"UnknownBounds", "map:", "map:\n  bounds: body",
                "map.bounds: is \"body\"; choose axle or footprint"},
        BadCase{"Anchor", "[30, 5, 0]", "&a [30, 5, 0]",
                "line 5, column 12: anchors and aliases are not supported; write the value out"},
        BadCase{"AnchorOfNothing", "[30, 5, 0]", "&a ~",
                "line 5, column 12: anchors and aliases are not supported; write the value out"},
        BadCase{
            "LongText", "30, 5, 0", "30, a23456789b23456789c23456789d23456789e23456789f, 0",
            "agents[1].start[1]: is \"a23456789b23456789c23456789d23456789e234...\"; give a finite "
            "number [m]"},
        BadCase{"Tag", "[30, 5, 0]", "!!python/object [30, 5, 0]",
                "line 5, column 12: the tag \"tag:yaml.org,2002:python/object\" is not supported; "
                "remove it"},
        BadCase{"SecondDocument", "map:", "---\nmap:",
                "line 8, column 1: a second document begins here; keep one per file"},
        BadCase{"OpenBracket", "[30, 5, 0]", "[30, 5, 0",
                "line 6, column 9: is not YAML: end of sequence flow not found"}),
    [](const auto& test) { return test.param.name; });

TEST_F(InstanceFile, NoAgentsAreAnError) {
  EXPECT_THAT(error("agents: []\nmap: {dimensions: [5, 5]}\n"),
              HasSubstr("agents: is a list of 0; give a list like [{name: agent0"));
}

TEST_F(InstanceFile, LifelongGoalsAreAnError) {
  EXPECT_THAT(
      error(R"({"xmax": 9, "ymax": 9, "starts": [[1, 1, 0]], "goals": [[[2, 2, 0]]]})", "a.json"),
      HasSubstr("goals[0]: is a list of 1; give a list like [x, y, yaw]"));
  EXPECT_THAT(error(R"({"xmax": 9, "ymax": 9, "starts": [[1, 1, 0], [4, 4, 0]],
                        "goals": [[2, 2, 0]]})",
                    "a.json"),
              HasSubstr("goals: has 1 entries for 2 starts; give one goal per start"));
}

TEST_F(InstanceFile, BrokenJsonIsToldWithItsOffset) {
  EXPECT_THAT(error(R"({"agents": [)", "a.json"), HasSubstr("a.json: is not JSON at offset"));
}

TEST_F(InstanceFile, JsonThatIsCutOffIsToldSo) {
  const std::string text = R"({"xmax": 9, "ymax": 9, "starts": [[1, 1, 0]], "goals": [[2, 2, 0]]})";
  for (std::size_t size = 2; size < text.size(); ++size) {
    EXPECT_THAT(error(text.substr(0, size), "a.json"), HasSubstr("or is the file cut off?"))
        << size;
  }
  EXPECT_THAT(error(R"({"agents": ]})", "a.json"), testing::Not(HasSubstr("cut off")));
  EXPECT_THAT(error(R"({"other": 1})", "a.json"), testing::Not(HasSubstr("cut off")));
}

TEST_F(InstanceFile, HostileTextsEndInOneLine) {
  const auto repeated = [](const std::string& unit, std::size_t count) {
    std::string text = "agents: ";
    for (std::size_t k = 0; k < count; ++k) text += unit;
    return text;
  };
  for (const char* unit :
       {"[", "{", "- ", "? ",  "\"",   "'",      "[a, ",  "{a: ", "&a ", "*a ", "!a ",
        "%", "|", ": ", "a: ", "[[]]", "\n- - ", "\n-\n", "@",    "`",   "\\"}) {
    const std::string message = error(repeated(unit, 20'000));
    EXPECT_THAT(message, testing::StartsWith("cross.yaml: ")) << unit;
    EXPECT_THAT(message, testing::Not(HasSubstr("\n"))) << unit;
    EXPECT_LT(message.size(), 300u) << unit;
  }
  EXPECT_THAT(error(repeated("[", 100'000), "a.json"), HasSubstr("a.json: "));
}

TEST_F(InstanceFile, GarbageIsRefusedUnparsed) {
  EXPECT_THAT(error(std::string(10'000'000, 'x')),
              HasSubstr("is not an instance file (it has no key agents or starts)"));
  EXPECT_THAT(error(std::string("agents\0", 7)), HasSubstr("is not a text file (byte 0x00"));
  EXPECT_THAT(error("agents: \xff\xfe"), HasSubstr("is not a text file (byte 0xff at offset 8)"));
  EXPECT_THAT(error(""), HasSubstr("is empty; give another file"));
  EXPECT_THAT(error(" \n\n"), HasSubstr("is empty"));
}

TEST_F(InstanceFile, PlacesThatAreNoFilesAreErrors) {
  const auto message = [](const std::string& path) {
    try {
      (void)read_instance(path);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message(directory_.path("")), HasSubstr("is a directory; give a file"));
  EXPECT_THAT(message(directory_.path("none")), HasSubstr("cannot be read: No such file"));
  EXPECT_THAT(message("/dev/zero"), HasSubstr("is not a text file"));
}

// ---- writing

TEST_F(InstanceFile, WritesWhatItReads) {
  const std::vector<std::string> texts = {
      kPlain, "vehicle: {preset: cl-cbs}\n" + kPlain,
      "dt: 0.1\n" + kPlain + "  polygons: [[[1, 1], [2, 1], [2, 2.00001]]]\n  bounds: axle\n",
      replaced(kPlain, "name: agent1", "vehicle: {front: 4, max_accel: 2.5}\n    name: 'no: 1'")};
  for (const std::string& text : texts) {
    for (const YawSense yaw : {YawSense::kCounterClockwise, YawSense::kClockwise}) {
      const Instance instance = read(text, {.yaw = yaw});
      const std::string path = directory_.path("out.yaml");
      write_instance(instance, path, {.yaw = yaw});
      const Instance again = read_instance(path, {.yaw = yaw});
      ASSERT_EQ(again.agents.size(), instance.agents.size());
      for (std::size_t i = 0; i < again.agents.size(); ++i) {
        EXPECT_EQ(again.agents[i].name, instance.agents[i].name);
        EXPECT_EQ(again.agents[i].vehicle, instance.agents[i].vehicle);
        EXPECT_EQ(again.agents[i].start, instance.agents[i].start);
        EXPECT_EQ(again.agents[i].goal, instance.agents[i].goal);
      }
      EXPECT_EQ(again.dt, instance.dt);
      EXPECT_EQ(again.map.width, instance.map.width);
      EXPECT_EQ(again.map.height, instance.map.height);
      EXPECT_EQ(again.map.bounds, instance.map.bounds);
      EXPECT_EQ(again.map.polygons, instance.map.polygons);
      EXPECT_EQ(again.map.circles.size(), instance.map.circles.size());
    }
  }
}

TEST_F(InstanceFile, NamesTheVehicleByItsPresetWhereOneFits) {
  const auto written = [&](const std::string& text, const InstanceWriteOptions& options) {
    write_instance(read(text, {}), directory_.path("out.yaml"), options);
    return content_of(directory_.path("out.yaml"));
  };
  EXPECT_THAT(written("vehicle: {preset: cl-cbs}\n" + kPlain, {}),
              StartsWith("vehicle: {preset: cl-cbs}\nagents:"));
  EXPECT_THAT(written("vehicle: {preset: cl-cbs}\ndt: 1\n" + kPlain, {}),
              StartsWith("vehicle: {preset: cl-cbs}\ndt: 1.0\nagents:"));
  EXPECT_THAT(written("vehicle: {width: 1.5}\n" + kPlain, {}), StartsWith("vehicle: {front: 2.5,"));
  EXPECT_THAT(written(kPlain, {}), StartsWith("agents:"));

  const std::string named = written(kPlain, {.name_vehicle = true, .description = "a: b"});
  EXPECT_THAT(named, StartsWith("description: \"a: b\"\nvehicle: {preset: escot}\nagents:"));
  EXPECT_THAT(named, HasSubstr("  bounds: axle\n"));
}

/// Valid files with a few bytes changed, cut, doubled or swapped are read or refused, nothing else;
/// run under the sanitizers this is a small fuzz test.
TEST_F(InstanceFile, MutatedFilesAreReadOrRefused) {
  std::mt19937 random(1);
  const std::string base = "vehicle: {preset: cl-cbs, width: 1.5}\ndt: 0.5\n" + kPlain +
                           "  polygons: [[[1, 1], [2, 1], [2, 2]]]\n";
  const std::string alphabet = "[]{}:,-?&*!|>'\"%@`#\n \t0123456789.eEnaif\\\x01\xc3";
  int refused = 0;
  for (int round = 0; round < 500; ++round) {
    std::string text = base;
    for (unsigned edit = 0; edit <= random() % 3; ++edit) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = alphabet[random() % alphabet.size()];
          break;
        case 1:
          text.erase(at, 1 + random() % 10);
          break;
        case 2:
          text.insert(at, 1, alphabet[random() % alphabet.size()]);
          break;
        default:
          text.resize(at + 1);
          break;
      }
      if (text.empty()) text = "x";
    }
    refused += error(text) != "no error";
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(refused, 500);
}

}  // namespace
}  // namespace mvtp
