#include "tools/coordinate/misbehaviour.hpp"

#include <vector>

#include "tools/coordinate/drivers.hpp"

namespace mvtp {
namespace {

std::vector<std::string> lanes_before(const RoadNetwork& network,
                                      const std::set<std::string>& junctions) {
  std::set<std::string> lanes;
  for (const std::string& id : junctions) {
    for (const Connection& c : network.junctions.at(id).connections) lanes.insert(c.from_lane);
  }
  return {lanes.begin(), lanes.end()};
}

/// Everybody is a human driver under a controller that drives nobody.
ControlledShare share_of(const CoordinateOptions& options) {
  const bool drives = controller_named("--controller", options.controller).drives;
  return drives ? controlled_share(options) : ControlledShare{.penetration = 0.0};
}

}  // namespace

Misbehaviour::Misbehaviour(const CoordinateOptions& options, SumoTraffic& traffic,
                           const std::set<std::string>& junctions)
    : rate_(options.human_faults),
      faults_(traffic, traffic,
              {.rate = options.human_faults,
               .seed = options.seed,
               .humans = share_of(options),
               .lanes = lanes_before(traffic.network(), junctions)}),
      braking_(traffic.step_length()) {}

void Misbehaviour::observe(const Snapshot& now, const Audit& audit) {
  braking_.observe(now.time, now.vehicles, faults_.faults(), audit.events());
}

HumanFaultFigures Misbehaviour::figures() const {
  return {.rate = rate_, .faults = faults_.faults(), .overlaps = braking_.overlaps()};
}

std::unique_ptr<Misbehaviour> make_misbehaviour(const CoordinateOptions& options,
                                                SumoTraffic& traffic,
                                                const std::set<std::string>& junctions) {
  if (options.human_faults == 0.0) return nullptr;
  return std::make_unique<Misbehaviour>(options, traffic, junctions);
}

}  // namespace mvtp
