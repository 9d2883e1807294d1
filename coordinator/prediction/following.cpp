#include "coordinator/prediction/following.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "coordinator/prediction/tube.hpp"
#include "planner/road.hpp"

namespace mvtp {
namespace {

constexpr double kHorizon = 10.0;  ///< [s]
constexpr double kBraking = 4.5;   ///< [m/s^2] of a driver behind a leader
constexpr double kReaction = 0.5;  ///< [s] until he brakes for one whom he sees

/// The latest motion of one who passes, as it is delayed.
struct Follower {
  Forecast* forecast;
  SpeedProfile undelayed;
  std::size_t at = 0;  ///< the state of it that is reached
};

class Queue {
 public:
  Queue(std::vector<Forecast>& forecasts, const RoadScene& scene) : scene_(scene) {
    for (Forecast& f : forecasts) {
      if (f.yields || !f.latest) continue;
      followers_.push_back({&f, *f.latest});
      f.latest->states.resize(1);
    }
    for (const Follower& follower : followers_) {
      std::vector<Leader>& leaders = leaders_.emplace_back();
      for (const Follower& other : followers_) {
        const Forecast& f = *other.forecast;
        if (&f == follower.forecast) continue;
        const RoadContact contact(scene, f.vehicle, follower.forecast->vehicle, 0.0);
        if (!contact.never()) leaders.push_back({&f, contact});
      }
    }
  }

  void advance() {
    const int n = scene_.grid.steps_per_decision;
    const int decisions = int(kHorizon / scene_.grid.decision());
    for (int d = 0; d < decisions; ++d) {
      for (std::size_t i = 0; i < followers_.size(); ++i) {
        drive(followers_[i], n, has_room(i, scene_.step + d * n));
      }
    }
    for (Follower& f : followers_) drive(f, int(f.undelayed.states.size() - f.at) - 1, true);
  }

 private:
  struct Leader {
    const Forecast* forecast;
    RoadContact contact;  ///< of the leader and the follower
  };

  static void drive(Follower& f, int steps, bool goes) {
    std::vector<InertialState>& states = f.forecast->latest->states;
    for (int i = 0; i < steps && f.at + 1 < f.undelayed.states.size(); ++i) {
      if (goes) ++f.at;
      const InertialState& there = f.undelayed.states[f.at];
      states.push_back({there.s, goes ? there.v : 0.0});
    }
  }

  [[nodiscard]] bool has_room(std::size_t i, std::int64_t k) const {
    const Follower& f = followers_[i];
    const InertialState here = f.undelayed.states[f.at];
    const std::size_t last = f.undelayed.states.size() - 1;
    const double next =
        f.undelayed.states[std::min(last, f.at + std::size_t(scene_.grid.steps_per_decision))].s;
    return std::ranges::none_of(leaders_[i], [&](const Leader& leader) {
      const InertialState there = leader.forecast->latest->at(k);
      if (there.s >= SpeedProfile::kDeparted) return false;
      const double reach =
          next + drivers_gap(f.forecast->vehicle, here.v, kBraking, there.v, kBraking);
      return leader.contact.seen_from_b().meets(here.s, reach, there.s, there.s) &&
             leader.contact.is_ahead(there, here);
    });
  }

  const RoadScene& scene_;
  std::vector<Follower> followers_;
  std::vector<std::vector<Leader>> leaders_;  ///< of each
};

/// Does the driver at `b` see `a` ahead in his lane? With its rear axle on his path its whole nose
/// is there. Nobody sees who stands across his lane, or is about to come into it.
bool is_in_lane_ahead(const PathLibrary& library, const PlaceOnPath& a, const PlaceOnPath& b) {
  constexpr double kLook = 100.0;  // [m]
  constexpr double kAside = 0.3;   // [m] as paths of one lane differ
  constexpr double kTurned = 0.1;  // [rad]
  const Pose pose = library.path(a.path).at(a.s);
  const ReferencePath& path = library.path(b.path);
  const double foot = path.project({pose.x, pose.y}, b.s, b.s + kLook);
  const Pose local = relative(path.at(foot), pose);
  return foot > b.s && std::abs(local.y) < kAside && std::abs(local.theta) < kTurned;
}

}  // namespace

void follow_leaders(std::vector<Forecast>& forecasts, const RoadScene& scene) {
  Queue(forecasts, scene).advance();
}

bool follows(const Forecast& driver, const PlaceOnPath& leader, const PathLibrary& library) {
  const PlaceOnPath here{driver.vehicle.path, driver.vehicle.now.s};
  return is_in_lane_ahead(library, leader, here) &&
         !library.contacts(here.path, leader.path).parts_and_meets_again(here.s, leader.s);
}

bool merges_behind(const Forecast& driver, const Forecast& leader, const PathLibrary& library,
                   double dt) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const int path = driver.vehicle.path;
  const int other_path = leader.vehicle.path;
  const ContactTable& contacts = library.contacts(path, other_path);
  const double from = leader.vehicle.now.s;
  if (contacts.parts_and_meets_again(driver.vehicle.now.s, from)) return false;
  const double merge = contacts.first_met(driver.vehicle.now.s, from, kInfinity);
  const SpeedProfile& latest = leader.latest ? *leader.latest : leader.earliest;
  for (std::int64_t k = driver.earliest.begin; k < driver.earliest.end(); ++k) {
    const InertialState here = driver.earliest.at(k);
    const double stop = here.s + kReaction * here.v + braking_gap(here.v, kBraking, dt);
    if (stop < merge) continue;
    return is_in_lane_ahead(library, {other_path, latest.at(k).s}, {path, here.s});
  }
  return true;
}

void stay_behind(Forecast& driver, std::span<const HeldVehicle> held, const PathLibrary& library) {
  const PlaceOnPath here{driver.vehicle.path, driver.vehicle.now.s};
  double most = std::numeric_limits<double>::infinity();
  for (const HeldVehicle& h : held) {
    if (!drives_ahead(library, h.now, here)) continue;
    const double first =
        library.contacts(here.path, h.now.path).first_met(here.s, h.furthest, h.furthest);
    most = std::min(most, std::max(here.s, first));
  }
  const auto end_there = [&](SpeedProfile& profile) {
    const auto beyond = std::ranges::upper_bound(profile.states, most, {}, &InertialState::s);
    if (beyond == profile.states.end()) return;
    profile.states.erase(beyond, profile.states.end());
    profile.complete = false;
  };
  end_there(driver.earliest);
  if (driver.latest) end_there(*driver.latest);
}

}  // namespace mvtp
