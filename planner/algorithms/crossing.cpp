#include "planner/algorithms/crossing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "planner/search/draws.hpp"

namespace mvtp {
namespace {

using Entry = JointPlan::Entry;
using Order = std::vector<std::int64_t>;

/// Looks that the plan of one vehicle may take although the work is used up.
constexpr std::int64_t kLeastWork = 30000;

class CrossingPlanner {
 public:
  CrossingPlanner(const RoadPairs& pairs, const CrossingOptions& options, std::uint64_t seed,
                  WorkBudget work)
      : pairs_(pairs), scene_(pairs.scene()), options_(options), draws_(seed), work_(work) {}

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

    const std::int64_t reserve = work_.left / 2;
    Order repaired = order;
    for (int repair = 0;; ++repair) {
      std::vector<Entry> entries;
      const std::optional<std::size_t> failed = keep_or_plan(repaired, incumbent, entries);
      if (!failed) return {{entries}, {}, cost_of(entries)};
      if (repair >= options_.repairs || work_.left < reserve) break;
      if (!move_to_front(repaired, *failed)) break;
    }
    return around_the_stuck(order, incumbent);
  }

  /// Fills `entries` along `order` with the incumbents that fit and new plans for the others;
  /// returns the place of the first vehicle without a plan.
  std::optional<std::size_t> keep_or_plan(const Order& order, const JointPlan& incumbent,
                                          std::vector<Entry>& entries) {
    bool changed = false;  // until then, the incumbents only have to fit the forecasts
    for (std::size_t i = 0; i < order.size(); ++i) {
      const RoadVehicle& v = scene_.vehicle(order[i]);
      const auto old = std::ranges::find(incumbent.entries, order[i], &Entry::key);
      const std::span<const Entry> before =
          changed ? std::span<const Entry>(entries) : std::span<const Entry>();
      if (old != incumbent.entries.end() &&
          still_fits(pairs_, v, *old->trajectory, before, options_.trajectory, &work_)) {
        entries.push_back(*old);
        continue;
      }
      changed = true;
      auto t = plan_at_least(v, entries);
      if (!t) return i;
      entries.push_back({order[i], std::make_shared<PathTrajectory>(std::move(*t))});
    }
    return std::nullopt;
  }

  /// A plan even if the work is used up, as long as it is found fast.
  std::optional<PathTrajectory> plan_at_least(const RoadVehicle& v, std::span<const Entry> before) {
    WorkBudget least{std::max(work_.left, kLeastWork)};
    const std::int64_t given = least.left;
    auto t = plan_vehicle(pairs_, v, before, options_.trajectory, {.work = &least});
    work_.left -= given - least.left;
    return t;
  }

  /// What is left when no order works. Old plans stand; whoever has none looks for one among them,
  /// or brakes, and then those who would meet it there look for other plans.
  CrossingResult around_the_stuck(const Order& order, const JointPlan& incumbent) {
    std::vector<Entry> planned;
    std::vector<Entry> bodies;
    Order open;
    for (const std::int64_t key : order) {
      const auto old = std::ranges::find(incumbent.entries, key, &Entry::key);
      const bool keeps = old != incumbent.entries.end() &&
                         still_fits(pairs_, scene_.vehicle(key), *old->trajectory, {},
                                    options_.trajectory, &work_);
      if (keeps) planned.push_back(*old);
      if (!keeps) open.push_back(key);
    }
    CrossingResult result;
    std::set<std::int64_t> tried;
    for (std::size_t next = 0; next < open.size(); ++next) {
      const RoadVehicle& v = scene_.vehicle(open[next]);
      if (work_.left > 0 || tried.insert(v.key).second) {
        std::vector<Entry> before = bodies;
        before.insert(before.end(), planned.begin(), planned.end());
        if (auto t = plan_at_least(v, before)) {
          planned.push_back({v.key, std::make_shared<PathTrajectory>(std::move(*t))});
          continue;
        }
      }
      result.unplanned.push_back(v.key);
      const double b = scene_.body(v).max_decel;
      bodies.push_back({v.key, std::make_shared<PathTrajectory>(stop_after(scene_, v.now, -b, b))});
      const std::span<const Entry> body(&bodies.back(), 1);
      std::erase_if(planned, [&](const Entry& e) {
        const bool fits = fits_beside(pairs_, scene_.vehicle(e.key), *e.trajectory, body,
                                      options_.trajectory, &work_);
        if (!fits) open.push_back(e.key);
        return !fits;
      });
    }
    result.cost = cost_of(planned);
    result.plan.entries = std::move(planned);
    return result;
  }

  /// Extends `entries` along `order`; returns the place of the first vehicle without a plan, or
  /// where it is clear that the cost will not be below `budget`: nobody is faster than alone.
  std::optional<std::size_t> plan_rest(const Order& order, std::vector<Entry>& entries,
                                       double budget) {
    double cost = 0.0;
    for (const Entry& e : entries) cost += handback_cost(e);
    for (std::size_t i = entries.size(); i < order.size(); ++i) cost += cost_alone(order[i]);
    for (std::size_t i = entries.size(); i < order.size(); ++i) {
      if (cost >= budget) return i;
      // Whoever costs more than this makes the whole no better.
      const PlanLimits limits{.work = &work_, .cost = budget - cost + cost_alone(order[i])};
      auto t = plan_vehicle(pairs_, scene_.vehicle(order[i]), entries, options_.trajectory, limits);
      if (!t || work_.left <= 0) return i;
      entries.push_back({order[i], std::make_shared<PathTrajectory>(std::move(*t))});
      cost += handback_cost(entries.back()) - cost_alone(order[i]);
    }
    return std::nullopt;
  }

  /// Local search over orders: single vehicles earlier or later, or with their followers earlier.
  void improve(CrossingResult& best) {
    std::vector<double> delays;
    const int tries = tries_for(best.plan.entries.size());
    for (int attempt = 0; attempt < tries && work_.left > 0; ++attempt) {
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

  [[nodiscard]] int tries_for(std::size_t n) const {
    if (int(n) <= options_.many) return options_.tries;
    const double share = double(options_.many) / double(n);
    return int(std::ceil(options_.tries * share * share));
  }

  Order random_move(Order order, const std::vector<double>& delays) {
    const std::size_t i = draws_.weighted(delays);
    const int kind = draws_.between(0, 3);
    if (kind == 0) {
      move_later(order, i, draws_.between(1, 6));
    } else {
      const int places = draws_.between(1, 8);
      const int followers = kind == 1 ? draws_.between(1, 4) : 0;
      move_earlier(order, i, places, followers);
    }
    return order;
  }

  /// Must `a` stay before `b` in every order?
  [[nodiscard]] bool leads(std::int64_t a, std::int64_t b) const {
    return pairs_.leads(pairs_.index(a), pairs_.index(b));
  }

  void move_earlier(Order& order, std::size_t i, int places, int followers) const {
    const std::int64_t moved = order[i];
    std::size_t to = i;
    while (to > 0 && places > 0 && !leads(order[to - 1], moved)) --to, --places;
    std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(i),
                order.begin() + std::ptrdiff_t(i) + 1);
    for (std::size_t j = i + 1; j < order.size() && followers > 0; ++j) {
      if (!leads(moved, order[j])) continue;
      ++to;
      --followers;
      std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(j),
                  order.begin() + std::ptrdiff_t(j) + 1);
    }
  }

  void move_later(Order& order, std::size_t i, int places) const {
    const std::int64_t moved = order[i];
    while (i + 1 < order.size() && places-- > 0 && !leads(moved, order[i + 1])) {
      std::swap(order[i], order[i + 1]);
      ++i;
    }
  }

  /// To the first place behind its own lane leaders; false if it is there already.
  bool move_to_front(Order& order, std::size_t i) const {
    const std::int64_t moved = order[i];
    std::size_t to = 0;
    for (std::size_t j = 0; j < i; ++j) {
      if (leads(order[j], moved)) to = j + 1;
    }
    if (to == i) return move_leader_to_front(order, to);
    std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(i),
                order.begin() + std::ptrdiff_t(i) + 1);
    return true;
  }

  /// A vehicle right behind its leader cannot pass it: the leader has to come earlier first.
  bool move_leader_to_front(Order& order, std::size_t follower) const {
    return follower > 0 && leads(order[follower - 1], order[follower]) &&
           move_to_front(order, follower - 1);
  }

  void restore_lane_order(Order& order) const {
    for (std::size_t i = 1; i < order.size(); ++i) {
      std::size_t to = i;
      for (std::size_t j = 0; j < i; ++j) {
        if (leads(order[i], order[j])) {
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
      auto run = plan_alone(pairs_, scene_.vehicle(key), options_.trajectory);
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

  const RoadPairs& pairs_;
  const RoadScene& scene_;
  const CrossingOptions& options_;
  Draws draws_;
  WorkBudget work_;
  std::map<std::int64_t, double> alone_;  ///< hand-back cost alone on the road
};

}  // namespace

CrossingResult plan_crossing(const RoadPairs& pairs, const std::vector<std::int64_t>& keys,
                             const JointPlan& incumbent, const CrossingOptions& options,
                             std::uint64_t seed, WorkBudget work) {
  return CrossingPlanner(pairs, options, seed, work).plan(keys, incumbent);
}

}  // namespace mvtp
