#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "coordinator/network/road_network.hpp"
#include "coordinator/traffic.hpp"
#include "tests/coordinator/network_maker.hpp"

namespace mvtp {

/// Four arms with one lane each way, right-hand traffic, junction "C" in the middle.
///
///                |   ^            Edges "W_in", "W_out", ...; lanes "W_in_0", ...
///        <-------+   +-------     Arms W, S, E, N; the next one counter-clockwise is to the right
///        ------->+   +------->    of a vehicle that comes in.
///                v   |
[[nodiscard]] RoadNetwork make_crossroads(double arm = 200.0);

/// A network with the edges on which vehicles come and go, and where they may want to go between.
struct NetworkShape {
  std::string name;
  RoadNetwork network;
  std::vector<std::string> sources;
  std::vector<std::string> sinks;
  /// Of its signals, as far as they are known.
  std::map<std::string, std::vector<SignalPhase>> programs = {};
};

/// Adds a junction "C" at the origin with the arms "W", "S", "E", "N", where vehicles come and go.
void add_crossroads(NetworkMaker& maker, NetworkShape& shape, double arm = 120.0,
                    double radius = 7.2);
[[nodiscard]] NetworkShape crossroads_shape(double arm = 120.0, double radius = 7.2);
/// Nine crossroads in three rows, between them 21 to 45 m of road.
[[nodiscard]] NetworkShape grid_shape();
[[nodiscard]] NetworkShape t_shape(double radius = 7.2);
[[nodiscard]] NetworkShape five_arms_shape();
/// Four arms around a one-way ring of edges of about 16 m.
[[nodiscard]] NetworkShape roundabout_shape();
/// Two crossroads, so far from middle to middle.
[[nodiscard]] NetworkShape chain_shape(double radius = 7.2, double apart = 40.0);
/// Crossroads with two lanes each way: the left one leads to the left only.
[[nodiscard]] NetworkShape two_lanes_shape();
[[nodiscard]] NetworkShape left_hand_shape();
/// Crossroads of which the arms are 20, 16, 12 and 9 m long.
[[nodiscard]] NetworkShape short_arms_shape();
/// A T junction where vehicles may also turn round.
[[nodiscard]] NetworkShape u_turn_shape();
/// A crossroads A, and `behind` metres behind it a bend B of a road on which nobody meets anybody,
/// whose lanes may be marked as slow as such a bend is.
[[nodiscard]] NetworkShape bend_behind_shape(double behind, bool marked = true);
/// Crossroads; just before them the western arm, from `west`, has a small node without conflicts,
/// by default in a bend.
[[nodiscard]] NetworkShape seam_shape(Point west = {-90, 60}, Point seam = {-30, 0},
                                      double radius = 5.0);
/// Crossroads with a one-way road out that forks, without conflicts, just behind them.
[[nodiscard]] NetworkShape fork_shape();

/// W ---- C ====(2 lanes)==== E, with a road to the south at C. The only lane from the west leads
/// onto either lane to the east.
[[nodiscard]] NetworkShape fan_out_shape();

/// The same with a traffic signal at every junction with conflicts, named as that.
[[nodiscard]] NetworkShape with_signals(NetworkShape shape);
/// The crossroads with a signal whose two green phases are known: west and east, then south and
/// north; left-turners yield.
[[nodiscard]] NetworkShape crossroads_with_phases();

/// The same with a crossing over every road that leads both ways into a junction with conflicts,
/// right behind its stop line; under the signal where there is one.
[[nodiscard]] NetworkShape with_crossings(NetworkShape shape);

/// A shape that is made when it is asked for: each test has a process of its own, and needs few.
struct NamedShape {
  std::string name;
  NetworkShape (*make)() = nullptr;
};

[[nodiscard]] const std::vector<NamedShape>& all_shapes();
/// Those where bodies of 12 and 18 m can turn.
[[nodiscard]] const std::vector<NamedShape>& roomy_shapes();

}  // namespace mvtp
