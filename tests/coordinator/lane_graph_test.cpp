#include "coordinator/network/lane_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/coordinator/shapes.hpp"

namespace mvtp {
namespace {

constexpr int kNone = LaneGraph::kNone;

TEST(LaneGraph, NumbersAndIdsLeadToEachOther) {
  for (const NamedShape& named : all_shapes()) {
    const NetworkShape shape = named.make();
    const LaneGraph graph(shape.network);
    EXPECT_EQ(graph.lanes(), int(shape.network.lanes.size()));
    EXPECT_EQ(graph.junctions(), int(shape.network.junctions.size()));
    for (int l = 0; l < graph.lanes(); ++l) {
      EXPECT_EQ(graph.find_lane(graph.lane(l).id), l);
      EXPECT_EQ(graph.edge_of(l) == kNone, graph.lane(l).internal);
      if (graph.edge_of(l) == kNone) continue;
      EXPECT_EQ(graph.edge_id(graph.edge_of(l)), graph.lane(l).edge);
      EXPECT_EQ(graph.lanes_of(graph.edge_of(l))[std::size_t(graph.lane(l).index)], l);
    }
    EXPECT_EQ(graph.find_lane("nowhere"), kNone);
    EXPECT_EQ(graph.find_edge("nowhere"), kNone);
    EXPECT_EQ(graph.find_junction("nowhere"), kNone);
  }
}

TEST(LaneGraph, EveryConnectionIsALinkSeenFromAllItsLanes) {
  for (const NamedShape& named : all_shapes()) {
    const NetworkShape shape = named.make();
    const LaneGraph graph(shape.network);
    std::size_t connections = 0;
    for (const auto& [id, junction] : shape.network.junctions) {
      connections += junction.connections.size();
    }
    ASSERT_EQ(std::size_t(graph.links()), connections) << shape.name;
    for (int k = 0; k < graph.links(); ++k) {
      const LaneGraph::Link& link = graph.link(k);
      EXPECT_THAT(graph.links_from(link.from), testing::Contains(k));
      EXPECT_THAT(graph.links_to(link.to), testing::Contains(k));
      double length = 0.0;
      for (const int via : link.via) {
        EXPECT_THAT(graph.links_over(via), testing::Contains(k));
        length += graph.lane(via).length;
      }
      EXPECT_DOUBLE_EQ(link.length, length);
      EXPECT_EQ(graph.junction_behind(graph.edge_of(link.from)), link.junction);
    }
  }
}

TEST(LaneGraph, NothingLeavesADeadEnd) {
  const NetworkShape shape = crossroads_shape();
  const LaneGraph graph(shape.network);
  EXPECT_EQ(graph.junction_behind(graph.find_edge("C-W")), kNone);
  EXPECT_EQ(graph.junction_behind(graph.find_edge("W-C")), graph.find_junction("C"));
}

}  // namespace
}  // namespace mvtp
