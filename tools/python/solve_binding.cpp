#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <utility>

#include "planner/problem/check_instance.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/plan_file.hpp"
#include "planner/problem/validate.hpp"
#include "tools/cli/instance_options.hpp"
#include "tools/cli/version.hpp"
#include "tools/python/bindings.hpp"
#include "tools/python/plan_object.hpp"
#include "tools/python/words.hpp"
#include "tools/solve/solve_and_judge.hpp"
#include "tools/solve/solve_options.hpp"

namespace mvtp {
namespace {

/// How long Python's signals and callbacks wait while a search goes on.
constexpr std::chrono::milliseconds kPollInterval(50);

struct Search {
  SolveOptions options;
  double time_limit = 60.0;  ///< [s]
};

Search read_search(const std::vector<std::string>& words) {
  Search search;
  parse_words("solve", words, [&](CLI::App& app) {
    add_search_options(app, search.options, search.time_limit);
    add_collision_option(app, search.options.collision);
  });
  return search;
}

/// Lets Python handle signals, and tells its callback about the share of the time that is over.
/// @return what either of them raised, or none
py::object ask_python(const py::object& progress, double seconds, double time_limit) {
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress.is_none()) {
      progress(std::min(1.0, seconds / time_limit), fmt::format("{:.1f} s", seconds));
    }
  } catch (py::error_already_set& error) {
    return error.value();
  }
  return py::none();
}

/// Searches on a thread of its own while this one listens to Python.
/// @return the plan, and what Python raised meanwhile, which has ended the search, or None
std::pair<PlanObject, py::object> search(const NamedInstance& self,
                                         const std::vector<std::string>& words,
                                         const py::object& progress) {
  using Clock = std::chrono::steady_clock;
  const Search search = read_search(words);
  const Deadline deadline = Deadline::in(search.time_limit);
  const auto problems = check_instance(self.instance, self.name);
  if (!problems.empty()) throw problems.front();

  const auto start = Clock::now();
  std::atomic<bool> stop = false;
  std::future<Plan> plan = std::async(std::launch::async, [&] {
    return solve_and_judge(self.instance, search.options, deadline, stop);
  });
  py::object raised = py::none();
  {
    const py::gil_scoped_release released;
    while (plan.wait_for(kPollInterval) != std::future_status::ready) {
      const std::chrono::duration<double> elapsed = Clock::now() - start;
      const py::gil_scoped_acquire acquired;
      if (!stop) raised = ask_python(progress, elapsed.count(), search.time_limit);
      stop = stop || !raised.is_none();
    }
  }
  return {PlanObject(plan.get()), raised};
}

std::vector<Violation> validate(const NamedInstance& instance, const PlanObject& plan,
                                const std::string& collision) {
  CollisionRule rule = CollisionRule::kContinuous;
  parse_words("validate", {"--collision=" + collision},
              [&](CLI::App& app) { add_collision_option(app, rule); });
  Instance judged = instance.instance;
  (void)take_vehicles(plan.plan(), judged);
  const py::gil_scoped_release released;
  return find_violations(judged, plan.plan(), rule);
}

}  // namespace

void bind_solve(py::module_& module) {
  using namespace py::literals;
  module.attr("version") = version();
  module.attr("algorithms") = py::tuple(py::cast(algorithm_names()));
  py::class_<Violation>(module, "Violation", "One broken rule: where, when, and by how much.")
      .def_property_readonly(
          "rule", [](const Violation& v) { return to_string(v.rule); }, "The rule's name.")
      .def_readonly("agents", &Violation::agents, "One name, or the two that overlap.")
      .def_readonly("step", &Violation::step,
                    "When it begins [steps]; fractional between two steps.")
      .def_readonly("amount", &Violation::amount,
                    "In the rule's unit: m, rad, 1/m, m/s; 0 where none applies.")
      .def_readonly("message", &Violation::message, "One line.")
      .def("__repr__", [](const Violation& v) {
        return fmt::format("<mvtp.Violation {}: {}>", to_string(v.rule), v.message);
      });
  module.def("search", &search, "instance"_a, "words"_a, "progress"_a);
  module.def(
      "validate", &validate, "instance"_a, "plan"_a, py::kw_only(), "collision"_a = "continuous",
      R"(The referee: every rule that the plan breaks, in the order of the rules; empty if it is valid.

collision: "continuous", footprints may not touch along the motion, or "steps", only at whole steps.
If the plan records its vehicles they are used, as in `mvtp validate`. The GIL is released.)");
}

}  // namespace mvtp
