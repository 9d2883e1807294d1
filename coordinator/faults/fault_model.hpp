#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planner/road.hpp"

namespace mvtp {

/// How messages get through the air, one way. They are sent again at every step.
struct ChannelModel {
  double delay = 0.0;  ///< [s]
  double loss = 0.0;   ///< share of the messages that do not arrive, 0 ... < 1
};

/// How far vehicles and messages are from what the coordinator believes of them. Deviations are
/// first-order autoregressive, and never more than kMostDeviations standard deviations.
struct FaultModel {
  static constexpr double kMostDeviations = 3.0;
  /// Of the along-track error so much is across: steering keeps to the lane better than speed keeps
  /// to time.
  static constexpr double kAcross = 0.3;

  ChannelModel command;    ///< plans on their way to vehicles
  ChannelModel report;     ///< states on their way from vehicles
  double position = 0.0;   ///< [m] standard deviation of reported positions, along and across
  double heading = 0.0;    ///< [rad] the same of reported headings
  double actuation = 0.0;  ///< [m] the same of where a vehicle is and where its plan has it

  [[nodiscard]] bool is_exact() const {
    return command.delay == 0.0 && command.loss == 0.0 && report.delay == 0.0 &&
           report.loss == 0.0 && position == 0.0 && heading == 0.0 && actuation == 0.0;
  }
};

/// What a coordinator has to reckon with under a declared FaultModel. It follows from the model
/// alone.
struct FaultTolerance {
  int lead = 0;               ///< steps from a decision until every vehicle follows it
  double age = 0.0;           ///< [s] of the oldest report
  Margins more = {0.0, 0.0};  ///< what the safety distances grow by
  double off = 0.0;   ///< [m] by which a report may differ from the plan of a vehicle that obeys
  bool exact = true;  ///< nothing of all this

  [[nodiscard]] double latency(double dt) const { return lead * dt + age; }
};

/// @param dt  [s] between two messages.
/// @param longest  [m] of the bodies concerned, for noise of headings.
[[nodiscard]] FaultTolerance tolerance_of(const FaultModel& declared, double dt, double longest);

/// A vehicle that does something else than it is told.
struct VehicleFault {
  enum class Kind { kStops, kIgnores };
  Kind kind = Kind::kStops;
  std::string id;
  double time = 0.0;  ///< [s] from which on
};

/// All that goes wrong in a run.
struct FaultPlan {
  FaultModel model;
  std::vector<VehicleFault> vehicles;
  double stop_share = 0.0;          ///< of the vehicles stop dead inside a junction, by seed
  double ignore_share = 0.0;        ///< of the vehicles ignore their plans there, by seed
  double stop_duration = 60.0;      ///< [s] until one that stopped dead has its driver again
  double late_share = 0.0;          ///< of the decisions come too late
  std::optional<double> sumo_ends;  ///< [s] when the traffic stops working
  std::uint64_t seed = 0;

  [[nodiscard]] bool is_none() const {
    return model.is_exact() && vehicles.empty() && stop_share == 0.0 && ignore_share == 0.0 &&
           late_share == 0.0 && !sumo_ends;
  }
};

/// Something that went wrong, and when.
struct FaultEvent {
  std::int64_t frame = 0;  ///< steps of the traffic since the begin
  double time = 0.0;       ///< [s]
  std::string vehicle;
  std::string what;
};

/// What went wrong in a run.
struct FaultFigures {
  std::int64_t commands = 0;  ///< messages sent,
  std::int64_t commands_lost = 0;
  std::int64_t reports = 0;
  std::int64_t reports_lost = 0;
  double largest_deviation = 0.0;  ///< [m] of a vehicle from its plan
  std::vector<FaultEvent> events;
};

}  // namespace mvtp
