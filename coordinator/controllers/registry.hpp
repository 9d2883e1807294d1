#pragma once

#include <span>
#include <string>

#include "coordinator/controllers/controller_kind.hpp"

namespace mvtp {

/// All controllers that there are, in the order in which they are listed.
[[nodiscard]] std::span<const ControllerKind> controller_kinds();

/// nullptr if there is none with this name.
[[nodiscard]] const ControllerKind* find_controller(const std::string& name);

/// The one that drives on parking lots in this way.
[[nodiscard]] const ControllerKind& controller_of_lots(LotController controller);

}  // namespace mvtp
