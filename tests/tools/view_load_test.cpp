#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "planner/problem/input_error.hpp"
#include "tools/view/load.hpp"
#include "tools/view/page.hpp"

namespace mvtp {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr const char* kInstance = R"(
agents:
  - {name: a, start: [5, 5, 0], goal: [7, 5, 0]}
  - {name: b, start: [7, 9, 0], goal: [8, 9, 0]}
map: {dimensions: [20, 20], obstacles: [[1, 15]]}
)";
constexpr const char* kPlan = R"(
statistics: {cost: 3}
schedule:
  a: [{x: 5, y: 5, yaw: 0, t: 0}, {x: 6, y: 5, yaw: 0, t: 1}, {x: 7, y: 5, yaw: 0, t: 2}]
  b: [{x: 7, y: 9, yaw: 0, t: 0}, {x: 8, y: 9, yaw: 0, t: 1}]
)";

class LoadReplays : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
    write("instance.yaml", kInstance);
    write("plan.yaml", kPlan);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
  }

  /// The message of the InputError, without the folder.
  [[nodiscard]] std::string message(const ViewRequest& request) const {
    try {
      (void)load_replays(request);
    } catch (const InputError& error) {
      const std::string text = error.what();
      const std::size_t at = text.find(folder_.string());
      return at == 0 ? text.substr(folder_.string().size() + 1) : text;
    }
    return "";
  }

  std::filesystem::path folder_;
};

nlohmann::json header_of(const Replay& replay) { return nlohmann::json::parse(replay.header); }

TEST_F(LoadReplays, APlanWithItsInstance) {
  const auto replays =
      load_replays({.files = {path("plan.yaml")}, .instances = {path("instance.yaml")}});
  ASSERT_EQ(replays.size(), 1U);
  EXPECT_EQ(header_of(replays[0])["frames"], 3);
  EXPECT_EQ(header_of(replays[0])["title"], "plan.yaml");
  EXPECT_TRUE(header_of(replays[0])["events"].empty());
}

TEST_F(LoadReplays, AnInstanceAlone) {
  const auto replays = load_replays({.files = {path("instance.yaml")}});
  ASSERT_EQ(replays.size(), 1U);
  EXPECT_EQ(header_of(replays[0])["frames"], 1);
}

TEST_F(LoadReplays, PagesAndPlansSideBySideUnderNewNames) {
  write("run.html", to_html(load_replays({.files = {path("instance.yaml")}})));
  const auto replays = load_replays({.files = {path("run.html"), path("plan.yaml")},
                                     .instances = {path("instance.yaml")},
                                     .labels = {"before", "after"}});
  ASSERT_EQ(replays.size(), 2U);
  EXPECT_EQ(header_of(replays[0])["label"], "before");
  EXPECT_EQ(header_of(replays[1])["label"], "after");
}

//   a drives through b's place: an event to jump to
TEST_F(LoadReplays, AnOverlapIsAnEvent) {
  std::string plan = kPlan;
  plan.replace(plan.find("x: 7, y: 9"), 10, "x: 7, y: 5");
  write("plan.yaml", plan);
  const auto replays =
      load_replays({.files = {path("plan.yaml")}, .instances = {path("instance.yaml")}});
  std::vector<std::string> kinds;
  const nlohmann::json header = header_of(replays.at(0));
  for (const auto& event : header["events"]) kinds.push_back(event["kind"]);
  EXPECT_THAT(kinds, Contains("overlap"));
}

TEST_F(LoadReplays, SaysWhatIsWrongWithFilesAndCounts) {
  EXPECT_THAT(message({.files = {path("none.yaml")}}), HasSubstr("none.yaml: "));
  EXPECT_THAT(message({.files = {folder_}}), HasSubstr("director"));
  EXPECT_EQ(message({.files = {path("plan.yaml")}}),
            "plan.yaml: looks like a plan; name its instance with --instance");
  write("garbage.html", std::string(1000, '\x01'));
  EXPECT_THAT(message({.files = {path("garbage.html")}}), HasSubstr("garbage.html: "));
  EXPECT_EQ(message({.files = {path("plan.yaml")},
                     .instances = {path("instance.yaml"), path("instance.yaml")}}),
            "--instance: names 2 instances for 1 plans; name one for all, or one for each");
  EXPECT_EQ(message({.files = {path("instance.yaml")}, .labels = {"x", "y"}}),
            "--label: names 2 of 1 replays; name all or none");
  write("other.yaml", R"({agents: [{name: c, start: [5, 5, 0], goal: [7, 5, 0]}],
                          map: {dimensions: [20, 20], obstacles: []}})");
  EXPECT_EQ(message({.files = {path("plan.yaml")}, .instances = {path("other.yaml")}}),
            "plan.yaml: schedule: lacks agent \"c\"; name the instance of this plan");
}

}  // namespace
}  // namespace mvtp
