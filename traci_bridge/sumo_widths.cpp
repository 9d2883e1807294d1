#include "traci_bridge/sumo_widths.hpp"

#include <cmath>
#include <limits>
#include <span>

#include "coordinator/network/polyline.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {
namespace {

constexpr double kSpare = 0.3;  ///< [m] that it may be further aside before it is widened, and then
constexpr double kMost = 4.0;   ///< [m] that it is widened: beyond, it has left the road

/// How far a place is beside a line, or the straight lines that its ends go on in [m].
double beside(std::span<const Point> line, const Point& place) {
  double least = std::numeric_limits<double>::infinity();
  double aside = 0.0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Point on_it = nearest(place, line[i], line[i + 1]);
    const double off = distance(place, on_it);
    if (off >= least) continue;
    least = off;
    constexpr double kAtEnd = 1e-6;  // [m]
    const bool beyond = (i == 0 && distance(on_it, line.front()) < kAtEnd) ||
                        (i + 2 == line.size() && distance(on_it, line.back()) < kAtEnd);
    const Pose along{on_it.x, on_it.y, heading(line[i], line[i + 1])};
    aside = beyond ? std::abs(relative(along, {place.x, place.y, 0.0}).y) : off;
  }
  return aside;
}

}  // namespace

void SumoWidths::widen(const std::string& id, const Lane& lane, const SumoPosition& front) {
  const auto [known, is_new] = widths_.try_emplace(id);
  Width& width = known->second;
  if (is_new) width.own = width.shown = api::Vehicle::getWidth(id);
  const double aside = beside(lane.shape, {front.x_m, front.y_m});
  const double needed = 2.0 * (aside + kSpare) - lane.width;
  if (needed <= width.own) {
    show(id, width, width.own);
  } else if (needed > width.shown && needed <= width.own + kMost) {
    show(id, width, needed + kSpare);
  }
}

void SumoWidths::restore(const std::string& id) {
  const auto known = widths_.find(id);
  if (known == widths_.end()) return;
  show(id, known->second, known->second.own);
  widths_.erase(known);
}

void SumoWidths::forget_if(const std::function<bool(const std::string&)>& has_left) {
  std::erase_if(widths_, [&](const auto& entry) { return has_left(entry.first); });
}

void SumoWidths::show(const std::string& id, Width& width, double shown) {
  if (shown == width.shown) return;
  width.shown = shown;
  api::Vehicle::setWidth(id, shown);
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
