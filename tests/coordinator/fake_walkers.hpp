#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/network/lane_graph.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// Somebody who comes to a crossing, goes over it, and leaves a few metres behind it.
struct FakeWalker {
  std::string id;
  double depart = 0.0;
  int crossing = 0;     ///< in the LaneGraph
  bool forward = true;  ///< along the crossing's shape
  double aside = 0.0;   ///< [m] to the left of its middle
  double speed = 1.35;  ///< [m/s]
  bool turns = false;   ///< he only comes near, and turns away at the kerb
  /// He goes over whichever crossing there has green first, onto which he is set at once.
  bool takes_any = false;
};

/// People on foot as SUMO's are: they wait at the kerb as long as their light is red, and look at
/// no vehicle while it is green or there is none.
class FakeWalkers {
 public:
  static constexpr double kApproach = 16.0;  ///< [m] that they walk to the kerb

  explicit FakeWalkers(const LaneGraph& graph) : graph_(graph) {}

  void add(const FakeWalker& walker) { waiting_.push_back(walker); }
  /// @param green  does the signal of a crossing show green?
  void step(double time, double dt, const std::function<bool(int)>& green);
  [[nodiscard]] const std::vector<Pedestrian>& people() const { return people_; }
  [[nodiscard]] bool all_arrived() const { return waiting_.empty() && walking_.empty(); }
  [[nodiscard]] double longest_wait() const { return longest_wait_; }  ///< [s]

 private:
  struct Walking {
    FakeWalker walker;
    double s = -kApproach;  ///< [m] from the kerb
    double v = 0.0;
    double waited = 0.0;
  };
  void change_crossing(Walking& w, const std::function<bool(int)>& green) const;
  [[nodiscard]] Pedestrian seen(const Walking& w) const;

  const LaneGraph& graph_;
  std::vector<FakeWalker> waiting_;
  std::vector<Walking> walking_;
  std::vector<Pedestrian> people_;
  double longest_wait_ = 0.0;
};

}  // namespace mvtp
