#include "coordinator/prediction/following.hpp"

#include <algorithm>
#include <cstddef>

#include "planner/road.hpp"

namespace mvtp {
namespace {

constexpr double kHorizon = 10.0;  ///< [s]
constexpr double kBraking = 4.5;   ///< [m/s^2] of a driver behind a leader

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

}  // namespace

void follow_leaders(std::vector<Forecast>& forecasts, const RoadScene& scene) {
  Queue(forecasts, scene).advance();
}

}  // namespace mvtp
