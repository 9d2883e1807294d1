#pragma once

#include <functional>
#include <vector>

namespace mvtp {

/// A vehicle that comes to a signal.
struct QueuedVehicle {
  int link = 0;          ///< by which it goes on
  double arrival = 0.0;  ///< [s] from now until it is at its line, if nobody hinders it
  bool stands = false;
  bool needs_green = true;  ///< not only those behind it
  double weight = 1.0;      ///< of what it loses
};

/// What comes to one signal: the vehicles of each lane, the first first.
using Queues = std::vector<std::vector<QueuedVehicle>>;

/// Which connections may go at a signal, and when that changes.
struct QueuePhases {
  int phases = 0;
  int present = 0;            ///< the phase that has green, or is about to get it,
  double ready = 0.0;         ///< [s] from now until it has,
  double least_end = 0.0;     ///< [s] from now until it may end at the earliest
  double first_change = 4.0;  ///< [s] from the end of the present phase to the next green,
  double change = 4.0;        ///< [s] and from each later one
  double least_green = 5.0;   ///< [s]
  std::function<bool(int phase, int link)> has_green;
  std::function<bool(int link, int other)> yields_to;
  /// [s] from now until people on crossings let it be green.
  std::function<double(int link)> free_in = [](int) { return 0.0; };
};

/// What the vehicles lose in all [s], by their weights, if the present phase ends `end` seconds
/// from now and `next` follows: vertical queues that discharge at saturation; later greens last as
/// long as vehicles come closely, and go to the phase for which most wait.
[[nodiscard]] double queue_delay(const Queues& queues, const QueuePhases& phases, double end,
                                 int next);
/// The same if the present phase lasts as long as vehicles come closely.
[[nodiscard]] double queue_delay(const Queues& queues, const QueuePhases& phases);

}  // namespace mvtp
