#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "coordinator/drivers/lane_keeping.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// The path over coordinated junctions for vehicles that are not under control.
///
/// Whoever comes without a plan is held before its stop line. Guests, vehicles that keep their own
/// drivers, are let through when all vehicles under control have plans around their passage,
/// whatever signals and right of way say. One that stands before its line nevertheless is held
/// again.
class Gate {
 public:
  /// @param passage  what those need not heed who are let through: where nobody stops for signals
  ///     they pass several lines at once, if there is no room to stop between them, else one.
  Gate(Traffic& traffic, LaneKeeping& keeping, Passage passage)
      : traffic_(traffic), keeping_(keeping), passage_(passage) {}

  /// Where a guest is.
  struct Place {
    int line = -1;           ///< which stop line is the next; -1: none nearby
    double to_line = 0.0;    ///< [m] before it
    double to_hold = 0.0;    ///< [m] before the end of its lane, where it can be held; 0: inside
    bool is_inside = false;  ///< a junction with such lines
    bool leads_on = true;    ///< its lane leads to the next edge of its route
    bool has_room = true;  ///< held at the end of its lane its tail is clear of the junction behind
    bool is_clear = true;  ///< its tail is, where it is now
  };

  /// A decision begins: who is not seen until the end of it has departed.
  void begin();
  /// A guest.
  void see(const VehicleState& vehicle, const Place& place, const Vehicle& body);
  /// Somebody who is to be taken over: stays held if it is.
  void keep(const std::string& id);
  void end();

  /// Until it is released, or is no more seen.
  void hold(const std::string& id);
  [[nodiscard]] bool holds(const std::string& id) const;
  [[nodiscard]] bool passes(const std::string& id) const;
  /// Is it a guest, and held until it is let through?
  [[nodiscard]] bool holds_guest(const std::string& id) const;
  /// Is it a guest who does not stand?
  [[nodiscard]] bool is_under_way(const std::string& id) const;
  /// Could these two meet if both pass?
  using MayMeet = std::function<bool(const std::string&, const std::string&)>;
  /// Is nobody ahead of it on its lane but those who pass?
  using IsFirst = std::function<bool(const std::string&)>;
  /// Held guests who may be let through next, those who were asked for least lately first: as many
  /// as cannot meet each other, nor anybody behind his line; nor one who has been passed over for a
  /// while. Drivers from one lane keep clear of each other.
  [[nodiscard]] std::vector<std::string> propose(const IsFirst& is_first, const MayMeet& may_meet);
  /// It has been asked for: others come first now.
  void asked_for(const std::string& id);
  void let_through(const std::string& id);
  /// It is under control now, or on its own again.
  void release(const std::string& id);
  void release_all();

 private:
  struct Visitor {
    bool guest = false;  ///< else it is to be taken over
    bool passes = false;
    bool held = false;
    bool seen = false;
    bool waits = false;    ///< for its turn, on a lane that leads on
    int line = -1;         ///< for which it was held or let through
    bool is_over = false;  ///< that line
    Place place;
    std::string lane;        ///< the last before a junction
    int stands = 0;          ///< for so many decisions
    int passed_over = 0;     ///< likewise, the first on its lane, for others that it may meet
    std::int64_t asked = 0;  ///< when it was last asked for, or came
  };

  [[nodiscard]] const Visitor* find(const std::string& id) const;  ///< nullptr: there is none
  void decide(const std::string& id, Visitor& guest, double room);
  void keep_in_lane(const std::string& id, const Visitor& guest);

  Traffic& traffic_;
  LaneKeeping& keeping_;
  Passage passage_;
  std::map<std::string, Visitor> visitors_;
  std::int64_t decisions_ = 0;
};

}  // namespace mvtp
