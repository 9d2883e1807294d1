#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/metrics.hpp"
#include "planner/problem/plan_array.hpp"
#include "planner/problem/plan_file.hpp"
#include "tools/cli/instance_options.hpp"
#include "tools/python/bindings.hpp"
#include "tools/python/plan_object.hpp"
#include "tools/python/words.hpp"

namespace mvtp {
namespace {

constexpr const char* kBuilt = "plan";  ///< stands for the file in messages
constexpr py::ssize_t kColumns = 5;     ///< of a waypoint

PlanReadOptions read_options(const std::string& yaw, double dt) {
  InstanceReadOptions options;
  parse_words("validate", {"--yaw=" + yaw, fmt::format("--dt={}", dt)},
              [&](CLI::App& app) { add_instance_options(app, options); });
  return {options.yaw, *options.dt};
}

PlanObject load(const std::filesystem::path& path, const std::string& yaw, double dt) {
  return PlanObject(read_plan(path.string(), read_options(yaw, dt)));
}

/// Plans of other planners may hold anything; the referee says so, and no file holds it.
void require_finite(const Plan& plan) {
  const auto is_known = [](double control) { return !std::isinf(control); };  // NaN: not known
  for (std::size_t i = 0; i < plan.trajectories.size(); ++i) {
    for (std::size_t t = 0; t <= plan.trajectories[i].makespan(); ++t) {
      const Waypoint& w = plan.trajectories[i].at(t);
      const bool finite = std::isfinite(w.pose.x) && std::isfinite(w.pose.y) &&
                          std::isfinite(w.pose.theta) && is_known(w.v) && is_known(w.phi);
      if (finite) continue;
      throw InputError(std::string(kBuilt) + ": " + plan.names[i],
                       fmt::format("step {} is not finite; a file of it would be none", t));
    }
  }
}

void save(const PlanObject& self, const std::filesystem::path& path, const std::string& yaw) {
  require_finite(self.plan());
  write_plan(self.plan(), path.string(), read_options(yaw, 1.0).yaw);
}

/// What pickle and copy keep: the file.
py::tuple state_of(const PlanObject& self) {
  require_finite(self.plan());
  return py::make_tuple(plan_text(self.plan()));
}

PlanObject from_state(const py::tuple& state) {
  return PlanObject(parse_plan(kBuilt, std::get<0>(state.cast<std::tuple<std::string>>())));
}

Trajectory trajectory_from(const Numbers& states, py::ssize_t robot) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const bool has_controls = states.shape(2) == kColumns;
  std::vector<Waypoint> waypoints;
  for (py::ssize_t t = 0; t < states.shape(1); ++t) {
    const auto at = [&](py::ssize_t column) { return states.at(robot, t, column); };
    waypoints.push_back({{at(0), at(1), wrap_to_pi(at(2))},
                         has_controls ? at(3) : kUnknown,
                         has_controls ? at(4) : kUnknown});
  }
  return Trajectory(std::move(waypoints));
}

PlanObject build(const py::object& values, std::optional<std::vector<std::string>> names,
                 double dt) {
  const Numbers states = numbers_of(values);
  const bool fits = states && states.ndim() == 3 && states.size() > 0 &&
                    (states.shape(2) == 3 || states.shape(2) == kColumns);
  if (!fits) {
    throw InputError(std::string(kBuilt) + ": states",
                     "is no array of the shape (n_robots, n_steps, 3 or 5); give x [m], y [m], yaw "
                     "[rad] and perhaps v [m/s], phi [rad]");
  }
  Plan plan;
  plan.statistics.dt = read_options("ccw", dt).dt;
  for (py::ssize_t i = 0; i < states.shape(0); ++i) {
    plan.names.push_back(fmt::format("agent{}", i));
    plan.trajectories.push_back(trajectory_from(states, i));
  }
  if (names && names->size() != plan.names.size()) {
    throw InputError(std::string(kBuilt) + ": names",
                     fmt::format("has {} entries for {} robots; give one each, or None",
                                 names->size(), plan.names.size()));
  }
  if (names) plan.names = std::move(*names);
  fill_in_durations(plan);
  return PlanObject(std::move(plan));
}

/// The first columns of all robots' states at all steps.
py::array columns_of(const py::object& self, py::ssize_t columns) {
  const PlanObject& plan = self.cast<const PlanObject&>();
  const py::ssize_t robots = py::ssize_t(plan.plan().trajectories.size());
  const py::ssize_t steps = py::ssize_t(plan.steps());
  if (robots == 0) return py::array_t<double>(std::vector<py::ssize_t>{0, 0, columns});
  const py::ssize_t row = sizeof(Waypoint);
  return view_of(&plan.states().front().pose.x, {robots, steps, columns},
                 {steps * row, row, py::ssize_t(sizeof(double))}, self);
}

/// One robot's states, where the planner left them.
py::array trajectory_of(const py::object& self, py::ssize_t robot) {
  const std::vector<Trajectory>& all = self.cast<const PlanObject&>().plan().trajectories;
  const auto count = py::ssize_t(all.size());
  if (robot < -count || robot >= count) {
    throw py::index_error(fmt::format("the plan has {} robots, no number {}", count, robot));
  }
  const auto states = mvtp::states(all[std::size_t(robot < 0 ? robot + count : robot)]);
  return view_of(states.data(), {states.rows(), kColumns},
                 {py::ssize_t(sizeof(Waypoint)), py::ssize_t(sizeof(double))}, self);
}

py::dict statistics_of(const PlanObject& self) {
  const Statistics& s = self.plan().statistics;
  py::dict d;
  d["status"] = s.status;
  d["algorithm"] = s.algorithm;
  d["cost"] = s.cost;
  d["makespan"] = s.makespan;
  d["flowtime"] = s.flowtime;
  d["runtime"] = s.runtime;
  d["first_solution"] = s.first_solution;
  d["makespan_steps"] = s.makespan_steps;
  d["lower_bound"] = s.lower_bound;
  d["solo_makespan"] = s.solo_makespan;
  d["seed"] = s.seed;
  d["dt"] = s.dt;
  d["version"] = s.version;
  d["reason"] = s.reason;
  d["initial_overlaps"] = s.initial_overlaps;
  return d;
}

void bind_making(py::class_<PlanObject>& plan) {
  using namespace py::literals;
  plan.def(py::init(&build), "states"_a, py::kw_only(), "names"_a = py::none(), "dt"_a = 1.0,
           R"(A plan from values, for the referee or to be saved.

states: (n_robots, n_steps, 3), x [m], y [m], yaw [rad] of the rear axles at the steps 0, 1, ..., or
(n_robots, n_steps, 5) with v [m/s] and phi [rad], held during the step that ends in the row; without
them the referee infers each step's arc. names: "agent0", ... if None. dt: duration of a step [s].)")
      .def_static(
          "load", &load, "path"_a, py::kw_only(), "yaw"_a = "ccw", "dt"_a = 1.0,
          "Reads a plan file of mvtp, CL-CBS, CSDO, or Guo and Yu. yaw: \"ccw\" or \"cw\";\n"
          "dt: duration of a step [s] where the file does not say.")
      .def("save", &save, "path"_a, py::kw_only(), "yaw"_a = "ccw",
           "Writes a plan file (YAML), as `mvtp solve -o` does.")
      .def(py::pickle(&state_of, &from_state));
}

void bind_values(py::class_<PlanObject>& plan) {
  plan.def_property_readonly(
          "poses", [](const py::object& self) { return columns_of(self, 3); },
          "(n_robots, n_steps, 3): x [m], y [m], yaw [rad] of the rear axles at the steps 0, 1, "
          "...;\n"
          "whoever has arrived rests. A view of `states`.")
      .def_property_readonly(
          "states", [](const py::object& self) { return columns_of(self, kColumns); },
          "(n_robots, n_steps, 5): the poses, and v [m/s] (negative: reverse) and phi [rad], held\n"
          "during the step that ends in the row. A view of the plan's memory.")
      .def("trajectory", &trajectory_of, py::arg("robot"),
           "(n_own_steps, 5): the states of one robot until it has arrived. A view.")
      .def_property_readonly(
          "names", [](const PlanObject& self) { return self.plan().names; }, "One for each robot.")
      .def_property_readonly(
          "vehicles", [](const PlanObject& self) { return self.plan().vehicles; },
          "One for each robot; empty if the plan does not say.")
      .def_property_readonly(
          "statistics", &statistics_of,
          "How it was found: what a plan file has under `statistics`; durations\n"
          "in s.")
      .def_property_readonly(
          "dt", [](const PlanObject& self) { return self.plan().statistics.dt; },
          "Duration of a step [s].")
      .def_property_readonly(
          "solved",
          [](const PlanObject& self) {
            return self.plan().statistics.status == to_string(Status::kSolved);
          },
          "Does every robot reach its goal, and does the referee agree?")
      .def("__len__", [](const PlanObject& self) { return self.plan().trajectories.size(); })
      .def("__repr__", [](const PlanObject& self) {
        return fmt::format("<mvtp.Plan {}, {} robots, {} steps>", self.plan().statistics.status,
                           self.plan().trajectories.size(), self.steps());
      });
}

}  // namespace

void bind_plan(py::module_& module) {
  py::class_<PlanObject> plan(module, "Plan", "Trajectories of all robots. Cannot be changed.");
  bind_making(plan);
  bind_values(plan);
}

}  // namespace mvtp
