#pragma once

#include <map>
#include <string>
#include <vector>

#include "coordinator/lot/lot_coordinator.hpp"
#include "coordinator/lot/lot_report.hpp"
#include "coordinator/report/report.hpp"

namespace mvtp {

/// Watches a parking lot: how full it is, and where vehicles drive.
class LotRecorder {
 public:
  explicit LotRecorder(const LotCoordinator& lot) : lot_(lot) {}

  [[nodiscard]] const ParkingLot& lot() const { return lot_.lot(); }

  /// After each step.
  void observe(double time);

  /// @param at_gate  when each vehicle would have been at the gate with nobody before it [s]
  [[nodiscard]] LotReport report(const std::map<std::string, double>& at_gate) const;

  /// The lot with the trails of all who drove on it, as an SVG picture.
  [[nodiscard]] std::string picture() const;

 private:
  struct Trail {
    bool leaving = false;
    std::vector<Point> points;
  };

  const LotCoordinator& lot_;
  std::vector<Occupied> occupancy_;
  std::map<std::string, std::vector<Trail>> trails_;
  double next_sample_ = 0.0;
  double next_point_ = 0.0;
};

}  // namespace mvtp
