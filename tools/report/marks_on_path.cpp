#include "tools/report/marks_on_path.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "planner/problem/referee_geometry.hpp"

namespace mvtp {
namespace {

constexpr double kSameLine = 1.0;  // [m] between the stop lines of lanes beside each other
constexpr double kOneLane = 4.0;   // [m] aside: a lane farther left or right is the same road

/// A place as the path sees it, which goes on straight beyond its ends.
struct Projected {
  double station = 0.0;
  double aside = 0.0;  ///< [m], positive
};

Projected project(const ReferencePath& path, const Point& point) {
  const double s = path.project(point, 0.0, path.length());
  return {s, distance(path.at(s), {point.x, point.y, 0.0})};
}

bool is_between_ends(double station, const ReferencePath& path) {
  return station > 0.0 && station < path.length() - 1.0;
}

void sort_and_join(std::vector<Stretch>& stretches) {
  std::ranges::sort(stretches, {}, &Stretch::from);
  std::vector<Stretch> joined;
  for (const Stretch& next : stretches) {
    if (!joined.empty() && next.from <= joined.back().to + kSameLine) {
      joined.back().to = std::max(joined.back().to, next.to);
    } else {
      joined.push_back(next);
    }
  }
  stretches = std::move(joined);
}

/// What one light of a signal shows in that time; letters that mean the same colour are one.
std::vector<TimeSpaceSignal::Shown> shown_by(const ReplaySignal& signal, int light, Stretch time) {
  std::vector<TimeSpaceSignal::Shown> pieces;
  const auto index = static_cast<std::size_t>(light);
  for (std::size_t i = 0; i < signal.shown.size(); ++i) {
    const auto& [since, letters] = signal.shown[i];
    const double until = i + 1 < signal.shown.size() ? signal.shown[i + 1].first : time.to;
    const Stretch now{std::max(since, time.from), std::min(until, time.to)};
    if (now.from >= now.to || index >= letters.size()) continue;
    const auto letter = static_cast<unsigned char>(letters[index]);
    const auto colour = static_cast<char>(std::tolower(letter));
    if (!pieces.empty() && pieces.back().light == colour && pieces.back().time.to >= now.from) {
      pieces.back().time.to = now.to;
    } else {
      pieces.push_back({now, colour});
    }
  }
  return pieces;
}

}  // namespace

std::vector<double> stop_lines_on(const ReferencePath& path, const ReplayScene& scene) {
  std::vector<double> stations;
  for (const ReplayLane& lane : scene.lanes) {
    const bool for_cars = lane.kind == ReplayLaneKind::kCars || lane.kind == ReplayLaneKind::kBuses;
    if (!lane.stop_line || lane.internal || !for_cars || lane.shape.size() < 2) continue;
    const auto [station, aside] = project(path, lane.shape.back());
    if (aside > kOneLane || !is_between_ends(station, path)) continue;
    const Point& before = lane.shape[lane.shape.size() - 2];
    const Point& end = lane.shape.back();
    const double heading = std::atan2(end.y - before.y, end.x - before.x);
    if (std::abs(wrap_to_pi(heading - path.at(station).theta)) > 0.5) continue;
    stations.push_back(station);
  }
  std::ranges::sort(stations);
  const auto same = [](double a, double b) { return b - a < kSameLine; };
  stations.erase(std::ranges::unique(stations, same).begin(), stations.end());
  return stations;
}

std::vector<Stretch> junctions_on(const ReferencePath& path, const ReplayScene& scene) {
  std::vector<Stretch> stretches;
  for (const Polygon& junction : scene.junctions) {
    bool was_inside = false;
    for (std::size_t i = 0; i < path.samples(); ++i) {
      const Pose& pose = path.sample(i);
      const double station = double(i) * ReferencePath::kSpacing;
      const bool inside = referee::contains(junction, Point{pose.x, pose.y});
      if (inside && !was_inside) stretches.push_back({station, station});
      if (inside) stretches.back().to = station;
      was_inside = inside;
    }
  }
  // Where only the road changes its width a junction is hardly as long as a car.
  std::erase_if(stretches, [](const Stretch& s) { return s.to - s.from < 4.0; });
  sort_and_join(stretches);
  return stretches;
}

std::vector<Stretch> zones_on(const ReferencePath& path,
                              std::span<const ReplayCorridor> corridors) {
  std::vector<Stretch> stretches;
  for (const ReplayCorridor& corridor : corridors) {
    if (corridor.shape.size() < 2) continue;
    const bool is_on = std::ranges::all_of(
        corridor.shape, [&](const Point& point) { return project(path, point).aside <= kOneLane; });
    const auto station = [&](const Point& point) {
      return std::clamp(project(path, point).station, 0.0, path.length());
    };
    const double from = station(corridor.shape.front());
    const double to = station(corridor.shape.back());
    if (is_on && from < to) stretches.push_back({from, to});
  }
  sort_and_join(stretches);
  return stretches;
}

std::vector<TimeSpaceSignal> signals_on(const ReferencePath& path, const ReplayScene& scene,
                                        std::span<const ReplaySignal> signals, Stretch time) {
  constexpr double kOnIt = 2.5;  // [m] aside
  struct Found {
    double station = 0.0;
    double away = 0.0;  ///< from the path, behind the junction
    const ReplayLight* light = nullptr;
  };
  std::vector<Found> found;
  for (const ReplayLight& light : scene.lights) {
    if (!light.target || light.signal >= signals.size()) continue;
    const Point middle{(light.from.x + light.to.x) / 2.0, (light.from.y + light.to.y) / 2.0};
    const auto [station, aside] = project(path, middle);
    const double away = project(path, *light.target).aside;
    if (aside > kOnIt || away > kOnIt || !is_between_ends(station, path)) continue;
    const auto same = std::ranges::find_if(
        found, [&](const Found& other) { return std::abs(other.station - station) < kSameLine; });
    if (same == found.end()) {
      found.push_back({station, away, &light});
    } else if (away < same->away) {
      *same = {station, away, &light};
    }
  }
  std::vector<TimeSpaceSignal> lights;
  for (const Found& one : found) {
    lights.push_back({one.station, shown_by(signals[one.light->signal], one.light->index, time)});
  }
  return lights;
}

}  // namespace mvtp
