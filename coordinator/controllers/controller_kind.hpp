#pragma once

#include <memory>
#include <optional>
#include <string>

#include "coordinator/controller.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/lot/lot_controller.hpp"
#include "coordinator/network/drivable_area.hpp"

namespace mvtp {

/// What a controller is made for; all of it outlives the controller.
struct ControllerSetup {
  Traffic& traffic;
  const DrivableArea& area;
  /// Which junctions, who is taken over, margins, seed, ...; `junctions` names them all.
  CoordinatorOptions options;
};

/// The controller of a run that names none, and the one that leaves all to SUMO.
constexpr const char* kUsualController = "escot";
constexpr const char* kSumosController = "sumo";

/// A controller by its name.
struct ControllerKind {
  std::string name;
  std::string meaning;  ///< one line for `--help`
  /// Makes it for junctions; nullptr: it is for parking lots only.
  /// @throws InputError if there is nothing for it to control
  std::unique_ptr<Controller> (*make)(const ControllerSetup& setup) = nullptr;
  bool drives = false;                        ///< vehicles go where it says
  bool needs_signals = false;                 ///< it runs those of the network
  std::optional<LotController> on_lots = {};  ///< how it drives on parking lots; none: not there
};

}  // namespace mvtp
