#include "coordinator/braking_analysis.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

/// Poses along a path that was driven, by the way from its begin [m].
class DrivenPath {
 public:
  void add(const Pose& pose) {
    const double step = poses_.empty() ? 0.0 : distance(poses_.back(), pose);
    ways_.push_back(ways_.empty() ? 0.0 : ways_.back() + step);
    poses_.push_back(pose);
  }
  [[nodiscard]] Pose at(double way) const {
    const auto next = std::ranges::lower_bound(ways_, way);
    if (next == ways_.begin()) return poses_.front();
    if (next == ways_.end()) return poses_.back();
    const auto i = std::size_t(next - ways_.begin());
    const double length = ways_[i] - ways_[i - 1];
    const StepMotion motion(poses_[i - 1], poses_[i]);
    return motion.at(length > 0.0 ? (way - ways_[i - 1]) / length : 1.0);
  }

 private:
  std::vector<Pose> poses_;
  std::vector<double> ways_;
};

}  // namespace

void BrakingAnalysis::remember(double time, std::span<const Sighting> sightings) {
  for (const Sighting& s : sightings) {
    Track& track = tracks_[s.state->id];
    track.body = s.type->body;
    track.moments.push_back({time, s.state->pose, s.state->speed});
    while (track.moments.front().time < time - kMemory) track.moments.pop_front();
  }
  std::erase_if(tracks_, [&](const auto& entry) { return entry.second.moments.back().time < time; });
}

void BrakingAnalysis::observe(double time, std::span<const Sighting> sightings,
                              std::span<const HumanFault> faults) {
  constexpr double kNear = 30.0;  // [m]
  remember(time, sightings);
  for (const Sighting& ours : sightings) {
    if (!ours.coordinated) continue;
    for (const Sighting& human : sightings) {
      if (human.coordinated || distance(ours.state->pose, human.state->pose) > kNear) continue;
      const double gap = clearance(ours.state->pose, ours.type->body, human.state->pose,
                                   human.type->body);
      const bool is_new = gap < -Audit::kTolerance &&
                          known_.insert({ours.state->id, human.state->id}).second;
      if (is_new) judge(time, ours.state->id, human.state->id, faults);
    }
  }
}

void BrakingAnalysis::judge(double time, const std::string& controlled, const std::string& human,
                            std::span<const HumanFault> faults) {
  HumanOverlap found{.time = time, .controlled = controlled, .human = human};
  const Track& ours = tracks_.at(controlled);
  const Track& theirs = tracks_.at(human);
  found.sight = std::max(ours.moments.front().time, theirs.moments.front().time);
  const auto fault = std::ranges::find(faults, human, &HumanFault::vehicle);
  if (fault != faults.end() && fault->begin < time) {
    found.fault = to_string(fault->kind);
    found.sight = std::max(found.sight, fault->begin + dt_);  // after a step it shows
  }
  found.avoidable = could_stop(ours, theirs, found.sight);
  overlaps_.push_back(std::move(found));
}

/// Full braking from `sight` on to rest, with the human where he was, and then going on straight at
/// his speed: no overlap?
bool BrakingAnalysis::could_stop(const Track& ours, const Track& human, double sight) const {
  DrivenPath path;
  double speed = -1.0;
  double driven = 0.0;
  for (const Moment& m : ours.moments) {
    if (m.time < sight - dt_ / 2.0) continue;
    path.add(m.pose);
    if (speed < 0.0) speed = m.speed;
  }
  const auto brakes_clear_of = [&](const Pose& pose) {
    const bool touches =
        clearance(path.at(driven), ours.body, pose, human.body) < -Audit::kTolerance;
    const double next = std::max(0.0, speed - ours.body.max_decel * dt_);
    driven += 0.5 * (speed + next) * dt_;
    speed = next;
    return !touches;
  };
  for (const Moment& m : human.moments) {
    if (m.time >= sight - dt_ / 2.0 && !brakes_clear_of(m.pose)) return false;
  }
  const Moment& last = human.moments.back();
  for (double way = last.speed * dt_; speed > 0.0; way += last.speed * dt_) {
    if (!brakes_clear_of(compose(last.pose, {way, 0.0, 0.0}))) return false;
  }
  return true;
}

}  // namespace mvtp
