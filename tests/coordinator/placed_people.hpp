#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {

/// Traffic among people who stand where a test puts them.
class PlacedPeople : public FakeTraffic {
 public:
  using FakeTraffic::FakeTraffic;
  std::span<const Pedestrian> pedestrians() const override { return people; }
  std::vector<Pedestrian> people;
};

/// The crossing over the arm to the east of crossroads around the origin.
inline const PedestrianCrossing& east_crossing(const RoadNetwork& network) {
  const auto& crossings = network.junctions.at("C").crossings;
  return *std::ranges::max_element(crossings, {}, [](const auto& c) { return c.shape.front().x; });
}

}  // namespace mvtp
