#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "coordinator/audit/audit.hpp"
#include "coordinator/drivers/human_faults.hpp"

namespace mvtp {

/// An overlap of a vehicle under control with a human driver, and what could have been done.
struct HumanOverlap {
  double time = 0.0;  ///< [s] simulated: the frame of the replay
  std::string controlled;
  std::string human;
  std::string fault;        ///< of the human driver; empty: he kept to the rules
  double seen_since = 0.0;  ///< [s] simulated: since when the fault, or the vehicle, could be seen
  bool avoidable = false;   ///< by full braking from then on
};

/// Looks back at each overlap of a vehicle under control with a human driver: had the vehicle
/// braked fully from the moment at which the fault could be seen, on the path that it drove, would
/// the two have overlapped, the human driving as he did? Who keeps to the rules can be seen for
/// `kMemory` seconds.
class BrakingAnalysis {
 public:
  static constexpr double kMemory = 12.0;  ///< [s]

  explicit BrakingAnalysis(double step_length) : dt_(step_length) {}

  /// After each step. @param events  all that the audit has found until now.
  void observe(double time, std::span<const Observation> observations,
               std::span<const HumanFault> faults, std::span<const AuditEvent> events);

  [[nodiscard]] const std::vector<HumanOverlap>& overlaps() const { return overlaps_; }

 private:
  struct Moment {
    double time = 0.0;
    Pose pose;
    double speed = 0.0;
  };
  struct Track {
    Vehicle body;
    bool coordinated = false;
    std::deque<Moment> moments;  ///< the oldest first
  };
  void remember(double time, std::span<const Observation> observations);
  void judge(double time, const std::string& controlled, const std::string& human,
             std::span<const HumanFault> faults);
  [[nodiscard]] bool could_stop(const Track& ours, const Track& human, double seen_since) const;

  double dt_;
  std::map<std::string, Track> tracks_;
  std::size_t looked_at_ = 0;  ///< events of the audit
  std::vector<HumanOverlap> overlaps_;
};

}  // namespace mvtp
