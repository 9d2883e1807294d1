#include "planner/road/crossing.hpp"

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
  /// A plan for every vehicle: those without an incumbent around all incumbents, as long as these
  /// fit; else in order, where a vehicle that finds none moves to the front, which is priority
  /// inheritance on whole trajectories.
  CrossingResult complete(const Order& keys, const JointPlan& incumbent) {
    Order order;
    for (const Entry& e : incumbent.entries) {
      if (std::ranges::find(keys, e.key) != keys.end()) order.push_back(e.key);
    }
    const std::size_t old = order.size();
    for (const std::int64_t key : keys) {
      if (!incumbent.find(key)) order.push_back(key);
    }
    if (auto result = around_the_incumbents(order, old, incumbent)) return *std::move(result);
    order = in_lane_order(order);

    const std::int64_t reserve = work_.left / 2;
    Order repaired = order;
    for (int repair = 0;; ++repair) {
      std::vector<Entry> entries;
      const std::optional<std::size_t> failed = keep_or_plan(repaired, incumbent, entries);
      if (!failed) return {{entries}, {}, cost_of(entries)};
      if (repair >= options_.repairs || work_.left < reserve) break;
      if (!move_to_front(repaired, *failed)) break;
    }
    // No order works for all: either old plans stand as long as they fit, or earlier ones go first.
    CrossingResult standing = around_the_stuck(order, incumbent, /*old_plans_stand=*/true);
    if (standing.unplanned.size() < 2) return standing;
    CrossingResult in_order = around_the_stuck(order, incumbent, /*old_plans_stand=*/false);
    return in_order.unplanned.size() < standing.unplanned.size() ? in_order : standing;
  }

  /// All incumbents stand, those of the first `old` vehicles of `order`, and all others find plans
  /// around them; nullopt if that is not possible.
  std::optional<CrossingResult> around_the_incumbents(const Order& order, std::size_t old,
                                                      const JointPlan& incumbent) {
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < old; ++i) {
      const Entry* fits = fitting_incumbent(order[i], incumbent, {});
      if (fits == nullptr) return std::nullopt;
      entries.push_back(*fits);
    }
    restore_headways(entries);
    for (std::size_t i = old; i < order.size(); ++i) {
      auto t = plan_at_least(scene_.vehicle(order[i]), entries);
      if (!t) return std::nullopt;
      entries.push_back({order[i], std::make_shared<PathTrajectory>(std::move(*t))});
    }
    return CrossingResult{{in_lane_order(entries)}, {}, cost_of(entries)};
  }

  /// A leader may go on otherwise than it was expected to when its follower was planned: whoever
  /// would be handed back too close behind it is planned anew around all others, if that works.
  void restore_headways(std::vector<Entry>& entries) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const RoadVehicle& v = scene_.vehicle(entries[i].key);
      if (leaves_room(pairs_, v, *entries[i].trajectory, entries, options_.trajectory)) continue;
      auto t = plan_at_least(v, entries);
      if (t) entries[i].trajectory = std::make_shared<PathTrajectory>(std::move(*t));
    }
  }

  /// Fills `entries` along `order` with the incumbents that fit and new plans for the others;
  /// returns the place of the first vehicle without a plan.
  std::optional<std::size_t> keep_or_plan(const Order& order, const JointPlan& incumbent,
                                          std::vector<Entry>& entries) {
    bool changed = false;  // until then, the incumbents only have to fit the forecasts
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::span<const Entry> before =
          changed ? std::span<const Entry>(entries) : std::span<const Entry>();
      if (const Entry* old = fitting_incumbent(order[i], incumbent, before)) {
        entries.push_back(*old);
        continue;
      }
      changed = true;
      auto t = plan_at_least(scene_.vehicle(order[i]), entries);
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

  /// What is left when no order works. Whoever has no plan looks for one among those that stand, or
  /// brakes, and then those who would meet it there look for other plans.
  CrossingResult around_the_stuck(const Order& order, const JointPlan& incumbent,
                                  bool old_plans_stand) {
    std::vector<Entry> planned;
    std::vector<Entry> bodies;
    Order open;
    for (const std::int64_t key : order) {
      const Entry* old = old_plans_stand ? fitting_incumbent(key, incumbent, {}) : nullptr;
      if (old != nullptr) planned.push_back(*old);
      if (old == nullptr) open.push_back(key);
    }
    CrossingResult result;
    std::set<std::int64_t> tried;
    for (std::size_t next = 0; next < open.size(); ++next) {
      const RoadVehicle& v = scene_.vehicle(open[next]);
      if (work_.left > 0 || tried.insert(v.key).second) {
        std::vector<Entry> before = bodies;
        before.insert(before.end(), planned.begin(), planned.end());
        if (const Entry* old = fitting_incumbent(v.key, incumbent, before)) {
          planned.push_back(*old);
          continue;
        }
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

  /// The incumbent of a vehicle if it still fits among those planned `before`; else nullptr.
  const Entry* fitting_incumbent(std::int64_t key, const JointPlan& incumbent,
                                 std::span<const Entry> before) {
    const auto old = std::ranges::find(incumbent.entries, key, &Entry::key);
    const bool fits =
        old != incumbent.entries.end() && still_fits(pairs_, scene_.vehicle(key), *old->trajectory,
                                                     before, options_.trajectory, &work_);
    return fits ? &*old : nullptr;
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

  void improve(CrossingResult& best) {
    if (options_.tries <= 0) return;
    if (int(best.plan.entries.size()) > options_.many) {
      improve_neighbourhoods(best);
    } else {
      improve_order(best);
    }
  }

  /// Large neighbourhood search: a vehicle that loses time and some of those it meets are planned
  /// anew, in another order, around all others as they are.
  void improve_neighbourhoods(CrossingResult& best) {
    std::vector<double> delays = own_delays(best.plan.entries);
    int left = options_.tries * options_.per_try;
    for (int failures = 0; left > 0 && failures < options_.patience && work_.left > 0; --left) {
      if (std::accumulate(delays.begin(), delays.end(), 0.0) < 0.1) return;
      const Order chosen = neighbourhood(best.plan.entries, draws_.weighted(delays));
      std::vector<Entry> entries = best.plan.entries;
      std::erase_if(entries, [&](const Entry& e) { return std::ranges::count(chosen, e.key) > 0; });
      ++failures;
      if (plan_rest(joined(keys_of(entries), chosen), entries, best.cost)) continue;
      const double cost = cost_of(entries);
      if (cost >= best.cost - 1e-6) continue;
      failures = 0;
      best = {{in_lane_order(std::move(entries))}, {}, cost};
      delays = own_delays(best.plan.entries);
    }
  }

  /// A vehicle with some of its followers, and behind them another one that it meets, with some of
  /// its own: who passes later needs room behind it.
  Order neighbourhood(const std::vector<Entry>& entries, std::size_t first) {
    constexpr int kFollowers = 4;
    const std::size_t own = pairs_.index(entries[first].key);
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const std::size_t other = pairs_.index(entries[i].key);
      if (i == first || pairs_.leads(own, other) || pairs_.leads(other, own)) continue;
      if (meet_soon(own, *entries[first].trajectory, entries[i])) near.push_back(i);
    }
    Order chosen;
    add_with_followers(entries, first, draws_.between(0, kFollowers), chosen);
    if (!near.empty()) {
      const std::size_t other = near[std::size_t(draws_.between(0, int(near.size()) - 1))];
      add_with_followers(entries, other, draws_.between(0, kFollowers), chosen);
    }
    return in_lane_order(chosen);
  }

  void add_with_followers(const std::vector<Entry>& entries, std::size_t i, int followers,
                          Order& chosen) const {
    const std::int64_t leader = entries[i].key;
    if (std::ranges::find(chosen, leader) == chosen.end()) chosen.push_back(leader);
    for (; i < entries.size() && followers > 0; ++i) {
      if (!leads(leader, entries[i].key)) continue;
      --followers;
      const bool known = std::ranges::find(chosen, entries[i].key) != chosen.end();
      if (!known) chosen.push_back(entries[i].key);
    }
  }

  /// What each vehicle loses beside what its leader loses already [s], with a little of that.
  std::vector<double> own_delays(const std::vector<Entry>& entries) {
    constexpr double kShare = 0.05;
    const std::vector<double> delays = delays_of(entries);
    std::vector<double> own = delays;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      std::size_t leader = i;
      while (leader > 0 && !leads(entries[leader - 1].key, entries[i].key)) --leader;
      if (leader == 0) continue;
      own[i] = std::max(kShare * delays[i], delays[i] - delays[leader - 1]);
    }
    return own;
  }

  /// Would the other one be where this one is, had either been a few seconds earlier or later?
  [[nodiscard]] bool meet_soon(std::size_t own, const PathTrajectory& t, const Entry& other) const {
    constexpr double kSoon = 4.0;  // [s]
    const ContactView contact = pairs_.between(own, pairs_.index(other.key));
    if (contact.contact->never()) return false;
    const auto few = std::int64_t(kSoon / scene_.grid.dt);
    const std::int64_t last = std::min(t.end() - 1, other.trajectory->end() - 1 + few);
    for (std::int64_t k = scene_.step; k <= last; k += few) {
      const std::int64_t until = std::min(k + few, t.end() - 1);
      const std::int64_t from = std::max(scene_.step, k - few);
      if (from >= other.trajectory->end()) return false;
      const std::int64_t to = std::min(until + few, other.trajectory->end() - 1);
      if (contact.table().reaches(t.at(k).s, t.at(until).s, other.trajectory->at(from).s,
                                  other.trajectory->at(to).s)) {
        return true;
      }
    }
    return false;
  }

  /// Local search over orders: single vehicles earlier or later, or with their followers earlier.
  void improve_order(CrossingResult& best) {
    std::vector<double> delays;
    for (int attempt = 0; attempt < options_.tries && work_.left > 0; ++attempt) {
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

  /// The order in which nobody comes before its lane leaders: whoever does waits for them.
  [[nodiscard]] Order in_lane_order(const Order& order) const {
    const std::size_t n = order.size();
    std::vector<std::size_t> index;
    for (const std::int64_t key : order) index.push_back(pairs_.index(key));
    std::vector<int> leaders(n, 0);  // that are not sorted yet
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) leaders[i] += pairs_.leads(index[j], index[i]) ? 1 : 0;
    }
    Order sorted;
    std::vector<bool> taken(n, false);
    while (sorted.size() < n) {
      std::size_t next = 0;
      while (next < n && (taken[next] || leaders[next] > 0)) ++next;
      // Leaders in a circle: one of them has to be the first.
      if (next == n) next = std::size_t(std::ranges::find(taken, false) - taken.begin());
      taken[next] = true;
      sorted.push_back(order[next]);
      for (std::size_t i = 0; i < n; ++i) leaders[i] -= pairs_.leads(index[next], index[i]) ? 1 : 0;
    }
    return sorted;
  }

  static Order keys_of(const std::vector<Entry>& entries) {
    Order keys;
    for (const Entry& e : entries) keys.push_back(e.key);
    return keys;
  }

  static Order joined(Order order, const Order& more) {
    order.insert(order.end(), more.begin(), more.end());
    return order;
  }

  [[nodiscard]] std::vector<Entry> in_lane_order(const std::vector<Entry>& entries) const {
    std::vector<Entry> sorted;
    for (const std::int64_t key : in_lane_order(keys_of(entries))) {
      sorted.push_back(*std::ranges::find(entries, key, &Entry::key));
    }
    return sorted;
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
    std::vector<OnExit> all;
    for (const Entry& e : entries) all.push_back({&scene_.vehicle(e.key), e.trajectory.get()});
    for (const Forecast& f : scene_.forecasts) all.push_back({&f.vehicle, &f.trajectory});
    double cost = 0.0;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      cost += handback_cost(entries[i]) + options_.headway_weight * missing_headway(all[i], all);
    }
    return cost;
  }

  struct OnExit {
    const RoadVehicle* vehicle;
    const PathTrajectory* trajectory;
  };

  /// Time headway that the driver who takes over will miss [s].
  [[nodiscard]] double missing_headway(const OnExit& own, const std::vector<OnExit>& all) const {
    const RoadVehicle& v = *own.vehicle;
    if (v.exit_lane < 0) return 0.0;
    const std::int64_t k = arrival_step(*own.trajectory, v.s_handback);
    if (k >= own.trajectory->end()) return 0.0;
    const InertialState state = own.trajectory->at(k);
    double missing = 0.0;
    for (const auto& [vehicle, trajectory] : all) {
      const RoadVehicle& o = *vehicle;
      if (o.exit_lane != v.exit_lane) continue;
      const InertialState ahead = trajectory->at(k);
      const double gap = (ahead.s - o.s_exit_lane) - (state.s - v.s_exit_lane);
      if (gap <= 0.0 || ahead.s >= PathTrajectory::kGone) continue;
      const double wanted =
          drivers_gap(v, state.v, scene_.body(v).max_decel, ahead.v, scene_.body(o).max_decel);
      missing += std::max(0.0, wanted - (gap - scene_.body(o).length())) / std::max(1.0, state.v);
    }
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
