#pragma once

#include <cstddef>
#include <map>
#include <tuple>
#include <vector>

#include "planner/problem/validate.hpp"

namespace mvtp::referee {

/// Collects broken rules; the same one by the same parties in successive steps is one entry.
class Protocol {
 public:
  struct Entry {
    Rule rule;
    std::size_t subject;
    std::size_t object;
    std::size_t last_step;
    double when;
    double amount;
    double turn;  ///< [rad], for kStart, kGoal and kArc
  };

  /// @param subject index of the agent (of the trajectory for kAgentUnknown).
  /// @param object the other agent, or the obstacle; 0 where the rule needs none.
  /// @param step the whole step at whose end it is seen; `when` the moment itself.
  void add(Rule rule, std::size_t subject, std::size_t object, std::size_t step, double when,
           double amount, double turn = 0.0);

  /// Nothing has moved since the step before: what was broken then still is.
  void prolong(Rule rule, std::size_t subject, std::size_t object, std::size_t step);

  /// In the order of the rules, then of the parties, then of time.
  [[nodiscard]] std::vector<Entry> entries() const;

 private:
  std::vector<Entry> entries_;
  std::map<std::tuple<Rule, std::size_t, std::size_t>, std::size_t> open_;  ///< the latest entry
};

}  // namespace mvtp::referee
