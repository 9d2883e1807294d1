// The rooms of a floor use only those below them: planner/README.md, coordinator/README.md,
// tools/README.md.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mvtp {
namespace {

using Rooms = std::map<std::string, std::set<std::string>>;

std::filesystem::path folder_of(const std::string& floor) {
  return std::filesystem::path(MVTP_SOURCE_DIR) / floor;
}

/// What each room of a floor includes directly, by the sources themselves; other floors end in '/'.
Rooms included(const std::string& floor) {
  const std::regex include(R"re(^\s*#include "([a-z_]+)/(?:([a-z_/]+)/)?[a-z0-9_]+\.hpp")re");
  Rooms rooms;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_of(floor))) {
    const std::string extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp") continue;
    const std::string room = entry.path().parent_path().lexically_relative(folder_of(floor));
    std::set<std::string>& uses = rooms[room];
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      const std::string used = match[1] != floor        ? match[1].str() + '/'
                               : match[2].length() == 0 ? "."
                                                        : match[2].str();
      if (used != room) uses.insert(used);
    }
  }
  return rooms;
}

/// Which rooms each one may use: those named, and what they use.
class Floor {
 public:
  explicit Floor(std::string name) : name_(std::move(name)) {}

  void add(const std::string& room, const std::set<std::string>& direct) {
    std::set<std::string>& all = may_[room] = direct;
    for (const std::string& used : direct) {
      if (!used.ends_with('/')) all.insert(may_.at(used).begin(), may_.at(used).end());
    }
  }
  void expect_its_sources_to_keep_to_it() const {
    const Rooms rooms = included(name_);
    EXPECT_EQ(rooms.size(), may_.size());
    for (const auto& [room, uses] : rooms) {
      ASSERT_TRUE(may_.contains(room)) << room << " is not known";
      for (const std::string& used : uses) {
        EXPECT_TRUE(may_.at(room).contains(used)) << room << " uses " << used;
      }
    }
  }

 private:
  std::string name_;
  Rooms may_;
};

TEST(Rooms, OfThePlannerUseOnlyThoseBelowThem) {
  Floor planner("planner");
  planner.add("problem", {});
  planner.add("geometry", {"problem"});
  planner.add("motion", {"geometry"});
  planner.add("search", {"motion"});
  planner.add("escot", {"search"});
  planner.add("anytime", {"escot"});
  planner.add("road", {"escot"});
  planner.add("lot", {"escot"});
  planner.add(".", {"anytime", "road", "lot"});  // solve() and the other public headers
  planner.expect_its_sources_to_keep_to_it();
}

TEST(Rooms, OfTheCoordinatorUseOnlyThoseBelowThem) {
  Floor coordinator("coordinator");
  coordinator.add("network", {"planner/"});
  coordinator.add(".", {"network"});  // the port
  coordinator.add("audit", {"."});
  coordinator.add("measures", {"audit"});
  coordinator.add("corridor", {"audit"});
  coordinator.add("prediction", {"corridor"});
  coordinator.add("signals", {"prediction"});
  coordinator.add("drivers", {"signals"});
  coordinator.add("people", {"signals"});
  coordinator.add("faults", {"drivers"});
  coordinator.add("junctions", {"drivers", "people", "faults"});
  coordinator.add("lot", {"measures"});
  coordinator.add("controllers", {"junctions", "lot"});
  coordinator.add("simulation", {"audit"});
  coordinator.add("report", {"measures", "junctions", "lot", "simulation"});
  coordinator.expect_its_sources_to_keep_to_it();
}

TEST(Rooms, OfToolsUseOnlyThoseBelowThem) {
  Floor tools("tools");
  tools.add("manual", {"planner/"});
  tools.add("cli", {"manual"});
  tools.add("runs", {"cli"});
  tools.add("view", {"runs", "coordinator/"});
  tools.add("doctor", {"view"});
  tools.add("export", {"view", "traci_bridge/"});
  tools.add("solve", {"cli"});
  tools.add("bench", {"solve", "runs"});
  tools.add("generate", {"cli", "traci_bridge/"});
  tools.add("toio/cube", {"cli"});
  tools.add("toio/plan", {"toio/cube"});
  tools.add("toio/device", {"toio/plan"});
  tools.add("toio/emulator", {"toio/device"});
  tools.add("toio", {"toio/emulator"});
  tools.add("coordinate", {"view", "traci_bridge/"});
  tools.add("compare", {"coordinate"});
  tools.add("sweep", {"compare"});
  tools.add("report", {"bench", "sweep"});
  tools.add("python", {"solve", "coordinate"});
  tools.add(".", {"doctor", "export", "generate", "toio", "report", "python"});  // the programs
  tools.expect_its_sources_to_keep_to_it();
}

/// The public headers of the planner, as cmake/PublicHeaders.cmake lists them.
std::set<std::string> public_headers_of_the_planner() {
  const std::regex entry(R"re(^\s*[a-z_]+\.hpp\s+(planner/[a-z_/]+\.hpp))re");
  std::set<std::string> headers;
  std::ifstream list(folder_of("cmake") / "PublicHeaders.cmake");
  for (std::string line; std::getline(list, line);) {
    std::smatch match;
    if (std::regex_search(line, match, entry)) headers.insert(match[1]);
  }
  return headers;
}

/// Each line of a folder's sources that includes a header of the planner: the header, and where.
std::vector<std::pair<std::string, std::string>> includes_of_the_planner(
    const std::string& folder) {
  const std::regex include(R"re(^\s*#\s*include\s*["<](planner/[^">]+)[">])re");
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_of(folder))) {
    if (!entry.is_regular_file()) continue;
    const std::string where = entry.path().lexically_relative(MVTP_SOURCE_DIR);
    std::ifstream file(entry.path());
    int number = 0;
    for (std::string line; std::getline(file, line);) {
      ++number;
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      found.emplace_back(match[1], where + ":" + std::to_string(number));
    }
  }
  return found;
}

TEST(Rooms, OfThePlannerAreIncludedByOtherFloorsThroughItsPublicHeaders) {
  const std::set<std::string> headers = public_headers_of_the_planner();
  for (const char* world : {"planner/solve.hpp", "planner/road.hpp", "planner/lot.hpp"}) {
    EXPECT_TRUE(headers.contains(world)) << world << " is not in cmake/PublicHeaders.cmake";
  }
  for (const std::string& header : headers) {
    EXPECT_TRUE(std::filesystem::exists(folder_of(header))) << header;
  }
  for (const char* floor : {"coordinator", "traci_bridge", "tools"}) {
    const auto includes = includes_of_the_planner(floor);
    EXPECT_FALSE(includes.empty()) << floor;
    for (const auto& [header, where] : includes) {
      EXPECT_TRUE(header.starts_with("planner/problem/") || headers.contains(header))
          << where << " includes " << header << ", which is private to the planner";
    }
  }
}

TEST(Rooms, OfThePlannerSayWhatIsInThem) {
  for (const auto& [room, uses] : included("planner")) {
    EXPECT_TRUE(std::filesystem::exists(folder_of("planner") / room / "README.md")) << room;
  }
}

}  // namespace
}  // namespace mvtp
