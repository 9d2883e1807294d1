#include "coordinator/referee.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "coordinator/audit.hpp"

namespace mvtp {
namespace {

struct Placed {
  const RoadVehicle* vehicle;
  const Vehicle* body;
  Pose pose;
};

/// Everybody who is still on the road at step k, from west to east.
std::vector<Placed> place(const RoadScene& scene, const JointPlan& plan, std::int64_t k) {
  std::vector<Placed> placed;
  for (const JointPlan::Entry& e : plan.entries) {
    const InertialState state = e.trajectory->at(k);
    if (state.s >= PathTrajectory::kGone) continue;
    const RoadVehicle& v = scene.vehicle(e.key);
    placed.push_back({&v, &scene.body(v), scene.library->path(v.path).at(state.s)});
  }
  std::ranges::sort(placed, {}, [](const Placed& p) { return p.pose.x; });
  return placed;
}

double reach(const Vehicle& body) {
  return std::hypot(std::max(body.front, body.rear), body.width / 2.0);
}

}  // namespace

std::optional<PlannedContact> find_planned_contact(const RoadScene& scene, const JointPlan& plan,
                                                   int every) {
  std::int64_t end = scene.step;
  double widest = 0.0;
  for (const JointPlan::Entry& e : plan.entries) {
    end = std::max(end, e.trajectory->end());
    widest = std::max(widest, reach(scene.body(scene.vehicle(e.key))));
  }
  for (std::int64_t k = scene.step; k < end; k += every) {
    const std::vector<Placed> placed = place(scene, plan, k);
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const Placed& a = placed[i];
      for (std::size_t j = i + 1; j < placed.size(); ++j) {
        const Placed& b = placed[j];
        if (b.pose.x - a.pose.x > reach(*a.body) + widest) break;
        if (distance(a.pose, b.pose) > reach(*a.body) + reach(*b.body)) continue;
        if (clearance(a.pose, *a.body, b.pose, *b.body) < -Audit::kTolerance) {
          return PlannedContact{a.vehicle->key, b.vehicle->key, k};
        }
      }
    }
  }
  return std::nullopt;
}

}  // namespace mvtp
