#include "planner/road/better_orders.hpp"

#include <algorithm>
#include <numeric>

#include "planner/problem/draws.hpp"
#include "planner/road/neighbourhoods.hpp"

namespace mvtp {
namespace {

using Entry = JointPlan::Entry;
using Order = PassingOrder;

class BetterOrders {
 public:
  BetterOrders(CrossingSearch& search, std::uint64_t seed)
      : search_(search), neighbourhoods_(search.pairs), draws_(seed) {}

  void improve(CrossingResult& best) {
    if (search_.options.tries <= 0) return;
    if (int(best.plan.entries.size()) > search_.options.many) {
      improve_neighbourhoods(best);
    } else {
      improve_order(best);
    }
  }

 private:
  /// Extends `entries` along `order`. False if somebody finds no plan, or as soon as it is clear
  /// that the cost will not be below `budget`: nobody is faster than alone.
  bool plan_rest(const Order& order, std::vector<Entry>& entries, double budget) {
    JointCost& costs = search_.cost;
    double cost = 0.0;
    for (const Entry& e : entries) cost += costs.until_handback(e);
    for (std::size_t i = entries.size(); i < order.size(); ++i) cost += costs.alone(order[i]);
    for (std::size_t i = entries.size(); i < order.size(); ++i) {
      if (cost >= budget) return false;
      const RoadVehicle& v = search_.scene.vehicle(order[i]);
      if (search_.leaving.find(v.key)) {
        const Entry* stands = search_.fitting_incumbent(v.key, search_.leaving, entries);
        if (stands == nullptr) return false;
        entries.push_back(*stands);
        cost += costs.until_handback(*stands) - costs.alone(order[i]);
        continue;
      }
      // Whoever costs more than this makes the whole no better.
      const PlanLimits limits{.work = &search_.work,
                              .cost = (budget - cost + costs.alone(order[i])) / v.weight};
      const KnownPlans::Plan t = search_.plans.plan(v, entries, limits);
      if (!t || search_.work.left <= 0) return false;
      entries.push_back({order[i], t});
      cost += costs.until_handback(entries.back()) - costs.alone(order[i]);
    }
    return true;
  }

  /// Large neighbourhood search: a vehicle that loses time and some of those it meets are planned
  /// anew, in another order, around all others as they are.
  void improve_neighbourhoods(CrossingResult& best) {
    std::vector<double> delays = search_.cost.own_delays(best.plan.entries);
    int left = search_.options.tries * search_.options.per_try;
    for (int failures = 0;
         left > 0 && failures < search_.options.stagnation_limit && !search_.work.is_spent();
         --left) {
      if (std::accumulate(delays.begin(), delays.end(), 0.0) < 0.1) return;
      const Order chosen =
          neighbourhoods_.around(best.plan.entries, draws_.weighted(delays), draws_);
      std::vector<Entry> entries = best.plan.entries;
      std::erase_if(entries, [&](const Entry& e) { return std::ranges::count(chosen, e.key) > 0; });
      ++failures;
      if (!plan_rest(joined(search_.keys_of(entries), chosen), entries, best.cost)) continue;
      const double cost = search_.cost.of(entries);
      if (cost >= best.cost - 1e-6) continue;
      failures = 0;
      best = {{search_.in_lane_order(std::move(entries))}, {}, cost};
      delays = search_.cost.own_delays(best.plan.entries);
    }
  }

  /// Local search over orders: single vehicles earlier or later, or with their followers earlier.
  void improve_order(CrossingResult& best) {
    std::vector<double> delays;
    for (int attempt = 0; attempt < search_.options.tries && !search_.work.is_spent(); ++attempt) {
      const Order order = search_.keys_of(best.plan.entries);
      delays = search_.cost.delays(best.plan.entries);
      if (std::accumulate(delays.begin(), delays.end(), 0.0) < 0.1) return;
      const Order changed = random_move(order, delays);
      const std::size_t same = common_prefix(changed, best.plan.entries);
      if (same == order.size()) continue;
      std::vector<Entry> entries(best.plan.entries.begin(),
                                 best.plan.entries.begin() + std::ptrdiff_t(same));
      if (!plan_rest(changed, entries, best.cost)) continue;
      const double cost = search_.cost.of(entries);
      if (cost < best.cost - 1e-6) best = {{std::move(entries)}, {}, cost};
    }
  }

  Order random_move(Order order, const std::vector<double>& delays) {
    const std::size_t i = draws_.weighted(delays);
    const int kind = draws_.between(0, 3);
    if (kind == 0) {
      search_.orders.move_later(order, i, draws_.between(1, 6));
    } else {
      const int places = draws_.between(1, 8);
      const int followers = kind == 1 ? draws_.between(1, 4) : 0;
      search_.orders.move_earlier(order, i, places, followers);
    }
    return order;
  }

  static std::size_t common_prefix(const Order& order, const std::vector<Entry>& entries) {
    std::size_t n = 0;
    while (n < order.size() && n < entries.size() && order[n] == entries[n].key) ++n;
    return n;
  }

  CrossingSearch& search_;
  Neighbourhoods neighbourhoods_;
  Draws draws_;
};

}  // namespace

void improve(CrossingResult& best, CrossingSearch& search, std::uint64_t seed) {
  BetterOrders(search, seed).improve(best);
}

}  // namespace mvtp
