#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/network/road_network.hpp"
#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_log.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// The routes of vehicles: as they are, and as far as SUMO knows them.
///
/// SUMO takes a vehicle that we place for one on the nearest lane of its whole route, edges that it
/// has left included. Where a route comes to a junction twice, that may be another lane than the
/// one it drives on, and an assertion fails. Of such a route SUMO only knows a piece at a time.
class SumoRoutes {
 public:
  /// @param network, log  must outlive it.
  SumoRoutes(const RoadNetwork& network, SumoLog& log);

  /// The edges of the rest of the route, the one that the vehicle is on first; looked up once for
  /// each `time`, valid until the next.
  [[nodiscard]] std::span<const std::string> rest(const std::string& id, double time) const;

  /// How much of the rest of the route SUMO should know for a vehicle that is placed along `edges`,
  /// in edges; 0: all of it, as now.
  [[nodiscard]] std::size_t length_to_cut(const std::string& id, std::span<const std::string> edges,
                                          double time) const;
  /// Lets SUMO know the first edges of the rest only: at most `length`, and none that come to a
  /// junction that others of them have come to. Where SUMO refuses that, nothing changes.
  void cut(const std::string& id, std::size_t length, double time);
  /// Is it time for the next piece? How long it is, in edges of the rest; else 0.
  [[nodiscard]] std::size_t next_cut(const std::string& id, double time) const;
  [[nodiscard]] bool is_cut(const std::string& id) const { return cuts_.contains(id); }
  /// Lets SUMO know the whole rest again, and the stops on it. Returns whether SUMO accepts it.
  bool restore(const std::string& id, double time);

  /// See Traffic::detour.
  bool detour(const std::string& id);

  /// The stops that SUMO does not know because they lie behind the piece that it knows.
  [[nodiscard]] std::vector<libsumo::TraCINextStopData> stops_behind(const std::string& id) const;

  void forget(const std::string& id);

 private:
  /// A route under SUMO's name for it: it never gives two different ones the same.
  struct Route {
    std::string name;
    std::vector<std::string> edges;
    std::size_t done = 0;  ///< edges that the vehicle has left
    double seen = -1.0;    ///< [s] simulated time of the last look at it
  };

  struct Cut {
    std::string name;               ///< of what SUMO knows
    std::vector<std::string> rest;  ///< the true rest, from the first edge that SUMO knows
    std::size_t known = 0;          ///< edges of it that SUMO knows,
    std::size_t base = 0;           ///< and the index of the first of them in SUMO's route
    std::size_t length = 0;         ///< edges of it along which the vehicle will be placed
    std::vector<libsumo::TraCINextStopData> stops;  ///< behind those that SUMO knows
  };

  void look(const std::string& id, Route& route) const;
  void take_over_detour(const std::string& id, const std::string& name, Cut& cut) const;
  [[nodiscard]] bool meets_itself(const Route& route) const;
  [[nodiscard]] std::size_t clear_length(std::span<const std::string> edges) const;
  [[nodiscard]] bool is_near_end(const std::string& id) const;
  [[nodiscard]] std::vector<std::string> edges_after(const std::string& lane) const;
  [[nodiscard]] bool give(const std::string& id, const std::string& name);
  const std::string& name_of(const std::vector<std::string>& edges);

  const RoadNetwork& network_;
  SumoLog& log_;
  /// The junctions where each edge begins and ends; "" where the network ends.
  std::map<std::string, std::pair<std::string, std::string>> ends_;
  mutable std::map<std::string, Route> routes_;  ///< by vehicle
  mutable std::map<std::string, Cut> cuts_;      ///< likewise
  mutable std::map<std::string, bool> meeting_;  ///< by the name of a route
  std::map<std::vector<std::string>, std::string> names_;
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
