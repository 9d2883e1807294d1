#include "coordinator/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "tests/temporary_directory.hpp"

namespace mvtp {
namespace {

using testing::ContainerEq;

/// The names in the first column of the table that follows `heading` in docs/outputs.md.
std::set<std::string> documented(const std::string& heading) {
  const std::string text = content_of(MVTP_SOURCE_DIR "/docs/outputs.md");
  const std::size_t at = text.find("\n" + heading + "\n");
  if (at == std::string::npos) return {};
  std::istringstream lines(text.substr(at + heading.size() + 2));
  std::set<std::string> names;
  const std::regex name("`([a-z0-9_]+)`");
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() && names.empty()) continue;
    if (!line.starts_with("|")) break;
    const std::string column = line.substr(1, line.find('|', 1) - 1);
    for (std::sregex_iterator m(column.begin(), column.end(), name), end; m != end; ++m) {
      names.insert((*m)[1]);
    }
  }
  return names;
}

std::set<std::string> keys_of(const nlohmann::json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

TEST(Report, TheDocsNameEveryKeyOfTheSummaryAndNoOther) {
  RunReport report;
  report.message = "SUMO ended";
  report.lots.resize(2);
  report.humans.emplace();
  report.faults.emplace();
  report.human_faults.emplace();
  report.vehicles = {{.id = "a", .type = "car", .departure = 0.0, .movement = "W>E"}};
  const nlohmann::json summary = nlohmann::json::parse(summary_json(report));
  EXPECT_THAT(documented("### `summary.json`"), ContainerEq(keys_of(summary)));
  EXPECT_THAT(documented("`audit`:"), ContainerEq(keys_of(summary["audit"])));
  EXPECT_THAT(documented("`parking`:"), ContainerEq(keys_of(summary["parking"])));
  const std::set<std::string> of_a_group =
      documented("each group of `delay_by_type_s` and `delay_by_movement_s`:");
  EXPECT_THAT(of_a_group, ContainerEq(keys_of(summary["delay_by_type_s"]["car"])));
  EXPECT_THAT(of_a_group, ContainerEq(keys_of(summary["delay_by_movement_s"]["W>E"])));
}

TEST(Report, DelaysAreThoseOfControlledAndOfHumanDrivenVehicles) {
  RunReport report;
  const auto add = [&](const char* id, std::optional<double> departure, double arrival,
                       bool coordinated) {
    report.vehicles.push_back(
        {.id = id, .departure = departure, .arrival = arrival, .coordinated = coordinated});
  };
  add("ours", 0.0, 10.0, true);
  add("human", 0.0, 20.0, false);
  add("other human", 0.0, 40.0, false);
  add("never there", std::nullopt, 100.0, false);
  const nlohmann::json summary = nlohmann::json::parse(summary_json(report));
  EXPECT_EQ(summary["delay_controlled_s"]["mean"], 10.0);
  EXPECT_EQ(summary["delay_controlled_s"]["vehicles"], 1);
  EXPECT_EQ(summary["delay_human_s"]["mean"], 30.0);
  EXPECT_EQ(summary["delay_human_s"]["vehicles"], 2);
}

TEST(Report, ContactsAreTheOverlapsWithACoordinatedVehicle) {
  RunReport report;
  report.begin = 100.0;
  report.end = 110.0;
  report.faults.emplace().step_length = 0.1;
  report.events = {
      {.kind = AuditEventKind::kOverlap, .time = 101.0, .what = "overlap of two human drivers"},
      {.kind = AuditEventKind::kOffRoad, .time = 102.0, .what = "overlap.3 is off the road"},
      {.kind = AuditEventKind::kOverlap,
       .time = 103.46,
       .what = "overlap of a and b (human-driven)",
       .coordinated = true},
      {.kind = AuditEventKind::kPersonTouched, .time = 104.0, .what = "a touches p"}};
  const nlohmann::json summary = nlohmann::json::parse(summary_json(report));
  const nlohmann::json& contacts = summary["faults"]["contacts"];
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0]["frame"], 35);
  EXPECT_EQ(contacts[0]["time_s"], 103.46);
  EXPECT_EQ(contacts[0]["what"], "overlap of a and b (human-driven)");
}

}  // namespace
}  // namespace mvtp
