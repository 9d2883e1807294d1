#pragma once

#include <cstddef>
#include <vector>

#include "planner/road/road_scene.hpp"

namespace mvtp {

/// The speed profile, as a formula, of a car that keeps its speed for `reaction` seconds and then
/// brakes to rest.
struct BrakingProfile {
  static constexpr double kLook = 0.2;  ///< [s] between two looks at braking cars

  InertialState from;
  double decel = 0.0;
  double reaction = 0.0;

  [[nodiscard]] double position(int look) const {
    const double tau = look * kLook;
    if (tau <= reaction) return from.s + from.v * tau;
    return braked_position({from.s + from.v * reaction, from.v}, decel, tau - reaction);
  }
  [[nodiscard]] double rest() const {
    return from.s + from.v * reaction + stopping_distance(from.v, decel);
  }
  /// Looks until it stands.
  [[nodiscard]] int looks() const {
    return int(std::ceil(reaction / kLook)) + braking_steps(from.v, decel, kLook);
  }
};

/// Two vehicles of a scene and where their bodies may touch: the one collision test of all planners
/// on roads, so that what one of them accepts is accepted by the others.
///
/// Motions are compared between the looks too (ContactTable::sweeps). Vehicles come into the
/// control zone as their drivers left them. If they are so close that braking now would bring them
/// into their margins, then as long as that is so the margins do not count, but the gap between the
/// true bodies must not become smaller than by braking now. Nor do they count for two that are
/// stuck, down to a bare gap: a junction where nobody can move for the sake of margins is worse.
class RoadContact {
 public:
  /// @param reaction  [s] after which `a` answers to braking of `b`.
  RoadContact(const RoadScene& scene, const RoadVehicle& a, const RoadVehicle& b, double reaction);

  [[nodiscard]] bool never() const { return ab_->empty(); }
  /// With `a` as the one that moves on its rows, and with `b`.
  [[nodiscard]] const ContactTable& seen_from_a() const { return *ab_; }
  [[nodiscard]] const ContactTable& seen_from_b() const { return *ba_; }

  /// Do they touch on their way through the positions a(0) … a(last) and b(0) … b(last)?
  /// @param lenient  margins do not count; see is_close().
  template <class A, class B>
  [[nodiscard]] bool touch(const A& a, const B& b, int last, bool lenient) const {
    return touch_though_they_brake(a, b, last, lenient) || (lenient && grazes(a, b, last));
  }
  /// The same for two who brake fully, and so can do no more: what they come to between the looks
  /// does not count if they are close.
  template <class A, class B>
  [[nodiscard]] bool touch_though_they_brake(const A& a, const B& b, int last, bool lenient) const {
    return lenient ? comes_closer(a, b, last) : meet(a, b, 0, last);
  }

  [[nodiscard]] bool touch_braking(const InertialState& a, const InertialState& b,
                                   bool lenient) const;

  /// Does `a`, where it is, block the rest of the path of `b`? Not if only its margins are,
  /// of two that stand too close.
  [[nodiscard]] bool a_blocks(const InertialState& a, const InertialState& b) const;
  [[nodiscard]] bool b_blocks(const InertialState& a, const InertialState& b) const;
  /// Does only the one block the other?
  [[nodiscard]] bool is_ahead(const InertialState& a, const InertialState& b) const {
    return a_blocks(a, b) && !b_blocks(a, b);
  }
  [[nodiscard]] bool is_behind(const InertialState& a, const InertialState& b) const {
    return b_blocks(a, b) && !a_blocks(a, b);
  }
  /// Does each, where it is now, block the rest of the path of the other?
  [[nodiscard]] bool block_each_other() const {
    return !never() && a_blocks(a_->now, b_->now) && b_blocks(a_->now, b_->now);
  }
  /// Is `a` not in the lane of `b` yet, although they drive the same way? Its driver does not see
  /// it there.
  [[nodiscard]] bool a_is_beside(const InertialState& a, const InertialState& b) const;
  /// The same, with some part of `a` level with some part of `b`, once `b` has closed in by so much
  /// [m].
  [[nodiscard]] bool a_is_alongside(const InertialState& a, const InertialState& b,
                                    double closing) const;
  /// If `a` brakes now, does the driver of `b` run into it, who takes his time to notice?
  [[nodiscard]] bool cuts_off(const InertialState& a, const InertialState& b) const;

  [[nodiscard]] bool is_close_now() const { return close_; }
  [[nodiscard]] bool are_stuck() const { return stuck_; }
  /// Are the true bodies apart now, but not if both brake?
  [[nodiscard]] bool braking_is_too_late() const { return too_late_; }
  /// Are they in these states within what braking now may save them from? Only if they are now.
  [[nodiscard]] bool is_close(const InertialState& a, const InertialState& b) const {
    return close_ && (stuck_ || touch_braking(a, b, false));
  }

 private:
  /// Halves the time until bounds tell that they are apart, or down to a single step of it.
  template <class A, class B>
  [[nodiscard]] bool meet(const A& a, const B& b, int first, int last) const {
    const double a_first = a(first), a_last = a(last), b_first = b(first), b_last = b(last);
    if (last - first <= 1) return ab_->sweeps(a_first, a_last, b_first, b_last);
    if (!ab_->reaches(a_first, a_last, b_first, b_last)) return false;
    const int middle = (first + last) / 2;
    return meet(a, b, first, middle) || meet(a, b, middle, last);
  }

  template <class A, class B>
  [[nodiscard]] bool comes_closer(const A& a, const B& b, int last) const {
    for (int i = 0; i < last; ++i) {
      if (!ab_->sweeps(a(i), a(i + 1), b(i), b(i + 1))) continue;
      if (gap(a(i + 1), b(i + 1)) < least_gap_ - kNoWorse) return true;
    }
    return false;
  }

  /// Between the looks the gap may be half of what it has to be at them. Whoever turns in behind
  /// the tail of another one is nearest to it there.
  template <class A, class B>
  [[nodiscard]] bool grazes(const A& a, const B& b, int last) const {
    for (int i = 0; i < last; ++i) {
      const double a_from = a(i), a_to = a(i + 1), b_from = b(i), b_to = b(i + 1);
      if (ab_->sweeps(a_from, a_to, b_from, b_to) && dips(a_from, a_to, b_from, b_to)) return true;
    }
    return false;
  }
  [[nodiscard]] bool dips(double a, double a_end, double b, double b_end) const;

  static constexpr double kNoWorse = 1e-6;  ///< [m]

  [[nodiscard]] double gap(double s_a, double s_b) const;

  const PathLibrary* library_;
  const ContactTable* ab_;
  const ContactTable* ba_;
  const RoadVehicle* a_;
  const RoadVehicle* b_;
  double reaction_;
  double least_gap_ = 0.0;   ///< [m] see gap(), if both brake now; only if close_
  bool b_ahead_ = true;      ///< of `a` now; only if close_
  bool in_one_lane_ = true;  ///< now; only if close_
  bool close_ = false;       ///< braking now would bring them into their margins
  bool too_late_ = false;    ///< see braking_is_too_late()
  bool stuck_ = false;       ///< both
};

/// A contact as one of its two vehicles sees it.
struct ContactView {
  const RoadContact* contact;
  bool is_b;  ///< the one who looks is `b`

  [[nodiscard]] const ContactTable& table() const {
    return is_b ? contact->seen_from_b() : contact->seen_from_a();
  }
  template <class Self, class Other>
  [[nodiscard]] bool touch(const Self& self, const Other& other, int last, bool lenient) const {
    return is_b ? contact->touch(other, self, last, lenient)
                : contact->touch(self, other, last, lenient);
  }
  [[nodiscard]] bool touch_braking(const InertialState& self, const InertialState& other,
                                   bool lenient) const {
    return is_b ? contact->touch_braking(other, self, lenient)
                : contact->touch_braking(self, other, lenient);
  }
  [[nodiscard]] bool is_close(const InertialState& self, const InertialState& other) const {
    return is_b ? contact->is_close(other, self) : contact->is_close(self, other);
  }
};

struct PlaceOnPath {
  int path = 0;    ///< in the PathLibrary
  double s = 0.0;  ///< station of the rear axle [m]
};

/// Is somebody at `a` ahead of somebody at `b`, along the path of one of them?
[[nodiscard]] bool drives_ahead(const PathLibrary& library, const PlaceOnPath& a,
                                const PlaceOnPath& b);

/// A scene, and for all pairs in it what planning asks again and again.
class RoadPairs {
 public:
  /// Implicit: every planner on roads takes a scene; who plans often makes this once.
  RoadPairs(const RoadScene& scene);  // NOLINT(google-explicit-constructor)

  [[nodiscard]] const RoadScene& scene() const { return *scene_; }
  /// The place of a vehicle in the scene. @pre it is there
  [[nodiscard]] std::size_t index(std::int64_t key) const {
    return std::size_t(std::ranges::lower_bound(scene_->vehicles, key, {}, &RoadVehicle::key) -
                       scene_->vehicles.begin());
  }

  /// Vehicle i towards vehicle j != i.
  [[nodiscard]] ContactView between(std::size_t i, std::size_t j) const {
    return i < j ? ContactView{&vehicles_[pair(i, j)], false}
                 : ContactView{&vehicles_[pair(j, i)], true};
  }
  /// Vehicle i towards forecast f.
  [[nodiscard]] ContactView towards_forecast(std::size_t i, std::size_t f) const {
    return {&forecasts_[i * scene_->forecasts.size() + f], false};
  }

  /// Does what vehicle j will do matter to vehicle i != j? Only if they may touch, leave by one lane
  /// or may cross ground that is reserved.
  [[nodiscard]] bool matters(std::size_t j, std::size_t i) const;

  /// Must vehicle i stay before vehicle j in every order of planning? Its body, where it is,
  /// blocks the rest of j's path, and not the other way round.
  [[nodiscard]] bool leads(std::size_t i, std::size_t j) const {
    return leads_[i * scene_->vehicles.size() + j];
  }
  /// Does vehicle i block forecast f, and not the other way round? Its driver has to keep
  /// clear of us then, not we of him.
  [[nodiscard]] bool follows(std::size_t f, std::size_t i) const {
    return follows_[i * scene_->forecasts.size() + f];
  }
  /// Is vehicle i behind the driver of forecast f, along its own path?
  [[nodiscard]] bool is_behind(std::size_t i, std::size_t f) const;

 private:
  /// Pairs are stored row by row, i < j.
  [[nodiscard]] static std::size_t pair(std::size_t i, std::size_t j) {
    return j * (j - 1) / 2 + i;
  }

  const RoadScene* scene_;
  std::vector<RoadContact> vehicles_;
  std::vector<RoadContact> forecasts_;
  std::vector<bool> leads_;
  std::vector<bool> follows_;
};

}  // namespace mvtp
