#pragma once

#include <utility>
#include <vector>

#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {

/// So many vehicles are under control, the others have human drivers.
inline CoordinatorOptions share(double penetration,
                                const SignalTiming& timing = SignalTiming::real()) {
  CoordinatorOptions options;
  options.share = {.penetration = penetration, .seed = 1};
  options.signals = timing;
  return options;
}

/// Cars on crossroads with a traffic signal.
inline std::vector<FakeTrip> cars(unsigned seed, int vehicles = 24) {
  return random_trips(with_signals(crossroads_shape()), {.vehicles = vehicles, .seed = seed});
}

inline ClosedLoop loop(std::vector<FakeTrip> trips, const CoordinatorOptions& options) {
  return {with_signals(crossroads_shape()), std::move(trips), 0.1, options};
}

}  // namespace mvtp
