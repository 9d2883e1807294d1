#include "coordinator/faults/fault_model.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

/// A message that is sent again at every step is late with no more than this probability.
constexpr double kResidual = 1e-6;
constexpr double kRounding = 1e-9;

/// Messages until one has got through.
int tries(const ChannelModel& channel) {
  if (channel.loss <= 0.0) return 1;
  return int(std::ceil(std::log(kResidual) / std::log(channel.loss) - kRounding));
}

/// Steps until a message that is sent from now on has arrived.
int steps_until_received(const ChannelModel& channel, double dt) {
  return int(std::ceil(channel.delay / dt - kRounding)) + tries(channel) - 1;
}

}  // namespace

FaultTolerance tolerance_of(const FaultModel& declared, double dt, double longest) {
  FaultTolerance tolerance;
  tolerance.exact = declared.is_exact();
  if (tolerance.exact) return tolerance;
  constexpr double kMost = FaultModel::kMostDeviations;
  tolerance.lead = steps_until_received(declared.command, dt);
  tolerance.age = steps_until_received(declared.report, dt) * dt;
  const double driven = kMost * declared.actuation;
  const double driven_across = FaultModel::kAcross * driven;
  const double seen = kMost * declared.position;
  const double seen_across = seen + longest * std::sin(kMost * declared.heading);
  // Of two vehicles one at least is under control, where it was planned to be but for its
  // actuation; the other one too, or it is where it says.
  tolerance.more = {driven + std::max(driven, seen),
                    driven_across + std::max(driven_across, seen_across)};
  tolerance.off = driven + seen;
  return tolerance;
}

}  // namespace mvtp
