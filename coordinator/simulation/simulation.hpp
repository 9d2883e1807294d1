#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coordinator/audit/audit.hpp"
#include "coordinator/controller.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// What there is to see after a step.
struct Snapshot {
  double time = 0.0;                      ///< [s]
  std::span<const Observation> vehicles;  ///< ordered by id
  std::span<const char> resting;          ///< 1 for each of them that is parked or at a stop
  std::span<const Pedestrian> people;
  std::span<const std::string> pending;  ///< vehicles that wait to enter, looked up once a second
};

/// What ends a run before everyone has arrived.
struct RunLimits {
  std::optional<double> end;   ///< [s] simulated
  double stuck_after = 300.0;  ///< [s] in which nobody moves, and nobody rests
  std::function<bool()> interrupted = [] { return false; };
};

/// How a run ended, in the words of summary.json.
enum class RunStatus { kFinished, kEndReached, kInterrupted, kStuck, kFailed };
[[nodiscard]] std::string to_string(RunStatus status);

/// The closed loop. Owns the clock: nobody else steps the traffic.
class Simulation {
 public:
  using Observer = std::function<void(const Snapshot&)>;

  explicit Simulation(Traffic& traffic) : traffic_(traffic), last_motion_(traffic.time()) {}

  void add(Controller& controller) { controllers_.push_back(&controller); }
  /// Observers look at each step in the order in which they were added.
  void add(Observer observer) { observers_.push_back(std::move(observer)); }

  /// Every controller decides, then every controller acts, then the traffic steps, and everyone
  /// looks at what became of it.
  void step();
  /// How the run has ended: a limit is reached, or the last vehicle has arrived; none: it goes on.
  [[nodiscard]] std::optional<RunStatus> end_by(const RunLimits& limits) const;
  /// Steps until the run has ended.
  [[nodiscard]] RunStatus run(const RunLimits& limits);

  [[nodiscard]] const VehicleType& type_of(const std::string& id);
  /// Has type_of() been asked for it?
  [[nodiscard]] bool knows(const std::string& type) const { return types_.contains(type); }

 private:
  [[nodiscard]] Snapshot look();
  /// Does somebody move, or rest for a while, or is nobody there who could?
  [[nodiscard]] static bool is_alive(const Snapshot& frame);

  Traffic& traffic_;
  std::vector<Controller*> controllers_;
  std::vector<Observer> observers_;
  std::map<std::string, VehicleType> types_;
  std::vector<Observation> sightings_;
  std::vector<char> resting_;
  std::vector<std::string> pending_;
  double next_look_at_pending_ = -1e300;  ///< [s]
  double last_motion_ = 0.0;              ///< [s] when somebody last moved or rested
};

}  // namespace mvtp
