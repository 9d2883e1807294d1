#include "traci_bridge/configuration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/traci_bridge/fixtures.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::SizeIs;

/// A directory with the files net.xml, a.xml and b.xml.
class ReadConfiguration : public testing::Test {
 protected:
  ReadConfiguration() {
    for (const char* name : {"net.xml", "a.xml", "b.xml"}) directory_.write(name, "<x/>");
  }

  SumoConfiguration read(const std::string& content) {
    return read_configuration(directory_.write("test.sumocfg", content));
  }
  std::string error_of(const std::string& content) {
    return message_of([&] { read(content); });
  }

  TemporaryDirectory directory_;
};

TEST_F(ReadConfiguration, FilesAreFoundBesideTheConfiguration) {
  const SumoConfiguration c = read(R"(<configuration>
    <input><net-file value="net.xml"/><route-files value="a.xml, b.xml"/>
           <additional-files value=""/></input>
    <time><begin value="30"/><end value="1:00:05"/><step-length value="0.1"/></time>
  </configuration>)");

  EXPECT_EQ(c.net_file, directory_ / "net.xml");
  EXPECT_THAT(c.route_files, ElementsAre(directory_ / "a.xml", directory_ / "b.xml"));
  EXPECT_THAT(c.additional_files, IsEmpty());
  EXPECT_DOUBLE_EQ(c.begin, 30.0);
  EXPECT_DOUBLE_EQ(c.end.value(), 3605.0);
  EXPECT_DOUBLE_EQ(c.step_length, 0.1);
}

TEST_F(ReadConfiguration, FlatFilesAndSynonymsAreReadAsSumoDoes) {
  const SumoConfiguration c = read(R"(<c><net v="net.xml"/><r>a.xml</r><end value="-1"/></c>)");

  EXPECT_EQ(c.net_file, directory_ / "net.xml");
  EXPECT_THAT(c.route_files, ElementsAre(directory_ / "a.xml"));
  EXPECT_DOUBLE_EQ(c.step_length, 1.0);
  EXPECT_EQ(c.end, std::nullopt);
}

TEST_F(ReadConfiguration, EnvironmentVariablesAreReplaced) {
  setenv("MVTP_TEST_NAME", "net", 1);
  EXPECT_EQ(read(R"(<c><net-file value="${MVTP_TEST_NAME}.xml"/></c>)").net_file,
            directory_ / "net.xml");
  unsetenv("MVTP_TEST_NAME");
  EXPECT_THAT(error_of(R"(<c><net-file value="${MVTP_TEST_NAME}.xml"/></c>)"),
              MatchesRegex(".*:1: the environment variable MVTP_TEST_NAME is not set; export .*"));
  EXPECT_THAT(error_of(R"(<c><net-file value="${MVTP"/></c>)"), MatchesRegex(".* a } is missing"));
}

TEST_F(ReadConfiguration, MissingFilesAreNamedWithTheirOption) {
  EXPECT_THAT(error_of("<c>\n<net-file value=\"lost.xml\"/></c>"),
              MatchesRegex(R"(.*/test\.sumocfg:2: net-file: .*/lost\.xml: no such file; .*)"));
  EXPECT_THAT(error_of(R"(<c><net-file value="net.xml"/><route-files value="a.xml,x.xml"/></c>)"),
              MatchesRegex(R"(.*:1: route-files: .*/x\.xml: no such file; .*)"));
}

TEST_F(ReadConfiguration, BadValuesAreNamed) {
  EXPECT_THAT(error_of("<c/>"), MatchesRegex(".*:1: no net-file in it; .*"));
  EXPECT_THAT(error_of(R"(<c><net-file value="net.xml"/><begin value="soon"/></c>)"),
              MatchesRegex(R"(.*:1: begin: "soon" is not a time; .*)"));
  EXPECT_THAT(error_of(R"(<c><net-file value="net.xml"/><step-length value="0"/></c>)"),
              MatchesRegex(".*: step-length: 0.0* s is below 0.001 s; .*"));
  EXPECT_THAT(error_of("<c"), MatchesRegex(R"(.*:1: not XML .*; give the path of a SUMO conf.*)"));
}

class ShippedScenario : public testing::TestWithParam<const char*> {};

TEST_P(ShippedScenario, NamesFilesThatAreThere) {
  const SumoConfiguration c = read_configuration(project_file(GetParam()));
  EXPECT_THAT(c.route_files, SizeIs(1));
  EXPECT_DOUBLE_EQ(c.step_length, 0.1);
  EXPECT_EQ(c.end, std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScenario,
                         testing::Values("scenarios/crossroads/crossroads.sumocfg",
                                         "scenarios/crossroads/crossroads.static.sumocfg",
                                         "scenarios/crossroads/crossroads2-800.actuated.sumocfg",
                                         "scenarios/rilsa/rilsa.sumocfg"));

class ShippedLayout : public testing::TestWithParam<const char*> {};

TEST_P(ShippedLayout, LastsTenMinutesUnderEachOfItsControls) {
  const std::string name = std::string("scenarios/layouts/") + GetParam();
  const bool has_lights = name.find("roundabout") == std::string::npos;
  for (const char* kind : {"", ".static", ".actuated"}) {
    if (*kind != '\0' && !has_lights) continue;
    const SumoConfiguration c = read_configuration(project_file(name + kind + ".sumocfg"));
    EXPECT_THAT(c.route_files, SizeIs(1));
    EXPECT_DOUBLE_EQ(c.step_length, 0.1);
    EXPECT_EQ(c.end, 600.0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedLayout,
                         testing::Values("four-arm-200", "four-arm-360", "four-arm-600",
                                         "four-arm-800", "four-arm2-720", "t-junction-468",
                                         "roundabout-360"));

/// Leaves SUMO_HOME as it was to the tests behind it.
class SetSumoHome : public testing::Test {
 protected:
  void TearDown() override {
    if (before_) {
      setenv("SUMO_HOME", before_->c_str(), 1);
    } else {
      unsetenv("SUMO_HOME");
    }
  }

 private:
  static std::optional<std::string> value() {
    const char* const home = std::getenv("SUMO_HOME");
    return home == nullptr ? std::nullopt : std::optional<std::string>(home);
  }

  std::optional<std::string> before_ = value();
};

TEST_F(SetSumoHome, FindsSumoWhereTheVariableIsNotSet) {
  unsetenv("SUMO_HOME");
  set_sumo_home();
  ASSERT_NE(std::getenv("SUMO_HOME"), nullptr);
  EXPECT_TRUE(std::filesystem::is_directory(std::string(std::getenv("SUMO_HOME")) + "/tools"));
}

TEST_F(SetSumoHome, KeepsTheUsersChoice) {
  setenv("SUMO_HOME", "/opt/my-sumo", 1);
  set_sumo_home();
  EXPECT_STREQ(std::getenv("SUMO_HOME"), "/opt/my-sumo");
}

}  // namespace
}  // namespace mvtp
