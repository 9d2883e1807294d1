#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/drivers/human_fault_port.hpp"
#include "coordinator/traffic.hpp"
#include "planner/problem/interruption.hpp"

namespace mvtp {

/// A SUMO that somebody else has started, and that waits for its clients.
struct SumoAddress {
  std::string host;
  int port = 0;
  int order = 1;    ///< of this client among them, from 1: who speaks first in each step
  int clients = 1;  ///< for how many it waits; its option --num-clients
};

struct SumoOptions {
  std::string configuration;          ///< path of the *.sumocfg
  std::optional<std::uint32_t> seed;  ///< of SUMO's random numbers; none: SUMO's own default
  bool gui = false;                   ///< show the run in sumo-gui; implies separate_process
  /// Run SUMO as a program of its own (libtraci) instead of inside this process (libsumo): the
  /// same figures many times slower, but a crash of SUMO is then an InputError.
  bool separate_process = false;
  /// Join this one instead of starting any; seed, gui, outputs and more options are its own then.
  std::optional<SumoAddress> remote;
  std::string fcd_output;          ///< path of the trajectories; empty: none
  std::string tripinfo_output;     ///< path of one record per vehicle; empty: none
  std::string log;                 ///< path of what SUMO says on the way; empty: nowhere
  std::vector<std::string> extra;  ///< more options for SUMO, as on its command line
  InterruptionPoint point = never_interrupted;  ///< called while SUMO is being opened
};

/// What SUMO has warned of.
struct SumoWarnings {
  std::int64_t count = 0;
  std::int64_t untold = 0;         ///< those that are not about collisions and emergency braking
  std::vector<std::string> first;  ///< of these
};

/// SUMO, opened at the begin of a scenario; nothing has entered the network before the first step.
///
/// While open, its output files are PATH.part; close() gives them their names. A run that ends by
/// an error or without close() leaves no file.
///
/// @note libsumo holds one simulation per process, is not thread-safe, and may abort the process
/// where SUMO has a bug; whoever needs to survive that runs it in a child process.
class SumoTraffic : public Traffic, public HumanFaultPort {
 public:
  /// Vehicles that entered and left the network in the last step, ordered by id.
  [[nodiscard]] virtual const std::vector<std::string>& departed() const = 0;
  [[nodiscard]] virtual const std::vector<std::string>& arrived() const = 0;

  /// Ends the run and completes the output files; vehicles still on the road or waiting are in the
  /// tripinfo-output as unfinished. No other function may be called afterwards but this.
  virtual void close() = 0;
  /// From now on its output files stay, even if the run cannot be closed: PATH.part then.
  virtual void keep_outputs() = 0;
  [[nodiscard]] virtual SumoWarnings warnings() const = 0;
};

/// Starts SUMO on a scenario.
///
/// Throws InputError for whatever SUMO or we have against the scenario, the options or the output
/// paths, with SUMO's own words, in one line; SUMO itself prints nothing.
///
/// One that is joined goes on after close(), and a vehicle that another client drives counts as
/// taken over.
[[nodiscard]] std::unique_ptr<SumoTraffic> open_sumo(const SumoOptions& options);

/// The version of libsumo, e.g. "SUMO 1.15.0".
[[nodiscard]] std::string sumo_version();

}  // namespace mvtp
