#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/network/crossing_paths.hpp"
#include "coordinator/signals/signal_heads.hpp"
#include "planner/road.hpp"

namespace mvtp {

/// People on foot at crossings: obstacles of the planner wherever they are or may be, and, where
/// the signal of a crossing is the coordinator's, those who ask for a green.
///
/// Safety: who is on a crossing, or may step onto it, is in a tube that vehicles under control keep
/// clear of; at a crossing of the coordinator nobody may step onto it but in its green, shown
/// only once everybody's plan keeps clear of those who use it. Liveness: a green that is due begins
/// three seconds after it is promised, before which everybody can stop. One that was promised is
/// not shown if somebody stands on the crossing by then.
class People {
 public:
  People(Traffic& traffic, const LaneGraph& graph, PathLibrary& library, SignalHeads& heads,
         const DecisionGrid& grid);

  /// A decision begins: looks at everybody, ends greens that are over, and shows those that were
  /// promised for now.
  /// @param is_clear  do all keep clear of those who use the green of a crossing, by its id?
  void begin(std::int64_t step, const std::function<bool(const std::string&)>& is_clear);

  /// Is this a crossing, by its id, whose light is ours?
  [[nodiscard]] bool knows(const std::string& crossing) const;
  [[nodiscard]] int light_of(const std::string& crossing) const {
    return heads_.light_of_crossing(numbers_.at(crossing));
  }
  [[nodiscard]] int junction_of(const std::string& crossing) const {
    return graph_.crossing(numbers_.at(crossing)).junction;
  }
  /// What somebody may do.
  struct Expected {
    int crossing = 0;
    Forecast forecast;
  };
  /// What everybody may do who is on a crossing or before one.
  /// @param guests  crossings, by id, that get green now, beside those that have it.
  [[nodiscard]] std::vector<Expected> expect(const std::vector<std::string>& guests);
  [[nodiscard]] const std::string& id_of(int crossing) const {
    return graph_.crossing(crossing).crossing->id;
  }

  /// Crossings that should get green now, by id. As long as nobody there has waited for long,
  /// drivers go first who have waited longer.
  /// @param drivers_waited  how long a driver has waited at his line who crosses this light [s];
  ///                        0: nobody has who could go now.
  [[nodiscard]] std::vector<std::string> propose(const std::function<double(int)>& drivers_waited);
  /// How long the first of those has waited who want to go over it [s].
  [[nodiscard]] double waited(const std::string& crossing) const;
  /// What a green is worth that these crossings get now [s]: what those there have waited. At last
  /// it is worth whatever it costs others.
  [[nodiscard]] double worth(const std::vector<std::string>& crossings) const;
  /// Plans keep clear of those who use its green: shows it when it begins.
  void grant(const std::string& crossing);
  /// Nobody plans any more: no new greens.
  void release_all();

  [[nodiscard]] std::int64_t greens() const { return greens_; }

 private:
  /// Where somebody is, as seen from a crossing that he may walk over.
  enum class Where {
    kPasses,  ///< he walks past it
    kNear,    ///< he may turn elsewhere
    kBefore,  ///< he wants to go over it
    kOnIt
  };
  struct Person {
    int crossing = 0;
    Where where = Where::kNear;
    bool forward = true;
    double s = 0.0;
    double aside = 0.0;
    double speed = 0.0;
    std::int64_t came = 0;          ///< step
    std::int64_t stands_since = 0;  ///< step
  };
  /// By the person's id and the crossing.
  using Persons = std::map<std::pair<std::string, int>, Person>;
  /// A green, from step to step.
  struct Green {
    std::int64_t begin = 0;
    std::int64_t end = 0;
  };

  void remember_crossings();
  void see(const Pedestrian& person, Persons& now);
  void see_at(const Pedestrian& person, int crossing, Where where, Persons& now);
  [[nodiscard]] bool waits(const Person& person, int crossing) const;
  void show_greens(const std::function<bool(const std::string&)>& is_clear);
  void call_for_greens();
  [[nodiscard]] double over_at(int crossing);
  [[nodiscard]] std::int64_t steps(double seconds) const;
  [[nodiscard]] bool is_ours(int crossing) const;
  [[nodiscard]] bool has_waited(int crossing, double seconds) const;
  [[nodiscard]] std::optional<std::int64_t> waits_since(int crossing) const;
  [[nodiscard]] Green next_green(int crossing) const;
  [[nodiscard]] Forecast expect_one(const Person& person, const std::optional<Green>& green);
  [[nodiscard]] Forecast crosses(const Person& person, const Green& green);
  [[nodiscard]] Forecast stays(const Person& person, double to);
  [[nodiscard]] Forecast forecast_on(int path, const Person& person, SpeedProfile earliest,
                                     SpeedProfile latest) const;
  [[nodiscard]] SpeedProfile walk(double from, std::int64_t wait, double speed, double to,
                                  bool leaves) const;

  Traffic& traffic_;
  const LaneGraph& graph_;
  SignalHeads& heads_;
  DecisionGrid grid_;
  CrossingPaths paths_;
  std::map<std::string, int> numbers_;               ///< of crossings, by id
  std::map<std::string, std::vector<int>> meeting_;  ///< those that begin or end at an edge
  std::int64_t step_ = 0;
  std::map<std::string, int> last_crossing_;  ///< by person
  Persons people_;
  std::map<int, Green> granted_;         ///< by crossing
  std::map<int, std::int64_t> offered_;  ///< the last decision in which a green at once was wanted
  std::int64_t greens_ = 0;
};

}  // namespace mvtp
