#include "planner/anytime/escot_star.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <memory>
#include <numeric>
#include <thread>

#include "planner/anytime/exchange.hpp"
#include "planner/anytime/first_plan.hpp"
#include "planner/anytime/repair.hpp"
#include "planner/anytime/single_agent_trajectories.hpp"
#include "planner/search/joint_motion.hpp"

namespace mvtp {
namespace {

constexpr double kTimeStep = 0.106;  ///< the fastest robot drives no further between time steps [m]
constexpr double kSoloWeight = 1.1;  ///< the longest paths are looked for again, better
constexpr int kSoloExpansions = 20'000;
constexpr std::int64_t kStagnationLimit =
    50'000;  ///< expansions without progress of attempts to lower ...
constexpr std::int64_t kStagnationLimitPerRobot = 1'500;  ///< ... and so many more for each robot
constexpr double kFar = 1.2;           ///< times the lower bound: too far to try the bound at once
constexpr int kLateExpansions = 5000;  ///< of one search for a robot that is to arrive earlier
constexpr std::int64_t kExchangeEvery = 20'000;  ///< expansions between two meetings
constexpr int kMaxDoublings = 6;  ///< of the efforts, before nothing more is expected
constexpr int kShortenExpansions = 300;
constexpr int kShortenRounds = 2;

/// Time steps so fine that arcs shorter than one cost little, and motion primitives of half a car's
/// length.
TimeGrid time_grid(const Instance& instance) {
  double speed = 0.0;
  double primitive = std::numeric_limits<double>::infinity();
  for (const Agent& agent : instance.agents) {
    const Vehicle& vehicle = agent.vehicle;
    speed = std::max(speed, vehicle.max_speed);
    primitive = std::min({primitive, vehicle.min_turning_radius / 2, vehicle.length() / 2});
  }
  TimeGrid time;
  time.dt = instance.dt / std::max(1.0, std::ceil(instance.dt * speed / kTimeStep - 1e-9));
  time.macro_step = std::clamp(int(primitive / (speed * time.dt)), 2, 60);
  return time;
}

/// Radius of the circle around the longest motion primitive.
double reach_of_primitives(const Instance& instance) {
  double reach = 1.0;
  for (const Agent& agent : instance.agents) reach = std::max(reach, 1.5 * agent.vehicle.length());
  return reach;
}

/// The instance as all searchers see it; they change nothing in it.
struct Scene {
  Scene(const PlanningProblem& problem, const Deadline& deadline)
      : time(time_grid(problem.instance())),
        obstacles(problem.instance().map, reach_of_primitives(problem.instance())),
        clearance(problem.instance().map, obstacles, deadline) {
    for (int i = 0; i < problem.size(); ++i) {
      robots.push_back({&car_of(problem, i), &problem.cost_to_go(i),
                        problem.instance().agents[std::size_t(i)].start});
    }
    lower_bound = int(std::ceil(problem.lower_bound() / time.dt - 1e-6));
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  TimeGrid time;
  Obstacles obstacles;
  Clearance clearance;
  std::deque<MotionPrimitives> cars;  ///< one for all robots that may move alike
  std::vector<MacroRobot> robots;
  std::vector<ArcTrajectory> alone;
  int lower_bound = 0;  ///< [time steps]
  int goal = 0;         ///< good enough [time steps]

 private:
  const MotionPrimitives& car_of(const PlanningProblem& problem, int robot) {
    const Instance& instance = problem.instance();
    const Vehicle& vehicle = instance.agents[std::size_t(robot)].vehicle;
    const Exemptions* exemptions = problem.exemptions(robot);
    const auto known = std::ranges::find_if(cars, [&](const MotionPrimitives& car) {
      return car.vehicle() == vehicle && car.exemptions() == exemptions;
    });
    if (known != cars.end()) return *known;
    return cars.emplace_back(vehicle, time, instance.map, obstacles, clearance, exemptions);
  }
};

/// One thread's search for plans.
class Searcher {
 public:
  Searcher(const Scene& scene, std::uint64_t seed, int number, Exchange& exchange,
           const Deadline& deadline)
      : scene_(scene),
        number_(number),
        seed_(seed + 0x9e3779b97f4a7c15U * std::uint64_t(number)),
        deadline_(deadline),
        alone_(scene.alone),
        motion_(scene.robots, scene.time),
        repair_(motion_, alone_, {}, seed_, deadline),
        exchange_(exchange),
        begin_(std::chrono::steady_clock::now()) {}

  /// Until the goal, the deadline, or nothing more to try.
  void run() {
    find_first_plan();
    improve();
    while (!ended_) meet(true);
  }

  [[nodiscard]] const ConflictFreePlan& best() const { return best_; }
  [[nodiscard]] double first_solution() const { return first_solution_; }
  /// Nothing was left to try.
  [[nodiscard]] bool exhausted() const { return exhausted_; }

  /// The longest single-agent path [s]; what the plan does, a robot can do alone.
  [[nodiscard]] double solo_makespan() const;

  /// Robots arrive earlier one by one, nobody later than the makespan.
  void shorten();

 private:
  void find_first_plan();
  void improve();
  void straighten_longest_paths();
  void keep();

  void meet(bool finished) {
    const int makespan = best_.makespan;
    ended_ = exchange_.meet(number_, best_, finished);
    adopted_ = adopted_ || best_.makespan < makespan;
    next_meeting_ += kExchangeEvery;
  }
  /// Meets the others when it is time. @return true if the work under way has become pointless
  bool interrupted() {
    while (repair_.expansions() >= next_meeting_ && !ended_) meet(false);
    return ended_ || adopted_;
  }

  const Scene& scene_;
  int number_;
  std::uint64_t seed_;
  const Deadline& deadline_;
  std::vector<ArcTrajectory> alone_;  ///< as in the scene, the longest of them better
  JointMotion motion_;
  Repair repair_;
  Exchange& exchange_;
  std::chrono::steady_clock::time_point begin_;
  ConflictFreePlan best_;
  double first_solution_ = std::numeric_limits<double>::infinity();
  std::int64_t next_meeting_ = kExchangeEvery;
  bool adopted_ = false;  ///< the best plan is someone else's, and not worked on yet
  bool ended_ = false;
  bool exhausted_ = false;
};

/// The plan under way is free of conflicts: keeps it.
void Searcher::keep() {
  if (best_.trajectories.empty()) {
    first_solution_ =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  ConflictFreePlan plan{motion_.trajectories(), motion_.makespan(), motion_.flowtime()};
  if (plan.better_than(best_)) best_ = std::move(plan);
}

void Searcher::find_first_plan() {
  FirstPlan first(motion_, repair_, alone_, deadline_, [this] { return interrupted(); });
  if (first.find()) keep();
}

/// Looks for better single-agent paths for the robots that would be too late even so.
void Searcher::straighten_longest_paths() {
  for (std::size_t i = 0; i < alone_.size(); ++i) {
    if (alone_[i].arrival() <= scene_.goal || deadline_.expired()) continue;
    std::optional<ArcTrajectory> better = find_single_agent_trajectory(
        repair_.search(), scene_.robots[i], kSoloWeight, kSoloExpansions, 0, deadline_);
    if (better && better->arrival() < alone_[i].arrival()) alone_[i] = *std::move(better);
  }
}

/// Lowers the deadline of all robots: boldly first, unless it is far from the bound, less so after
/// each failure, and again with twice the effort when nothing was too much to ask for.
void Searcher::improve() {
  if (best_.trajectories.empty()) return;
  straighten_longest_paths();
  int floor = scene_.lower_bound;
  const bool far = best_.makespan > kFar * floor;
  double part = far ? 0.5 : 0.0;  // share of the makespans from floor to best that is not dared
  const std::int64_t stagnation_limit =
      kStagnationLimit + kStagnationLimitPerRobot * motion_.size();
  int doublings = 0;
  while (best_.makespan > scene_.goal && !ended_ && !deadline_.expired()) {
    adopted_ = false;
    const int best = best_.makespan;
    const int lowest = std::min(floor, best - 1);
    const int limit = lowest + int(part * (best - 1 - lowest));
    bool unreachable = false;
    motion_.place_all(best_.trajectories);
    if (repair_.tighten(
            limit, stagnation_limit << doublings, kLateExpansions << doublings,
            [this] { return interrupted(); }, unreachable)) {
      keep();
      part /= 2;
    } else if (!adopted_ && limit < best - 1) {
      if (unreachable) floor = limit + 1;
      part = (1.0 + part) / 2;
    } else if (!adopted_) {
      if (++doublings > kMaxDoublings) {
        exhausted_ = true;
        return;
      }
      floor = scene_.lower_bound;
      part = 0.0;
    }
  }
}

void Searcher::shorten() {
  motion_.place_all(best_.trajectories);
  repair_.set_limit(best_.makespan);
  for (int round = 0; round < kShortenRounds; ++round) {
    bool shortened = false;
    for (int i = 0; i < motion_.size() && !deadline_.expired(); ++i) {
      const int driven = alone_[std::size_t(i)].arrival();
      if (motion_.trajectory(i).arrival() <= driven) continue;
      shortened = repair_.shorten(i, kShortenExpansions) || shortened;
    }
    if (!shortened) break;
  }
  keep();
}

double Searcher::solo_makespan() const {
  int longest = 0;
  for (std::size_t i = 0; i < alone_.size(); ++i) {
    longest = std::max(longest, std::min(alone_[i].arrival(), best_.trajectories[i].arrival()));
  }
  return longest * scene_.time.dt;
}

}  // namespace

PlannerResult solve_escot_star(const PlanningProblem& problem, const EscotStarOptions& options,
                               const Deadline& deadline) {
  const auto begin = std::chrono::steady_clock::now();
  PlannerResult plan{Status::kExhausted, {}};
  if (problem.size() == 0) return {Status::kSolved, {}};
  Scene scene(problem, deadline);
  scene.goal =
      std::max(scene.lower_bound, int(problem.lower_bound() * (1.0 + options.gap) / scene.time.dt));
  scene.alone = find_single_agent_trajectories(problem, scene.robots, deadline);
  if (scene.alone.empty()) {
    if (deadline.expired()) plan.status = Status::kTimeout;
    return plan;
  }
  const auto searching = std::chrono::steady_clock::now();

  Exchange exchange(options.threads, scene.goal);
  std::vector<std::unique_ptr<Searcher>> searchers;
  for (int n = 0; n < options.threads; ++n) {
    searchers.push_back(std::make_unique<Searcher>(scene, options.seed, n, exchange, deadline));
  }
  {
    std::vector<std::jthread> threads;
    for (std::size_t n = 1; n < searchers.size(); ++n) {
      threads.emplace_back([&searchers, n] { searchers[n]->run(); });
    }
    searchers.front()->run();
  }

  Searcher& first = *searchers.front();  // has adopted the best of all
  if (first.best().trajectories.empty()) {
    plan.status = first.exhausted() ? Status::kExhausted : Status::kTimeout;
    return plan;
  }
  first.shorten();
  double soonest = std::numeric_limits<double>::infinity();
  for (const auto& searcher : searchers) soonest = std::min(soonest, searcher->first_solution());
  plan.status = Status::kSolved;
  for (int i = 0; i < problem.size(); ++i) {
    const std::vector<Arc>& steps = first.best().trajectories[std::size_t(i)].steps();
    plan.trajectories.push_back(trajectory_of(problem, i, steps, scene.time.dt));
  }
  plan.dt = scene.time.dt;
  plan.first_solution = soonest + std::chrono::duration<double>(searching - begin).count();
  plan.solo_makespan = first.solo_makespan();
  return plan;
}

}  // namespace mvtp
