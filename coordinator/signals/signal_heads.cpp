#include "coordinator/signals/signal_heads.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "coordinator/network/polyline.hpp"

namespace mvtp {
namespace {

/// Two movements whose middles come nearer than this are driven one after the other [m]: the
/// greatest width of a vehicle on European roads.
constexpr double kWidest = 2.55;
constexpr double kTimeTolerance = 1e-6;  ///< [s]

/// The middle of a connection inside its junction.
std::vector<Point> middle_of(const LaneGraph& graph, const LaneGraph::Link& link) {
  std::vector<Point> line = {graph.lane(link.from).shape.back()};
  for (const int via : link.via) {
    const std::vector<Point>& shape = graph.lane(via).shape;
    line.insert(line.end(), shape.begin(), shape.end());
  }
  line.push_back(graph.lane(link.to).shape.front());
  return line;
}

/// Do two lines come nearer to each other than `near` [m]? Looks every half metre.
bool are_close(const std::vector<Point>& a, const std::vector<Point>& b, double near) {
  constexpr double kLook = 0.5;  // [m]
  for (std::size_t i = 1; i < a.size(); ++i) {
    const double length = distance(a[i - 1], a[i]);
    const int looks = std::max(1, int(std::ceil(length / kLook)));
    for (int k = 0; k <= looks; ++k) {
      const double f = double(k) / looks;
      const Point p{a[i - 1].x + f * (a[i].x - a[i - 1].x), a[i - 1].y + f * (a[i].y - a[i - 1].y)};
      for (std::size_t j = 1; j < b.size(); ++j) {
        if (distance(p, nearest(p, b[j - 1], b[j])) < near) return true;
      }
    }
  }
  return false;
}

}  // namespace

double SignalTiming::yellow(double speed_limit) const {
  constexpr double kKmh = 1.0 / 3.6;
  constexpr double kRounding = 0.1;  // [m/s]: networks give 13.89 and 13.9 for 50 km/h
  if (!has_yellow) return 0.0;
  if (speed_limit <= 50.0 * kKmh + kRounding) return 3.0;
  return speed_limit <= 60.0 * kKmh + kRounding ? 4.0 : 5.0;
}

SignalHeads::SignalHeads(Traffic& traffic, const LaneGraph& graph,
                         const std::vector<bool>& coordinated, const SignalTiming& timing)
    : traffic_(traffic),
      graph_(graph),
      timing_(timing),
      heads_(std::size_t(graph.links() + graph.crossings())) {
  find_signals(coordinated);
  find_conflicts(coordinated);
}

/// Those all of whose lights are known.
void SignalHeads::find_signals(const std::vector<bool>& coordinated) {
  std::map<std::string, std::set<int>> lights;
  for (int k = 0; k < graph_.links(); ++k) {
    const LaneGraph::Link& link = graph_.link(k);
    if (link.signal.empty() || !coordinated[std::size_t(link.junction)]) continue;
    lights[link.signal].insert(link.signal_index);
  }
  for (int c = 0; c < graph_.crossings(); ++c) {
    const PedestrianCrossing& crossing = *graph_.crossing(c).crossing;
    if (crossing.signal.empty() || !coordinated[std::size_t(graph_.crossing(c).junction)]) continue;
    lights[crossing.signal].insert(crossing.lights.begin(), crossing.lights.end());
  }
  for (const auto& [signal, known] : lights) {
    const auto all = graph_.network().signals.find(signal);
    if (all != graph_.network().signals.end() && std::ssize(known) == all->second) {
      signals_.insert(signal);
    }
  }
}

void SignalHeads::find_conflicts(const std::vector<bool>& coordinated) {
  std::map<int, std::vector<int>> at_junction;
  for (int k = 0; k < graph_.links(); ++k) {
    const LaneGraph::Link& link = graph_.link(k);
    if (!coordinated[std::size_t(link.junction)] || !signals_.contains(link.signal)) continue;
    heads_[std::size_t(k)].owned = true;
    at_junction[link.junction].push_back(k);
  }
  for (const auto& [junction, links] : at_junction) {
    for (const int a : links) {
      for (const int b : links) {
        const LaneGraph::Link& first = graph_.link(a);
        const LaneGraph::Link& second = graph_.link(b);
        const bool meet = a < b && first.from != second.from &&
                          (first.to == second.to ||
                           are_close(middle_of(graph_, first), middle_of(graph_, second), kWidest));
        if (meet) cross_each_other(a, b);
      }
    }
  }
  for (int c = 0; c < graph_.crossings(); ++c) {
    const LaneGraph::Crossing& x = graph_.crossing(c);
    if (!coordinated[std::size_t(x.junction)] || !signals_.contains(x.crossing->signal)) continue;
    heads_[std::size_t(light_of_crossing(c))].owned = true;
    const double near = 0.5 * (kWidest + x.crossing->width);
    for (const int k : at_junction[x.junction]) {
      if (are_close(middle_of(graph_, graph_.link(k)), x.crossing->shape, near)) {
        cross_each_other(k, light_of_crossing(c));
      }
    }
  }
}

void SignalHeads::cross_each_other(int a, int b) {
  heads_[std::size_t(a)].crossing.push_back(b);
  heads_[std::size_t(b)].crossing.push_back(a);
}

void SignalHeads::call(int crossing, std::int64_t since) {
  heads_[std::size_t(light_of_crossing(crossing))].called = since;
}

void SignalHeads::reserve(int crossing, bool reserved) {
  heads_[std::size_t(light_of_crossing(crossing))].reserved = reserved;
}

void SignalHeads::occupy(int crossing, bool occupied) {
  heads_[std::size_t(light_of_crossing(crossing))].occupied = occupied;
}

void SignalHeads::expect_people(int crossing, double until) {
  heads_[std::size_t(light_of_crossing(crossing))].people_until = until;
}

double SignalHeads::barred_until(int link, const std::function<bool(int)>& beside) const {
  double until = -1e300;
  for (const int other : heads_[std::size_t(link)].crossing) {
    if (!beside(other)) until = std::max(until, heads_[std::size_t(other)].people_until);
  }
  return until;
}

bool SignalHeads::is_called_before(int link, std::int64_t came) const {
  const std::vector<int>& crossing = heads_[std::size_t(link)].crossing;
  return std::ranges::any_of(crossing,
                             [&](int other) { return heads_[std::size_t(other)].called < came; });
}

bool SignalHeads::all_show_green(std::span<const int> links) const {
  return !links.empty() &&
         std::ranges::all_of(links, [&](int k) { return light(k) == Light::kGreen; });
}

double SignalHeads::shown_for(int link) const {
  return traffic_.time() - heads_[std::size_t(link)].since;
}

bool SignalHeads::cross(int link, int other) const {
  return std::ranges::count(heads_[std::size_t(link)].crossing, other) > 0;
}

bool SignalHeads::may_turn_green(int link, const std::function<bool(int)>& beside) const {
  const std::vector<int>& crossing = heads_[std::size_t(link)].crossing;
  return std::ranges::all_of(crossing, [&](int other) {
    if (beside(other)) return true;
    const Head& head = heads_[std::size_t(other)];
    return head.light == Light::kRed && !head.reserved && !(head.occupied && timing_.has_yellow) &&
           shown_for(other) >= timing_.all_red - kTimeTolerance;
  });
}

void SignalHeads::own() {
  if (!free_) return;
  free_ = false;
  for (std::size_t k = 0; k < heads_.size(); ++k) {
    if (heads_[k].owned) show(int(k), Light::kRed);
  }
}

void SignalHeads::turn_green(int link, bool yields) {
  if (light(link) == Light::kGreen) return;
  if (link < graph_.links()) ++greens_;
  show(link, yields ? kYieldingGreen : Light::kGreen);
}

void SignalHeads::end_green(int link) {
  if (light(link) != Light::kGreen) return;
  show(link, yellow_of(link) <= 0.0 ? Light::kRed : Light::kYellow);
}

/// People have none [s].
double SignalHeads::yellow_of(int light) const {
  if (light >= graph_.links()) return 0.0;
  return timing_.yellow(graph_.lane(graph_.link(light).from).speed_limit);
}

void SignalHeads::advance() {
  for (std::size_t k = 0; k < heads_.size(); ++k) {
    if (!heads_[k].owned || heads_[k].light != Light::kYellow) continue;
    if (shown_for(int(k)) >= yellow_of(int(k)) - kTimeTolerance) show(int(k), Light::kRed);
  }
}

void SignalHeads::free() {
  if (free_) return;
  free_ = true;
  for (const std::string& signal : signals_) traffic_.free_signal(signal);
}

void SignalHeads::show(int link, Light light) {
  Head& head = heads_[std::size_t(link)];
  head.light = light == kYieldingGreen ? Light::kGreen : light;
  if (head.light == Light::kGreen) head.yields = light == kYieldingGreen;
  head.since = traffic_.time();
  if (link < graph_.links()) {
    return traffic_.show(graph_.link(link).signal, graph_.link(link).signal_index, light);
  }
  const PedestrianCrossing& crossing = *graph_.crossing(link - graph_.links()).crossing;
  for (const int index : crossing.lights) traffic_.show(crossing.signal, index, light);
}

}  // namespace mvtp
