#include "coordinator/signal_heads.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace mvtp {
namespace {

/// Two ways whose middles come nearer than this are driven one after the other [m]: the greatest
/// width of a vehicle on European roads.
constexpr double kWidest = 2.55;
constexpr double kInstant = 1e-6;  ///< [s]

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

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double length = dx * dx + dy * dy;
  const double f =
      length > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length, 0.0, 1.0) : 0.0;
  return std::hypot(a.x + f * dx - p.x, a.y + f * dy - p.y);
}

/// Do two lines come nearer to each other than a vehicle is wide? Looks every half metre.
bool are_close(const std::vector<Point>& a, const std::vector<Point>& b) {
  constexpr double kLook = 0.5;  // [m]
  for (std::size_t i = 1; i < a.size(); ++i) {
    const double length = std::hypot(a[i].x - a[i - 1].x, a[i].y - a[i - 1].y);
    const int looks = std::max(1, int(std::ceil(length / kLook)));
    for (int k = 0; k <= looks; ++k) {
      const double f = double(k) / looks;
      const Point p{a[i - 1].x + f * (a[i].x - a[i - 1].x), a[i - 1].y + f * (a[i].y - a[i - 1].y)};
      for (std::size_t j = 1; j < b.size(); ++j) {
        if (distance_to_segment(p, b[j - 1], b[j]) < kWidest) return true;
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
    : traffic_(traffic), graph_(graph), timing_(timing), heads_(std::size_t(graph.links())) {
  std::map<std::string, std::set<int>> lights;
  for (int k = 0; k < graph.links(); ++k) {
    const LaneGraph::Link& link = graph.link(k);
    if (link.signal.empty() || !coordinated[std::size_t(link.junction)]) continue;
    lights[link.signal].insert(link.signal_index);
  }
  for (const auto& [signal, known] : lights) {
    const auto all = graph.network().signals.find(signal);
    if (all != graph.network().signals.end() && std::ssize(known) == all->second) {
      signals_.insert(signal);
    }
  }
  std::map<int, std::vector<int>> at_junction;
  for (int k = 0; k < graph.links(); ++k) {
    const LaneGraph::Link& link = graph.link(k);
    if (!coordinated[std::size_t(link.junction)] || !signals_.contains(link.signal)) continue;
    heads_[std::size_t(k)].owned = true;
    at_junction[link.junction].push_back(k);
  }
  for (const auto& [junction, links] : at_junction) {
    for (const int a : links) {
      for (const int b : links) {
        const LaneGraph::Link& first = graph.link(a);
        const LaneGraph::Link& second = graph.link(b);
        const bool meet =
            first.from != second.from &&
            (first.to == second.to || are_close(middle_of(graph, first), middle_of(graph, second)));
        if (meet) heads_[std::size_t(a)].crossing.push_back(b);
      }
    }
  }
}

double SignalHeads::shown_for(int link) const {
  return traffic_.time() - heads_[std::size_t(link)].since;
}

bool SignalHeads::cross(int link, int other) const {
  return std::ranges::count(heads_[std::size_t(link)].crossing, other) > 0;
}

bool SignalHeads::may_turn_green(int link) const {
  const std::vector<int>& crossing = heads_[std::size_t(link)].crossing;
  return std::ranges::all_of(crossing, [&](int other) {
    return light(other) == Light::kRed && shown_for(other) >= timing_.all_red - kInstant;
  });
}

void SignalHeads::own() {
  if (!free_) return;
  free_ = false;
  for (std::size_t k = 0; k < heads_.size(); ++k) {
    if (heads_[k].owned) show(int(k), Light::kRed);
  }
}

void SignalHeads::turn_green(int link) {
  if (light(link) == Light::kGreen) return;
  ++greens_;
  show(link, Light::kGreen);
}

void SignalHeads::end_green(int link) {
  if (light(link) != Light::kGreen) return;
  const bool at_once = timing_.yellow(graph_.lane(graph_.link(link).from).speed_limit) <= 0.0;
  show(link, at_once ? Light::kRed : Light::kYellow);
}

void SignalHeads::advance() {
  for (std::size_t k = 0; k < heads_.size(); ++k) {
    if (!heads_[k].owned || heads_[k].light != Light::kYellow) continue;
    const double yellow = timing_.yellow(graph_.lane(graph_.link(int(k)).from).speed_limit);
    if (shown_for(int(k)) >= yellow - kInstant) show(int(k), Light::kRed);
  }
}

void SignalHeads::free() {
  if (free_) return;
  free_ = true;
  for (const std::string& signal : signals_) traffic_.free_signal(signal);
}

void SignalHeads::show(int link, Light light) {
  Head& head = heads_[std::size_t(link)];
  head.light = light;
  head.since = traffic_.time();
  traffic_.show(graph_.link(link).signal, graph_.link(link).signal_index, light);
}

}  // namespace mvtp
