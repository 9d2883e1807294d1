#pragma once

#include <memory>

#include "coordinator/controllers/controller_kind.hpp"

namespace mvtp {

/// A coordinator whose vehicles reserve ground on junctions, first come, first served: each plans
/// once, when it is taken over, around what is reserved, and keeps its plan. Who finds none waits
/// before its line and asks again at each decision. Corridors, speed profiles and the rules of
/// safety are the same as for all others.
[[nodiscard]] std::unique_ptr<Controller> make_reserving(const ControllerSetup& setup,
                                                         Reservation reservation);

/// The same with tiles, under signals that run their own programs for human drivers.
[[nodiscard]] std::unique_ptr<Controller> make_reserving(const ControllerSetup& setup,
                                                         GreenGround greens);

}  // namespace mvtp
