#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "coordinator/controllers/controller_kind.hpp"

namespace mvtp {

/// How many vehicles are where, as detectors over the lanes would tell.
class LaneCounts {
 public:
  /// @param reach  of the detectors, before a stop line and behind the junction [m]
  explicit LaneCounts(double reach) : reach_(reach) {}

  void count(const Traffic& traffic);

  /// Vehicles on a lane within reach of its end.
  [[nodiscard]] int on_lane(const std::string& lane) const { return find(on_lane_, lane); }
  /// Those of them that go on to this edge.
  [[nodiscard]] int heading(const std::string& lane, const std::string& edge) const;
  /// Vehicles on an edge within reach of its begin.
  [[nodiscard]] int on_edge(const std::string& edge) const { return find(on_edge_, edge); }

 private:
  using Counts = std::map<std::string, int>;
  static int find(const Counts& counts, const std::string& key) {
    const auto found = counts.find(key);
    return found == counts.end() ? 0 : found->second;
  }

  double reach_;
  Counts on_lane_;
  Counts on_edge_;
  std::map<std::pair<std::string, std::string>, int> heading_;
};

/// A path over a junction as its signal sees it.
struct SignalLink {
  int light = 0;  ///< its place in SignalPhase::lights
  std::string from_lane;
  std::string from_edge;
  std::string to_edge;
  int movements_on = 0;  ///< connections that leave `to_edge`
};

/// Signals that show, of the green phases of their own programs, at each decision the one that is
/// worth most. Between two greens come the yellow, and the red for all, that the program has behind
/// the one that ends; lights that stay green do not change.
class PhaseSelection : public Controller {
 public:
  /// What a phase is worth: over the links that have green in it.
  using Worth =
      std::function<double(const std::vector<const SignalLink*>& green, const LaneCounts& counts)>;

  static constexpr double kDecision = 10.0;  ///< [s] from one decision to the next

  /// @param reach  of its detectors [m], see LaneCounts
  PhaseSelection(Traffic& traffic, const std::vector<std::string>& signals, double reach,
                 Worth worth);

  void decide() override;
  void act() override {}
  [[nodiscard]] bool drives(const std::string& /*id*/) const override { return false; }
  [[nodiscard]] const std::vector<Replan>& replans() const override { return replans_; }

 private:
  struct Green {
    std::string lights;
    double yellow = 0.0;   ///< [s] after it
    double all_red = 0.0;  ///< [s] after that
    std::vector<const SignalLink*> links;
  };
  struct Signal {
    std::string id;
    std::vector<SignalLink> links;
    std::vector<Green> greens;
    std::size_t shown = 0;    ///< of the greens; while it changes, the next
    std::size_t before = 0;   ///< the last one
    double change_began = 0;  ///< [s]
    double next_decision = 0;
  };

  void read_program(Signal& signal) const;
  void choose(Signal& signal);
  [[nodiscard]] std::string lights_now(const Signal& signal) const;

  Traffic& traffic_;
  Worth worth_;
  LaneCounts counts_;
  std::vector<Signal> signals_;
  std::vector<Replan> replans_;
};

}  // namespace mvtp
