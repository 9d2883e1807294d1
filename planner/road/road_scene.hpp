#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "planner/motion/inertial_car.hpp"
#include "planner/road/path_library.hpp"

namespace mvtp {

/// Time on roads is counted in steps of the simulation; a decision holds for several of them.
struct DecisionGrid {
  double dt = 0.1;             ///< [s] one simulation step
  int steps_per_decision = 5;  ///< for so many steps an acceleration is held

  [[nodiscard]] double decision() const { return dt * steps_per_decision; }
};

/// The motion of one vehicle along its reference path: a state per simulation step, from `begin`
/// on.
///
/// After its last state the vehicle has left the road and touches nobody any more, if the
/// profile is complete; otherwise it stays where it came to rest.
struct SpeedProfile {
  static constexpr double kDeparted = 1e9;  ///< [m] where a vehicle is that has left

  std::int64_t begin = 0;
  std::vector<InertialState> states;
  bool complete = true;

  [[nodiscard]] std::int64_t end() const { return begin + std::int64_t(states.size()); }
  [[nodiscard]] InertialState at(std::int64_t k) const {
    if (k >= end()) return complete ? InertialState{kDeparted, 0.0} : states.back();
    return states[std::size_t(std::max<std::int64_t>(0, k - begin))];
  }
  /// The same of one that is complete, but the vehicle drives on at the same speed after its last
  /// state. @param dt  [s] of a step
  [[nodiscard]] InertialState goes_on_at(std::int64_t k, double dt) const {
    if (!complete || k < end()) return at(k);
    const InertialState last = states.back();
    return {last.s + last.v * double(k - end() + 1) * dt, last.v};
  }
};

/// A stretch of a path that is kept free of the vehicle for a while: its rear axle is not there.
struct ClosedStretch {
  double from = 0.0;       ///< [m]
  double to = 0.0;         ///< [m]
  std::int64_t begin = 0;  ///< step, and
  std::int64_t end = 0;    ///< the first step at which it is open again
};

/// An exit lane of another junction, and where along its path a vehicle is a leader there of those
/// who leave that junction: from when it comes onto the lane until its tail has left it.
struct EntryLane {
  int lane = -1;
  double s_lane = 0.0;  ///< rear axle when the front bumper enters the lane [m]
  double from = -std::numeric_limits<double>::infinity();  ///< rear axle [m]
  double to = std::numeric_limits<double>::infinity();     ///< likewise

  [[nodiscard]] bool is_there(double s) const { return from <= s && s <= to; }
};

/// One vehicle on the road as the planner sees it.
struct RoadVehicle {
  std::int64_t key = 0;  ///< its name over time; ties are broken by it
  int path = 0;          ///< in the PathLibrary
  InertialState now;
  std::shared_ptr<const SpeedEnvelope> envelope;
  double cruise_speed = 13.9;  ///< [m/s] where nothing slows it down
  double min_gap = 2.5;        ///< [m] and
  double tau = 1.0;            ///< [s] of the driver it is handed back to
  /// Rear axle when the front bumper is at each stop line, ascending [m]: a vehicle without a
  /// complete plan waits before the next.
  std::vector<double> stop_lines;
  /// Where its rear axle must not come to rest to wait, from and to [m]: inside junctions.
  std::vector<std::pair<double, double>> no_waiting;
  /// Likewise before junctions, for who can still stop before them with half its deceleration: from
  /// further back it is faster on the junction, and sooner off it.
  std::vector<std::pair<double, double>> run_ups;
  /// Rear axle while the front bumper is on lanes between two junctions, from and to [m].
  std::vector<std::pair<double, double>> between;
  std::vector<ClosedStretch> closed;  ///< ground that others have a right to
  /// Its plan gives way to a better one around all others at every decision, as soon as there is
  /// one; else only where the order of passage is searched.
  bool asks_again = false;
  int exit_lane = -1;                  ///< vehicles of one exit lane keep a headway on it
  double s_exit_lane = 0.0;            ///< rear axle when the front bumper enters the exit lane [m]
  std::vector<EntryLane> entry_lanes;  ///< where its path begins behind another junction
  double s_handback = 0.0;             ///< rear axle where the control zone ends [m]
  double s_end = 0.0;                  ///< rear axle where a plan is complete [m]; >= s_handback
  double weight = 1.0;                 ///< its time costs so many times that of any other vehicle
  /// It has stood for long without a complete plan, or it stands with a driver of its own. Two such
  /// vehicles may pass each other closely.
  bool stuck = false;

  /// Is it where it may be handed back at any moment? Nobody may count on what it does from here on
  /// but to go on as it plans.
  [[nodiscard]] bool leaves() const { return now.s >= s_handback; }

  /// Is it, at some place of its path, a leader of those who leave a junction on this lane?
  [[nodiscard]] bool enters(int lane) const {
    return std::ranges::any_of(entry_lanes, [lane](const EntryLane& e) { return e.lane == lane; });
  }
  /// May its rear axle come to rest at `s` [m] to wait, as far as junctions go?
  [[nodiscard]] bool may_wait_at(double s) const {
    return std::ranges::none_of(
        no_waiting, [s](const auto& inside) { return s > inside.first && s < inside.second; });
  }
  /// Is it inside the junctions of its path, and not on a lane between two of them?
  [[nodiscard]] bool is_on_junction() const {
    const auto is_there = [this](const auto& lane) {
      return now.s >= lane.first && now.s <= lane.second;
    };
    return !stop_lines.empty() && now.s > stop_lines.front() &&
           std::ranges::none_of(between, is_there);
  }
  /// Does it leave onto a lane on which the other one may be a leader?
  [[nodiscard]] bool exits_with(const RoadVehicle& other) const {
    return exit_lane >= 0 && (exit_lane == other.exit_lane || other.enters(exit_lane));
  }
};

/// The gap that the driver of a vehicle wants to the one ahead [m]: what he keeps at rest, his
/// headway, and what he needs more than that one to stop.
[[nodiscard]] inline double drivers_gap(const RoadVehicle& vehicle, double speed, double decel,
                                        double speed_ahead, double decel_ahead) {
  const double braking =
      stopping_distance(speed, decel) - stopping_distance(speed_ahead, decel_ahead);
  return vehicle.min_gap + vehicle.tau * speed + std::max(0.0, braking);
}

/// What the coordinator has told a driver, or would tell him in this trial: to wait at his line, or
/// to pass.
enum class Told { kNothing, kToWait, kToPass };

/// A vehicle that is not under control, with the motion that is expected of it; or, with `latest`,
/// with all motions between the two: at each time it may be anywhere between them.
struct Forecast {
  RoadVehicle vehicle;
  SpeedProfile earliest;
  std::optional<SpeedProfile> latest;
  bool yields = true;  ///< to whoever blocks it; else only to those ahead on its own lane
  /// Its driver relies on being let pass and brakes for nobody across his path: braking there does
  /// not help.
  bool relies = false;
  /// To wait: its driver slows down as is expected, and not later. To pass: new plans stay as far
  /// behind him as it takes to stop if he brakes, at any time.
  Told told = Told::kNothing;
  /// Steps that new plans keep beside what is expected, before the earliest and behind the latest:
  /// plans that are kept need not, so that a small surprise does not break them.
  int slack_before = 0;
  int slack_behind = 0;
  /// Nobody has planned around it before: plans that are kept keep the slack, too.
  bool is_new = false;
  /// Of a driver who is held at a line: he stays there, whatever `earliest` says, until whoever
  /// is not behind him on his lane has passed. Else each of the two might wait for the other.
  std::optional<SpeedProfile> held;
};

/// The vehicles on the road at the moment of a decision.
struct RoadScene {
  const PathLibrary* library = nullptr;
  DecisionGrid grid;
  std::int64_t step = 0;              ///< now
  std::vector<RoadVehicle> vehicles;  ///< ours, ordered by key
  std::vector<Forecast> forecasts;
  double reaction = 0.5;  ///< [s] until we answer to a forecast vehicle that brakes

  /// @pre there is one with this key
  [[nodiscard]] const RoadVehicle& vehicle(std::int64_t key) const {
    return *std::ranges::lower_bound(vehicles, key, {}, &RoadVehicle::key);
  }
  [[nodiscard]] const Vehicle& body(const RoadVehicle& v) const { return library->body(v.path); }

  /// The same moment with nobody on the road.
  [[nodiscard]] RoadScene without_vehicles() const {
    // A new member does not compile here until somebody says whether it is copied.
    const auto& [its_library, its_grid, its_step, ours, others, its_reaction] = *this;
    return {its_library, its_grid, its_step, {}, {}, its_reaction};
  }
};

/// Complete speed profiles, in the order of priority in which they were planned.
struct JointPlan {
  struct Entry {
    std::int64_t key = 0;
    std::shared_ptr<const SpeedProfile> profile;
  };
  std::vector<Entry> entries;

  /// nullptr if there is none
  [[nodiscard]] const Entry* entry(std::int64_t key) const {
    const auto e = std::ranges::find(entries, key, &Entry::key);
    return e == entries.end() ? nullptr : &*e;
  }
  [[nodiscard]] Entry* entry(std::int64_t key) {
    return const_cast<Entry*>(std::as_const(*this).entry(key));
  }

  /// nullptr if there is none
  [[nodiscard]] const SpeedProfile* find(std::int64_t key) const {
    const Entry* e = entry(key);
    return e == nullptr ? nullptr : e->profile.get();
  }
};

}  // namespace mvtp
