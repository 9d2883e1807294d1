#include "coordinator/referee.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "coordinator/audit.hpp"
#include "coordinator/footprint_motion.hpp"

namespace mvtp {
namespace {

constexpr int kSlice = 5;       ///< steps that are looked at together
constexpr double kBulge = 0.3;  ///< [m] beyond its places at the steps a body reaches between them

/// A vehicle during some steps: its poses at their ends, and the ground it needs.
struct Drive {
  std::size_t entry = 0;  ///< in the plan
  const RoadVehicle* vehicle = nullptr;
  const Vehicle* body = nullptr;
  std::vector<Pose> poses;  ///< at the begin, and at the end of each step until it leaves
  double x_low = 1e300, x_high = -1e300, y_low = 1e300, y_high = -1e300;
};

Drive drive_of(const RoadScene& scene, const JointPlan& plan, std::size_t entry,
               std::int64_t from) {
  const RoadVehicle& v = scene.vehicle(plan.entries[entry].key);
  Drive drive{.entry = entry, .vehicle = &v, .body = &scene.body(v)};
  const GuidePath& path = scene.library->path(v.path);
  const Vehicle& body = *drive.body;
  const double middle = (body.front - body.rear) / 2.0;
  for (std::int64_t k = from; k <= from + kSlice; ++k) {
    const InertialState state = plan.entries[entry].trajectory->at(k);
    if (state.s >= PathTrajectory::kGone) break;
    const Pose p = path.at(state.s);
    drive.poses.push_back(p);
    const double c = std::cos(p.theta);
    const double s = std::sin(p.theta);
    const double x = p.x + middle * c;
    const double y = p.y + middle * s;
    const double half_x = (std::abs(c) * body.length() + std::abs(s) * body.width) / 2.0 + kBulge;
    const double half_y = (std::abs(s) * body.length() + std::abs(c) * body.width) / 2.0 + kBulge;
    drive.x_low = std::min(drive.x_low, x - half_x);
    drive.x_high = std::max(drive.x_high, x + half_x);
    drive.y_low = std::min(drive.y_low, y - half_y);
    drive.y_high = std::max(drive.y_high, y + half_y);
  }
  return drive;
}

class Referee {
 public:
  Referee(const RoadScene& scene, const JointPlan& plan, const JointPlan& judged)
      : scene_(scene), plan_(plan) {
    for (const JointPlan::Entry& e : plan.entries) {
      end_ = std::max(end_, e.trajectory->end());
      kept_.push_back(judged.find(e.key) == e.trajectory.get());
    }
  }

  std::vector<PlannedContact> judge() {
    if (std::ranges::all_of(kept_, [](bool kept) { return kept; })) return {};
    for (std::int64_t k = scene_.step; k < end_; k += kSlice) judge_slice(k);
    std::vector<PlannedContact> contacts;
    for (const auto& [pair, contact] : found_) {
      if (contact) contacts.push_back({pair.first, pair.second, *contact});
    }
    return contacts;
  }

 private:
  void judge_slice(std::int64_t from) {
    std::vector<Drive> drives;
    for (std::size_t e = 0; e < plan_.entries.size(); ++e) {
      Drive drive = drive_of(scene_, plan_, e, from);
      if (!drive.poses.empty()) drives.push_back(std::move(drive));
    }
    std::ranges::sort(drives, {}, &Drive::x_low);
    for (std::size_t i = 0; i < drives.size(); ++i) {
      const Drive& a = drives[i];
      for (std::size_t j = i + 1; j < drives.size() && drives[j].x_low <= a.x_high; ++j) {
        const Drive& b = drives[j];
        if (b.y_low > a.y_high || a.y_low > b.y_high) continue;
        if (kept_[a.entry] && kept_[b.entry]) continue;
        judge_pair(a, b, from);
      }
    }
  }

  void judge_pair(const Drive& a, const Drive& b, std::int64_t from) {
    const std::pair<std::int64_t, std::int64_t> pair =
        std::minmax(a.vehicle->key, b.vehicle->key);
    const auto known = found_.find(pair);
    if (known != found_.end() && known->second) return;
    // Those who overlap when the plan begins are listed until they are apart.
    bool overlap = known != found_.end();
    if (from == scene_.step) overlap = touch(a, b, 0);
    const std::size_t steps = std::min(a.poses.size(), b.poses.size()) - 1;
    for (std::size_t i = 0; i < steps; ++i) {
      if (overlap) {
        overlap = touch(a, b, i + 1);
        continue;
      }
      const NearestMoment nearest = nearest_moment(
          StepMotion(a.poses[i], a.poses[i + 1]), *a.body,
          StepMotion(b.poses[i], b.poses[i + 1]), *b.body, 0.0, -Audit::kTolerance);
      if (nearest.gap >= -Audit::kTolerance) continue;
      found_[pair] = from + std::int64_t(i) + 1;
      return;
    }
    if (overlap) {
      found_[pair] = std::nullopt;
    } else {
      found_.erase(pair);
    }
  }

  static bool touch(const Drive& a, const Drive& b, std::size_t i) {
    return clearance(a.poses[i], *a.body, b.poses[i], *b.body) < -Audit::kTolerance;
  }

  const RoadScene& scene_;
  const JointPlan& plan_;
  std::int64_t end_ = 0;
  std::vector<bool> kept_;  ///< of each entry: as in the plan that was judged before
  /// The step of the first contact of a pair; none as long as they overlap since the begin.
  std::map<std::pair<std::int64_t, std::int64_t>, std::optional<std::int64_t>> found_;
};

}  // namespace

std::vector<PlannedContact> find_planned_contacts(const RoadScene& scene, const JointPlan& plan,
                                                  const JointPlan& judged) {
  return Referee(scene, plan, judged).judge();
}

std::vector<std::size_t> groups_in_contact(std::span<const std::vector<std::int64_t>> groups,
                                           std::span<const PlannedContact> contacts) {
  std::vector<std::size_t> touched;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto is_member = [&](std::int64_t key) {
      return std::ranges::find(groups[g], key) != groups[g].end();
    };
    const bool in_contact = std::ranges::any_of(contacts, [&](const PlannedContact& c) {
      return is_member(c.first) || is_member(c.second);
    });
    if (in_contact) touched.push_back(g);
  }
  return touched;
}

}  // namespace mvtp
