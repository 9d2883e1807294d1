#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/network/road_network.hpp"
#include "traci_bridge/output_file.hpp"
#include "traci_bridge/sumo_traffic.hpp"

namespace mvtp {

/// A run of SUMO about to begin.
struct SumoLaunch {
  std::string configuration;           ///< for messages
  std::vector<std::string> arguments;  ///< of SUMO's command line, the program first
  RoadNetwork network;
  std::vector<OutputFile> outputs;
  std::string log;                    ///< as in SumoOptions
  std::optional<SumoAddress> remote;  ///< likewise; with libtraci only
  InterruptionPoint point;            ///< likewise
};

/// The two back ends: sumo_backend.cpp, compiled against libsumo and against libtraci.
[[nodiscard]] std::unique_ptr<SumoTraffic> launch_libsumo(SumoLaunch launch);
[[nodiscard]] std::unique_ptr<SumoTraffic> launch_libtraci(SumoLaunch launch);

}  // namespace mvtp
