// The rooms of the planner use only those below them: planner/README.md.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace mvtp {
namespace {

using Rooms = std::map<std::string, std::set<std::string>>;

const std::filesystem::path kPlanner = std::filesystem::path(MVTP_SOURCE_DIR) / "planner";

/// What each room includes directly, by the sources themselves.
Rooms included() {
  const std::regex include(R"re(^\s*#include "([a-z_]+)/(?:([a-z_]+)/)?[a-z_]+\.hpp")re");
  Rooms rooms;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kPlanner)) {
    const std::string extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp") continue;
    const std::string room = entry.path().parent_path().lexically_relative(kPlanner).string();
    std::set<std::string>& uses = rooms[room];
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      const std::string floor = match[1];
      const std::string used = match[2];
      if (floor != "planner") uses.insert(floor + "/");
      if (floor == "planner" && !used.empty() && used != room) uses.insert(used);
    }
  }
  return rooms;
}

TEST(Rooms, UseOnlyThoseBelowThem) {
  Rooms may = {{"problem", {}}};
  const auto add = [&](const std::string& room, const std::set<std::string>& direct) {
    std::set<std::string>& all = may[room] = direct;
    for (const std::string& used : direct) all.insert(may.at(used).begin(), may.at(used).end());
  };
  add("geometry", {"problem"});
  add("motion", {"geometry"});
  add("search", {"motion"});
  add("escot", {"search"});
  add("anytime", {"escot"});
  add("road", {"escot"});
  add("lot", {"escot"});
  add(".", {"anytime"});  // solve()

  const Rooms rooms = included();
  EXPECT_EQ(rooms.size(), may.size());
  for (const auto& [room, uses] : rooms) {
    ASSERT_TRUE(may.contains(room)) << room << " is not in planner/README.md";
    for (const std::string& used : uses) {
      EXPECT_TRUE(may.at(room).contains(used)) << room << " uses " << used;
    }
  }
}

TEST(Rooms, SayWhatIsInThem) {
  for (const auto& [room, uses] : included()) {
    EXPECT_TRUE(std::filesystem::exists(kPlanner / room / "README.md")) << room;
  }
}

}  // namespace
}  // namespace mvtp
