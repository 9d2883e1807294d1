#include "planner/problem/check_instance.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "planner/problem/initial_overlap.hpp"
#include "planner/problem/referee_geometry.hpp"
#include "planner/problem/validate.hpp"

namespace mvtp {
namespace {

class Check {
 public:
  Check(const Instance& instance, const std::string& file) : instance_(instance), file_(file) {}

  [[nodiscard]] std::vector<InputError> run() const {
    std::vector<InputError> problems;
    if (instance_.initial_overlap == InitialOverlap::kRefuse) {
      for (const OverlappingPlace& place : find_overlapping_places(instance_)) {
        problems.push_back(overlap(place));
      }
    }
    for (const bool at_goal : {false, true}) {
      for (std::size_t i = 0; i < instance_.agents.size(); ++i) check_bounds(i, at_goal, problems);
    }
    check_speeds(problems);
    for (std::size_t i = 0; i < instance_.agents.size(); ++i) check_steps(i, problems);
    return problems;
  }

 private:
  static const char* key(bool at_goal) { return at_goal ? "goal" : "start"; }

  [[nodiscard]] const Pose& pose(std::size_t i, bool at_goal) const {
    const Agent& agent = instance_.agents[i];
    return at_goal ? agent.goal : agent.start;
  }

  [[nodiscard]] std::string where(std::size_t i, bool at_goal) const {
    return fmt::format("{}: agents[{}].{}", file_, i, key(at_goal));
  }

  [[nodiscard]] std::string at(std::size_t i, bool at_goal) const {
    return fmt::format("({:.2f}, {:.2f})", pose(i, at_goal).x, pose(i, at_goal).y);
  }

  [[nodiscard]] InputError overlap(const OverlappingPlace& p) const {
    const std::string begin = fmt::format("the footprint at {} overlaps ", at(p.agent, p.at_goal));
    if (p.with == OverlappingPlace::With::kAgent) {
      return {where(p.agent, p.at_goal),
              fmt::format("{}that of agents[{}].{} by {}; move one of them", begin, p.object,
                          key(p.at_goal), depth_text(p.depth))};
    }
    return {where(p.agent, p.at_goal), fmt::format("{}{} by {}; move the {} or the obstacle", begin,
                                                   obstacle_name(instance_.map, p.object),
                                                   depth_text(p.depth), key(p.at_goal))};
  }

  void check_bounds(std::size_t i, bool at_goal, std::vector<InputError>& problems) const {
    const Map& map = instance_.map;
    const bool of_axle = map.bounds == Bounds::kAxle;
    const Pose& place = pose(i, at_goal);
    const double outside =
        -(of_axle ? referee::margin_inside(map, Point{place.x, place.y})
                  : referee::margin_inside(map,
                                           referee::footprint(instance_.agents[i].vehicle, place)));
    if (outside <= kTouchTolerance) return;
    problems.emplace_back(
        where(i, at_goal),
        fmt::format("the {} at {} is {} outside the map of {} x {} m; move it{}",
                    of_axle ? "rear axle" : "footprint", at(i, at_goal), depth_text(outside),
                    map.width, map.height, of_axle ? "" : ", or choose --bounds axle"));
  }

  /// Whoever needs millions of steps to its goal needs them in memory.
  void check_steps(std::size_t i, std::vector<InputError>& problems) const {
    constexpr double kMost = 1e6;
    const Agent& agent = instance_.agents[i];
    const double speed = agent.vehicle.max_speed;
    const double steps = distance(agent.start, agent.goal) / (speed * instance_.dt);
    if (steps <= kMost) return;
    problems.emplace_back(
        fmt::format("{}: agents[{}]", file_, i),
        fmt::format("needs at least {:.2g} steps of dt = {} s at max_speed = {} m/s to its goal; "
                    "choose them such that {:.0g} are enough",
                    steps, instance_.dt, speed, kMost));
  }

  /// escot-star's steps are as fine as the fastest robot needs them.
  void check_speeds(std::vector<InputError>& problems) const {
    constexpr double kMost = 1e4;
    const auto [slowest, fastest] = std::ranges::minmax_element(
        instance_.agents, {}, [](const Agent& agent) { return agent.vehicle.max_speed; });
    if (slowest == instance_.agents.end()) return;
    const double slow = slowest->vehicle.max_speed;
    const double fast = fastest->vehicle.max_speed;
    if (fast <= kMost * slow) return;
    problems.emplace_back(
        fmt::format("{}: agents[{}].vehicle.max_speed", file_, slowest - instance_.agents.begin()),
        fmt::format("is {} m/s, where another agent has {} m/s; give speeds that differ by a "
                    "factor of {:.0f} at most",
                    slow, fast, kMost));
  }

  const Instance& instance_;
  const std::string& file_;
};

}  // namespace

std::vector<InputError> check_instance(const Instance& instance, const std::string& file) {
  return Check(instance, file).run();
}

}  // namespace mvtp
