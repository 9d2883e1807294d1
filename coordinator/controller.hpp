#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/traffic.hpp"

namespace mvtp {

/// One decision, for the record.
struct Replan {
  double time = 0.0;  ///< [s]
  int vehicles = 0;   ///< under control
  int newcomers = 0;
  int forecasts = 0;
  int groups = 0;
  int stepped = 0;        ///< vehicles without a complete plan, moved by PBCR
  bool fallback = false;  ///< late, or refused by the referee: the previous plan was kept
  double cost = 0.0;      ///< [s]
  double ms = 0.0;        ///< wall clock
};

/// Who lets the vehicles of a traffic drive.
class Controller {
 public:
  virtual ~Controller() = default;

  /// One step of the traffic; a decision before it where one is due.
  virtual void step() = 0;
  [[nodiscard]] virtual bool drives(const std::string& id) const = 0;
  /// Does the vehicle stand because it is parked and its stay is not over?
  [[nodiscard]] virtual bool rests(const std::string& /*id*/) const { return false; }
  [[nodiscard]] virtual const std::vector<Replan>& replans() const = 0;
};

/// Leaves all vehicles to their own drivers.
class OwnDrivers : public Controller {
 public:
  explicit OwnDrivers(Traffic& traffic) : traffic_(traffic) {}

  void step() override { traffic_.step(); }
  [[nodiscard]] bool drives(const std::string& /*id*/) const override { return false; }
  [[nodiscard]] bool rests(const std::string& id) const override {
    const std::optional<ParkingStop> stop = traffic_.parking_stop(id);
    return stop && stop->parked;
  }
  [[nodiscard]] const std::vector<Replan>& replans() const override { return replans_; }

 private:
  Traffic& traffic_;
  std::vector<Replan> replans_;
};

}  // namespace mvtp
