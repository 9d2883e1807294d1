#include "tests/coordinator/fake_walkers.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {

void FakeWalkers::step(double time, double dt, const std::function<bool(int)>& green) {
  constexpr double kOff = 4.0;  // [m] behind the crossing
  std::erase_if(waiting_, [&](const FakeWalker& walker) {
    if (walker.depart > time) return false;
    walking_.push_back({.walker = walker});
    return true;
  });
  for (Walking& w : walking_) {
    const double next = w.s + w.walker.speed * dt;
    const bool stops = w.s <= 0.0 && next > 0.0 && !green(w.walker.crossing);
    w.v = stops ? 0.0 : w.walker.speed;
    if (!stops) w.s = next;
    if (stops) w.waited += dt;
    if (stops && w.walker.takes_any) change_crossing(w, green);
    longest_wait_ = std::max(longest_wait_, w.waited);
  }
  std::erase_if(walking_, [&](const Walking& w) {
    return w.s > (w.walker.turns ? -1.0 : graph_.crossing(w.walker.crossing).length + kOff);
  });
  people_.clear();
  for (const Walking& w : walking_) people_.push_back(seen(w));
  std::ranges::sort(people_, {}, &Pedestrian::id);
}

void FakeWalkers::change_crossing(Walking& w, const std::function<bool(int)>& green) const {
  const std::string here =
      graph_.crossing(w.walker.crossing).crossing->ends[w.walker.forward ? 0 : 1];
  for (int c = 0; c < graph_.crossings(); ++c) {
    const std::vector<std::string>& ends = graph_.crossing(c).crossing->ends;
    if (!green(c) || std::ranges::count(ends, here) == 0) continue;
    w.walker.crossing = c;
    w.walker.forward = ends.front() == here;
    w.s = 0.1;
    return;
  }
}

Pedestrian FakeWalkers::seen(const Walking& w) const {
  constexpr double kCorner = 4.0;  // [m] before the kerb, where he turns to the crossing
  const PedestrianCrossing& crossing = *graph_.crossing(w.walker.crossing).crossing;
  const Point from = w.walker.forward ? crossing.shape.front() : crossing.shape.back();
  const Point to = w.walker.forward ? crossing.shape.back() : crossing.shape.front();
  const double theta = std::atan2(to.y - from.y, to.x - from.x);
  Pedestrian p{.id = w.walker.id,
               .position = {from.x + w.s * std::cos(theta) - w.walker.aside * std::sin(theta),
                            from.y + w.s * std::sin(theta) + w.walker.aside * std::cos(theta)},
               .theta = theta,
               .speed = w.v,
               .radius = 0.26};
  const std::string& end = crossing.ends[w.walker.forward ? 0 : 1];
  const bool on_it = w.s > 0.0 && w.s < graph_.crossing(w.walker.crossing).length;
  const bool comes = w.s <= 0.0 && w.s > -kCorner && !w.walker.turns;
  p.edge = on_it ? crossing.id : comes ? end : "sidewalk";
  if (comes) p.next = crossing.id;
  if (w.s <= -kCorner || w.walker.turns) p.next = end;
  return p;
}

}  // namespace mvtp
