#include "coordinator/network/partition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

using testing::UnorderedElementsAre;

/// The ids of the junctions of each control zone.
std::set<std::set<std::string>> zones_of(const RoadNetwork& network, double chain,
                                         std::vector<std::string> ids = {}) {
  const LaneGraph graph(network);
  std::set<std::set<std::string>> zones;
  for (const ControlZone& zone : partition(graph, select_junctions(graph, ids, chain), chain)) {
    std::set<std::string> names;
    for (const int j : zone.junctions) names.insert(graph.junction(j).id);
    EXPECT_EQ(names.size(), zone.junctions.size());
    zones.insert(names);
  }
  return zones;
}

TEST(Partition, HasEachCoordinatedJunctionInExactlyOneZone) {
  for (const NamedShape& named : all_shapes()) {
    const NetworkShape shape = named.make();
    const LaneGraph graph(shape.network);
    for (const double chain : {0.0, 25.0, 50.0, 200.0}) {
      const std::vector<bool> coordinated = select_junctions(graph, {}, chain);
      std::vector<int> seen(std::size_t(graph.junctions()), 0);
      for (const ControlZone& zone : partition(graph, coordinated, chain)) {
        int connections = 0;
        for (const int j : zone.junctions) {
          ++seen[std::size_t(j)];
          connections += int(graph.junction(j).connections.size());
        }
        EXPECT_EQ(zone.connections, connections);
      }
      for (std::size_t j = 0; j < seen.size(); ++j) {
        EXPECT_EQ(seen[j], coordinated[j] ? 1 : 0) << shape.name << ", chain " << chain;
      }
    }
  }
}

TEST(Partition, PutsNearJunctionsTogetherAndOthersApart) {
  EXPECT_THAT(zones_of(chain_shape().network, 50.0),
              UnorderedElementsAre(std::set<std::string>{"A", "B"}));
  EXPECT_THAT(zones_of(chain_shape().network, 20.0),
              UnorderedElementsAre(std::set<std::string>{"A"}, std::set<std::string>{"B"}));
  // Between the columns of the grid there are 22 and 45 m of road, between its rows 28 and 30 m.
  EXPECT_EQ(zones_of(grid_shape().network, 50.0).size(), 1U);
  EXPECT_THAT(zones_of(grid_shape().network, 40.0),
              UnorderedElementsAre(std::set<std::string>{"A0", "A1", "A2", "B0", "B1", "B2"},
                                   std::set<std::string>{"C0", "C1", "C2"}));
  EXPECT_EQ(zones_of(grid_shape().network, 20.0).size(), 9U);
}

/// The same network with other names, in another order.
RoadNetwork renamed(const RoadNetwork& network, const std::map<std::string, std::string>& names) {
  RoadNetwork other = network;
  other.junctions.clear();
  for (const auto& [id, junction] : network.junctions) {
    const auto name = names.find(id);
    Junction& copy = other.junctions[name == names.end() ? id : name->second];
    copy = junction;
    copy.id = name == names.end() ? id : name->second;
    std::ranges::reverse(copy.connections);
  }
  return other;
}

TEST(Partition, DoesNotDependOnTheOrderOfItsInput) {
  const RoadNetwork grid = grid_shape().network;
  std::map<std::string, std::string> names;
  std::map<std::string, std::string> back;
  const std::vector<std::string> ids = {"A0", "A1", "A2", "B0", "B1", "B2", "C0", "C1", "C2"};
  for (std::size_t i = 0; i < ids.size(); ++i) {
    names[ids[i]] = ids[(7 * i + 3) % ids.size()] + "x";
    back[names[ids[i]]] = ids[i];
  }
  for (const double chain : {20.0, 40.0, 50.0}) {
    std::set<std::set<std::string>> zones;
    for (const std::set<std::string>& zone : zones_of(renamed(grid, names), chain)) {
      std::set<std::string> original;
      for (const std::string& id : zone) original.insert(back.at(id));
      zones.insert(original);
    }
    EXPECT_EQ(zones, zones_of(grid, chain));
  }
  EXPECT_EQ(zones_of(grid, 40.0, {"A0", "C2"}), zones_of(grid, 40.0, {"C2", "A0"}));
}

TEST(SelectJunctions, TakesNeighboursWithoutRoomBetweenAlong) {
  EXPECT_THAT(zones_of(chain_shape().network, 50.0, {"A"}),
              UnorderedElementsAre(std::set<std::string>{"A", "B"}));
  EXPECT_THAT(zones_of(chain_shape().network, 20.0, {"A"}),
              UnorderedElementsAre(std::set<std::string>{"A"}));
  // D is a bend without conflicts: it is not coordinated.
  EXPECT_THAT(zones_of(seam_shape().network, 50.0),
              UnorderedElementsAre(std::set<std::string>{"C"}));
}

}  // namespace
}  // namespace mvtp
