#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "coordinator/audit/audit.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {

/// Who drives through a shape: vehicles that enter at random moments between random ends.
struct Demand {
  int vehicles = 24;
  double duration = 40.0;                    ///< [s] in which they enter
  std::vector<std::string> types = {"car"};  ///< drawn from these
  bool guests = true;                        ///< also those whose bodies cannot drive their route
  unsigned seed = 1;
};
[[nodiscard]] std::vector<FakeTrip> random_trips(const NetworkShape& shape, const Demand& demand);

/// How far two bodies overlap along the axis on which they do so least, by the theorem of
/// separating axes on their corners [m]; negative: a distance between them. Shares nothing with the
/// code tested.
[[nodiscard]] double overlap(const Pose& a, const Vehicle& body_a, const Pose& b,
                             const Vehicle& body_b);

/// The pose at a share of a step, with a constant turn along the chord.
[[nodiscard]] Pose between(const Pose& from, const Pose& to, double share);

/// A run of the closed loop that is watched at every step. What it finds against a law is said in
/// `broken`, in words.
class ClosedLoop {
 public:
  ClosedLoop(const NetworkShape& shape, std::vector<FakeTrip> trips, double step_length = 0.1,
             const CoordinatorOptions& options = {});

  void step();
  /// Until everybody has arrived or `end` [s].
  void run_until(double end);

  FakeTraffic traffic;
  DrivableArea area;
  Coordinator coordinator;
  Audit audit;
  int number_of_trips = 0;
  int taken_over = 0;  ///< so far
  int handed_back = 0;
  std::vector<std::string> broken;

 private:
  /// A vehicle after a step.
  struct Seen {
    Pose pose;
    double speed = 0.0;
    bool driven = false;
    std::string lane;
  };

  void look();
  void look_at_motion(const VehicleState& v, const Seen& before, const Seen& now);
  void look_for_contacts(const std::map<std::string, Seen>& now);
  void look_at_braking();
  [[nodiscard]] double leaves_at(const Driven& driven) const;
  void look_at_hand_backs();
  [[nodiscard]] const Vehicle& body(const std::string& type);
  [[nodiscard]] std::string words(const std::string& id, const Seen& seen) const;
  void report(const std::string& what, const std::string& who, double value);

  Simulation simulation_{traffic};
  LaneGraph graph_{traffic.network()};
  std::map<std::string, VehicleType> types_;
  std::map<std::string, Seen> last_;
  std::map<std::string, std::string> type_of_;
};

}  // namespace mvtp
