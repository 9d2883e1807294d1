#include "planner/problem/input_error.hpp"
#include "tools/python/bindings.hpp"

/// What of mvtp needs no SUMO.
PYBIND11_MODULE(_planner, module) {
  using namespace mvtp;
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).attr("__doc__") =
      "Bad input: where, what, the value with its unit, and what to do, in one line.";
  bind_instance(module);
  bind_plan(module);
  bind_solve(module);
}
