#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "coordinator/lane_graph.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// How long lights show what, in seconds.
struct SignalTiming {
  bool has_yellow = true;
  double all_red = 1.0;      ///< between the end of a yellow and a green that crosses it
  double least_green = 5.0;  ///< netconvert's --tls.min-dur
  double most_green = 50.0;  ///< while somebody waits; netconvert's --tls.max-dur

  /// Lights as they stand in the street.
  [[nodiscard]] static SignalTiming real() { return {}; }
  /// Lights that turn at once, for comparison with the literature.
  [[nodiscard]] static SignalTiming instant() { return {false, 0.0, 0.0, 50.0}; }

  /// [s] by the speed limit of the lane [m/s]: 3 s up to 50 km/h, 4 s up to 60, 5 s above [RiLSA].
  [[nodiscard]] double yellow(double speed_limit) const;
};

/// The traffic signals that the coordinator owns: one light per connection, red unless it says
/// otherwise. A signal is owned if all its lights are those of connections at coordinated
/// junctions.
class SignalHeads {
 public:
  /// @param graph  must outlive it.
  SignalHeads(Traffic& traffic, const LaneGraph& graph, const std::vector<bool>& coordinated,
              const SignalTiming& timing);

  [[nodiscard]] const SignalTiming& timing() const { return timing_; }
  [[nodiscard]] bool owns(int link) const { return heads_[std::size_t(link)].owned; }
  [[nodiscard]] bool owns_any() const { return !signals_.empty(); }
  [[nodiscard]] Light light(int link) const { return heads_[std::size_t(link)].light; }
  /// For how long it has shown that [s].
  [[nodiscard]] double shown_for(int link) const;
  /// Do vehicles on these two connections meet? Not those that come from one lane.
  [[nodiscard]] bool cross(int link, int other) const;
  /// Has every light that crosses it been red for long enough?
  [[nodiscard]] bool may_turn_green(int link) const;

  /// Every light red; and again after free().
  void own();
  void turn_green(int link);
  /// Yellow, then red.
  void end_green(int link);
  /// Yellow lights turn red when it is time.
  void advance();
  /// The signals run their own programs.
  void free();
  [[nodiscard]] bool is_free() const { return free_; }

  [[nodiscard]] std::int64_t greens() const { return greens_; }

 private:
  struct Head {
    bool owned = false;
    Light light = Light::kRed;
    double since = -1e300;  ///< [s]
    std::vector<int> crossing;
  };
  void show(int link, Light light);

  Traffic& traffic_;
  const LaneGraph& graph_;
  SignalTiming timing_;
  std::vector<Head> heads_;  ///< by link
  std::set<std::string> signals_;
  bool free_ = true;
  std::int64_t greens_ = 0;
};

}  // namespace mvtp
