#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/instance.hpp"

namespace mvtp {

/// A lane of a road network, normal or inside a junction (internal).
struct Lane {
  std::string id;
  std::string edge;                                   ///< id of the edge it belongs to
  int index = 0;                                      ///< on its edge, 0 = rightmost
  double speed_limit = 13.89;                         ///< [m/s]
  std::optional<double> posted_limit = std::nullopt;  ///< [m/s], if `speed_limit` was lowered
  double length = 0.0;  ///< [m]; may differ from the length of the centre line
  double width = 3.2;   ///< [m]
  bool internal = false;
  bool drivable = true;      ///< open to passenger traffic
  bool road = true;          ///< open to motor vehicles of some kind, e.g. to buses only
  bool footpath = false;     ///< open to people on foot only
  std::vector<Point> shape;  ///< centre line [m]
  /// SUMO's vClass words: who may drive here if any are named; else all but those banned.
  std::vector<std::string> allowed;
  std::vector<std::string> banned;

  /// Never raises it.
  void lower_limit(double speed) {
    if (speed >= speed_limit) return;
    posted_limit = posted_limit.value_or(speed_limit);
    speed_limit = speed;
  }

  /// May vehicles of this class drive here?
  [[nodiscard]] bool allows(const std::string& vehicle_class) const {
    if (vehicle_class == "ignoring") return true;
    const auto names = [&](const std::vector<std::string>& words) {
      return std::ranges::any_of(
          words, [&](const auto& word) { return word == "all" || word == vehicle_class; });
    };
    return allowed.empty() ? !names(banned) : names(allowed);
  }
};

/// One path across a junction: from a normal lane over its internal lanes to the next normal lane.
struct Connection {
  std::string from_lane;
  std::vector<std::string> via;  ///< the chain of internal lanes, in driving order; may be empty
  std::string to_lane;
  std::string signal = {};  ///< id of the traffic signal that it obeys; empty: none
  int signal_index = -1;    ///< which of the signal's lights
};

/// A marked path for people on foot over the lanes at a junction.
struct PedestrianCrossing {
  std::string id;                      ///< of its edge
  double width = 4.0;                  ///< [m]
  std::vector<Point> shape;            ///< its middle, from kerb to kerb [m]
  bool has_priority = false;           ///< vehicles give way on it, as on a zebra
  std::vector<std::string> ends = {};  ///< the edges where people wait for it, two at most
  std::string signal = {};             ///< id of the traffic signal that it obeys; empty: none
  std::vector<int> lights;             ///< which of the signal's lights
};

struct Junction {
  std::string id;
  std::string type;  ///< "priority", "traffic_light", "dead_end", ...
  Point position;
  Polygon shape;  ///< not closed
  std::vector<std::string> incoming_lanes;
  std::vector<Connection> connections;
  std::vector<PedestrianCrossing> crossings;  ///< in the order of the network
  /// Do two of its connections cross or merge (come from different lanes and share ground)?
  bool has_conflicts = false;
};

/// The geometry and topology of a road network, in metres; ordered by id throughout.
struct RoadNetwork {
  std::map<std::string, Lane> lanes;
  std::map<std::string, Junction> junctions;
  /// lanes of each normal edge, rightmost first
  std::map<std::string, std::vector<std::string>> edges;
  /// How many lights each traffic signal has, those of people on foot included.
  std::map<std::string, int> signals;
  bool left_hand = false;       ///< traffic keeps to the left
  bool opposite_lanes = false;  ///< drivers may overtake in the lane of the other direction
};

}  // namespace mvtp
