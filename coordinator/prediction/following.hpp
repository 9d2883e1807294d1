#pragma once

#include <vector>

#include "planner/road.hpp"

namespace mvtp {

/// Whoever passes a junction keeps behind those ahead of him, also behind who comes into his lane
/// from another one: his latest motion waits until they have left his path, or drive on before him.
/// Looks ten seconds ahead.
/// @param scene  of the moment, with tables of all paths
void follow_leaders(std::vector<Forecast>& forecasts, const RoadScene& scene);

}  // namespace mvtp
