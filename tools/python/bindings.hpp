#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "planner/problem/instance.hpp"
#include "planner/problem/plan.hpp"

namespace mvtp {

namespace py = pybind11;

/// An instance as Python has it: with the word for it in messages, the file it came from.
struct NamedInstance {
  Instance instance;
  std::string name;
};

/// Any array or nested sequence of numbers; copied only where it is not one of doubles already.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The values as an array; none (false) where they are no real numbers.
[[nodiscard]] inline Numbers numbers_of(const py::object& values) {
  const auto given = py::array::ensure(values);
  const bool real = given && given.dtype().kind() != 'c';
  Numbers numbers = real ? Numbers::ensure(given) : py::reinterpret_steal<Numbers>(py::handle());
  if (!numbers) PyErr_Clear();
  return numbers;
}

/// A read-only view of memory that `owner` keeps alive.
[[nodiscard]] inline py::array view_of(const double* data, std::vector<py::ssize_t> shape,
                                       std::vector<py::ssize_t> strides, py::handle owner) {
  py::array_t<double> view(std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

// The parts of the module _planner, in the order in which they need each other.
void bind_instance(py::module_& module);
void bind_plan(py::module_& module);
void bind_solve(py::module_& module);

// The parts of the module _sumo.
void bind_traffic(py::module_& module);
void bind_session(py::module_& module);

}  // namespace mvtp
