#include "tools/generate/random_instance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "planner/geometry.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/solve.hpp"
#include "tools/generate/dice.hpp"

namespace mvtp {
namespace {

constexpr double kObstacleRadius = 0.8;  // [m]
constexpr double kClearance = 0.5;       // [m] between bodies, and from obstacles
constexpr int kDraws = 1000;             // for one pose, before all are drawn anew
constexpr int kRestarts = 10;            // under one rule
constexpr int kRounds = 100;             // of new poses for robots that find no path

/// How far apart reference points have to be [m], the stricter rule first.
const std::array<double, 2> kApart = {std::sqrt(20.0), 0.0};

/// A coordinate of a point of the map, in whole millimetres.
double along(Dice& dice, int side) { return dice.between(0, 1000 * side) / 1000.0; }

Pose any_pose(Dice& dice, int side) {
  const double x = along(dice, side);
  const double y = along(dice, side);
  return {x, y, dice.between(-31415, 31415) / 1e4};
}

/// The poses of one kind, starts or goals, that keep their distance from each other.
class Places {
 public:
  Places(const Vehicle& vehicle, const Map& map, double apart)
      : vehicle_(vehicle), map_(map), apart_(apart) {}

  [[nodiscard]] bool has_room_for(const Pose& pose) const {
    const OrientedBox box = footprint(vehicle_, pose);
    return inside_map(box) && clear_of_obstacles(box) && clear_of_others(pose, box);
  }
  void add(const Pose& pose) { taken_.push_back({pose, footprint(vehicle_, pose), true}); }
  void replace(std::size_t i, const Pose& pose) {
    taken_[i] = {pose, footprint(vehicle_, pose), true};
  }
  /// Leaves the place of robot i free.
  void lift(std::size_t i) { taken_[i].present = false; }

  [[nodiscard]] std::size_t size() const { return taken_.size(); }
  [[nodiscard]] const Pose& operator[](std::size_t i) const { return taken_[i].pose; }

 private:
  struct Place {
    Pose pose;
    OrientedBox box;
    bool present = true;
  };

  [[nodiscard]] bool inside_map(const OrientedBox& box) const {
    const double x = box.half_length * std::abs(box.ux) + box.half_width * std::abs(box.uy);
    const double y = box.half_length * std::abs(box.uy) + box.half_width * std::abs(box.ux);
    return box.x >= x && box.x <= map_.width - x && box.y >= y && box.y <= map_.height - y;
  }

  [[nodiscard]] bool clear_of_obstacles(const OrientedBox& box) const {
    for (const Circle& circle : map_.circles) {
      if (separation(box, Point{circle.x, circle.y}) < circle.radius + kClearance) return false;
    }
    return true;
  }

  [[nodiscard]] bool clear_of_others(const Pose& pose, const OrientedBox& box) const {
    const double corner = std::hypot(std::max(vehicle_.front, vehicle_.rear), vehicle_.width / 2);
    const double near = std::max(apart_, 2 * corner + kClearance);
    for (const Place& other : taken_) {
      const double away = distance(pose, other.pose);
      if (!other.present || away > near) continue;
      if (away < apart_ || separation(box, other.box) < kClearance) return false;
    }
    return true;
  }

  const Vehicle& vehicle_;
  const Map& map_;
  double apart_;
  std::vector<Place> taken_;
};

/// Obstacles, starts and goals at random, drawn again until they are as they should be.
class Scene {
 public:
  Scene(const Cell& cell, const VehiclePreset& preset, Bounds bounds, Dice& dice)
      : cell_(cell), preset_(preset), dice_(dice) {
    map_.width = map_.height = cell.side;
    map_.bounds = bounds;
  }

  /// @return the distance that the reference points keep [m].
  double draw() {
    for (const double apart : kApart) {
      for (int restart = 0; restart < kRestarts; ++restart) {
        if (place_all(apart) && make_solvable()) return apart;
      }
    }
    throw InputError(
        fmt::format("{} robots among {} obstacles on {} x {} m", cell_.robots, cell_.obstacles,
                    cell_.side, cell_.side),
        "no instance was found in which all bodies are 0.5 m apart and each robot has a "
        "single-agent path; give fewer robots or obstacles, or a larger map");
  }

  [[nodiscard]] Instance instance() const {
    Instance instance{.agents = {}, .map = map_, .dt = preset_.dt};
    for (std::size_t i = 0; i < starts_->size(); ++i) instance.agents.push_back(agent(i));
    return instance;
  }

 private:
  bool place_all(double apart) {
    map_.circles.clear();
    for (int i = 0; i < cell_.obstacles; ++i) {
      const double x = along(dice_, cell_.side);
      map_.circles.push_back({x, along(dice_, cell_.side), kObstacleRadius});
    }
    starts_.emplace(preset_.vehicle, map_, apart);
    goals_.emplace(preset_.vehicle, map_, apart);
    for (int i = 0; i < cell_.robots; ++i) {
      const std::optional<Pose> start = free_pose(*starts_);
      const std::optional<Pose> goal = free_pose(*goals_);
      if (!start || !goal) return false;
      starts_->add(*start);
      goals_->add(*goal);
    }
    return true;
  }

  [[nodiscard]] std::optional<Pose> free_pose(const Places& places) {
    for (int draw = 0; draw < kDraws; ++draw) {
      const Pose pose = any_pose(dice_, cell_.side);
      if (places.has_room_for(pose)) return pose;
    }
    return std::nullopt;
  }

  /// Gives robots that find no single-agent path other places, until all find one.
  bool make_solvable() {
    std::vector<std::size_t> unproven(starts_->size());
    for (std::size_t i = 0; i < unproven.size(); ++i) unproven[i] = i;
    for (int round = 0; round < kRounds; ++round) {
      unproven = not_solvable_alone(unproven);
      if (unproven.empty()) return true;
      for (const std::size_t i : unproven) {
        if (!move(*starts_, i) || !move(*goals_, i)) return false;
      }
    }
    return false;
  }

  [[nodiscard]] std::vector<std::size_t> not_solvable_alone(
      std::span<const std::size_t> robots) const {
    Instance part{.agents = {}, .map = map_, .dt = preset_.dt};
    for (const std::size_t i : robots) part.agents.push_back(agent(i));
    std::vector<std::size_t> result;
    for (const std::size_t k : robots_without_single_agent_path(part)) result.push_back(robots[k]);
    return result;
  }

  bool move(Places& places, std::size_t i) {
    places.lift(i);
    const std::optional<Pose> pose = free_pose(places);
    if (pose) places.replace(i, *pose);
    return pose.has_value();
  }

  [[nodiscard]] Agent agent(std::size_t i) const {
    return {fmt::format("agent{}", i), preset_.vehicle, (*starts_)[i], (*goals_)[i]};
  }

  const Cell& cell_;
  const VehiclePreset& preset_;
  Dice& dice_;
  Map map_;
  std::optional<Places> starts_;
  std::optional<Places> goals_;
};

/// Robots around a circle of 30 m, each facing its goal straight across.
Instance circle(const Cell& cell, const VehiclePreset& preset, Bounds bounds, Dice& dice,
                bool exact) {
  constexpr double kRadius = 15.0;  // [m]
  Instance instance{.agents = {}, .map = {}, .dt = preset.dt};
  instance.map.width = instance.map.height = cell.side;
  instance.map.bounds = bounds;
  const auto millis = [&](double value) {
    return (std::round(1e3 * value) + (exact ? 0 : dice.between(-1000, 1000))) / 1e3;
  };
  for (int i = 0; i < cell.robots; ++i) {
    const double angle = 2 * std::numbers::pi * i / cell.robots;
    const auto across = [&](double radius) -> Pose {
      const double x = millis(cell.side / 2.0 + radius * std::cos(angle));
      const double y = millis(cell.side / 2.0 + radius * std::sin(angle));
      const double inwards = std::round(1e4 * wrap_to_pi(angle + std::numbers::pi));
      return {x, y, (inwards + (exact ? 0 : dice.between(-2000, 2000))) / 1e4};
    };
    const Pose start = across(kRadius);
    instance.agents.push_back({fmt::format("agent{}", i), preset.vehicle, start, across(-kRadius)});
  }
  return instance;
}

}  // namespace

GeneratedInstance generate_instance(const Cell& cell, const GenerateOptions& options, int index) {
  const std::optional<VehiclePreset> preset = vehicle_preset(options.vehicle);
  if (!preset) {
    throw InputError(
        "--vehicle",
        fmt::format("is the unknown preset \"{}\"; choose escot or cl-cbs", options.vehicle));
  }
  Dice dice{low_word(options.seed), high_word(options.seed),  low_word(int(cell.suite)),
            low_word(cell.side),    low_word(cell.obstacles), low_word(cell.robots),
            low_word(index)};
  const std::string origin = fmt::format("{}, seed {}, instance {} of its cell",
                                         to_string(cell.suite), options.seed, index);
  if (cell.layout == Layout::kCircle) {
    return {circle(cell, *preset, options.bounds, dice, index == 0), origin};
  }
  Scene scene(cell, *preset, options.bounds, dice);
  const double apart = scene.draw();
  return {scene.instance(), fmt::format("{}; starts and goals keep {}", origin,
                                        apart > 0.0 ? "sqrt(20) m between rear axles, bodies 0.5 m"
                                                    : "0.5 m between bodies")};
}

}  // namespace mvtp
