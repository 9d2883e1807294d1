#pragma once

#include <span>
#include <vector>

#include "planner/road.hpp"

namespace mvtp {

/// Whoever passes a junction keeps behind those ahead of him, also behind who comes into his lane
/// from another one: his latest motion waits until they have left his path, or drive on before him.
/// Looks ten seconds ahead.
/// @param scene  of the moment, with tables of all paths
void follow_leaders(std::vector<Forecast>& forecasts, const RoadScene& scene);

/// Does a driver follow somebody who is at `leader`, in his lane? Not one who stands across it or
/// is about to come into it, nor if their paths part and meet again.
[[nodiscard]] bool follows(const Forecast& driver, const PlaceOnPath& leader,
                           const PathLibrary& library);

/// Does a driver come into the lane of another one only when that one drives there ahead of him,
/// whatever both do within their tubes? From then on he keeps behind it. Not if their paths part
/// and meet again: there he does not look out for it.
/// @param dt  [s] a step
[[nodiscard]] bool merges_behind(const Forecast& driver, const Forecast& leader,
                                 const PathLibrary& library, double dt);

/// Somebody who is held before a line.
struct HeldVehicle {
  PlaceOnPath now;
  double furthest = 0.0;  ///< [m] station where it stands if it moves up
};

/// Nobody drives through those who are held ahead of him in his lane: what he may do ends behind
/// the first of them.
void stay_behind(Forecast& driver, std::span<const HeldVehicle> held, const PathLibrary& library);

}  // namespace mvtp
