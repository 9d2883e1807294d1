#include <algorithm>
#include <cctype>
#include <cmath>

#include "planner/problem/input_error.hpp"
#include "tools/cli/version.hpp"
#include "tools/export/formats.hpp"
#include "tools/export/xml_writer.hpp"

namespace mvtp {
namespace {

constexpr double kGoalPosition = 0.1;     // [m] and
constexpr double kGoalOrientation = 0.1;  // [rad] from the goal that still count as there

/// When the first vehicle is there [s].
double begin_of(const Recording& recording) {
  double begin = recording.vehicles.front().states.front().time;
  for (const RecordedVehicle& vehicle : recording.vehicles) {
    begin = std::min(begin, vehicle.states.front().time);
  }
  return begin;
}

/// Writes one scenario. Positions of vehicles are those of the middle of the rectangle.
class Scenario {
 public:
  explicit Scenario(const Recording& recording)
      : recording_(recording), begin_(begin_of(recording)) {}

  CommonRoadScenario write(const RecordedVehicle& ego, bool ego_is_obstacle) {
    CommonRoadScenario scenario;
    xml_.element("commonRoad", [&] {
      write_head();
      write_lanelets();
      write_static_obstacles();
      for (const RecordedVehicle& vehicle : recording_.vehicles) {
        if (!ego_is_obstacle && &vehicle == &ego) continue;
        write_vehicle(vehicle);
        ++scenario.obstacles;
        if (step_of(vehicle.states.front().time) > 0) ++scenario.late;
      }
      write_problem(ego);
    });
    scenario.text = xml_.str();
    return scenario;
  }

 private:
  void write_head() {
    xml_.attribute("commonRoadVersion", std::string("2020a"));
    xml_.attribute("benchmarkID", fmt::format("ZAM_{}-1_1_T-1", letters_of(recording_.name)));
    xml_.attribute("date", recording_.date);
    xml_.attribute("author", fmt::format("mvtp {}", version()));
    xml_.attribute("affiliation", std::string());
    xml_.attribute("source", recording_.name);
    xml_.attribute("timeStepSize", recording_.dt, 6);
    xml_.element("location", [&] {
      xml_.text("geoNameId", "-999");
      xml_.text("gpsLatitude", "999");
      xml_.text("gpsLongitude", "999");
    });
    xml_.element("scenarioTags", [&] { xml_.element("simulated", [] {}); });
  }

  /// Names of maps are letters and digits.
  static std::string letters_of(std::string name) {
    std::erase_if(name, [](unsigned char c) { return std::isalnum(c) == 0; });
    return name.empty() ? "Mvtp" : name;
  }

  void write_id() { xml_.attribute("id", std::to_string(++last_id_)); }

  void write_point(const Point& point, const char* name = "point") {
    xml_.element(name, [&] {
      xml_.number("x", point.x);
      xml_.number("y", point.y);
    });
  }

  void write_exact(const char* name, double value, int digits) {
    xml_.element(name, [&] { xml_.number("exact", value, digits); });
  }

  // ---- what does not move

  void write_lanelets() {
    for (const ReplayLane& lane : recording_.scene.lanes) {
      if (lane.kind == ReplayLaneKind::kCars) write_lanelet(lane);
    }
    if (last_id_ == 0) write_lanelet(whole_ground());  // there must be one
  }

  void write_lanelet(const ReplayLane& lane) {
    xml_.element("lanelet", [&] {
      write_id();
      write_bound("leftBound", lane, lane.width / 2.0);
      write_bound("rightBound", lane, -lane.width / 2.0);
      xml_.text("laneletType", "unknown");
    });
  }

  /// The line beside the middle of the lane, at each of its points across the mean direction there.
  void write_bound(const char* name, const ReplayLane& lane, double aside) {
    const std::vector<Point>& shape = lane.shape;
    xml_.element(name, [&] {
      for (std::size_t i = 0; i < shape.size(); ++i) {
        const Point& from = shape[i == 0 ? 0 : i - 1];
        const Point& to = shape[std::min(i + 1, shape.size() - 1)];
        const double length = std::max(std::hypot(to.x - from.x, to.y - from.y), 1e-9);
        write_point({shape[i].x - aside * (to.y - from.y) / length,
                     shape[i].y + aside * (to.x - from.x) / length});
      }
    });
  }

  /// The map as one broad lane; without a map, the ground on which there are vehicles.
  [[nodiscard]] ReplayLane whole_ground() const {
    Point low{0.0, 0.0};
    Point high{0.0, 0.0};
    if (recording_.scene.border) {
      high = *recording_.scene.border;
    } else {
      for (const RecordedVehicle& vehicle : recording_.vehicles) {
        for (const RecordedState& state : vehicle.states) {
          low = {std::min(low.x, state.pose.x), std::min(low.y, state.pose.y)};
          high = {std::max(high.x, state.pose.x), std::max(high.y, state.pose.y)};
        }
      }
      const double around = 10.0;  // [m]
      low = {low.x - around, low.y - around};
      high = {high.x + around, high.y + around};
    }
    const double middle = (low.y + high.y) / 2.0;
    return {.shape = {{low.x, middle}, {high.x, middle}}, .width = high.y - low.y};
  }

  void write_static_obstacles() {
    for (const Circle& circle : recording_.scene.circles) {
      write_static({circle.x, circle.y},
                   [&] { xml_.element("circle", [&] { xml_.number("radius", circle.radius); }); });
    }
    for (const Polygon& polygon : recording_.scene.polygons) {
      write_static({0.0, 0.0}, [&] {
        xml_.element("polygon", [&] {
          for (const Point& point : polygon) write_point(point);
        });
      });
    }
  }

  void write_static(const Point& place, const std::function<void()>& shape) {
    xml_.element("staticObstacle", [&] {
      write_id();
      xml_.text("type", "unknown");
      xml_.element("shape", shape);
      xml_.element("initialState", [&] { write_place({place.x, place.y, 0.0}, 0); });
    });
  }

  // ---- vehicles

  [[nodiscard]] static Pose middle_of(const RecordedVehicle& vehicle, const RecordedState& state) {
    return compose(state.pose, {(vehicle.body.front - vehicle.body.rear) / 2.0, 0.0, 0.0});
  }

  [[nodiscard]] long step_of(double time) const {
    return std::lround((time - begin_) / recording_.dt);
  }

  void write_place(const Pose& middle, long step) {
    xml_.element("position", [&] { write_point({middle.x, middle.y}); });
    write_exact("orientation", middle.theta, 6);
    xml_.element("time", [&] { xml_.text("exact", std::to_string(step)); });
  }

  void write_state(const char* name, const RecordedVehicle& vehicle, const RecordedState& state,
                   long step) {
    xml_.element(name, [&] {
      write_place(middle_of(vehicle, state), step);
      write_exact("velocity", state.v, 4);
    });
  }

  void write_vehicle(const RecordedVehicle& vehicle) {
    xml_.element("dynamicObstacle", [&] {
      write_id();
      xml_.comment(fmt::format(" {} ", without_dashes(vehicle.id)));
      xml_.text("type", vehicle.body.length() > 7.0 ? "bus" : "car");
      xml_.element("shape", [&] { write_rectangle(vehicle, nullptr); });
      const long first = step_of(vehicle.states.front().time);
      write_state("initialState", vehicle, vehicle.states.front(), first);
      xml_.element("trajectory", [&] {
        for (std::size_t i = 1; i < vehicle.states.size(); ++i) {
          write_state("state", vehicle, vehicle.states[i], step_of(vehicle.states[i].time));
        }
        // There must be one: who was there for a moment only stands for a step.
        if (vehicle.states.size() == 1) {
          write_state("state", vehicle, vehicle.states.front(), first + 1);
        }
      });
    });
  }

  /// Comments must not contain "--".
  static std::string without_dashes(std::string id) {
    std::size_t at = 0;
    while ((at = id.find("--", at)) != std::string::npos) id.replace(at, 2, "- -");
    return id;
  }

  /// @param place  of its middle; nullptr: around the origin
  void write_rectangle(const RecordedVehicle& vehicle, const Pose* place) {
    xml_.element("rectangle", [&] {
      xml_.number("length", place == nullptr ? vehicle.body.length() : 2.0 * kGoalPosition);
      xml_.number("width", place == nullptr ? vehicle.body.width : 2.0 * kGoalPosition);
      if (place == nullptr) return;
      xml_.number("orientation", place->theta, 6);
      write_point({place->x, place->y}, "center");
    });
  }

  // ---- the planning problem

  void write_problem(const RecordedVehicle& ego) {
    const RecordedState& start = ego.states.front();
    xml_.element("planningProblem", [&] {
      write_id();
      xml_.element("initialState", [&] {
        write_place(middle_of(ego, start), 0);
        write_exact("velocity", start.v, 4);
        write_exact("yawRate", 0.0, 4);
        write_exact("slipAngle", 0.0, 4);
      });
      write_goal(ego);
    });
  }

  void write_goal(const RecordedVehicle& ego) {
    const Pose goal = middle_of(ego, ego.states.back());
    const long steps = step_of(ego.states.back().time) - step_of(ego.states.front().time);
    const auto interval = [&](const char* name, const std::string& low, const std::string& high) {
      xml_.element(name, [&] {
        xml_.text("intervalStart", low);
        xml_.text("intervalEnd", high);
      });
    };
    xml_.element("goalState", [&] {
      interval("time", "0", std::to_string(std::max(steps, 1L)));
      xml_.element("position", [&] { write_rectangle(ego, &goal); });
      interval("orientation", XmlWriter::fixed(goal.theta - kGoalOrientation, 6),
               XmlWriter::fixed(goal.theta + kGoalOrientation, 6));
    });
  }

  const Recording& recording_;
  double begin_;  ///< [s] of time step 0
  long last_id_ = 0;
  XmlWriter xml_;
};

}  // namespace

CommonRoadScenario to_commonroad(Recording recording, const CommonRoadRequest& request) {
  const std::string& ego = request.ego;
  const auto chosen = [&] {
    return ego.empty() ? recording.vehicles.begin()
                       : std::ranges::find(recording.vehicles, ego, &RecordedVehicle::id);
  };
  split_stays(recording);
  const auto found = chosen();
  if (found == recording.vehicles.end()) {
    throw InputError("--ego", "is \"" + ego + "\", which is no vehicle of " + recording.name);
  }
  if (!ego.empty()) cut(recording, found->states.front().time, found->states.back().time);
  if (request.obstacle_start_at_zero) {
    const double latest = begin_of(recording) + recording.dt / 2.0;
    std::erase_if(recording.vehicles, [&](const RecordedVehicle& vehicle) {
      return vehicle.states.front().time >= latest;
    });
  }
  return Scenario(recording).write(*chosen(), ego.empty());
}

}  // namespace mvtp
