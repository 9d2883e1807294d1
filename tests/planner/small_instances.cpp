#include "tests/planner/small_instances.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "planner/problem/check_instance.hpp"
#include "planner/problem/instance_file.hpp"
#include "planner/problem/text_file.hpp"
#include "tests/temporary_directory.hpp"

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;

bool is_clean(const Instance& instance) { return check_instance(instance, "instance").empty(); }

Vehicle odd_vehicle(Dice& dice) {
  Vehicle vehicle;
  vehicle.front = dice.in(0.8, 3.5);
  vehicle.rear = dice.in(-0.2, 1.5);
  vehicle.width = dice.in(0.5, 2.4);
  vehicle.wheelbase = vehicle.front * dice.in(0.5, 1.0);
  vehicle.min_turning_radius = dice.in(0.7, 5.0);
  vehicle.max_speed = dice.in(0.3, 3.0);
  return vehicle;
}

/// A rectangle, a triangle, or an L, somewhere on the map or across its border.
Polygon odd_polygon(Dice& dice, const Map& map) {
  const double a = dice.in(0.5, 6);
  const double b = dice.in(0.2, 3);
  const std::array<Polygon, 3> shapes = {
      Polygon{{0, 0}, {a, 0}, {a, b}, {0, b}}, Polygon{{0, 0}, {a, 0}, {b, a}},
      Polygon{{0, 0}, {a, 0}, {a, b / 2}, {b / 2, b / 2}, {b / 2, a}, {0, a}}};
  const Pose at{dice.in(0, map.width), dice.in(0, map.height), dice.in(-kPi, kPi)};
  Polygon polygon;
  for (const Point& p : shapes[std::size_t(dice.below(3))]) {
    const Pose corner = compose(at, {p.x, p.y, 0});
    polygon.push_back({corner.x, corner.y});
  }
  return polygon;
}

Map odd_map(Dice& dice) {
  Map map{.width = dice.in(12, 40), .height = dice.in(12, 40), .circles = {}, .polygons = {}};
  map.bounds = dice.chance(0.5) ? Bounds::kAxle : Bounds::kFootprint;
  const int circles = dice.chance(0.3) ? 0 : dice.below(13);
  for (int i = 0; i < circles; ++i) {
    const double radius = dice.chance(0.7) ? 0.8 : dice.in(0.1, 2.5);
    map.circles.push_back({dice.in(0, map.width), dice.in(0, map.height), radius});
  }
  const int polygons = dice.chance(0.25) ? 1 + dice.below(2) : 0;
  for (int i = 0; i < polygons; ++i) map.polygons.push_back(odd_polygon(dice, map));
  return map;
}

Pose anywhere(Dice& dice, const Map& map) {
  const double theta = dice.chance(0.2) ? dice.below(4) * kPi / 2 - kPi / 2 : dice.in(-kPi, kPi);
  return {dice.in(0, map.width), dice.in(0, map.height), theta};
}

/// Beside the left flank of the robot, or right ahead of it, without a gap.
Pose touching(Dice& dice, const Agent& neighbour, const Vehicle& vehicle) {
  if (dice.chance(0.5)) {
    return compose(neighbour.start, {0, (neighbour.vehicle.width + vehicle.width) / 2, 0});
  }
  return compose(neighbour.start, {neighbour.vehicle.front + vehicle.rear, 0, 0});
}

/// A start and a goal that may or may not be free.
Agent odd_agent(Dice& dice, const Instance& instance, const Vehicle& vehicle) {
  Agent agent{"agent" + std::to_string(instance.agents.size()), vehicle,
              anywhere(dice, instance.map), anywhere(dice, instance.map)};
  if (!instance.agents.empty()) {
    const Agent& other = instance.agents[std::size_t(dice.below(int(instance.agents.size())))];
    if (dice.chance(0.15)) agent.start = touching(dice, other, vehicle);
    if (dice.chance(0.2)) agent.start = other.goal;
    if (dice.chance(0.2)) agent.goal = other.start;
  }
  if (dice.chance(0.1)) agent.goal = agent.start;
  return agent;
}

}  // namespace

Instance small_instance(std::uint64_t seed) {
  Dice dice(seed);
  Instance instance{.agents = {}, .map = odd_map(dice), .dt = 1.0};
  instance.dt = std::array{0.5, 1.0, 2.118}[std::size_t(dice.below(3))];
  const int mix = dice.below(3);
  const int robots = dice.chance(0.03) ? 0 : 1 + dice.below(8);
  for (int i = 0; i < robots; ++i) {
    const Vehicle vehicle = mix == 2
                                ? odd_vehicle(dice)
                                : vehicle_preset(mix == 0 ? "escot" : "cl-cbs").value().vehicle;
    for (int attempt = 0; attempt < 30; ++attempt) {
      instance.agents.push_back(odd_agent(dice, instance, vehicle));
      if (is_clean(instance)) break;
      instance.agents.pop_back();
    }
  }
  return instance;
}

Instance mirrored(const Instance& instance) {
  Instance image = instance;
  const double height = instance.map.height;
  for (Circle& circle : image.map.circles) circle.y = height - circle.y;
  for (Polygon& polygon : image.map.polygons) {
    for (Point& point : polygon) point.y = height - point.y;
  }
  for (Agent& agent : image.agents) {
    for (Pose* pose : {&agent.start, &agent.goal}) {
      *pose = {pose->x, height - pose->y, wrap_to_pi(-pose->theta)};
    }
  }
  return image;
}

Instance shrunk(Instance instance, const std::function<bool(const Instance&)>& fails) {
  const auto drop_from = [&](auto member) {
    for (std::size_t i = member(instance).size(); i-- > 0;) {
      Instance less = instance;
      member(less).erase(member(less).begin() + std::ptrdiff_t(i));
      if (fails(less)) instance = std::move(less);
    }
  };
  drop_from([](Instance & whole) -> auto& { return whole.agents; });
  drop_from([](Instance & whole) -> auto& { return whole.map.polygons; });
  drop_from([](Instance & whole) -> auto& { return whole.map.circles; });
  return instance;
}

std::string yaml_of(const Instance& instance) {
  const TemporaryDirectory directory;
  write_instance(instance, directory.path("instance.yaml"));
  return read_text_file(directory.path("instance.yaml"), 1U << 20U);
}

}  // namespace mvtp
