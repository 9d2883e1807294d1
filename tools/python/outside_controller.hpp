#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coordinator/controller.hpp"
#include "tools/python/traffic_door.hpp"

namespace mvtp {

/// A controller that is written in Python, or the part of it that is the same for all: vehicles
/// that were taken over are its own. By itself it does nothing, and its user drives from outside.
class OutsideController : public Controller {
 public:
  void decide() override {}
  void act() override {}
  [[nodiscard]] bool drives(const std::string& id) const override {
    return door_ != nullptr && door_->open().is_taken_over(id);
  }
  [[nodiscard]] const std::vector<Replan>& replans() const override { return replans_; }

  /// Before the first step.
  void plug_into(std::shared_ptr<TrafficDoor> door) { door_ = std::move(door); }
  /// @throws InputError before that
  [[nodiscard]] std::shared_ptr<TrafficDoor> traffic() const {
    if (!door_) throw InputError("controller", "has no traffic yet; give it to mvtp.Simulation");
    return door_;
  }

 private:
  std::shared_ptr<TrafficDoor> door_;
  std::vector<Replan> replans_;
};

}  // namespace mvtp
