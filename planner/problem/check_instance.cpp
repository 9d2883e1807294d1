#include "planner/problem/check_instance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "planner/problem/referee_geometry.hpp"
#include "planner/problem/validate.hpp"

namespace mvtp {
namespace {

using referee::Box;

/// One of the two poses of each agent.
struct Place {
  const char* key;  ///< in the file
  Pose Agent::*pose;
};

class Check {
 public:
  Check(const Instance& instance, const std::string& file) : instance_(instance), file_(file) {}

  [[nodiscard]] std::vector<InputError> run() {
    for (const Place place : {Place{"start", &Agent::start}, Place{"goal", &Agent::goal}}) {
      std::vector<Box> boxes;
      for (const Agent& agent : instance_.agents) {
        boxes.push_back(referee::footprint(agent.vehicle, agent.*place.pose));
      }
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        check_circles(i, place, boxes[i]);
        check_polygons(i, place, boxes[i]);
        check_bounds(i, place, boxes[i]);
      }
      check_pairs(place, boxes);
    }
    return std::move(problems_);
  }

 private:
  void add(std::size_t i, const Place& place, const std::string& what) {
    problems_.emplace_back(fmt::format("{}: agents[{}].{}", file_, i, place.key), what);
  }

  [[nodiscard]] std::string at(std::size_t i, const Place& place) const {
    const Pose& pose = instance_.agents[i].*place.pose;
    return fmt::format("({:.2f}, {:.2f})", pose.x, pose.y);
  }

  void add_obstacle(std::size_t i, const Place& place, const std::string& obstacle, double depth) {
    add(i, place,
        fmt::format("the footprint at {} overlaps {} by {}; move the {} or the obstacle",
                    at(i, place), obstacle, metres(depth), place.key));
  }

  /// Two digits as far as they say something.
  static std::string metres(double depth) {
    return depth < 0.01 ? fmt::format("{:.4f} m", depth) : fmt::format("{:.2f} m", depth);
  }

  void check_circles(std::size_t i, const Place& place, const Box& box) {
    for (std::size_t c = 0; c < instance_.map.circles.size(); ++c) {
      const double depth = -referee::separation(box, instance_.map.circles[c]);
      if (depth <= kTouchTolerance) continue;
      add_obstacle(i, place, fmt::format("obstacles[{}]", c), depth);
    }
  }

  void check_polygons(std::size_t i, const Place& place, const Box& box) {
    for (std::size_t p = 0; p < instance_.map.polygons.size(); ++p) {
      const double depth = -referee::separation(box, instance_.map.polygons[p]);
      if (depth <= kTouchTolerance) continue;
      add_obstacle(i, place, fmt::format("polygons[{}]", p), depth);
    }
  }

  void check_bounds(std::size_t i, const Place& place, const Box& box) {
    const Map& map = instance_.map;
    const bool of_axle = map.bounds == Bounds::kAxle;
    const Pose& pose = instance_.agents[i].*place.pose;
    const double outside = -(of_axle ? referee::margin_inside(map, Point{pose.x, pose.y})
                                     : referee::margin_inside(map, box));
    if (outside <= kTouchTolerance) return;
    add(i, place,
        fmt::format("the {} at {} is {} outside the map of {} x {} m; move it{}",
                    of_axle ? "rear axle" : "footprint", at(i, place), metres(outside), map.width,
                    map.height, of_axle ? "" : ", or choose --bounds axle"));
  }

  void check_pairs(const Place& place, const std::vector<Box>& boxes) {
    std::vector<referee::Disc> discs;
    for (const Box& box : boxes) {
      discs.push_back({box.center, std::hypot(box.half_length, box.half_width)});
    }
    std::vector<std::tuple<std::size_t, std::size_t, double>> overlaps;
    for (const auto& [i, j] : referee::near_pairs(discs)) {
      const double depth = -referee::separation(boxes[i], boxes[j]);
      if (depth > kTouchTolerance) overlaps.emplace_back(j, i, depth);
    }
    std::sort(overlaps.begin(), overlaps.end());
    for (const auto& [i, j, depth] : overlaps) {
      add(i, place,
          fmt::format("the footprint at {} overlaps that of agents[{}].{} by {}; move one of them",
                      at(i, place), j, place.key, metres(depth)));
    }
  }

  const Instance& instance_;
  const std::string& file_;
  std::vector<InputError> problems_;
};

}  // namespace

std::vector<InputError> check_instance(const Instance& instance, const std::string& file) {
  return Check(instance, file).run();
}

}  // namespace mvtp
