#pragma once

#include <span>
#include <vector>

#include "coordinator/traffic.hpp"
#include "planner/lot.hpp"

namespace mvtp {

/// Looks ahead for those whom no plan knows: people on foot and vehicles with human drivers.
///
/// People are expected to go on as they walk now. A car stops before ground where somebody will be
/// while it is there, at a place where nobody walks into it; if it is too late for that it drives
/// on, unless into somebody. People walk on, whatever stands there, so that a car enters a footpath
/// only if nobody comes before it has left it again; that no other car holds it up there, its order
/// says (PathCells::keep_clear). Once it can no longer stop before the footpath it crosses.
class LotLookout {
 public:
  struct View {
    std::span<const Pedestrian> people;
    std::span<const StandingCar> strangers;
  };

  /// How far a car may drive for now [m]; infinity: anywhere. All in one frame.
  /// @param turn  how far the other cars let it, LotMotion::turns
  [[nodiscard]] static double stopping_point(const LotMotion& motion, const LotCar& car,
                                             double turn, const View& view);

 private:
  struct Look;
  [[nodiscard]] static double before_people(const Look& look);
  [[nodiscard]] static double before_footpath(const Look& look);
  [[nodiscard]] static double before_strangers(const Look& look);
};

}  // namespace mvtp
