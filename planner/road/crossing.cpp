#include "planner/road/crossing.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>

#include "planner/road/better_orders.hpp"
#include "planner/road/crossing_search.hpp"

namespace mvtp {
namespace {

using Entry = JointPlan::Entry;
using Order = PassingOrder;

/// Looks that the plan of one vehicle may take although the work is used up.
constexpr std::int64_t kLeastWork = 10000;
constexpr double kNotWorthIt = 0.1;  ///< [s] for which nobody asks again

/// A plan for everybody, if there is one.
class CrossingCompletion {
 public:
  explicit CrossingCompletion(CrossingSearch& search) : search_(search) {}

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
    order = search_.orders.in_lane_order(order);

    if (auto result = in_some_order(order, incumbent)) return *std::move(result);
    // Plans made around drivers who might have waited for long are kept no longer than they help.
    if (search_.work.left > 0) {
      if (auto result = in_some_order(order, search_.leaving)) return *std::move(result);
    }
    // No order works for all: either old plans stand as long as they fit, or earlier ones go first.
    CrossingResult standing = around_the_stuck(order, incumbent, /*old_plans_stand=*/true);
    if (standing.unplanned.size() < 2 || search_.work.left <= 0) return standing;
    CrossingResult in_order = around_the_stuck(order, incumbent, /*old_plans_stand=*/false);
    return in_order.unplanned.size() < standing.unplanned.size() ? in_order : standing;
  }

 private:
  /// Plans for everybody, those `kept` as long as they fit, in `order` or one in which who finds
  /// none goes earlier.
  std::optional<CrossingResult> in_some_order(Order order, const JointPlan& kept) {
    const std::int64_t reserve = search_.work.left / 2;
    for (int repair = 0;; ++repair) {
      std::vector<Entry> entries;
      const std::optional<std::size_t> failed = keep_or_plan(order, kept, entries);
      if (!failed) return CrossingResult{{entries}, {}, search_.cost.of(entries)};
      if (repair >= search_.options.repairs || search_.work.left < reserve) break;
      if (is_hopeless(search_.scene.vehicle(order[*failed]), kept)) break;
      if (!search_.orders.move_to_front(order, *failed)) break;
    }
    return std::nullopt;
  }

  /// All incumbents stand, those of the first `old` vehicles of `order`, and all others find plans
  /// around them; nullopt if that is not possible.
  std::optional<CrossingResult> around_the_incumbents(const Order& order, std::size_t old,
                                                      const JointPlan& incumbent) {
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < old; ++i) {
      const Entry* fits = search_.fitting_incumbent(order[i], incumbent, {});
      if (fits == nullptr) return std::nullopt;
      entries.push_back(*fits);
    }
    restore_headways(entries);
    ask_again(entries);
    for (std::size_t i = old; i < order.size(); ++i) {
      if (!fit_in(search_.scene.vehicle(order[i]), entries, {})) return std::nullopt;
    }
    return CrossingResult{{search_.in_lane_order(entries)}, {}, search_.cost.of(entries)};
  }

  /// Is there no plan for the vehicle even around forecasts alone? Then no order has one.
  bool is_hopeless(const RoadVehicle& v, const JointPlan& incumbent) {
    return search_.fitting_incumbent(v.key, incumbent, {}) == nullptr && !plan_at_least(v, {});
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
    if (blocking.empty() || search_.work.left <= 0) return false;
    std::erase_if(all, [&](const Entry& e) { return std::ranges::count(blocking, e.key) > 0; });
    for (const std::int64_t key : joined({v.key}, blocking)) {
      const KnownPlans::Plan t = plan_at_least(search_.scene.vehicle(key), all);
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
    const std::size_t self = search_.pairs.index(v.key);
    Order found;
    for (const Entry& e : planned) {
      if (search_.pairs.between(self, search_.pairs.index(e.key)).contact->never()) continue;
      if (plan_at_least(v, {&e, 1})) continue;
      found.push_back(e.key);
      if (found.size() > kFew || search_.leaving.find(e.key)) return {};
    }
    return search_.orders.in_lane_order(found);
  }

  /// A leader may go on otherwise than it was expected to when its follower was planned: whoever
  /// would be handed back too close behind it is planned anew around all others, if that works.
  void restore_headways(std::vector<Entry>& entries) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const RoadVehicle& v = search_.scene.vehicle(entries[i].key);
      if (leaves_room(search_.pairs, v, *entries[i].profile, entries, search_.options.profile))
        continue;
      const KnownPlans::Plan t = plan_at_least(v, entries);
      if (t) entries[i].profile = t;
    }
  }

  /// Better plans around all others for those who may change theirs.
  void ask_again(std::vector<Entry>& entries) {
    for (Entry& e : entries) {
      const RoadVehicle& v = search_.scene.vehicle(e.key);
      const double cost = search_.cost.until_handback(e);
      if (!v.asks_again || cost <= search_.cost.alone(e.key) + kNotWorthIt) continue;
      const KnownPlans::Plan t = plan_at_least(v, entries, cost / v.weight);
      if (!t) continue;
      const Entry better{e.key, t};
      if (search_.cost.until_handback(better) < cost) e = better;
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
      if (const Entry* old = search_.fitting_incumbent(order[i], incumbent, before)) {
        entries.push_back(*old);
        continue;
      }
      changed = true;
      // All others make room for who leaves.
      if (i > 0 && search_.fitting_incumbent(order[i], search_.leaving, {}) != nullptr) return i;
      const KnownPlans::Plan t = plan_at_least(search_.scene.vehicle(order[i]), entries);
      if (!t) return i;
      entries.push_back({order[i], t});
    }
    return std::nullopt;
  }

  /// A plan even if the work is used up, as long as it is found fast.
  /// @param cost  [s] from which it is of no use.
  KnownPlans::Plan plan_at_least(const RoadVehicle& v, std::span<const Entry> before,
                                 double cost = std::numeric_limits<double>::infinity()) {
    WorkBudget least{std::max(search_.work.left, kLeastWork)};
    const std::int64_t given = least.left;
    KnownPlans::Plan t = search_.plans.plan(v, before, {.work = &least, .cost = cost});
    search_.work.left -= given - least.left;
    return t;
  }

  /// If no order works for all: vehicles without a plan are planned around those that keep theirs.
  CrossingResult around_the_stuck(const Order& order, const JointPlan& incumbent,
                                  bool old_plans_stand) {
    std::vector<Entry> planned;
    Order open;
    for (const std::int64_t key : order) {
      const bool stands = old_plans_stand || search_.leaving.find(key) != nullptr;
      const Entry* old = stands ? search_.fitting_incumbent(key, incumbent, {}) : nullptr;
      if (old != nullptr) planned.push_back(*old);
      if (old == nullptr) open.push_back(key);
    }
    CrossingResult result = fit_in_or_brake(std::move(open), std::move(planned), incumbent);
    // Vehicles that lost their plans have made room for those that found none before. No plan
    // counts on room that a driver would have to make.
    while (result.unplanned.size() > 1 && search_.work.left > 0) {
      open = search_.orders.in_lane_order(result.unplanned);
      std::ranges::stable_partition(open,
                                    [&](std::int64_t key) { return search_.leaving.find(key); });
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
      const RoadVehicle& v = search_.scene.vehicle(open[next]);
      if (search_.work.left > 0 || tried.insert(v.key).second) {
        std::vector<Entry> before = bodies;
        before.insert(before.end(), planned.begin(), planned.end());
        if (const Entry* old = search_.fitting_incumbent(v.key, incumbent, before)) {
          planned.push_back(*old);
          continue;
        }
        if (fit_in(v, planned, bodies)) continue;
      }
      result.unplanned.push_back(v.key);
      const double b = search_.scene.body(v).max_decel;
      bodies.push_back(
          {v.key, std::make_shared<SpeedProfile>(stop_after(search_.scene, v.now, -b, b))});
      const std::span<const Entry> body(&bodies.back(), 1);
      std::erase_if(planned, [&](const Entry& e) {
        const bool fits = fits_beside(search_.pairs, search_.scene.vehicle(e.key), *e.profile, body,
                                      search_.options.profile, &search_.work);
        if (!fits) open.push_back(e.key);
        return !fits;
      });
    }
    result.cost = search_.cost.of(planned);
    result.plan.entries = std::move(planned);
    return result;
  }

  CrossingSearch& search_;
};

}  // namespace

CrossingResult plan_crossing(const RoadPairs& pairs, const std::vector<std::int64_t>& keys,
                             const JointPlan& incumbent, const CrossingOptions& options,
                             std::uint64_t seed, WorkBudget work) {
  CrossingSearch search(pairs, options, work);
  search.leaving = search.those_leaving(incumbent);
  CrossingResult result = CrossingCompletion(search).complete(keys, incumbent);
  search.leaving = search.those_leaving(result.plan);
  if (result.unplanned.empty()) improve(result, search, seed);
  return result;
}

}  // namespace mvtp
