#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planner/escot/generate_config.hpp"
#include "planner/lot/lot_planner.hpp"
#include "planner/lot/replanning_session.hpp"

namespace mvtp {

/// The world of generate_config() on an open lot: the cars under way, and one that asks for a path,
/// if any.
///
/// A motion is the ground that a car may use until the next decision and to stop after it. Whoever
/// follows a complete plan keeps the whole rest of its path: among those the order of passage
/// decides (LotMotion), whatever their speeds, and the others stay clear of it.
/// GroupRobots: the car that asks, or else the one that loses most, with those on its path.
/// GetOptTraj: complete paths for them in other orders (ReplanningSession).
class LotPlanner::World {
 public:
  struct State {
    double s = 0.0;  ///< driven on its path [m]
    double v = 0.0;  ///< [m/s]
  };
  struct Motion {
    double from = 0.0;  ///< on its path [m], the rear axle,
    double stop = 0.0;  ///< and where it comes to rest at the latest
    bool planned = false;

    friend bool operator==(const Motion&, const Motion&) = default;
  };

  /// @param request  nullptr: nobody asks
  World(LotPlanner& planner, const LotMotion& motion, const LotRequest* request,
        std::span<const StandingCar> waiting);

  /// Of the cars under way, by key, and of the one that asks.
  [[nodiscard]] std::vector<State> states() const;

  // StepWorld
  [[nodiscard]] std::vector<Motion> candidates(int i, const State& state) const;
  [[nodiscard]] Motion safe_stop(int i, const State& state) const;
  [[nodiscard]] bool conflict(int i, const Motion& a, int j, const Motion& b) const;

  // GroupWorld
  [[nodiscard]] std::vector<Group> group_robots(const std::vector<State>& q);
  [[nodiscard]] bool pre_check(const Group& group) const;
  [[nodiscard]] std::vector<std::optional<Motion>> get_opt_traj(const std::vector<State>& q,
                                                                const Group& group);
  /// Who has been under way longest.
  [[nodiscard]] std::vector<int> order(const std::vector<State>& q) const;

  /// What was decided becomes the motion, unless the car that asks gets no path.
  /// @return for that one
  [[nodiscard]] std::optional<LotAdmission> carry_out(const std::vector<Motion>& motions,
                                                      LotMotion& motion);
  /// Cars that were planned anew for one of those under way.
  [[nodiscard]] int replanned() const;

 private:
  using Effort = ReplanningSession::Effort;
  struct Choice {
    std::size_t goal;
    ArcTrajectory alone;
    double duration;  ///< alone [s]
  };
  struct Candidate {
    LotMotion motion;
    double cost;
    std::size_t goal;
    double alone;
    int replanned;
  };

  /// One who stands, and a gap around it.
  struct StandingBox {
    BoxPose pose;
    BoxShape shape;
  };

  [[nodiscard]] bool asks(int i) const { return request_ != nullptr && i == session_.cars(); }
  [[nodiscard]] const LotCar& car(int i) const;
  void find_choices(Effort effort);
  void place_the_asking();
  [[nodiscard]] Group group_of_asking();
  [[nodiscard]] int who_loses_most() const;
  [[nodiscard]] Group group_of_loser();
  void plan_asking(std::span<const int> blockers);
  void plan_loser(std::span<const int> blockers);
  void try_place(const Choice& choice, Effort effort);
  void consider(const Choice& choice, std::span<const int> changed);
  [[nodiscard]] double beyond_footpath(const LotCar& car, double stop) const;
  [[nodiscard]] static bool reaches_footpath(const LotCar& car, double stop);
  [[nodiscard]] bool keeps_clear(int i, double stop) const;
  [[nodiscard]] bool is_free(const LotCar& car, const Motion& motion) const;

  LotPlanner& planner_;
  const LotPlannerOptions& options_;
  const LotMotion& motion_;
  const LotRequest* request_;
  ReplanningSession session_;
  std::vector<Choice> choices_;  ///< places with a path alone, the quickest first
  std::optional<LotCar> asking_;
  std::vector<StandingBox> waiting_;
  int focus_ = -1;                     ///< whose group is planned anew, unless somebody asks
  std::optional<ArcTrajectory> wish_;  ///< its path alone
  std::optional<Candidate> best_;
};

}  // namespace mvtp
