#include "planner/problem/initial_overlap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "planner/problem/referee_geometry.hpp"
#include "planner/problem/validate.hpp"

namespace mvtp {
namespace {

using referee::Box;
using referee::Disc;
using With = OverlappingPlace::With;

Disc disc_around(const Box& box) {
  return {box.center, std::hypot(box.half_length, box.half_width)};
}

void add_obstacles(const Map& map, referee::DiscsByX& obstacles, bool at_goal, std::size_t agent,
                   const Box& box, std::vector<OverlappingPlace>& found) {
  const std::size_t circles = map.circles.size();
  for (const std::size_t k : obstacles.near(disc_around(box))) {
    const double depth = k < circles ? -referee::separation(box, map.circles[k], 0.0)
                                     : -referee::separation(box, map.polygons[k - circles], 0.0);
    if (depth > kTouchTolerance) found.push_back({at_goal, agent, With::kObstacle, k, depth});
  }
}

void add_pairs(bool at_goal, const std::vector<Box>& boxes, std::vector<OverlappingPlace>& found) {
  std::vector<Disc> discs;
  for (const Box& box : boxes) discs.push_back(disc_around(box));
  std::vector<OverlappingPlace> pairs;
  for (const auto& [i, j] : referee::near_pairs(discs)) {
    const double depth = -referee::separation(boxes[i], boxes[j], 0.0);
    if (depth > kTouchTolerance) pairs.push_back({at_goal, j, With::kAgent, i, depth});
  }
  std::ranges::sort(pairs, {},
                    [](const OverlappingPlace& p) { return std::pair(p.agent, p.object); });
  found.insert(found.end(), pairs.begin(), pairs.end());
}

}  // namespace

std::vector<OverlappingPlace> find_overlapping_places(const Instance& instance) {
  referee::DiscsByX obstacles = referee::discs_of_obstacles(instance.map);
  std::vector<OverlappingPlace> found;
  for (const bool at_goal : {false, true}) {
    std::vector<Box> boxes;
    for (const Agent& agent : instance.agents) {
      boxes.push_back(referee::footprint(agent.vehicle, at_goal ? agent.goal : agent.start));
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      add_obstacles(instance.map, obstacles, at_goal, i, boxes[i], found);
    }
    add_pairs(at_goal, boxes, found);
  }
  return found;
}

std::string obstacle_name(const Map& map, std::size_t object) {
  const std::size_t circles = map.circles.size();
  return object < circles ? fmt::format("obstacles[{}]", object)
                          : fmt::format("polygons[{}]", object - circles);
}

std::string depth_text(double depth) {
  return depth < 0.01 ? fmt::format("{:.4f} m", depth) : fmt::format("{:.2f} m", depth);
}

std::vector<std::string> exemptions_of(const Instance& instance) {
  std::vector<std::string> texts;
  if (instance.initial_overlap == InitialOverlap::kRefuse) return texts;
  for (const OverlappingPlace& place : find_overlapping_places(instance)) {
    const auto name = [&](std::size_t i) { return instance.agents[i].name; };
    const std::string object = place.with == With::kObstacle
                                   ? obstacle_name(instance.map, place.object)
                                   : fmt::format("that of {}", name(place.object));
    texts.push_back(fmt::format("{} of {} in {} by {}", place.at_goal ? "goal" : "start",
                                name(place.agent), object, depth_text(place.depth)));
  }
  return texts;
}

}  // namespace mvtp
