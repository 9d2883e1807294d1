#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "planner/lot/lot_planner.hpp"

namespace mvtp {

/// One decision under way: everyone's motion from `ahead` seconds from now on.
///
/// Robots: the cars under way, the request once per goal, those who wait, the queue behind the
/// request in its entry lane.
class LotPlanner::ReplanningSession {
 public:
  ReplanningSession(LotPlanner& planner, const LotMotion& motion, const LotRequest* request,
                    std::span<const StandingCar> waiting);

  [[nodiscard]] const LotForecast& forecast() const { return forecast_; }
  [[nodiscard]] int cars() const { return int(motion_.cars().size()); }
  [[nodiscard]] int robot_of_goal(std::size_t g) const { return cars() + int(g); }

  /// Tight places need longer searches; most are done without.
  enum class Effort { kQuick, kThorough };

  /// The robot's path as if nobody else moved.
  [[nodiscard]] std::optional<ArcTrajectory> alone(int robot, Effort effort);
  /// The robot, absent so far, gets a path that touches nobody present.
  /// @param alone  its path as if nobody else moved
  [[nodiscard]] bool plan(int robot, const ArcTrajectory& alone, Effort effort);
  /// The same, quickly if possible.
  [[nodiscard]] std::optional<ArcTrajectory> alone(int robot);
  [[nodiscard]] bool plan(int robot, const ArcTrajectory& alone);
  [[nodiscard]] ArcTrajectory take(int robot) { return joint_->remove(robot); }
  [[nodiscard]] const ArcTrajectory& trajectory(int robot) const {
    return joint_->trajectory(robot);
  }
  /// The robots that block one that moves like this.
  [[nodiscard]] std::vector<int> blockers_of(int robot, const ArcTrajectory& trajectory);

  /// Must the car's path stay as it is? In an entry lane somebody follows; shortly before the end
  /// nothing is to be gained.
  [[nodiscard]] bool is_fixed(int i) const {
    const LotCar& car = motion_.cars()[std::size_t(i)];
    const double end = car.path.length() - (car.leaves ? kRunOut : 0.0);
    const Robot& robot = robots_[std::size_t(i)];
    return car.stopped_permanently || robot.prefix.length() >= end - kPrimitive ||
           planner_.in_entry(car.body, macro_robots_[std::size_t(i)].start);
  }
  /// PreCheck: can these be planned anew together with one more?
  [[nodiscard]] bool may_replan(std::span<const int> robots) const {
    const auto under_way = [&](int i) { return i < cars() && !is_fixed(i); };
    return int(robots.size()) < planner_.options_.max_group &&
           std::ranges::all_of(robots, under_way);
  }

  /// Plans a robot, absent so far, and then the others anew.
  /// @return all of them; empty if one of them has no path
  [[nodiscard]] std::vector<int> plan_before(int robot, const ArcTrajectory& alone,
                                             std::span<const int> others);

  /// The motion in which the given robots drive as placed here, the others as before.
  [[nodiscard]] LotMotion result(std::span<const int> changed) const;
  /// The robot on its way along `trajectory`.
  [[nodiscard]] LotCar car(int robot, const ArcTrajectory& trajectory) const;
  /// The next one follows in the lane: a car may leave it only forwards, and for good.
  [[nodiscard]] bool comes_back_into_entry(int robot, const std::vector<Arc>& steps) const;
  /// Arrival of a robot that drives `trajectory` with nobody else there [s from now].
  [[nodiscard]] double duration_alone(int robot, const ArcTrajectory& trajectory) const;

 private:
  struct Robot {
    Vehicle body;    ///< true size
    ArcPath prefix;  ///< what it drives until the session begins
    double s = 0.0;  ///< on the prefix, now
    double v = 0.0;
    int direction = 0;
    std::int64_t key = 0;
    Pose goal;
    bool leaves = false;
    bool stands = false;
  };

  void add_cars();
  void add_request(const LotRequest& request);
  void add_standing(const StandingCar& car);
  void add_queue(const LotRequest& request, const Pose& start);
  void add(Robot robot, const Pose& start, bool in_entry);
  [[nodiscard]] ArcTrajectory forecast_trajectory(int car) const;
  [[nodiscard]] bool drive_alone_later(int robot, const ArcTrajectory& alone);
  [[nodiscard]] SoftProblem problem(int robot) const;
  [[nodiscard]] std::optional<SoftResult> search_alone(SoftProblem problem, int expansions);
  [[nodiscard]] std::optional<SoftResult> search_alone_backwards(int robot, int expansions);
  [[nodiscard]] std::optional<std::vector<Arc>> sample_alone(int robot) const;
  [[nodiscard]] std::vector<Arc> tail(const ArcTrajectory& alone) const;
  [[nodiscard]] ArcPath path_of(int robot, const ArcTrajectory& trajectory) const;
  [[nodiscard]] std::vector<float> times_of_kept(int car) const;
  [[nodiscard]] std::vector<float> times_of_planned(const LotCar& car, int robot) const;
  [[nodiscard]] double ahead() const { return planner_.options_.ahead; }

  LotPlanner& planner_;
  const LotMotion& motion_;
  LotForecast forecast_;
  std::vector<Robot> robots_;
  std::vector<std::unique_ptr<MotionPrimitives>> macro_cars_;
  std::vector<MacroRobot> macro_robots_;
  std::optional<JointMotion> joint_;
};

}  // namespace mvtp
