#pragma once

#include <exception>
#include <string>
#include <utility>

#include "traci_bridge/sumo_clock.hpp"
#include "traci_bridge/sumo_log.hpp"

namespace mvtp {

/// Calls of SUMO whose failures become one line for the user.
class SumoCalls {
 public:
  /// @param configuration  which the scenario comes from, for messages.
  /// @param log, clock  must outlive it.
  SumoCalls(std::string configuration, SumoLog& log, const SumoClock& clock)
      : configuration_(std::move(configuration)), log_(log), clock_(clock) {}

  /// Calls SUMO; what it throws, or says on stderr, becomes one InputError.
  template <class Call>
  auto ask(const Call& call) const -> decltype(call()) {
    std::string problem;
    try {
      const SumoLog::Redirection redirection(log_);
      return call();
    } catch (const std::exception& error) {
      problem = error.what();
    }
    fail(std::move(problem));
  }

  /// The same for what is asked often and only reads.
  template <class Call>
  auto look_up(const Call& call) const -> decltype(call()) {
    try {
      return call();
    } catch (const std::exception&) {
      return ask(call);
    }
  }

 private:
  /// @throws InputError
  [[noreturn]] void fail(std::string problem) const;

  std::string configuration_;
  SumoLog& log_;
  const SumoClock& clock_;
};

}  // namespace mvtp
