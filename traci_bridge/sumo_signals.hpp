#pragma once

#include <map>
#include <string>

#include "coordinator/traffic.hpp"
#include "traci_bridge/sumo_api.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// Traffic signals that show what they are told instead of their programs.
class SumoSignals {
 public:
  /// The first time all other lights of the signal turn red.
  void show(const std::string& signal, int index, Light light);
  /// Says to SUMO what is shown from the next step on.
  void send();
  void free(const std::string& signal);

 private:
  struct Signal {
    std::string program;  ///< SUMO's own, to go back to
    std::string lights;   ///< a letter each
    bool changed = false;
  };

  std::map<std::string, Signal> signals_;
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
