#pragma once

#include <csignal>
#include <optional>
#include <stdexcept>
#include <string>

#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_backend.hpp"
#include "traci_bridge/sumo_log.hpp"
#include "traci_bridge/sumo_process.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

#ifdef LIBTRACI
/// A SUMO that runs as a program of its own: ours, or one that somebody else has started.
class SumoConnection {
 public:
  SumoConnection(const SumoLaunch& launch, const SumoLog& log) {
    // A SUMO that dies, or never answers, is an error and must not take us along.
    std::signal(SIGPIPE, SIG_IGN);
    if (launch.remote) {
      join(*launch.remote);
      return;
    }
    process_.emplace(launch.arguments, log.descriptor(), launch.point);
    connect(process_->port(), "127.0.0.1", 0);
  }

  void close() {
    api::Simulation::close();
    if (process_ && !process_->wait()) throw std::runtime_error("it did not end well");
  }

 private:
  static void connect(int port, const std::string& host, int retries) {
    api::Simulation::init(port, retries, host, "mvtp-" + host + "-" + std::to_string(port));
  }

  static void join(const SumoAddress& remote) {
    constexpr int kRetries = 10;  // one second each
    try {
      connect(remote.port, remote.host, kRetries);
    } catch (const std::exception& error) {
      throw std::runtime_error("no SUMO answers at " + remote.host + ':' +
                               std::to_string(remote.port) + " (" + error.what() +
                               "); start one there with --remote-port");
    }
    // SUMO begins once every client has said when it speaks; a single one need not.
    if (remote.clients > 1) api::Simulation::setOrder(remote.order);
  }

  std::optional<SumoProcess> process_;
};
#else
/// A SUMO that runs inside this process.
class SumoConnection {
 public:
  SumoConnection(const SumoLaunch& launch, const SumoLog& /*log*/) {
    api::Simulation::start(launch.arguments);
  }

  void close() { api::Simulation::close(); }
};
#endif

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
