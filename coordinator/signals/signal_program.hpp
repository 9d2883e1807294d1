#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/traffic.hpp"

namespace mvtp {

/// What a signal that runs its network's own program may show from now on, as far as whoever sees
/// its lights and knows the program can tell.
class SignalProgram {
 public:
  /// Lights from one time to another.
  struct Shown {
    double begin = 0.0;  ///< [s] from now on
    double end = 0.0;    ///< [s]
    std::size_t phase = 0;
  };
  /// One course that the program may take, without a gap from now on.
  using Course = std::vector<Shown>;

  /// @param signal  one with a program.
  SignalProgram(const Traffic& traffic, std::string signal);

  /// Looks at the lights, at every step.
  void observe();

  /// The courses that bound all others for the next `horizon` seconds: the present phase lasts as
  /// long as it may; and, where the traffic may end it, it ends as soon as it may.
  [[nodiscard]] std::vector<Course> courses(double horizon) const;

  [[nodiscard]] char light(std::size_t phase, int index) const {
    return phases_[phase].lights[std::size_t(index)];
  }
  [[nodiscard]] char light_now(int index) const { return light(phase_, index); }
  /// What gives the right to be on the junction in a phase: of a yellow one what it was
  /// before.
  [[nodiscard]] char right(std::size_t phase, int index) const;

 private:
  [[nodiscard]] Course course(double left, double horizon) const;

  const Traffic& traffic_;
  std::string signal_;
  std::vector<SignalPhase> phases_;
  bool by_clock_ = true;         ///< each phase lasts its duration
  std::size_t phase_ = 0;        ///< now
  std::optional<double> since_;  ///< [s] when it began; none: before it was first seen
};

/// May nobody go?
[[nodiscard]] inline bool is_red(char light) { return light == 'r' || light == 'u'; }
/// May one go before everybody else?
[[nodiscard]] inline bool is_protected(char light) { return light == 'G' || light == 'O'; }

}  // namespace mvtp
