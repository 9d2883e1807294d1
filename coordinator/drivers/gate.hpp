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
    double to_hold = -1.0;   ///< [m] before the end of its lane, where it can be held; < 0: inside
    bool is_inside = false;  ///< a junction with such lines
    bool leads_on = true;    ///< its lane leads to the next edge of its route
    bool has_room = true;  ///< held at the end of its lane its tail is clear of the junction behind
    bool is_clear = true;  ///< its tail is, where it is now
    bool is_between = false;  ///< two junctions so near to each other that plans lead over both
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
  /// Two who might meet.
  struct Pair {
    const std::string& id;       ///< is to pass
    const std::string& other;    ///< passes too, but
    bool other_stays = false;    ///< this one before its line
    bool from_one_lane = false;  ///< they follow each other as long as they have one path
  };
  using MayMeet = std::function<bool(const Pair&)>;
  /// Would the first, held so many metres [m] further on, stand on the path of the second, or of
  /// somebody with a plan?
  using Blocks = std::function<bool(const std::string&, double, const std::string&)>;
  /// Is nobody ahead of it on its lane but those who pass?
  using IsFirst = std::function<bool(const std::string&)>;
  /// Has it to wait for people on foot?
  using WaitsForPeople = std::function<bool(const std::string&)>;
  /// What stands between guests and their passage.
  struct Surroundings {
    IsFirst is_first;
    MayMeet may_meet;
    Blocks blocks;
    WaitsForPeople waits_for_people = [](const std::string&) { return false; };
  };
  /// Held guests who may be let through next, those who were asked for least lately first: as many
  /// as cannot meet each other, nor anybody behind his line; nor one who has been passed over for a
  /// while. Who has to wait for people keeps no other guest waiting before he has been. Before
  /// that, of those who pass and would meet, one is held.
  [[nodiscard]] std::vector<std::string> propose(const Surroundings& surroundings);
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
    bool can_stop = true;  ///< before the end of its lane
    bool waits = false;    ///< for its turn, on a lane that leads on
    bool goes_on = false;  ///< over the next line, before which it could be held still
    bool may_go = false;   ///< over its line, as far as those ahead of it allow
    int line = -1;         ///< for which it was held or let through
    bool is_over = false;  ///< that line
    Place place;
    std::string lane;        ///< the last before a junction
    int stands = 0;          ///< for so many decisions
    int passed_over = 0;     ///< likewise, the first on its lane, for others that it may meet
    std::int64_t asked = 0;  ///< when it was last asked for, or came
    std::int64_t since = 0;  ///< when it was let through

    /// Is the other one behind it on its lane, and gets nowhere before it does?
    [[nodiscard]] bool is_followed_by(const Visitor& other) const {
      return place.to_hold >= 0.0 && lane == other.lane && place.to_hold < other.place.to_hold;
    }
  };
  using Entry = std::map<std::string, Visitor>::value_type;

  [[nodiscard]] const Visitor* find(const std::string& id) const;  ///< nullptr: there is none
  void decide(const std::string& id, Visitor& guest, double room);
  void hold_who_would_meet(const Surroundings& surroundings);
  void keep_in_lane(const std::string& id, const Visitor& guest);

  Traffic& traffic_;
  LaneKeeping& keeping_;
  Passage passage_;
  std::map<std::string, Visitor> visitors_;
  std::int64_t decisions_ = 0;
};

}  // namespace mvtp
