#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>

#include "tests/traci_bridge/fixtures.hpp"
#include "traci_bridge/sumo_traffic.hpp"

namespace mvtp {

inline constexpr double kStep = 0.1;

inline std::string vehicle(const std::string& id, double depart, const std::string& edges,
                           const std::string& more = "") {
  return "<vehicle id=\"" + id + "\" type=\"car\" depart=\"" + std::to_string(depart) +
         "\" departSpeed=\"max\" " + more + "><route edges=\"" + edges + "\"/></vehicle>";
}

/// The crossroads with cars that drive exactly at the limit, from west (Wi) to east (Eo) and so on.
class SumoTrafficTest : public testing::Test {
 protected:
  /// Opens the crossroads with some elements of a route file.
  std::unique_ptr<SumoTraffic> open(const std::string& vehicles) {
    options_.configuration = write_scenario(vehicles);
    return open_sumo(options_);
  }

  std::string write_scenario(const std::string& vehicles) {
    const std::string network = "networks/" + network_ + ".net.xml";
    directory_.write(
        "test.rou.xml",
        R"(<routes><vType id="car" length="4.5" width="1.8" sigma="0" speedDev="0"/>)" + vehicles +
            "</routes>");
    return directory_.write("test.sumocfg", "<configuration><net-file value=\"" +
                                                project_file(network) +
                                                R"("/><route-files value="test.rou.xml"/>
                                                <step-length value="0.1"/></configuration>)");
  }

  std::string error_of(const std::string& vehicles, int steps = 1) {
    return message_of([&] {
      const std::unique_ptr<SumoTraffic> traffic = open(vehicles);
      for (int i = 0; i < steps; ++i) traffic->step();
    });
  }

  TemporaryDirectory directory_;
  SumoOptions options_;
  std::string network_ = "crossroads";
};

inline const VehicleState& at(const Traffic& traffic, const std::string& id) {
  const VehicleState* state = find(traffic, id);
  if (state == nullptr) throw std::runtime_error("vehicle " + id + " is not on the road");
  return *state;
}

inline void run_until(Traffic& traffic, double time) {
  while (traffic.time() < time - kStep / 2.0) traffic.step();
}

}  // namespace mvtp
