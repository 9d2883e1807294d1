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
  bool fallback = false;  ///< some kept the previous plan: this one was late, or led to contacts
  double cost = 0.0;      ///< [s]
  double ms = 0.0;        ///< wall clock
};

/// Something that the controller leaves to the traffic's drivers, and why.
struct LeftToTraffic {
  std::string what;  ///< e.g. "junction C", "lane W_0 to E_1 for type bus"
  std::string why;
};

/// Junctions whose vehicles are planned together.
struct ZoneFigures {
  std::vector<std::string> junctions;  ///< ids
  int corridors = 0;                   ///< paths through them
};

/// Who lets some of the vehicles of a traffic drive. Several may control one traffic: each takes
/// over other vehicles. The Simulation steps the traffic, nobody else does.
class Controller {
 public:
  virtual ~Controller() = default;

  /// Before a step of the traffic: decides where a decision is due.
  virtual void decide() = 0;
  /// After every controller has decided: says to the traffic what happens in the step.
  virtual void act() = 0;
  /// After the step: looks at what became of it.
  virtual void observe() {}
  [[nodiscard]] virtual bool drives(const std::string& id) const = 0;
  /// Does the vehicle stand because it is parked and its parking event is not over?
  [[nodiscard]] virtual bool rests(const std::string& /*id*/) const { return false; }
  [[nodiscard]] virtual const std::vector<Replan>& replans() const = 0;
  /// For the record: what is planned together, and what is not planned at all.
  [[nodiscard]] virtual std::vector<ZoneFigures> zones() const { return {}; }
  [[nodiscard]] virtual std::vector<LeftToTraffic> left_to_sumo() const { return {}; }
};

/// Leaves all vehicles to human drivers.
class HumanDriversOnly : public Controller {
 public:
  void decide() override {}
  void act() override {}
  [[nodiscard]] bool drives(const std::string& /*id*/) const override { return false; }
  [[nodiscard]] const std::vector<Replan>& replans() const override { return replans_; }

 private:
  std::vector<Replan> replans_;
};

}  // namespace mvtp
