#pragma once

#include <map>
#include <string>
#include <vector>

#include "coordinator/traffic.hpp"
#include "traci_bridge/sumo_api.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// Traffic signals that show what they are told instead of their programs.
class SumoSignals {
 public:
  /// The first time all other lights of the signal turn red.
  void show(const std::string& signal, int index, Light light);
  void show_all(const std::string& signal, const std::string& lights);
  /// Says to SUMO what is shown from the next step on.
  void send();
  void free(const std::string& signal);
  [[nodiscard]] std::vector<SignalPhase> phases(const std::string& signal) const;
  void control(const std::string& signal, SignalControl control) const;
  /// Who runs its program.
  [[nodiscard]] SignalControl control_of(const std::string& signal) const;

 private:
  struct Signal;
  Signal& shown(const std::string& signal);
  [[nodiscard]] std::string program_of(const std::string& signal) const;

  struct Signal {
    std::string program;  ///< SUMO's own, to go back to
    std::string lights;   ///< a letter each
    bool changed = false;
  };

  std::map<std::string, Signal> signals_;
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
