#include "coordinator/drivers/braking_analysis.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "coordinator/audit/footprint_motion.hpp"

namespace mvtp {
namespace {

/// Poses along a path that was driven, by the way from its begin [m].
class DrivenPath {
 public:
  void add(const Pose& pose) {
    const double step = poses_.empty() ? 0.0 : distance(poses_.back(), pose);
    stations_.push_back(stations_.empty() ? 0.0 : stations_.back() + step);
    poses_.push_back(pose);
  }
  [[nodiscard]] Pose at(double s) const {
    const auto next = std::ranges::lower_bound(stations_, s);
    if (next == stations_.begin()) return poses_.front();
    if (next == stations_.end()) return poses_.back();
    const auto i = std::size_t(next - stations_.begin());
    const double length = stations_[i] - stations_[i - 1];
    const StepMotion motion(poses_[i - 1], poses_[i]);
    return motion.at(length > 0.0 ? (s - stations_[i - 1]) / length : 1.0);
  }

 private:
  std::vector<Pose> poses_;
  std::vector<double> stations_;
};

}  // namespace

void BrakingAnalysis::remember(double time, std::span<const Observation> observations) {
  for (const Observation& s : observations) {
    Track& track = tracks_[s.state->id];
    track.body = s.type->body;
    track.coordinated = s.coordinated;
    track.moments.push_back({time, s.state->pose, s.state->speed});
    while (track.moments.front().time < time - kMemory) track.moments.pop_front();
  }
  std::erase_if(tracks_,
                [&](const auto& entry) { return entry.second.moments.back().time < time; });
}

void BrakingAnalysis::observe(double time, std::span<const Observation> observations,
                              std::span<const HumanFault> faults,
                              std::span<const AuditEvent> events) {
  remember(time, observations);
  for (const AuditEvent& event : events.subspan(looked_at_)) {
    if (event.kind != AuditEventKind::kOverlap) continue;
    const bool first = tracks_.at(event.who[0]).coordinated;
    const bool second = tracks_.at(event.who[1]).coordinated;
    if (first != second) judge(time, event.who[first ? 0 : 1], event.who[first ? 1 : 0], faults);
  }
  looked_at_ = events.size();
}

void BrakingAnalysis::judge(double time, const std::string& controlled, const std::string& human,
                            std::span<const HumanFault> faults) {
  HumanOverlap found{.time = time, .controlled = controlled, .human = human};
  const Track& ours = tracks_.at(controlled);
  const Track& theirs = tracks_.at(human);
  found.seen_since = std::max(ours.moments.front().time, theirs.moments.front().time);
  const auto fault = std::ranges::find(faults, human, &HumanFault::vehicle);
  if (fault != faults.end() && fault->begin < time) {
    found.fault = to_string(fault->kind);
    found.seen_since = std::max(found.seen_since, fault->begin + dt_);  // after a step it shows
  }
  found.avoidable = could_stop(ours, theirs, found.seen_since);
  overlaps_.push_back(std::move(found));
}

/// Full braking from `seen_since` on to rest, with the human where he was, and then going on
/// straight at his speed: no overlap at or between the steps?
bool BrakingAnalysis::could_stop(const Track& ours, const Track& human, double seen_since) const {
  DrivenPath path;
  double speed = -1.0;
  double driven = 0.0;
  for (const Moment& m : ours.moments) {
    if (m.time < seen_since - dt_ / 2.0) continue;
    path.add(m.pose);
    if (speed < 0.0) speed = m.speed;
  }
  std::optional<Pose> before;  // the human, a step ago
  const auto brakes_clear_of = [&](const Pose& pose, double human_speed) {
    const Pose from = path.at(driven);
    if (before) {
      const double next = std::max(0.0, speed - ours.body.max_decel * dt_);
      driven += 0.5 * (speed + next) * dt_;
      speed = next;
    }
    // As for the audit: whoever leaps is only where he is at the step.
    const bool drove = before && distance(*before, pose) <= human_speed * dt_ + Audit::kLeap;
    const NearestMoment nearest =
        nearest_moment({from, path.at(driven)}, ours.body, {before.value_or(pose), pose},
                       human.body, drove ? 0.0 : 1.0, 1.0);
    before = pose;
    return nearest.gap >= -Audit::kTolerance;
  };
  for (const Moment& m : human.moments) {
    if (m.time >= seen_since - dt_ / 2.0 && !brakes_clear_of(m.pose, m.speed)) return false;
  }
  const Moment& last = human.moments.back();
  for (double s = last.speed * dt_; speed > 0.0; s += last.speed * dt_) {
    if (!brakes_clear_of(compose(last.pose, {s, 0.0, 0.0}), last.speed)) return false;
  }
  return true;
}

}  // namespace mvtp
