#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "coordinator/network/lane_graph.hpp"
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

/// Green for those who give way to others with green: SUMO's 'g'.
inline constexpr Light kYieldingGreen{'g'};

/// The traffic signals that the coordinator owns: one light per connection and per crossing, red
/// unless it says otherwise. A signal is owned if all its lights are those of connections and
/// crossings at coordinated junctions.
///
/// Lights go by the numbers of their links; those of crossings by light_of_crossing().
class SignalHeads {
 public:
  static constexpr double kWalking = 1.2;  ///< [m/s] of people over a crossing [RiLSA]

  /// @param graph  must outlive it.
  SignalHeads(Traffic& traffic, const LaneGraph& graph, const std::vector<bool>& coordinated,
              const SignalTiming& timing);

  [[nodiscard]] const SignalTiming& timing() const { return timing_; }
  [[nodiscard]] int light_of_crossing(int crossing) const { return graph_.links() + crossing; }
  [[nodiscard]] bool owns(int light) const { return heads_[std::size_t(light)].owned; }
  [[nodiscard]] bool owns_any() const { return !signals_.empty(); }
  [[nodiscard]] Light light(int link) const { return heads_[std::size_t(link)].light; }
  /// Is each of these green, and is there one?
  [[nodiscard]] bool all_show_green(std::span<const int> links) const;
  /// Was it shown last as green for those who give way?
  [[nodiscard]] bool yields(int link) const { return heads_[std::size_t(link)].yields; }
  /// For how long it has shown that [s].
  [[nodiscard]] double shown_for(int link) const;
  /// Do those meet who have these two lights? Not vehicles that come from one lane, nor people.
  [[nodiscard]] bool cross(int link, int other) const;
  /// Has every light that crosses it been red for long enough, is no green of theirs due, and at
  /// real timing nobody on a crossing of theirs?
  /// @param beside  lights that may be green beside it though they cross.
  [[nodiscard]] bool may_turn_green(
      int link, const std::function<bool(int)>& beside = [](int) { return false; }) const;
  /// How long people need to the other side [s].
  [[nodiscard]] double crossing_time(int crossing) const {
    return graph_.crossing(crossing).length / kWalking;
  }

  /// People have waited at a crossing since this step: those who cross it and came later wait.
  void call(int crossing, std::int64_t since);
  /// A crossing gets its green soon: no light that crosses it does so before.
  void reserve(int crossing, bool reserved);
  /// Is somebody on the crossing? At real timing no light that crosses it turns green then.
  void occupy(int crossing, bool occupied);
  /// People are expected on the crossing until then [s].
  void expect_people(int crossing, double until);
  /// Until when lights of crossings and people on them keep this light red [s].
  /// @param beside  lights that may be green beside it though they cross.
  [[nodiscard]] double barred_until(
      int link, const std::function<bool(int)>& beside = [](int) { return false; }) const;
  /// Is somebody before them who came at this step and want this light?
  [[nodiscard]] bool is_called_before(int link, std::int64_t came) const;

  /// Every light red; and again after free().
  void own();
  /// @param yields  whoever has it gives way to others with green.
  void turn_green(int link, bool yields = false);
  /// Yellow, then red.
  void end_green(int link);
  /// Yellow lights turn red when it is time.
  void advance();
  /// The signals run their own programs.
  void free();
  [[nodiscard]] bool is_free() const { return free_; }

  /// Shown to vehicles so far.
  [[nodiscard]] std::int64_t greens() const { return greens_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  struct Head {
    bool owned = false;
    bool reserved = false;
    std::int64_t called = kNever;  ///< step
    Light light = Light::kRed;
    bool yields = false;    ///< of its last green
    double since = -1e300;  ///< [s]
    std::vector<int> crossing;
    bool occupied = false;         ///< by people
    double people_until = -1e300;  ///< [s]
  };
  void find_signals(const std::vector<bool>& coordinated);
  void find_conflicts(const std::vector<bool>& coordinated);
  void cross_each_other(int a, int b);
  [[nodiscard]] double yellow_of(int light) const;
  void show(int link, Light light);

  Traffic& traffic_;
  const LaneGraph& graph_;
  SignalTiming timing_;
  std::vector<Head> heads_;  ///< by light
  std::set<std::string> signals_;
  bool free_ = true;
  std::int64_t greens_ = 0;
};

}  // namespace mvtp
