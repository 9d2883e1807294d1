#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "planner/problem/check_instance.hpp"
#include "planner/problem/document.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/instance_file.hpp"
#include "planner/problem/vehicle_file.hpp"
#include "planner/problem/yaml_text.hpp"
#include "tools/cli/instance_options.hpp"
#include "tools/python/bindings.hpp"
#include "tools/python/words.hpp"

namespace mvtp {
namespace {

constexpr const char* kBuilt = "instance";  ///< stands for the file in messages

/// The rows of an array of points or poses. @throws InputError unless it has 2 axes and `columns`
Numbers rows_of(const py::object& values, const char* what, std::initializer_list<int> columns,
                const char* meaning) {
  const Numbers array = numbers_of(values);
  if (!array) {
    throw InputError(std::string(kBuilt) + ": " + what,
                     fmt::format("is no array of numbers; give {}", meaning));
  }
  const bool fits = array.ndim() == 2 && std::ranges::count(columns, array.shape(1)) > 0;
  if (fits || array.size() == 0) return array;
  std::string shape;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    shape += fmt::format("{}{}", i == 0 ? "" : ", ", array.shape(i));
  }
  throw InputError(std::string(kBuilt) + ": " + what,
                   fmt::format("has the shape ({}); give {}", shape, meaning));
}

/// A number as it stands in an instance file; what is no finite one is refused by the reader.
std::string number_text(double value) {
  return std::isfinite(value) ? yaml_number(value) : fmt::format("{}", value);
}

std::string row_text(const Numbers& array, py::ssize_t row) {
  std::string text;
  for (py::ssize_t i = 0; i < array.shape(1); ++i) {
    text += (i == 0 ? "[" : ", ") + number_text(array.at(row, i));
  }
  return text + "]";
}

std::string rows_text(const Numbers& array) {
  std::string text;
  for (py::ssize_t i = 0; array.size() > 0 && i < array.shape(0); ++i) {
    text += (i == 0 ? "" : ", ") + row_text(array, i);
  }
  return "[" + text + "]";
}

using VehicleChoice = std::variant<std::string, Vehicle>;  ///< a preset's name, or its fields

/// What an instance is built from in Python.
struct Parts {
  py::object starts, goals;
  std::pair<double, double> size;
  py::object circles;
  py::iterable polygons;
  std::variant<VehicleChoice, std::vector<VehicleChoice>> vehicle;
  std::optional<std::vector<std::string>> names;
  std::optional<double> dt;
};

std::string vehicle_entry(const VehicleChoice& choice) {
  if (const auto* vehicle = std::get_if<Vehicle>(&choice)) return vehicle_fields_text(*vehicle);
  return fmt::format("{{preset: {}}}", yaml_string(std::get<std::string>(choice)));
}

/// One for every agent, or none if all have the same.
std::vector<std::string> own_vehicles(const Parts& parts, py::ssize_t agents) {
  std::vector<std::string> texts;
  const auto* vehicles = std::get_if<std::vector<VehicleChoice>>(&parts.vehicle);
  if (vehicles == nullptr) return texts;
  for (const VehicleChoice& vehicle : *vehicles) texts.push_back(vehicle_entry(vehicle));
  if (py::ssize_t(texts.size()) == agents) return texts;
  throw InputError(std::string(kBuilt) + ": vehicle",
                   fmt::format("has {} entries for {} agents; give one each, or one for all",
                               texts.size(), agents));
}

std::string agents_text(const Parts& parts) {
  const Numbers starts = rows_of(parts.starts, "starts", {3}, "(n, 3): x [m], y [m], yaw [rad]");
  const Numbers goals = rows_of(parts.goals, "goals", {3}, "(n, 3): x [m], y [m], yaw [rad]");
  const py::ssize_t count = starts.size() / 3;
  if (goals.size() != starts.size()) {
    throw InputError(std::string(kBuilt) + ": goals",
                     fmt::format("has {} rows for {} starts; give one goal for each start",
                                 goals.size() / 3, count));
  }
  const std::vector<std::string> names = parts.names.value_or(std::vector<std::string>());
  if (parts.names && py::ssize_t(names.size()) != count) {
    throw InputError(
        std::string(kBuilt) + ": names",
        fmt::format("has {} entries for {} starts; give one each, or None", names.size(), count));
  }
  const std::vector<std::string> vehicles = own_vehicles(parts, count);
  std::string text;
  for (py::ssize_t i = 0; i < count; ++i) {
    const auto k = std::size_t(i);
    text += fmt::format("{}{{name: {}, start: {}, goal: {}{}}}", i == 0 ? "" : ", ",
                        yaml_string(names.empty() ? fmt::format("agent{}", i) : names[k]),
                        row_text(starts, i), row_text(goals, i),
                        vehicles.empty() ? "" : ", vehicle: " + vehicles[k]);
  }
  return "[" + text + "]";
}

std::string map_text(const Parts& parts) {
  const Numbers circles = rows_of(parts.circles, "circles", {2, 3}, "(n, 3): x, y, radius [m]");
  std::string polygons;
  for (const py::handle polygon : parts.polygons) {
    const Numbers corners = rows_of(py::reinterpret_borrow<py::object>(polygon), "polygons", {2},
                                    "arrays of the shape (n, 2): x, y [m]");
    polygons += (polygons.empty() ? "" : ", ") + rows_text(corners);
  }
  const auto [width, height] = parts.size;
  return fmt::format("{{dimensions: [{}, {}], obstacles: {}, polygons: [{}]}}", number_text(width),
                     number_text(height), rows_text(circles), polygons);
}

/// The text of an instance file: so that its reader judges Python's values as those of a file.
std::string instance_text(const Parts& parts) {
  const auto* common = std::get_if<VehicleChoice>(&parts.vehicle);
  return fmt::format("{}{}agents: {}\nmap: {}\n",
                     common != nullptr ? fmt::format("vehicle: {}\n", vehicle_entry(*common)) : "",
                     parts.dt ? fmt::format("dt: {}\n", number_text(*parts.dt)) : "",
                     agents_text(parts), map_text(parts));
}

InstanceReadOptions read_options(const std::vector<std::string>& words) {
  InstanceReadOptions options;
  parse_words("solve", words, [&](CLI::App& app) {
    add_instance_options(app, options);
    add_instance_rules(app, options);
  });
  return options;
}

using Word = std::optional<std::string>;

/// Options as words of a command line; those that are not given are left out.
std::vector<std::string> words_of(std::initializer_list<std::pair<const char*, Word>> options) {
  std::vector<std::string> words;
  for (const auto& [name, value] : options) {
    if (value) words.push_back(fmt::format("--{}={}", name, *value));
  }
  return words;
}

NamedInstance build(const Parts& parts, const std::string& bounds,
                    const std::string& initial_overlap) {
  const auto words = words_of({{"bounds", bounds}, {"initial-overlap", initial_overlap}});
  return {parse_instance(kBuilt, instance_text(parts), read_options(words)), kBuilt};
}

NamedInstance load(const std::filesystem::path& path, const std::string& yaw, const Word& bounds,
                   const Word& vehicle, std::optional<double> dt,
                   const std::string& initial_overlap) {
  const auto words = words_of({{"yaw", yaw},
                               {"bounds", bounds},
                               {"vehicle", vehicle},
                               {"dt", dt ? Word(number_text(*dt)) : Word()},
                               {"initial-overlap", initial_overlap}});
  return {read_instance(path.string(), read_options(words)), path.string()};
}

void save(const NamedInstance& self, const std::filesystem::path& path, const std::string& yaw) {
  write_instance(self.instance, path.string(), {.yaw = read_options(words_of({{"yaw", yaw}})).yaw});
}

/// What pickle and copy keep: the file, and what the file does not say.
py::tuple state_of(const NamedInstance& self) {
  return py::make_tuple(self.name, instance_text(self.instance),
                        self.instance.initial_overlap == InitialOverlap::kAllow);
}

NamedInstance from_state(const py::tuple& state) {
  const auto [name, text, allow] = state.cast<std::tuple<std::string, std::string, bool>>();
  InstanceReadOptions options;
  if (allow) options.initial_overlap = InitialOverlap::kAllow;
  return {parse_instance(name, text, options), name};
}

/// The poses of all agents where they lie, in the list of agents.
py::array poses_of(const py::object& self, Pose Agent::*pose) {
  const std::vector<Agent>& agents = self.cast<const NamedInstance&>().instance.agents;
  static_assert(sizeof(Pose) == 3 * sizeof(double));
  return view_of(&(agents.front().*pose).x, {py::ssize_t(agents.size()), 3},
                 {sizeof(Agent), sizeof(double)}, self);
}

py::array circles_of(const py::object& self) {
  const std::vector<Circle>& circles = self.cast<const NamedInstance&>().instance.map.circles;
  static_assert(sizeof(Circle) == 3 * sizeof(double));
  if (circles.empty()) return py::array_t<double>(std::vector<py::ssize_t>{0, 3});
  return view_of(&circles.front().x, {py::ssize_t(circles.size()), 3},
                 {sizeof(Circle), sizeof(double)}, self);
}

std::vector<py::array> polygons_of(const py::object& self) {
  std::vector<py::array> polygons;
  static_assert(sizeof(Point) == 2 * sizeof(double));
  for (const Polygon& polygon : self.cast<const NamedInstance&>().instance.map.polygons) {
    polygons.push_back(view_of(&polygon.front().x, {py::ssize_t(polygon.size()), 2},
                               {sizeof(Point), sizeof(double)}, self));
  }
  return polygons;
}

template <class Value>
std::vector<Value> of_agents(const NamedInstance& self, Value Agent::*field) {
  std::vector<Value> values;
  for (const Agent& agent : self.instance.agents) values.push_back(agent.*field);
  return values;
}

std::vector<std::string> problems(const NamedInstance& self) {
  std::vector<std::string> lines;
  for (const InputError& error : check_instance(self.instance, self.name)) {
    lines.emplace_back(error.what());
  }
  return lines;
}

Vehicle vehicle_from(const std::string& fields) {
  const Document document = Document::parse("vehicle", fields, {"preset", "front"}, "a vehicle");
  return read_vehicle(document.root(), vehicle_preset("escot").value()).vehicle;
}

/// The fields that Python names, read as those of a file.
Vehicle make_vehicle(const std::string& preset, const py::kwargs& fields) {
  std::string text = "preset: " + yaml_string(preset);
  for (const auto& [key, value] : fields) {
    text += fmt::format(", {}: {}", key.cast<std::string>(),
                        number_text(py::float_(py::reinterpret_borrow<py::object>(value))));
  }
  return vehicle_from("{" + text + "}");
}

void bind_vehicle(py::module_& module) {
  py::class_<Vehicle>(
      module, "Vehicle",
      "A car-like vehicle: a rectangle around its rear axle, and its limits.\n\n"
      "Vehicle(preset=\"escot\", *, front, rear, width, wheelbase,\n"
      "min_turning_radius, max_speed, max_accel, max_decel): fields that are given\n"
      "replace those of the preset (\"escot\" or \"cl-cbs\"). Cannot be changed.\n"
      "Raises InputError for a field that is unknown or out of range.")
      .def(py::init(&make_vehicle), py::arg("preset") = "escot")
      .def_readonly("front", &Vehicle::front, "Rear axle to front bumper [m].")
      .def_readonly("rear", &Vehicle::rear, "Rear axle to rear bumper [m].")
      .def_readonly("width", &Vehicle::width, "[m]")
      .def_readonly("wheelbase", &Vehicle::wheelbase, "[m]")
      .def_readonly("min_turning_radius", &Vehicle::min_turning_radius,
                    "Of the middle of the rear axle [m].")
      .def_readonly("max_speed", &Vehicle::max_speed, "[m/s]")
      .def_readonly("max_accel", &Vehicle::max_accel, "[m/s^2]; infinite if not limited.")
      .def_readonly("max_decel", &Vehicle::max_decel, "[m/s^2]; infinite if not limited.")
      .def_property_readonly("length", &Vehicle::length, "front + rear [m].")
      .def(py::pickle(&vehicle_fields_text, &vehicle_from))
      .def("__eq__", [](const Vehicle& a, const Vehicle& b) { return a == b; })
      .def("__repr__", [](const Vehicle& v) { return "Vehicle" + vehicle_text(v); });
}

void bind_making(py::class_<NamedInstance>& instance) {
  using namespace py::literals;
  instance
      .def(py::init([](py::object starts, py::object goals, std::pair<double, double> size,
                       py::object circles, py::iterable polygons,
                       std::variant<VehicleChoice, std::vector<VehicleChoice>> vehicle,
                       std::optional<std::vector<std::string>> names, std::optional<double> dt,
                       const std::string& bounds, const std::string& initial_overlap) {
             return build({std::move(starts), std::move(goals), size, std::move(circles),
                           std::move(polygons), std::move(vehicle), std::move(names), dt},
                          bounds, initial_overlap);
           }),
           "starts"_a, "goals"_a, py::kw_only(), "size"_a, "circles"_a = py::tuple(),
           "polygons"_a = py::tuple(), "vehicle"_a = "escot", "names"_a = py::none(),
           "dt"_a = py::none(), "bounds"_a = "footprint", "initial_overlap"_a = "refuse",
           R"(Builds an instance from values, which are judged as those of a file are.

starts, goals: (n_robots, 3), x [m], y [m], yaw [rad] of the rear axles. size: (width, height) of
the map [m]. circles: (n, 3), x, y, radius [m], or (n, 2) for a radius of 0.8 m. polygons: solid,
each (n_corners, 2), x, y [m]. vehicle: a preset's name or a Vehicle, for all or a list of them.
names: "agent0", "agent1", ... if None. dt: duration of a step [s], by the vehicle if None. bounds:
"footprint" or "axle", what stays inside the map. initial_overlap: "refuse" or "allow".)")
      .def_static("load", &load, "path"_a, py::kw_only(), "yaw"_a = "ccw", "bounds"_a = py::none(),
                  "vehicle"_a = py::none(), "dt"_a = py::none(), "initial_overlap"_a = "refuse",
                  R"(Reads a file of CL-CBS, CSDO or Guo and Yu, or with mvtp's extensions.

yaw: "ccw" or "cw", how the file means it. bounds, vehicle (a preset's name) and dt [s] take the
place of what the file says, unless None.)")
      .def("save", &save, "path"_a, py::kw_only(), "yaw"_a = "ccw",
           "Writes an instance file (YAML); load() gives back the same numbers, bit by bit.")
      .def(py::pickle(&state_of, &from_state))
      .def("problems", &problems,
           "What makes it unsolvable by itself, a line each: solve() raises the first of\n"
           "them.");
}

void bind_values(py::class_<NamedInstance>& instance) {
  instance.def("__len__", [](const NamedInstance& self) { return self.instance.agents.size(); })
      .def("__repr__",
           [](const NamedInstance& self) {
             return fmt::format("<mvtp.Instance {}, {} robots>", self.name,
                                self.instance.agents.size());
           })
      .def_property_readonly(
          "starts", [](const py::object& self) { return poses_of(self, &Agent::start); },
          "(n_robots, 3): x [m], y [m], yaw [rad] of the rear axles; a view.")
      .def_property_readonly(
          "goals", [](const py::object& self) { return poses_of(self, &Agent::goal); },
          "(n_robots, 3): x [m], y [m], yaw [rad] of the rear axles; a view.")
      .def_property_readonly(
          "names", [](const NamedInstance& self) { return of_agents(self, &Agent::name); },
          "One for each robot.")
      .def_property_readonly(
          "vehicles", [](const NamedInstance& self) { return of_agents(self, &Agent::vehicle); },
          "One for each robot.")
      .def_property_readonly(
          "size",
          [](const NamedInstance& self) {
            return std::pair(self.instance.map.width, self.instance.map.height);
          },
          "Width and height of the map [m].")
      .def_property_readonly("circles", &circles_of, "(n, 3): x, y, radius [m]; a view.")
      .def_property_readonly("polygons", &polygons_of,
                             "Solid ones, each (n_corners, 2): x, y [m]; views.")
      .def_property_readonly(
          "dt", [](const NamedInstance& self) { return self.instance.dt; },
          "Duration of a step [s].")
      .def_property_readonly(
          "bounds",
          [](const NamedInstance& self) {
            return self.instance.map.bounds == Bounds::kAxle ? "axle" : "footprint";
          },
          "What stays inside the map: \"axle\" or \"footprint\".");
}

}  // namespace

void bind_instance(py::module_& module) {
  bind_vehicle(module);
  py::class_<NamedInstance> instance(
      module, "Instance",
      "Robots with starts and goals on a map, all at once. Cannot be changed.\n\n"
      "InputError is raised for values that make no instance.");
  bind_making(instance);
  bind_values(instance);
}

}  // namespace mvtp
