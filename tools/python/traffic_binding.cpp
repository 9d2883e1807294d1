#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "coordinator/network/road_network.hpp"
#include "tools/python/bindings.hpp"
#include "tools/python/outside_controller.hpp"
#include "tools/python/traffic_door.hpp"

namespace mvtp {
namespace {

using namespace py::literals;

py::array points_array(const std::vector<Point>& points) {
  py::array_t<double> array({py::ssize_t(points.size()), py::ssize_t(2)});
  auto cells = array.mutable_unchecked<2>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    cells(py::ssize_t(i), 0) = points[i].x;
    cells(py::ssize_t(i), 1) = points[i].y;
  }
  return array;
}

py::object observed(const char* name) { return py::module_::import("mvtp._observed").attr(name); }

/// The state of all vehicles after a step, as columns.
py::object vehicles_of(const TrafficDoor& door) {
  const std::span<const VehicleState> vehicles = door.open().vehicles();
  const auto count = py::ssize_t(vehicles.size());
  py::list ids, types, lanes;
  py::array_t<double> poses({count, py::ssize_t(3)}), speeds(count), positions(count);
  py::array_t<bool> taken_over(count);
  auto pose = poses.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < count; ++i) {
    const VehicleState& v = vehicles[std::size_t(i)];
    ids.append(v.id);
    types.append(v.type);
    lanes.append(v.lane);
    pose(i, 0) = v.pose.x;
    pose(i, 1) = v.pose.y;
    pose(i, 2) = v.pose.theta;
    speeds.mutable_at(i) = v.speed;
    positions.mutable_at(i) = v.lane_position;
    taken_over.mutable_at(i) = door.open().is_taken_over(v.id);
  }
  return observed("Vehicles")(ids, types, poses, speeds, lanes, positions, taken_over);
}

py::object people_of(const TrafficDoor& door) {
  const std::span<const Pedestrian> people = door.open().pedestrians();
  const auto count = py::ssize_t(people.size());
  py::list ids, edges;
  py::array_t<double> poses({count, py::ssize_t(3)}), speeds(count);
  auto pose = poses.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < count; ++i) {
    const Pedestrian& p = people[std::size_t(i)];
    ids.append(p.id);
    edges.append(p.edge);
    pose(i, 0) = p.position.x;
    pose(i, 1) = p.position.y;
    pose(i, 2) = p.theta;
    speeds.mutable_at(i) = p.speed;
  }
  return observed("People")(ids, poses, speeds, edges);
}

void bind_network(py::module_& module) {
  py::class_<Connection>(module, "Connection",
                         "One connection over a junction, from a normal lane to the next.")
      .def_readonly("from_lane", &Connection::from_lane, "Its id.")
      .def_readonly("via", &Connection::via, "The ids of the lanes inside, in driving order.")
      .def_readonly("to_lane", &Connection::to_lane, "Its id.")
      .def_readonly("signal", &Connection::signal, "Id of the traffic signal; empty: none.")
      .def_readonly("signal_index", &Connection::signal_index,
                    "Which of the signal's lights; -1: none.");
  py::class_<Lane>(module, "Lane", "A lane, normal or inside a junction.")
      .def_readonly("id", &Lane::id, "As in SUMO.")
      .def_readonly("edge", &Lane::edge, "Id of its edge.")
      .def_readonly("index", &Lane::index, "On its edge; 0 is the rightmost.")
      .def_readonly("speed_limit", &Lane::speed_limit, "[m/s]")
      .def_readonly("length", &Lane::length, "[m]")
      .def_readonly("width", &Lane::width, "[m]")
      .def_readonly("internal", &Lane::internal, "Is it inside a junction?")
      .def_property_readonly(
          "shape", [](const Lane& lane) { return points_array(lane.shape); },
          "The centre line, (n_points, 2): x, y [m].");
  py::class_<Junction>(module, "Junction", "Where lanes meet.")
      .def_readonly("id", &Junction::id, "As in SUMO.")
      .def_readonly("type", &Junction::type, "SUMO's word: \"priority\", \"traffic_light\", ...")
      .def_property_readonly(
          "position", [](const Junction& j) { return std::pair(j.position.x, j.position.y); },
          "x, y [m].")
      .def_property_readonly(
          "shape", [](const Junction& j) { return points_array(j.shape); },
          "The outline, (n_points, 2): x, y [m], not closed.")
      .def_readonly("incoming_lanes", &Junction::incoming_lanes, "Their ids.")
      .def_readonly("connections", &Junction::connections, "All connections over it.")
      .def_readonly("has_conflicts", &Junction::has_conflicts,
                    "Do two of its connections share ground?");
  py::class_<RoadNetwork>(module, "RoadNetwork", "Lanes and junctions, by their ids.")
      .def_readonly("lanes", &RoadNetwork::lanes, "Normal lanes and those inside junctions.")
      .def_readonly("junctions", &RoadNetwork::junctions, "Where lanes meet.")
      .def_readonly("edges", &RoadNetwork::edges, "The lanes' ids, rightmost first.")
      .def_readonly("signals", &RoadNetwork::signals, "How many lights each signal has.");
}

void bind_values(py::module_& module) {
  py::class_<VehicleType>(module, "VehicleType", "What vehicles of one type have in common.")
      .def_readonly("id", &VehicleType::id, "As in SUMO.")
      .def_readonly("body", &VehicleType::body, "Shape and limits, a Vehicle.")
      .def_readonly("min_gap", &VehicleType::min_gap, "To the leader at rest [m].")
      .def_readonly("tau", &VehicleType::tau, "Desired headway [s].")
      .def_readonly("vehicle_class", &VehicleType::vehicle_class, "SUMO's vClass.");
  py::class_<SignalPhase>(module, "SignalPhase", "One phase of a signal's program.")
      .def_readonly("duration", &SignalPhase::duration, "In a fixed program [s].")
      .def_readonly("lights", &SignalPhase::lights, "A letter each as in SUMO: G g y r s ...");
}

/// @throws InputError unless it is a speed that SUMO can be told
void require_speed(double speed) {
  if (std::isfinite(speed) && speed >= 0.0) return;
  throw InputError("speed", fmt::format("is {} m/s; give a finite number >= 0", speed));
}

/// @throws InputError unless all are numbers
void require_finite(const std::array<double, 3>& pose, double speed) {
  const bool finite = std::ranges::all_of(pose, [](double value) { return std::isfinite(value); });
  if (finite && std::isfinite(speed)) return;
  throw InputError("place", fmt::format("pose ({}, {}, {}), speed {}: give finite numbers", pose[0],
                                        pose[1], pose[2], speed));
}

using Door = py::class_<TrafficDoor, std::shared_ptr<TrafficDoor>>;

void bind_looking(Door& traffic) {
  traffic
      .def_property_readonly(
          "time", [](const TrafficDoor& d) { return d.open().time(); }, "Simulated time [s].")
      .def_property_readonly(
          "step_length", [](const TrafficDoor& d) { return d.open().step_length(); },
          "Duration of a step [s].")
      .def_property_readonly(
          "network", [](const TrafficDoor& d) { return d.open().network(); },
          py::return_value_policy::copy, "The roads, a RoadNetwork; a copy.")
      .def(
          "types", [](const TrafficDoor& d) { return d.open().types(); },
          "Ids of the vehicle types of the scenario.")
      .def(
          "type",
          [](const TrafficDoor& d, const std::string& id) { return d.with_type(id).type(id); },
          "id"_a, "The vehicle type with this id.")
      .def(
          "pending", [](const TrafficDoor& d) { return d.open().pending(); },
          "Ids of the vehicles that wait to enter the network.")
      .def(
          "route",
          [](const TrafficDoor& d, const std::string& id) {
            return d.with_vehicle_or_pending(id).route(id);
          },
          "id"_a, "The edges of the vehicle's route from where it is on.")
      .def(
          "is_taken_over",
          [](const TrafficDoor& d, const std::string& id) { return d.open().is_taken_over(id); },
          "id"_a, "Does the vehicle go where place() puts it?")
      .def(
          "signal_phases",
          [](const TrafficDoor& d, const std::string& signal) {
            return d.with_signal(signal).signal_phases(signal);
          },
          "signal"_a, "The phases of the program that the signal came with.")
      .def("vehicles", &vehicles_of, "All vehicles on the road after the last step: Vehicles.")
      .def("people", &people_of, "Everyone on foot after the last step: People.");
}

void bind_driving(Door& traffic) {
  traffic
      .def(
          "take_over",
          [](TrafficDoor& d, const std::string& id) { d.with_vehicle(id).take_over(id); }, "id"_a,
          "From now on the vehicle goes only where place() puts it, once before every step.")
      .def(
          "hand_back",
          [](TrafficDoor& d, const std::string& id) { d.with_vehicle(id).hand_back(id); }, "id"_a,
          "SUMO's car-following model goes on from the vehicle's pose and speed.")
      .def(
          "place",
          [](TrafficDoor& d, const std::string& id, const std::array<double, 3>& pose,
             double speed) {
            require_finite(pose, speed);
            d.with_taken_over(id).place(id, {pose[0], pose[1], pose[2]}, speed);
          },
          "id"_a, "pose"_a, "speed"_a,
          "Where a vehicle that is taken over is after the next step: x [m], y [m], yaw [rad] of\n"
          "the rear axle, and its speed [m/s].")
      .def(
          "hold",
          [](TrafficDoor& d, const std::string& id, bool stop) {
            d.with_vehicle(id).hold(id, stop);
          },
          "id"_a, "stop"_a,
          "Makes a vehicle that is not controlled stop before the end of its lane, or go on.")
      .def(
          "let_through",
          [](TrafficDoor& d, const std::string& id, bool pass) {
            d.with_vehicle(id).let_through(id, pass ? Passage::kOneLine : Passage::kNone);
          },
          "id"_a, "go"_a,
          "The driver heeds no right of way and not the signal at the end of its lane, or does so "
          "again.")
      .def(
          "cap_speed",
          [](TrafficDoor& d, const std::string& id, std::optional<double> speed) {
            if (speed) require_speed(*speed);
            d.with_vehicle(id).cap_speed(id,
                                         speed.value_or(std::numeric_limits<double>::infinity()));
          },
          "id"_a, "speed"_a,
          "Keeps a vehicle that is not controlled from driving faster [m/s]; None: no longer.")
      .def(
          "keep_lane",
          [](TrafficDoor& d, const std::string& id, bool keep) {
            d.with_vehicle(id).keep_lane(id, keep);
          },
          "id"_a, "keep"_a, "Keeps a vehicle that is not controlled in its lane, or no longer.");
}

void bind_lanes_and_signals(Door& traffic) {
  traffic
      .def(
          "limit_speed",
          [](TrafficDoor& d, const std::string& lane, double speed) {
            require_speed(speed);
            d.with_lane(lane).limit_speed(lane, speed);
          },
          "lane"_a, "speed"_a, "Lowers the limit of a lane for every driver [m/s].")
      .def(
          "show",
          [](TrafficDoor& d, const std::string& signal, const std::string& lights) {
            d.with_signal(signal).show_all(signal, lights);
          },
          "signal"_a, "lights"_a,
          "What the signal shows from the next step on: a letter for each light, as in SUMO.")
      .def(
          "free_signal",
          [](TrafficDoor& d, const std::string& signal) {
            d.with_signal(signal).free_signal(signal);
          },
          "signal"_a, "The signal runs its own program again.");
}

/// Calls the methods that Python overrides.
class PythonController final : public OutsideController {
 public:
  using OutsideController::OutsideController;
  void decide() override { PYBIND11_OVERRIDE(void, OutsideController, decide); }
  void act() override { PYBIND11_OVERRIDE(void, OutsideController, act); }
  void observe() override { PYBIND11_OVERRIDE(void, OutsideController, observe); }
  bool drives(const std::string& id) const override {
    PYBIND11_OVERRIDE(bool, OutsideController, drives, id);
  }
  bool rests(const std::string& id) const override {
    PYBIND11_OVERRIDE(bool, OutsideController, rests, id);
  }
};

void bind_controller(py::module_& module) {
  py::class_<OutsideController, PythonController>(
      module, "Controller",
      R"(Who lets vehicles drive: derive, and override what is needed.

In every step of mvtp.Simulation decide() is called, then act(), then SUMO steps, then observe().
Say what happens through `self.traffic`.)")
      .def(py::init<>())
      .def_property_readonly("traffic", &OutsideController::traffic,
                             "The traffic, once mvtp.Simulation has taken the controller in.")
      .def("decide", &OutsideController::decide, "Before a step: decides, by what there is to see.")
      .def("act", &OutsideController::act, "After that: says what happens in the step.")
      .def("observe", &OutsideController::observe, "After the step: looks at what became of it.")
      .def("drives", &OutsideController::drives, "id"_a,
           "Is the vehicle driven by this controller? By default: all that are taken over.")
      .def("rests", &OutsideController::rests, "id"_a,
           "Does the vehicle stand on purpose, so that the run is not stuck? By default: no.");
}

}  // namespace

void bind_traffic(py::module_& module) {
  bind_network(module);
  bind_values(module);
  Door traffic(
      module, "Traffic",
      "The traffic of a mvtp.Simulation: what there is to see, and what may be said to it.");
  bind_looking(traffic);
  bind_driving(traffic);
  bind_lanes_and_signals(traffic);
  bind_controller(module);
}

}  // namespace mvtp
