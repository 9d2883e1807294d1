#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_log.hpp"
#include "traci_bridge/sumo_process.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

#ifdef LIBTRACI
/// A SUMO that runs as a program of its own.
class SumoConnection {
 public:
  SumoConnection(const std::vector<std::string>& arguments, const SumoLog& log)
      : process_(arguments, log.descriptor()) {
    const std::string port = std::to_string(process_.port());
    api::Simulation::init(process_.port(), 0, "127.0.0.1", "mvtp-" + port);
  }

  void close() {
    api::Simulation::close();
    if (!process_.wait()) throw std::runtime_error("it did not end well");
  }

 private:
  SumoProcess process_;
};
#else
/// A SUMO that runs inside this process.
class SumoConnection {
 public:
  SumoConnection(const std::vector<std::string>& arguments, const SumoLog& /*log*/) {
    api::Simulation::start(arguments);
  }

  void close() { api::Simulation::close(); }
};
#endif

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
