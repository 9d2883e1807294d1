#include "planner/road/crossing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <set>

#include "planner/road/joint_cost.hpp"
#include "planner/road/known_plans.hpp"
#include "planner/road/neighbourhoods.hpp"
#include "planner/road/passing_order.hpp"
#include "planner/search/draws.hpp"

namespace mvtp {
namespace {

using Entry = JointPlan::Entry;
using Order = PassingOrder;

/// Looks that the plan of one vehicle may take although the work is used up.
constexpr std::int64_t kLeastWork = 10000;
constexpr double kNotWorthIt = 0.1;  ///< [s] for which nobody asks again

class CrossingPlanner {
 public:
  CrossingPlanner(const RoadPairs& pairs, const CrossingOptions& options, std::uint64_t seed,
                  WorkBudget work)
      : pairs_(pairs),
        orders_(pairs),
        neighbourhoods_(pairs),
        cost_(pairs, options.profile, options.headway_weight),
        plans_(pairs, cost_, options.profile),
        scene_(pairs.scene()),
        options_(options),
        draws_(seed),
        work_(work) {}

  CrossingResult plan(const Order& keys, const JointPlan& incumbent) {
    leaving_ = those_leaving(incumbent);
    CrossingResult result = complete(keys, incumbent);
    leaving_ = those_leaving(result.plan);
    if (result.unplanned.empty()) improve(result);
    return result;
  }

 private:
  /// The plans that are not changed to make room for others.
  [[nodiscard]] JointPlan those_leaving(const JointPlan& plan) const {
    JointPlan leaving;
    for (const RoadVehicle& v : scene_.vehicles) {
      const auto e = std::ranges::find(plan.entries, v.key, &Entry::key);
      if (v.leaves() && e != plan.entries.end()) leaving.entries.push_back(*e);
    }
    return leaving;
  }

  /// A plan for every vehicle: those without an incumbent around all incumbents, as long as these
  /// fit; else in order, where a vehicle that finds none moves to the front, which is priority
  /// inheritance on complete speed profiles.
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
    order = orders_.in_lane_order(order);

    const std::int64_t reserve = work_.left / 2;
    Order repaired = order;
    for (int repair = 0;; ++repair) {
      std::vector<Entry> entries;
      const std::optional<std::size_t> failed = keep_or_plan(repaired, incumbent, entries);
      if (!failed) return {{entries}, {}, cost_.of(entries)};
      if (repair >= options_.repairs || work_.left < reserve) break;
      if (is_hopeless(scene_.vehicle(repaired[*failed]), incumbent)) break;
      if (!orders_.move_to_front(repaired, *failed)) break;
    }
    // No order works for all: either old plans stand as long as they fit, or earlier ones go first.
    CrossingResult standing = around_the_stuck(order, incumbent, /*old_plans_stand=*/true);
    if (standing.unplanned.size() < 2 || work_.left <= 0) return standing;
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
    ask_again(entries);
    for (std::size_t i = old; i < order.size(); ++i) {
      if (!fit_in(scene_.vehicle(order[i]), entries, {})) return std::nullopt;
    }
    return CrossingResult{{in_lane_order(entries)}, {}, cost_.of(entries)};
  }

  /// Is there no plan for the vehicle even around forecasts alone? Then no order has one.
  bool is_hopeless(const RoadVehicle& v, const JointPlan& incumbent) {
    return fitting_incumbent(v.key, incumbent, {}) == nullptr && !plan_at_least(v, {});
  }

  /// Adds a plan for `v` to those `planned`, around them and the `bodies`; if there is none, around
  /// all but the few of them each of which alone leaves none, which get new plans around it.
  /// False, and nothing changes, if that does not work either.
  bool fit_in(const RoadVehicle& v, std::vector<Entry>& planned, std::span<const Entry> bodies) {
    std::vector<Entry> all(bodies.begin(), bodies.end());
    all.insert(all.end(), planned.begin(), planned.end());
    if (const KnownPlans::Plan t = plan_at_least(v, all)) {
      planned.push_back({v.key, t});
      return true;
    }
    const Order blocking = plan_at_least(v, bodies) ? blockers_of(v, planned) : Order();
    if (blocking.empty() || work_.left <= 0) return false;
    std::erase_if(all, [&](const Entry& e) { return std::ranges::count(blocking, e.key) > 0; });
    for (const std::int64_t key : joined({v.key}, blocking)) {
      const KnownPlans::Plan t = plan_at_least(scene_.vehicle(key), all);
      if (!t) return false;
      all.push_back({key, t});
    }
    planned.assign(all.begin() + std::ptrdiff_t(bodies.size()), all.end());
    return true;
  }

  /// In lane order, those whose plans each leave none for `v`; empty if they are too many, or if
  /// one of them leaves.
  Order blockers_of(const RoadVehicle& v, const std::vector<Entry>& planned) {
    constexpr std::size_t kFew = 4;
    const std::size_t self = pairs_.index(v.key);
    Order found;
    for (const Entry& e : planned) {
      if (pairs_.between(self, pairs_.index(e.key)).contact->never()) continue;
      if (plan_at_least(v, {&e, 1})) continue;
      found.push_back(e.key);
      if (found.size() > kFew || leaving_.find(e.key)) return {};
    }
    return orders_.in_lane_order(found);
  }

  /// A leader may go on otherwise than it was expected to when its follower was planned: whoever
  /// would be handed back too close behind it is planned anew around all others, if that works.
  void restore_headways(std::vector<Entry>& entries) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const RoadVehicle& v = scene_.vehicle(entries[i].key);
      if (leaves_room(pairs_, v, *entries[i].profile, entries, options_.profile)) continue;
      const KnownPlans::Plan t = plan_at_least(v, entries);
      if (t) entries[i].profile = t;
    }
  }

  /// Better plans around all others for those who may change theirs.
  void ask_again(std::vector<Entry>& entries) {
    for (Entry& e : entries) {
      const RoadVehicle& v = scene_.vehicle(e.key);
      const double cost = cost_.until_handback(e);
      if (!v.asks_again || cost <= cost_.alone(e.key) + kNotWorthIt) continue;
      const KnownPlans::Plan t = plan_at_least(v, entries, cost / v.weight);
      if (!t) continue;
      const Entry better{e.key, t};
      if (cost_.until_handback(better) < cost) e = better;
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
      // All others make room for who leaves.
      if (i > 0 && fitting_incumbent(order[i], leaving_, {}) != nullptr) return i;
      const KnownPlans::Plan t = plan_at_least(scene_.vehicle(order[i]), entries);
      if (!t) return i;
      entries.push_back({order[i], t});
    }
    return std::nullopt;
  }

  /// A plan even if the work is used up, as long as it is found fast.
  /// @param cost  [s] from which it is of no use.
  KnownPlans::Plan plan_at_least(const RoadVehicle& v, std::span<const Entry> before,
                                 double cost = std::numeric_limits<double>::infinity()) {
    WorkBudget least{std::max(work_.left, kLeastWork)};
    const std::int64_t given = least.left;
    KnownPlans::Plan t = plans_.plan(v, before, {.work = &least, .cost = cost});
    work_.left -= given - least.left;
    return t;
  }

  /// If no order works for all: vehicles without a plan are planned around those that keep theirs.
  CrossingResult around_the_stuck(const Order& order, const JointPlan& incumbent,
                                  bool old_plans_stand) {
    std::vector<Entry> planned;
    Order open;
    for (const std::int64_t key : order) {
      const bool stands = old_plans_stand || leaving_.find(key) != nullptr;
      const Entry* old = stands ? fitting_incumbent(key, incumbent, {}) : nullptr;
      if (old != nullptr) planned.push_back(*old);
      if (old == nullptr) open.push_back(key);
    }
    CrossingResult result = fit_in_or_brake(std::move(open), std::move(planned), incumbent);
    // Vehicles that lost their plans have made room for those that found none before. No plan
    // counts on room that a driver would have to make.
    while (result.unplanned.size() > 1 && work_.left > 0) {
      open = orders_.in_lane_order(result.unplanned);
      std::ranges::stable_partition(open, [&](std::int64_t key) { return leaving_.find(key); });
      CrossingResult again = fit_in_or_brake(open, result.plan.entries, incumbent);
      if (again.unplanned.size() >= result.unplanned.size()) break;
      result = std::move(again);
    }
    return result;
  }

  /// Plans the `open` vehicles around those `planned`. A vehicle that finds no plan brakes, and the
  /// vehicles that would meet it there are planned anew.
  CrossingResult fit_in_or_brake(Order open, std::vector<Entry> planned,
                                 const JointPlan& incumbent) {
    std::vector<Entry> bodies;
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
        if (fit_in(v, planned, bodies)) continue;
      }
      result.unplanned.push_back(v.key);
      const double b = scene_.body(v).max_decel;
      bodies.push_back({v.key, std::make_shared<SpeedProfile>(stop_after(scene_, v.now, -b, b))});
      const std::span<const Entry> body(&bodies.back(), 1);
      std::erase_if(planned, [&](const Entry& e) {
        const bool fits =
            fits_beside(pairs_, scene_.vehicle(e.key), *e.profile, body, options_.profile, &work_);
        if (!fits) open.push_back(e.key);
        return !fits;
      });
    }
    result.cost = cost_.of(planned);
    result.plan.entries = std::move(planned);
    return result;
  }

  /// The incumbent of a vehicle if it still fits among those planned `before`; else nullptr.
  const Entry* fitting_incumbent(std::int64_t key, const JointPlan& incumbent,
                                 std::span<const Entry> before) {
    const auto old = std::ranges::find(incumbent.entries, key, &Entry::key);
    const bool fits =
        old != incumbent.entries.end() &&
        still_fits(pairs_, scene_.vehicle(key), *old->profile, before, options_.profile, &work_);
    return fits ? &*old : nullptr;
  }

  /// Extends `entries` along `order`; returns the place of the first vehicle without a plan, or
  /// where it is clear that the cost will not be below `budget`: nobody is faster than alone.
  std::optional<std::size_t> plan_rest(const Order& order, std::vector<Entry>& entries,
                                       double budget) {
    double cost = 0.0;
    for (const Entry& e : entries) cost += cost_.until_handback(e);
    for (std::size_t i = entries.size(); i < order.size(); ++i) cost += cost_.alone(order[i]);
    for (std::size_t i = entries.size(); i < order.size(); ++i) {
      if (cost >= budget) return i;
      const RoadVehicle& v = scene_.vehicle(order[i]);
      if (leaving_.find(v.key)) {
        const Entry* stands = fitting_incumbent(v.key, leaving_, entries);
        if (stands == nullptr) return i;
        entries.push_back(*stands);
        cost += cost_.until_handback(*stands) - cost_.alone(order[i]);
        continue;
      }
      // Whoever costs more than this makes the whole no better.
      const PlanLimits limits{.work = &work_,
                              .cost = (budget - cost + cost_.alone(order[i])) / v.weight};
      const KnownPlans::Plan t = plans_.plan(v, entries, limits);
      if (!t || work_.left <= 0) return i;
      entries.push_back({order[i], t});
      cost += cost_.until_handback(entries.back()) - cost_.alone(order[i]);
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
    std::vector<double> delays = cost_.own_delays(best.plan.entries);
    int left = options_.tries * options_.per_try;
    for (int failures = 0; left > 0 && failures < options_.stagnation_limit && !work_.is_spent();
         --left) {
      if (std::accumulate(delays.begin(), delays.end(), 0.0) < 0.1) return;
      const Order chosen =
          neighbourhoods_.around(best.plan.entries, draws_.weighted(delays), draws_);
      std::vector<Entry> entries = best.plan.entries;
      std::erase_if(entries, [&](const Entry& e) { return std::ranges::count(chosen, e.key) > 0; });
      ++failures;
      if (plan_rest(joined(keys_of(entries), chosen), entries, best.cost)) continue;
      const double cost = cost_.of(entries);
      if (cost >= best.cost - 1e-6) continue;
      failures = 0;
      best = {{in_lane_order(std::move(entries))}, {}, cost};
      delays = cost_.own_delays(best.plan.entries);
    }
  }

  /// Local search over orders: single vehicles earlier or later, or with their followers earlier.
  void improve_order(CrossingResult& best) {
    std::vector<double> delays;
    for (int attempt = 0; attempt < options_.tries && !work_.is_spent(); ++attempt) {
      const Order order = keys_of(best.plan.entries);
      delays = cost_.delays(best.plan.entries);
      if (std::accumulate(delays.begin(), delays.end(), 0.0) < 0.1) return;
      const Order changed = random_move(order, delays);
      const std::size_t same = common_prefix(changed, best.plan.entries);
      if (same == order.size()) continue;
      std::vector<Entry> entries(best.plan.entries.begin(),
                                 best.plan.entries.begin() + std::ptrdiff_t(same));
      if (plan_rest(changed, entries, best.cost)) continue;
      const double cost = cost_.of(entries);
      if (cost < best.cost - 1e-6) best = {{std::move(entries)}, {}, cost};
    }
  }

  Order random_move(Order order, const std::vector<double>& delays) {
    const std::size_t i = draws_.weighted(delays);
    const int kind = draws_.between(0, 3);
    if (kind == 0) {
      orders_.move_later(order, i, draws_.between(1, 6));
    } else {
      const int places = draws_.between(1, 8);
      const int followers = kind == 1 ? draws_.between(1, 4) : 0;
      orders_.move_earlier(order, i, places, followers);
    }
    return order;
  }

  static Order keys_of(const std::vector<Entry>& entries) {
    Order keys;
    for (const Entry& e : entries) keys.push_back(e.key);
    return keys;
  }

  [[nodiscard]] std::vector<Entry> in_lane_order(const std::vector<Entry>& entries) const {
    std::vector<Entry> sorted;
    for (const std::int64_t key : orders_.in_lane_order(keys_of(entries))) {
      sorted.push_back(*std::ranges::find(entries, key, &Entry::key));
    }
    return sorted;
  }

  static std::size_t common_prefix(const Order& order, const std::vector<Entry>& entries) {
    std::size_t n = 0;
    while (n < order.size() && n < entries.size() && order[n] == entries[n].key) ++n;
    return n;
  }

  const RoadPairs& pairs_;
  PassingOrders orders_;
  Neighbourhoods neighbourhoods_;
  JointCost cost_;
  KnownPlans plans_;
  const RoadScene& scene_;
  const CrossingOptions& options_;
  Draws draws_;
  WorkBudget work_;
  JointPlan leaving_;  ///< see those_leaving()
};

}  // namespace

CrossingResult plan_crossing(const RoadPairs& pairs, const std::vector<std::int64_t>& keys,
                             const JointPlan& incumbent, const CrossingOptions& options,
                             std::uint64_t seed, WorkBudget work) {
  return CrossingPlanner(pairs, options, seed, work).plan(keys, incumbent);
}

}  // namespace mvtp
