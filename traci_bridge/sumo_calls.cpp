#include "traci_bridge/sumo_calls.hpp"

#include <algorithm>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

std::string seconds(double time) {
  const std::string text = std::to_string(time);
  return text.substr(0, text.find('.') + 3) + " s";
}

}  // namespace

void SumoCalls::fail(std::string problem) const {
  if (const std::string said = log_.take_errors(); !said.empty()) problem = said;
  std::ranges::replace(problem, '\n', ' ');
  if (problem.ends_with('.')) problem.pop_back();
  const std::string when = clock_.now < 0.0 ? "SUMO does not start: "
                                            : "SUMO stopped after " + seconds(clock_.now) + ": ";
  throw InputError(configuration_, when + problem + "; correct the scenario or SUMO's options");
}

}  // namespace mvtp
