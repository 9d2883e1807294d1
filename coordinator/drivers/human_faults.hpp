#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "coordinator/controller.hpp"
#include "coordinator/drivers/controlled_share.hpp"
#include "coordinator/drivers/human_fault_port.hpp"

namespace mvtp {

/// How a human driver misbehaves.
enum class HumanFaultKind {
  kRedRunner,     ///< heeds no signal and no right of way on his way over a junction
  kDeadStop,      ///< brakes to a stop as hard as he can and stands for a while
  kSwerve,        ///< changes to the lane beside him at once, whoever is there
  kLateReaction,  ///< reacts only every second and a half on his way over a junction
};
[[nodiscard]] std::string to_string(HumanFaultKind kind);

/// One that happened.
struct HumanFault {
  std::string vehicle;
  HumanFaultKind kind = HumanFaultKind::kRedRunner;
  double begin = 0.0;  ///< [s]
};

struct HumanFaultOptions {
  double rate = 0.0;       ///< share of the human drivers who misbehave once, 0 ... 1
  std::uint64_t seed = 0;  ///< another one draws others
  ControlledShare humans;  ///< whoever is not in it is a human driver
  /// The lanes before coordinated lines: there they misbehave.
  std::vector<std::string> lanes;
};

/// Has some of the human drivers misbehave, drawn by a hash of id and seed. Nobody who controls
/// others is told: what they do about it is what is measured.
class HumanFaults : public HumanDriversOnly {
 public:
  /// @param port  of the same traffic.
  HumanFaults(Traffic& traffic, HumanFaultPort& port, HumanFaultOptions options);

  void decide() override;

  [[nodiscard]] const std::vector<HumanFault>& faults() const { return faults_; }

 private:
  struct Ongoing {
    HumanFaultKind kind = HumanFaultKind::kRedRunner;
    double end = 0.0;  ///< [s]
  };
  void begin(const VehicleState& vehicle);
  void finish(const std::string& id, HumanFaultKind kind);
  [[nodiscard]] bool misbehaves(const VehicleState& vehicle) const;
  [[nodiscard]] double draw(const std::string& id, const char* what) const;

  Traffic& traffic_;
  HumanFaultPort& port_;
  HumanFaultOptions options_;
  std::map<std::string, double> ends_;  ///< of the lanes [m]
  std::map<std::string, Ongoing> ongoing_;
  std::map<std::string, HumanFaultKind> done_;
  std::vector<HumanFault> faults_;
};

}  // namespace mvtp
