#pragma once

#include <span>
#include <vector>

#include "coordinator/traffic.hpp"
#include "planner/algorithms/lot_motion.hpp"
#include "planner/algorithms/lot_planner.hpp"
#include "planner/problem/parking_lot.hpp"

namespace mvtp {

/// Looks ahead for those whom no plan knows: people on foot and vehicles with their own drivers.
///
/// People are expected to go on as they walk now. A car stops before ground where somebody will be
/// while it is there. Footpaths are kept clear: a car enters one only if it can leave it again at
/// once and nobody comes; people walk on, whatever stands there.
class LotLookout {
 public:
  /// @param lot  in the frame in which cars and people are given
  explicit LotLookout(const ParkingLot& lot);

  struct View {
    std::span<const Pedestrian> people;
    std::span<const StandingCar> strangers;
    bool footpaths = true;  ///< do people use them?
  };

  /// How far the car may drive for now [m]; infinity: anywhere.
  /// @param turn_ends  how far the other cars let it, LotMotion::turn_ends
  /// @param patient    false: it has waited long at a footpath; only people count there now
  [[nodiscard]] double halt(const LotCar& car, double turn_ends, const LotLimits& limits,
                            const View& view, bool patient) const;

 private:
  struct Look;
  [[nodiscard]] bool on_footpath(const LotCar& car, int cell) const;
  [[nodiscard]] double before_people(const Look& look) const;
  [[nodiscard]] double before_footpath(const Look& look, double turn_ends, bool patient) const;
  [[nodiscard]] static double before_strangers(const Look& look);

  struct Strip {
    BoxPose pose;
    BoxShape shape;
  };
  std::vector<Strip> strips_;
};

}  // namespace mvtp
