#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planner/road/profile_planner.hpp"

namespace mvtp {

/// Everything that one vehicle's plan is tested against, gathered once.
class Surroundings {
 public:
  /// kWithSlack: for a new plan.
  enum class Forecasts { kCount, kWithSlack, kIgnore };

  /// @param waived  by number of the forecasts: those that do not count; empty: none.
  Surroundings(const RoadPairs& pairs, const RoadVehicle& vehicle,
               std::span<const JointPlan::Entry> before, const ProfileOptions& options,
               Forecasts forecasts = Forecasts::kCount, const std::vector<bool>& waived = {});

  /// Is the decision to drive from `from` with acceleration `a` during steps k .. k + n free of
  /// contact, and everyone's braking in lock-step after it as well?
  [[nodiscard]] bool step_is_clear(std::int64_t k, const InertialState& from, double a,
                                   const InertialState& to) const;

  /// Is the vehicle allowed to come to rest there [m]?
  [[nodiscard]] bool may_stand_at(double s) const;

  /// Could the vehicle brake from `state` at step k and then stand clear of all planned futures?
  [[nodiscard]] bool can_wait(std::int64_t k, const InertialState& state) const;

  /// The same wherever that is: where it is not allowed to come to rest, too.
  [[nodiscard]] bool stands_clear(std::int64_t k, const InertialState& state) const;

  /// The same with nobody but drivers who do not yield: where it stands they would run into it.
  [[nodiscard]] bool leaves_passages_free(std::int64_t k, const InertialState& state) const;

  /// Does somebody block the path to `s`, ahead of where the vehicle can stop, who is not
  /// expected to move? Then no timing gets it there.
  [[nodiscard]] bool is_barred(double s) const;

  /// On a common exit lane: is the one behind far enough from the one ahead, whichever of the two
  /// this vehicle is? In both orders, since a vehicle planned later may slip in ahead.
  [[nodiscard]] bool keeps_headway(std::int64_t k, const InertialState& state) const;

  /// Will the driver who takes over at step k in this state have his headway to those ahead? They
  /// may have slowed down, or go on otherwise, since the plan was made.
  [[nodiscard]] bool leaves_room(std::int64_t k, const InertialState& state) const;

  /// What was asked so far, in looks at one other vehicle each.
  [[nodiscard]] std::int64_t work() const { return work_; }

 private:
  struct Other {
    ContactView contact;
    const SpeedProfile* profile;
    const SpeedProfile* latest;  ///< of a forecast; nullptr: `profile` itself
    const RoadVehicle* vehicle;
    const Vehicle* body;
    bool forecast;
    Told told;            ///< as of Forecast
    bool yields;          ///< a forecast whose driver keeps clear of whoever blocks him
    bool relies = false;  ///< as of Forecast
    /// What it has reserved; nullptr: nothing, or this vehicle is there already.
    const ContactTable* reserved = nullptr;
    bool is_new = true;  ///< the plan, or the forecast
    int before = 0;      ///< steps of slack; see Forecast
    int behind = 0;
    /// If this vehicle brakes now it comes to rest in its passage, or is met before it has left it.
    /// Then to go on may be safe: as long as it does not slow down, only where it drives counts.
    bool braking_is_no_help = false;

    /// Where it is at least at step k, and how fast then.
    [[nodiscard]] InertialState hindmost_state(std::int64_t k) const {
      return (latest != nullptr ? latest : profile)->at(k);
    }
    [[nodiscard]] double hindmost(std::int64_t k) const { return hindmost_state(k).s; }
  };

  /// Of this vehicle's path [m], where the other one may be met at all, and when: compared before
  /// anything is looked up.
  struct Stretch {
    double first;
    double last;
    std::int64_t begin;  ///< a decision that begins before this step ends too early to meet it
    std::int64_t end;    ///< from this step on it has passed
    [[nodiscard]] bool overlaps(double from, double to, std::int64_t k) const {
      return k < end && from <= last && to >= first;
    }
  };

  /// How far behind the start of this vehicle's exit lane the other one is in this state [m]: on it
  /// as its own exit lane,
  [[nodiscard]] std::optional<double> place_on_exit(const Other& other,
                                                    const InertialState& state) const;
  /// or as the lane on which its path begins.
  [[nodiscard]] std::optional<double> place_on_next(const Other& other,
                                                    const InertialState& state) const;
  /// Is the driver of a forecast met by braking from `state` at step k, or, unless he yields, does
  /// he pass where this vehicle then stands?
  [[nodiscard]] bool is_met_by_braking(const Other& other, std::int64_t k,
                                       const InertialState& state) const;
  void add(Other other);
  [[nodiscard]] Stretch stretch_of(const Other& other) const;
  void add_slack(const Forecast& forecast);

  void count_work() const {
    constexpr std::int64_t kOwn = 4;  // what the decision itself takes, in looks
    work_ += kOwn + std::int64_t(others_.size());
  }

  /// Where the other one is at step k. Who is handed back at the end of a plan goes on at the same
  /// speed as far as the path leads: nobody may count on that ground the moment after.
  [[nodiscard]] InertialState goes_on_at(const Other& other, std::int64_t k) const;
  /// Do we meet in the decision from `from` at step k to `to`, or if all brake after it?
  /// @param reach  where we could get in both
  [[nodiscard]] bool meets(const Other& other, std::int64_t k, const InertialState& from, double a,
                           const InertialState& to, double reach) const;

  /// Do we come onto what the other one has reserved, in the decision from `from` at step k?
  [[nodiscard]] bool enters_reserved(const Other& other, std::int64_t k, const InertialState& from,
                                     double a) const;
  /// Is the decision to drive from `from` at step k partly on ground that is closed then?
  [[nodiscard]] bool enters_closed(std::int64_t k, const InertialState& from, double a) const;
  /// Are we, braking from `state` at step k and then standing, where the other one will pass?
  [[nodiscard]] bool stands_blocking(const Other& other, const ContactTable& contacts,
                                     std::int64_t k, const InertialState& state) const;

  /// Is the other one, who may be anywhere between two profiles and does not brake, met by
  /// braking from `state` at step k?
  [[nodiscard]] bool brakes_into(const Other& other, std::int64_t k,
                                 const InertialState& state) const;
  /// The same as meets() for such a one.
  [[nodiscard]] bool meets_anywhere(const Other& other, std::int64_t k, const InertialState& from,
                                    double a, const InertialState& to) const;

  /// Is this vehicle beside the lane of a driver who goes the same way? He does not see it there: a
  /// new plan neither counts on him to make room, nor on braking as safe. One that is kept
  /// has no choice any more.
  [[nodiscard]] bool comes_over(const Other& other, const InertialState& state,
                                const InertialState& other_state) const;
  /// Level with such a driver at step k, does this vehicle get onto his lane if it brakes? He does
  /// not brake because of that, but drives on.
  [[nodiscard]] bool brakes_onto_lane(const Other& other, std::int64_t k,
                                      const InertialState& state) const;
  /// Does this vehicle block the driver of a forecast, and not the other way round? Then he
  /// keeps clear of it.
  [[nodiscard]] bool is_followed_by(const Other& other, const InertialState& state,
                                    const InertialState& other_state) const;

  /// A vehicle on an exit lane, at `place` [m] from its start.
  struct OnExit {
    double place = 0.0;
    double v = 0.0;
    const RoadVehicle* vehicle = nullptr;
    const Vehicle* body = nullptr;
  };
  /// Does the vehicle come over beside a driver in this decision, or before one who could not stop
  /// behind it? Between lanes its own braking does not help, but what brings that about.
  [[nodiscard]] bool cuts_in(const Other& other, std::int64_t k, const InertialState& from,
                             const InertialState& to) const;
  /// Is the gap between the two what it has to be there? It builds up along the exit lane, until
  /// the driver gets the vehicle back.
  [[nodiscard]] bool is_behind_well(const OnExit& behind, const OnExit& ahead) const;

  DecisionGrid grid_;
  std::int64_t now_;
  double reaction_;  ///< [s] as of RoadScene
  const RoadVehicle& vehicle_;
  const Vehicle& body_;
  const ProfileOptions& options_;
  std::span<const ClosedStretch> closed_;
  std::span<const std::pair<double, double>> run_ups_;  ///< those that are still ahead
  std::vector<Other> others_;
  std::vector<Stretch> stretches_;    ///< of each of the others
  std::vector<std::size_t> on_exit_;  ///< those of the others that use this vehicle's exit lane
  bool is_new_;                       ///< the plan, not one that is kept
  mutable std::size_t last_blocker_ = 0;
  mutable std::int64_t work_ = 0;
};

}  // namespace mvtp
