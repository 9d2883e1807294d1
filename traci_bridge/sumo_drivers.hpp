#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "coordinator/traffic.hpp"
#include "traci_bridge/sumo_api.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// The speed and lane-change modes in which SUMO corrects neither the commanded pose nor the speed.
inline constexpr int kObey = 0;

/// What the drivers of SUMO are told to do otherwise than they would.
class SumoDrivers {
 public:
  /// See Traffic for what each of these asks for.
  void let_through(const std::string& id, Passage passage);
  void rely_on_signal(const std::string& id, const std::vector<std::string>& waiting);
  void keep_lane(const std::string& id, bool keep);
  static void swap_lanes(const std::string& id, const std::string& other);
  void swerve(const std::string& id);
  void react_late(const std::string& id, double seconds);
  void cap_speed(const std::string& id, double speed);

  /// One who stands does not set off (true), nor is he slowed down for a stop; he may change lanes.
  void stand_still(const std::string& id, bool stand);
  [[nodiscard]] bool stands_still(const std::string& id) const { return still_.contains(id); }

  [[nodiscard]] bool relies_on_signal(const std::string& id) const { return relying_.contains(id); }
  [[nodiscard]] bool keeps_lane(const std::string& id) const { return lane_keepers_.contains(id); }

  /// The vehicle's own mode, even while it is let through.
  [[nodiscard]] static int own_speed_mode(const std::string& id);
  /// The vehicle's own mode, even if it has not got it back yet; it will not get it back.
  [[nodiscard]] int take_lane_change_mode(const std::string& id);
  /// The driver of a vehicle that was handed back now changes lanes again after a while.
  void change_lanes_again(const std::string& id, int mode, double now);
  /// To be called before each step.
  void resume_lane_changes(double now);

  void forget_if(const std::function<bool(const std::string&)>& has_left);

 private:
  /// When a vehicle that was handed back may change lanes again, and in which mode.
  struct Resumption {
    double time = 0.0;  ///< [s]
    int mode = 0;
  };

  std::map<std::string, double> caps_;  ///< [m/s]
  std::set<std::string> still_;         ///< who are not to set off
  std::map<std::string, Resumption> lane_changes_;
  std::set<std::string> relying_;            ///< on protected greens
  std::map<std::string, int> lane_keepers_;  ///< their own lane-change modes
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
