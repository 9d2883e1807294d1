#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "planner/lot/temporal_plan_graph.hpp"
#include "planner/motion/arc_path.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// How cars drive on a lot.
struct LotLimits {
  double speed = 10.0 / 3.6;  ///< [m/s]: walking speed
  double accel = 1.2;         ///< [m/s^2] speeding up and
  double braking = 1.2;       ///< [m/s^2] slowing down, as planned;
  double hardest = 1.45;      ///< [m/s^2] and at most
  double lateral = 1.4;       ///< [m/s^2]
};

/// A car under way: on its path, from its first place to the end.
struct LotCar {
  std::int64_t key = 0;  ///< its name over time; ties are broken by it
  Vehicle body;
  ArcPath path;
  PathCells cells;  ///< of `path`
  Pose goal;
  bool leaves = false;  ///< it drives on at the end of the path, out of reach, and does not stop
  bool stopped_permanently =
      false;            ///< the path ends where the car comes to rest, short of its goal
  bool planned = true;  ///< its path is part of a plan in which everyone arrives
  /// Without a plan: the decision that let it get under way. Earlier ones have priority.
  std::int64_t since = 0;
  /// [m] It may drive so far until the next decision; infinity: as far as it is its turn.
  double granted = std::numeric_limits<double>::infinity();
  double s = 0.0;  ///< driven [m]
  double v = 0.0;  ///< >= 0, in the direction of the path [m/s]

  [[nodiscard]] bool at_end() const { return s >= path.length(); }
  /// Does it stop at the end of the path?
  [[nodiscard]] bool stops() const { return stopped_permanently || !leaves; }
  [[nodiscard]] Pose pose() const { return path.at(s); }
};

/// How the cars will drive if nothing else happens.
struct LotForecast {
  bool complete = false;  ///< everyone arrives who has not stopped for good
  bool gentle = true;     ///< nobody ever has to brake harder than LotLimits::hardest
  double dt = 0.1;        ///< [s] between two entries of `driven`
  std::vector<std::vector<float>> driven;  ///< s of each car from now on, until its arrival
  std::vector<char> arrives;               ///< does it reach the end of its path?

  /// [s] from now; of a car that does not arrive, the end of the forecast.
  [[nodiscard]] double arrival(std::size_t i) const { return dt * double(driven[i].size() - 1); }
  [[nodiscard]] double driven_at(std::size_t i, double time) const;
  /// Sum of the arrivals of all who arrive [s].
  [[nodiscard]] double cost() const;
};

/// The cars under way and the order in which they use the ground that several of them need: a
/// temporal plan graph. Speeds follow from it: as fast as the limits allow, never further than the
/// car can still stop before ground that is not its turn.
///
/// Hence two laws, whatever the speeds: everyone braking now is free of contact; and cars whose
/// order came from one plan without contacts all arrive, as the order has no cycle.
/// Source: Hoenig et al. 2016 (temporal plan graphs), with cells of ground in place of vertices.
class LotMotion {
 public:
  explicit LotMotion(const LotLimits& limits = {}) : limits_(limits) {}

  [[nodiscard]] const LotLimits& limits() const { return limits_; }
  /// Ordered by key.
  [[nodiscard]] const std::vector<LotCar>& cars() const { return cars_; }
  /// Index of the car, or -1.
  [[nodiscard]] int find(std::int64_t key) const;
  /// Adds the car, or replaces the one with the same key; it has no orders yet.
  void put(LotCar car);
  void remove(std::int64_t key);
  /// The car may drive so far until the next decision [m].
  void grant(std::int64_t key, double stop);
  /// `first` waits for `second` as said.
  void set_order(std::int64_t first, std::int64_t second, Precedence order);

  /// The car brakes to rest and stays there: it broke down, or has no path any more.
  void stop_permanently(std::int64_t key);
  /// Stops those permanently who would wait for ever. @return their keys
  std::vector<std::int64_t> stop_the_blocked_permanently();

  /// Everyone drives for `dt` [s].
  /// @param stopping_points  per car: it must stop before it has driven so far [m]; infinity: no
  /// matter
  void step(double dt, std::span<const double> stopping_points);
  /// How far each car may drive for now, as far as the others go [m].
  [[nodiscard]] std::vector<double> turns() const;
  /// When the car has driven `s` [m] if nothing but `stop` [m] holds it up; [s] from now, infinity
  /// if that takes more than a minute.
  [[nodiscard]] double time_until(const LotCar& car, double s, double stop) const;

  /// Where the car comes to rest if it drives as fast as it may for `time` [s] and brakes then [m].
  [[nodiscard]] double rest_after(const LotCar& car, double time) const;

  /// Until everyone has arrived, or nobody gets on any more.
  [[nodiscard]] LotForecast forecast(double dt = 0.1) const;

  /// The next speed of a car that must not go beyond `stop` [m].
  [[nodiscard]] double next_speed(const LotCar& car, double s, double v, double stop,
                                  double dt) const;

 private:
  struct Link {
    std::size_t waiting;
    std::size_t first;
    const Precedence* order;
    std::size_t hint = 0;
  };
  struct State {
    double s;
    double v;
  };

  [[nodiscard]] std::vector<Link> links() const;
  [[nodiscard]] State advance(const LotCar& car, State now, double stop, double dt) const;
  [[nodiscard]] double speed_limit(const ArcPath::Piece& piece) const;

  LotLimits limits_;
  std::vector<LotCar> cars_;
  std::map<std::pair<std::int64_t, std::int64_t>, Precedence> orders_;
};

}  // namespace mvtp
