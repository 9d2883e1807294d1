#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/drivers/gate.hpp"
#include "tests/coordinator/closed_loop.hpp"

namespace mvtp {

/// Notes who is held and who is let through.
class NotedTraffic : public FakeTraffic {
 public:
  NotedTraffic() : FakeTraffic(make_crossroads(), {}) {}
  void hold(const std::string& id, bool stop) override {
    stop ? (void)held.insert(id) : (void)held.erase(id);
  }
  void let_through(const std::string& id, Passage passage) override {
    last = passage;
    passage != Passage::kNone ? (void)passing.insert(id) : (void)passing.erase(id);
  }
  void keep_lane(const std::string& id, bool keep) override {
    keep ? (void)in_lane.insert(id) : (void)in_lane.erase(id);
  }
  std::set<std::string> held, passing, in_lane;
  Passage last = Passage::kNone;  ///< that somebody was told
};

class GateTest : public testing::Test {
 protected:
  /// One decision that sees these vehicles at 0 m/s, 1 m before their lines.
  std::optional<std::string> decide(const std::vector<std::string>& ids) {
    gate.begin();
    for (const std::string& id : ids) see(id, 1.0, 0.0);
    gate.end();
    return propose();
  }
  /// Who is asked for next.
  std::optional<std::string> propose() {
    const std::vector<std::string> proposed = gate.propose({first, anybody, nobody});
    if (proposed.empty()) return std::nullopt;
    gate.asked_for(proposed.front());
    return proposed.front();
  }
  /// At 0 m it is inside the junction, from which line 1 is the next.
  void see(const std::string& id, double to_line, double speed, bool leads_on = true,
           bool has_room = true, int line = 0) {
    const bool is_inside = to_line == 0.0;
    gate.see({.id = id, .type = "car", .speed = speed, .lane = id},
             {.line = is_inside ? 1 : line,
              .to_line = to_line,
              .to_hold = is_inside ? -1.0 : to_line,
              .is_inside = is_inside,
              .leads_on = leads_on,
              .has_room = has_room,
              .is_clear = !is_inside},
             car);
  }
  /// One decision that sees this one only.
  void see_only(const std::string& id, const Gate::Place& place, double speed = 8.0) {
    gate.begin();
    gate.see({.id = id, .type = "car", .speed = speed, .lane = id}, place, car);
    gate.end();
  }

  const Gate::IsFirst first = [](const std::string&) { return true; };
  const Gate::MayMeet anybody = [](const Gate::Pair&) { return true; };
  const Gate::Blocks nobody = [](const std::string&, double, const std::string&) { return false; };
  const Vehicle car = fake_type("car").body;
  NotedTraffic traffic;
  LaneKeeping keeping{traffic};
  Gate gate{traffic, keeping, Passage::kOneLine};
};

}  // namespace mvtp
