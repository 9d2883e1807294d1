#include "planner/search/focal_queue.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

namespace mvtp {
namespace {

//   w = 1.5, least bound 10: nodes that cost up to 15 are in FOCAL, the one with the least key
//   wins.
TEST(FocalQueue, TakesTheLeastKeyAmongThoseWithinTheBound) {
  FocalQueue<int> queue(1.5);
  queue.push(0, 10, 10, 5);
  queue.push(1, 14, 15, 2);
  queue.push(2, 16, 16, 0);  // too costly, though its key is least
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), 0);
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_TRUE(queue.empty());
}

//   The bound is that of the least lower bound [Barer et al. 2014], not that of the least cost 12.
TEST(FocalQueue, BoundsByTheLeastLowerBoundNotByTheLeastCost) {
  FocalQueue<int> queue(1.5);
  queue.push(0, 8, 12, 5);
  queue.push(1, 13, 13, 1);  // 13 <= 1.5 * 12, but 13 > 1.5 * 8
  EXPECT_EQ(queue.pop(), 0);
}

TEST(FocalQueue, BreaksTiesByTheLowerNumber) {
  FocalQueue<int> queue(1.0);
  queue.push(1, 3, 3, 7);
  queue.push(0, 3, 3, 7);
  EXPECT_EQ(queue.pop(), 0);
}

TEST(FocalQueue, AlwaysPopsWithinTheBoundAndAtTheLeastKey) {
  std::mt19937_64 rng(5);
  FocalQueue<int> queue(1.3);
  struct Node {
    double f;
    int key;
  };
  std::vector<Node> nodes;
  std::set<int> open;
  double bound = 0.0;
  for (int k = 0; k < 3000; ++k) {
    if (open.empty() || rng() % 5 < 3) {
      // Like a search with a consistent heuristic: nothing below the bound is added.
      const Node node{bound + double(rng() % 100), int(rng() % 10)};
      queue.push(int(nodes.size()), node.f, node.f, node.key);
      open.insert(int(nodes.size()));
      nodes.push_back(node);
      continue;
    }
    double least = std::numeric_limits<double>::infinity();
    for (const int n : open) least = std::min(least, nodes[std::size_t(n)].f);
    bound = std::max(bound, least);
    const int popped = queue.pop();
    EXPECT_EQ(queue.lower_bound(), bound);
    EXPECT_LE(nodes[std::size_t(popped)].f, 1.3 * bound);
    for (const int n : open) {
      if (nodes[std::size_t(n)].f <= 1.3 * bound) {
        EXPECT_LE(nodes[std::size_t(popped)].key, nodes[std::size_t(n)].key);
      }
    }
    EXPECT_EQ(open.erase(popped), 1U);
  }
}

}  // namespace
}  // namespace mvtp
