#pragma once

#include <string>

namespace mvtp {

/// What a traffic may have its human drivers do wrong, beside what Traffic offers already.
class HumanFaultPort {
 public:
  virtual ~HumanFaultPort() = default;

  /// Changes to the lane beside him within a second, whoever is there: to the left, or else to the
  /// right; where there is none he stays.
  virtual void swerve(const std::string& id) = 0;
  /// Reacts only so often [s]; 0: at every step.
  virtual void react_late(const std::string& id, double seconds) = 0;
};

}  // namespace mvtp
