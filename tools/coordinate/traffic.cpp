#include "tools/coordinate/traffic.hpp"

#include <fmt/format.h>

#include <utility>

#include "coordinator/corridor/lateral_limits.hpp"
#include "planner/problem/input_error.hpp"
#include "tools/coordinate/fault_options.hpp"

namespace mvtp {

std::unique_ptr<SumoTraffic> open_traffic(const CoordinateOptions& options,
                                          const Scenario& scenario) {
  std::unique_ptr<SumoTraffic> traffic = open_sumo(scenario.sumo);
  if (scenario.sumo.remote && traffic->step_length() > kLongestStep) {
    throw InputError("--remote " + options.remote,
                     fmt::format("its step of {} s is too long to drive vehicles by; start it with "
                                 "--step-length {} or less",
                                 traffic->step_length(), kLongestStep));
  }
  if (options.max_lateral_accel > 0.0) {
    for (const auto& [lane, speed] :
         bend_speed_limits(traffic->network(), options.max_lateral_accel)) {
      scenario.sumo.point();
      traffic->limit_speed(lane, speed);
    }
  }
  return traffic;
}

std::unique_ptr<FaultyTraffic> make_faulty(const CoordinateOptions& options, Traffic& traffic) {
  FaultPlan plan = read_faults(options.faults);
  plan.seed = options.seed;
  if (options.faults.empty()) return nullptr;
  return std::make_unique<FaultyTraffic>(traffic, std::move(plan));
}

}  // namespace mvtp
