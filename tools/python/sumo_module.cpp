#include "tools/python/bindings.hpp"

/// What of mvtp needs SUMO, whose libraries take long to load.
PYBIND11_MODULE(_sumo, module) {
  using namespace mvtp;
  py::module_::import("mvtp._planner");  // Vehicle and InputError are its own
  bind_traffic(module);
  bind_session(module);
}
