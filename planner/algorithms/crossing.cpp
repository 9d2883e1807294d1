#include "planner/algorithms/crossing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <random>

namespace mvtp {
namespace {

using Entry = JointPlan::Entry;
using Order = std::vector<std::int64_t>;

/// Front bumper to the end of the entry lane [m]; negative behind it.
double distance_to_line(const RoadVehicle& v) { return v.s_entry_line - v.now.s; }

/// Must `a` stay before `b` in every order? Vehicles of one lane cannot overtake.
bool leads(const RoadVehicle& a, const RoadVehicle& b) {
  return a.entry_lane >= 0 && a.entry_lane == b.entry_lane &&
         distance_to_line(a) < distance_to_line(b);
}

class CrossingPlanner {
 public:
  CrossingPlanner(const RoadScene& scene, const CrossingOptions& options, std::uint64_t seed)
      : scene_(scene), options_(options), random_(seed) {}

  CrossingResult plan(const Order& keys, const JointPlan& incumbent) {
    CrossingResult result = complete(keys, incumbent);
    if (result.unplanned.empty()) improve(result);
    return result;
  }

 private:
  /// A plan for every vehicle: incumbents as long as they fit, then the rest in order; a vehicle
  /// that finds none moves to the front, which is priority inheritance on whole trajectories.
  CrossingResult complete(const Order& keys, const JointPlan& incumbent) {
    Order order;
    for (const Entry& e : incumbent.entries) {
      if (std::ranges::find(keys, e.key) != keys.end()) order.push_back(e.key);
    }
    for (const std::int64_t key : keys) {
      if (!incumbent.find(key)) order.push_back(key);
    }
    restore_lane_order(order);

    for (int repair = 0;; ++repair) {
      std::vector<Entry> entries;
      const std::optional<std::size_t> failed = keep_or_plan(order, incumbent, entries);
      if (!failed) return {{entries}, {}, cost_of(entries)};
      if (repair >= options_.repairs || !move_to_front(order, *failed)) break;
    }
    return without_the_stuck(order, incumbent);
  }

  /// Fills `entries` along `order` with the incumbents that fit and new plans for the others;
  /// returns the place of the first vehicle without a plan.
  std::optional<std::size_t> keep_or_plan(const Order& order, const JointPlan& incumbent,
                                          std::vector<Entry>& entries) const {
    bool changed = false;  // until then, the incumbents only have to fit the forecasts
    for (std::size_t i = 0; i < order.size(); ++i) {
      const RoadVehicle& v = scene_.vehicle(order[i]);
      const auto old = std::ranges::find(incumbent.entries, order[i], &Entry::key);
      const std::span<const Entry> before =
          changed ? std::span<const Entry>(entries) : std::span<const Entry>();
      if (old != incumbent.entries.end() &&
          still_fits(scene_, v, *old->trajectory, before, options_.trajectory)) {
        entries.push_back(*old);
        continue;
      }
      changed = true;
      auto t = plan_vehicle(scene_, v, entries, options_.trajectory);
      if (!t) return i;
      entries.push_back({order[i], std::make_shared<PathTrajectory>(std::move(*t))});
    }
    return std::nullopt;
  }

  /// What is left when no order works: whoever fits in this order.
  CrossingResult without_the_stuck(Order order, const JointPlan& incumbent) const {
    CrossingResult result;
    for (;;) {
      result.plan.entries.clear();
      const std::optional<std::size_t> failed = keep_or_plan(order, incumbent, result.plan.entries);
      if (!failed) break;
      result.unplanned.push_back(order[*failed]);
      order.erase(order.begin() + std::ptrdiff_t(*failed));
    }
    result.cost = cost_of(result.plan.entries);
    return result;
  }

  /// Extends `entries` along `order`; returns the place of the first vehicle without a plan, or where
  /// it is clear that the cost will not be below `budget`: nobody is faster than alone.
  std::optional<std::size_t> plan_rest(const Order& order, std::vector<Entry>& entries,
                                       double budget) {
    double cost = 0.0;
    for (const Entry& e : entries) cost += handback_cost(e);
    for (std::size_t i = entries.size(); i < order.size(); ++i) cost += cost_alone(order[i]);
    for (std::size_t i = entries.size(); i < order.size(); ++i) {
      if (cost >= budget) return i;
      auto t = plan_vehicle(scene_, scene_.vehicle(order[i]), entries, options_.trajectory);
      if (!t) return i;
      entries.push_back({order[i], std::make_shared<PathTrajectory>(std::move(*t))});
      cost += handback_cost(entries.back()) - cost_alone(order[i]);
    }
    return std::nullopt;
  }

  /// Local search over orders: single vehicles earlier or later, or with their followers earlier.
  void improve(CrossingResult& best) {
    std::vector<double> delays;
    for (int attempt = 0; attempt < options_.tries; ++attempt) {
      const Order order = keys_of(best.plan.entries);
      delays = delays_of(best.plan.entries);
      if (std::accumulate(delays.begin(), delays.end(), 0.0) < 0.1) return;
      const Order changed = random_move(order, delays);
      const std::size_t same = common_prefix(changed, best.plan.entries);
      if (same == order.size()) continue;
      std::vector<Entry> entries(best.plan.entries.begin(),
                                 best.plan.entries.begin() + std::ptrdiff_t(same));
      if (plan_rest(changed, entries, best.cost)) continue;
      const double cost = cost_of(entries);
      if (cost < best.cost - 1e-6) best = {{std::move(entries)}, {}, cost};
    }
  }

  Order random_move(Order order, const std::vector<double>& delays) {
    std::discrete_distribution<std::size_t> by_delay(delays.begin(), delays.end());
    const std::size_t i = by_delay(random_);
    const int kind = std::uniform_int_distribution(0, 3)(random_);
    if (kind == 0) {
      move_later(order, i, std::uniform_int_distribution(1, 6)(random_));
    } else {
      const int places = std::uniform_int_distribution(1, 8)(random_);
      const int followers = kind == 1 ? std::uniform_int_distribution(1, 4)(random_) : 0;
      move_earlier(order, i, places, followers);
    }
    return order;
  }

  void move_earlier(Order& order, std::size_t i, int places, int followers) const {
    const RoadVehicle& moved = scene_.vehicle(order[i]);
    std::size_t to = i;
    while (to > 0 && places > 0 && !leads(scene_.vehicle(order[to - 1]), moved)) --to, --places;
    std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(i),
                order.begin() + std::ptrdiff_t(i) + 1);
    for (std::size_t j = i + 1; j < order.size() && followers > 0; ++j) {
      if (!leads(moved, scene_.vehicle(order[j]))) continue;
      ++to;
      --followers;
      std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(j),
                  order.begin() + std::ptrdiff_t(j) + 1);
    }
  }

  void move_later(Order& order, std::size_t i, int places) const {
    const RoadVehicle& moved = scene_.vehicle(order[i]);
    while (i + 1 < order.size() && places-- > 0 && !leads(moved, scene_.vehicle(order[i + 1]))) {
      std::swap(order[i], order[i + 1]);
      ++i;
    }
  }

  /// To the first place behind its own lane leaders; false if it is there already.
  bool move_to_front(Order& order, std::size_t i) const {
    const RoadVehicle& moved = scene_.vehicle(order[i]);
    std::size_t to = 0;
    for (std::size_t j = 0; j < i; ++j) {
      if (leads(scene_.vehicle(order[j]), moved)) to = j + 1;
    }
    if (to == i) return move_leader_to_front(order, to);
    std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(i),
                order.begin() + std::ptrdiff_t(i) + 1);
    return true;
  }

  /// A vehicle right behind its leader cannot pass it: the leader has to come earlier first.
  bool move_leader_to_front(Order& order, std::size_t follower) const {
    return follower > 0 &&
           leads(scene_.vehicle(order[follower - 1]), scene_.vehicle(order[follower])) &&
           move_to_front(order, follower - 1);
  }

  void restore_lane_order(Order& order) const {
    for (std::size_t i = 1; i < order.size(); ++i) {
      std::size_t to = i;
      for (std::size_t j = 0; j < i; ++j) {
        if (leads(scene_.vehicle(order[i]), scene_.vehicle(order[j]))) {
          to = j;
          break;
        }
      }
      std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(i),
                  order.begin() + std::ptrdiff_t(i) + 1);
    }
  }

  static Order keys_of(const std::vector<Entry>& entries) {
    Order keys;
    for (const Entry& e : entries) keys.push_back(e.key);
    return keys;
  }

  static std::size_t common_prefix(const Order& order, const std::vector<Entry>& entries) {
    std::size_t n = 0;
    while (n < order.size() && n < entries.size() && order[n] == entries[n].key) ++n;
    return n;
  }

  /// Time until the zone is left, and what it takes to be at cruise speed again [s].
  [[nodiscard]] double handback_cost(const Entry& e) const {
    const RoadVehicle& v = scene_.vehicle(e.key);
    const std::int64_t k = std::max(scene_.step, arrival_step(*e.trajectory, v.s_handback));
    const double speed = k < e.trajectory->end() ? e.trajectory->at(k).v : v.cruise_speed;
    const double missing = std::max(0.0, v.cruise_speed - speed);
    return double(k - scene_.step) * scene_.grid.dt +
           missing * missing / (2.0 * scene_.body(v).max_accel * v.cruise_speed);
  }

  /// How much later than alone on the road each vehicle leaves [s].
  std::vector<double> delays_of(const std::vector<Entry>& entries) {
    std::vector<double> delays;
    for (const Entry& e : entries) {
      delays.push_back(std::max(0.0, handback_cost(e) - cost_alone(e.key)));
    }
    return delays;
  }

  double cost_alone(std::int64_t key) {
    const auto [alone, is_new] = alone_.try_emplace(key, 0.0);
    if (is_new) {
      auto run = plan_alone(scene_, scene_.vehicle(key), options_.trajectory);
      alone->second = handback_cost({key, std::make_shared<PathTrajectory>(std::move(run))});
    }
    return alone->second;
  }

  [[nodiscard]] double cost_of(const std::vector<Entry>& entries) const {
    double cost = 0.0;
    for (const Entry& e : entries) {
      cost += handback_cost(e) + options_.headway_weight * missing_headway(e, entries);
    }
    return cost;
  }

  /// Time headway that the driver who takes over will miss [s].
  [[nodiscard]] double missing_headway(const Entry& e, const std::vector<Entry>& entries) const {
    const RoadVehicle& v = scene_.vehicle(e.key);
    const std::int64_t k = arrival_step(*e.trajectory, v.s_handback);
    if (k >= e.trajectory->end()) return 0.0;
    const InertialState state = e.trajectory->at(k);
    double missing = 0.0;
    const auto look = [&](const RoadVehicle& o, const PathTrajectory& trajectory) {
      const InertialState ahead = trajectory.at(k);
      if (o.exit_lane != v.exit_lane || o.exit_lane < 0 || ahead.s >= PathTrajectory::kGone) return;
      const double gap = (ahead.s - o.s_exit_lane) - (state.s - v.s_exit_lane);
      if (gap <= 0.0) return;
      const double braking = stopping_distance(state.v, scene_.body(v).max_decel) -
                             stopping_distance(ahead.v, scene_.body(o).max_decel);
      const double wanted = v.min_gap + v.tau * state.v + std::max(0.0, braking);
      missing += std::max(0.0, wanted - (gap - scene_.body(o).length())) / std::max(1.0, state.v);
    };
    for (const Entry& other : entries) look(scene_.vehicle(other.key), *other.trajectory);
    for (const Forecast& f : scene_.forecasts) look(f.vehicle, f.trajectory);
    return missing;
  }

  const RoadScene& scene_;
  const CrossingOptions& options_;
  std::mt19937_64 random_;
  std::map<std::int64_t, double> alone_;  ///< hand-back cost alone on the road
};

}  // namespace

CrossingResult plan_crossing(const RoadScene& scene, const std::vector<std::int64_t>& keys,
                             const JointPlan& incumbent, const CrossingOptions& options,
                             std::uint64_t seed) {
  return CrossingPlanner(scene, options, seed).plan(keys, incumbent);
}

}  // namespace mvtp
