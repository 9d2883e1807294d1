#include "coordinator/measures/surrogate_safety.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kCrossing = 30.0 * 3.14159265358979 / 180.0;  ///< [rad]
constexpr double kRange = 100.0;                               ///< [m] between two that may meet

Point velocity_of(const Observation& s) {
  return {s.state->speed * std::cos(s.state->pose.theta),
          s.state->speed * std::sin(s.state->pose.theta)};
}

std::pair<std::string, std::string> pair_of(const std::string& a, const std::string& b) {
  return a < b ? std::pair(a, b) : std::pair(b, a);
}

}  // namespace

std::optional<double> time_to_collision(const OrientedBox& a, const Point& velocity_a,
                                        const OrientedBox& b, const Point& velocity_b) {
  double from = 0.0;
  double until = std::numeric_limits<double>::infinity();
  // Along each side of each box, when do their shadows overlap? [separating axes]
  for (const auto& [ux, uy] : {std::pair{a.ux, a.uy}, {-a.uy, a.ux}, {b.ux, b.uy}, {-b.uy, b.ux}}) {
    const auto half = [&](const OrientedBox& box) {
      return box.half_length * std::abs(box.ux * ux + box.uy * uy) +
             box.half_width * std::abs(box.ux * uy - box.uy * ux);
    };
    const double apart = (b.x - a.x) * ux + (b.y - a.y) * uy;
    const double closing = (velocity_b.x - velocity_a.x) * ux + (velocity_b.y - velocity_a.y) * uy;
    const double reach = half(a) + half(b);
    if (std::abs(closing) < 1e-9) {
      if (std::abs(apart) > reach) return std::nullopt;
      continue;
    }
    const double first = (-reach - apart) / closing;
    const double second = (reach - apart) / closing;
    from = std::max(from, std::min(first, second));
    until = std::min(until, std::max(first, second));
    if (from > until) return std::nullopt;
  }
  return from;
}

SurrogateSafety::SurrogateSafety(const RoadNetwork& network, double step_length)
    : step_length_(step_length) {
  for (const auto& [id, junction] : network.junctions) {
    if (!junction.has_conflicts || junction.shape.empty()) continue;
    Bounds bounds{1e300, -1e300, 1e300, -1e300};
    for (const Point& p : junction.shape) {
      bounds = {std::min(bounds.x_low, p.x), std::max(bounds.x_high, p.x),
                std::min(bounds.y_low, p.y), std::max(bounds.y_high, p.y)};
    }
    junctions_.push_back(bounds);
  }
}

void SurrogateSafety::observe(double time, std::span<const Observation> vehicles) {
  for (const Observation& s : vehicles) {
    if (is_on_junction(s.state->pose)) occupy(time, s);
  }
  if (time < next_look_ - 1e-6) return;
  next_look_ = time + kLook;
  look_ahead(vehicles);
}

bool SurrogateSafety::is_on_junction(const Pose& pose) const {
  constexpr double kBody = 5.0;  // [m] that a body reaches beyond its rear axle
  return std::ranges::any_of(junctions_, [&](const Bounds& b) {
    return pose.x > b.x_low - kBody && pose.x < b.x_high + kBody && pose.y > b.y_low - kBody &&
           pose.y < b.y_high + kBody;
  });
}

void SurrogateSafety::occupy(double time, const Observation& vehicle) {
  const OrientedBox box = footprint(vehicle.type->body, vehicle.state->pose);
  const double x = std::abs(box.ux) * box.half_length + std::abs(box.uy) * box.half_width;
  const double y = std::abs(box.uy) * box.half_length + std::abs(box.ux) * box.half_width;
  const auto cell = [](double v) { return int(std::floor(v / kCell)); };
  for (int i = cell(box.x - x); i <= cell(box.x + x); ++i) {
    for (int j = cell(box.y - y); j <= cell(box.y + y); ++j) {
      const double dx = (i + 0.5) * kCell - box.x;
      const double dy = (j + 0.5) * kCell - box.y;
      if (std::abs(dx * box.ux + dy * box.uy) > box.half_length ||
          std::abs(dy * box.ux - dx * box.uy) > box.half_width) {
        continue;  // its middle is outside
      }
      Occupant& occupant = occupants_[{i, j}];
      if (occupant.id != vehicle.state->id) {
        if (!occupant.id.empty()) encounter(time, occupant, vehicle);
        occupant.id = vehicle.state->id;
      }
      occupant.theta = vehicle.state->pose.theta;
      occupant.until = time;
    }
  }
}

void SurrogateSafety::encounter(double time, const Occupant& before, const Observation& vehicle) {
  if (std::abs(wrap_to_pi(vehicle.state->pose.theta - before.theta)) < kCrossing) return;
  // It left half a step after it was last seen there, the other one came half a step ago.
  const double seconds = std::max(0.0, time - before.until - step_length_);
  note(seconds, pair_of(before.id, vehicle.state->id), least_pet_, pet_);
}

void SurrogateSafety::look_ahead(std::span<const Observation> vehicles) {
  std::vector<std::size_t> by_west(vehicles.size());
  for (std::size_t i = 0; i < by_west.size(); ++i) by_west[i] = i;
  std::ranges::sort(by_west, {}, [&](std::size_t i) { return vehicles[i].state->pose.x; });
  for (std::size_t n = 0; n < by_west.size(); ++n) {
    const Observation& a = vehicles[by_west[n]];
    for (std::size_t m = n + 1; m < by_west.size(); ++m) {
      const Observation& b = vehicles[by_west[m]];
      if (b.state->pose.x - a.state->pose.x > kRange) break;
      if (std::abs(b.state->pose.y - a.state->pose.y) > kRange) continue;
      const auto seconds =
          time_to_collision(footprint(a.type->body, a.state->pose), velocity_of(a),
                            footprint(b.type->body, b.state->pose), velocity_of(b));
      if (seconds) note(*seconds, pair_of(a.state->id, b.state->id), least_ttc_, ttc_);
    }
  }
}

void SurrogateSafety::note(double seconds, const Pair& pair, std::map<Pair, double>& known,
                           ConflictFigures& figures) {
  if (seconds > kMost) return;
  const auto count = [&figures](double least) -> std::int64_t& {
    const auto bin = static_cast<std::size_t>(least / ConflictFigures::kBin);
    return figures.counts[std::min(bin, figures.counts.size() - 1)];
  };
  const auto [found, is_new] = known.try_emplace(pair, seconds);
  if (is_new) ++figures.pairs;
  const bool was_counted = !is_new && found->second < kLimit;
  if (!is_new) --count(found->second);
  found->second = std::min(found->second, seconds);
  ++count(found->second);
  if (found->second < kLimit && !was_counted) ++figures.below_1s;
  figures.least = std::min(figures.least, seconds);
}

}  // namespace mvtp
