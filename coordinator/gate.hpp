#pragma once

#include <map>
#include <optional>
#include <string>

#include "coordinator/traffic.hpp"

namespace mvtp {

/// The way over coordinated junctions for vehicles that keep their own drivers.
///
/// Each is held before its stop line until all vehicles under control have a plan around its
/// passage; then it is let through, whatever signals and right of way say.
class Gate {
 public:
  explicit Gate(Traffic& traffic) : traffic_(traffic) {}

  /// A decision begins: who is not seen until the end of it has gone.
  void begin();
  /// A vehicle with its own driver, `to_line` [m] before its stop line (0: behind it, inside), and
  /// `to_hold` [m] before the place where it can be held: the end of its lane.
  void see(const VehicleState& vehicle, double to_line, double to_hold, const Vehicle& body);
  void end();

  [[nodiscard]] bool passes(const std::string& id) const;
  /// Who waits at its line and may be let through next: each is proposed in turn.
  [[nodiscard]] std::optional<std::string> propose();
  void let_through(const std::string& id);
  /// It is under control now, or on its own again.
  void release(const std::string& id);

 private:
  struct Guest {
    bool passes = false;
    bool held = false;
    bool seen = false;
    bool waits = false;       ///< near its line
    std::int64_t asked = -1;  ///< when it was last proposed
  };

  Traffic& traffic_;
  std::map<std::string, Guest> guests_;
  std::int64_t decisions_ = 0;
};

}  // namespace mvtp
