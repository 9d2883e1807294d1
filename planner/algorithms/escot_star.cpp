#include "planner/algorithms/escot_star.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <thread>

#include "planner/algorithms/exchange.hpp"
#include "planner/algorithms/joint_motion.hpp"
#include "planner/algorithms/repair.hpp"

namespace mvtp {
namespace {

constexpr double kInstant = 0.106;    ///< the fastest robot drives no further between instants [m]
constexpr double kAloneWeight = 2.0;  ///< the first ways alone need only be good guides
constexpr int kAloneExpansions = 500;
constexpr double kSoloWeight = 1.1;  ///< the longest of them is looked for again, better
constexpr int kSoloExpansions = 20'000;
constexpr int kFirstExpansions = 500;
/// If robots on their ways alone have so many conflicts each, the first plan is found window by
/// window of time: what comes later changes too often to be worth the work.
constexpr double kCrowded = 1.0;
constexpr double kCrowdedLimit = 1.25;  ///< as kFirstLimit
constexpr int kWindow = 16;             ///< [buckets]
constexpr int kSight = 20;              ///< searches see so much further than the window [buckets]
/// The first plan is looked for within so much of the longest way alone; a deadline does not make
/// it harder to find, but much better. It is put off by kRelax whenever the repair comes to a halt.
constexpr double kFirstLimit = 1.2;
constexpr double kRelax = 1.25;
constexpr double kNoLimit = 1e9;  ///< [instants]
constexpr std::int64_t kPatience =
    50'000;  ///< expansions without progress of attempts to lower ...
constexpr std::int64_t kPatiencePerRobot = 1'500;  ///< ... and so many more for each robot
constexpr int kLateExpansions = 5000;  ///< of one search for a robot that is to arrive earlier
constexpr std::int64_t kExchangeEvery = 20'000;  ///< expansions between two meetings
constexpr int kMaxDoublings = 6;  ///< of the efforts, before nothing more is expected
constexpr int kShortenExpansions = 300;
constexpr int kShortenRounds = 2;

/// Instants so fine that arcs shorter than one cost little, and actions of half a car's length.
TimeGrid time_grid(const Instance& instance) {
  double speed = 0.0;
  double action = std::numeric_limits<double>::infinity();
  for (const Agent& agent : instance.agents) {
    const Vehicle& vehicle = agent.vehicle;
    speed = std::max(speed, vehicle.max_speed);
    action = std::min({action, vehicle.min_turning_radius / 2, vehicle.length() / 2});
  }
  TimeGrid time;
  time.dt = instance.dt / std::max(1.0, std::ceil(instance.dt * speed / kInstant - 1e-9));
  time.bucket = std::clamp(int(action / (speed * time.dt)), 2, 60);
  return time;
}

/// Radius of the circle around the longest action.
double longest_reach(const Instance& instance) {
  double reach = 1.0;
  for (const Agent& agent : instance.agents) reach = std::max(reach, 1.5 * agent.vehicle.length());
  return reach;
}

/// The instance as all searchers see it; they change nothing in it.
struct Scene {
  explicit Scene(const Fleet& fleet)
      : time(time_grid(fleet.instance())),
        obstacles(fleet.instance().map, longest_reach(fleet.instance())),
        clearance(fleet.instance().map, obstacles) {
    const Instance& instance = fleet.instance();
    cars.reserve(instance.agents.size());
    for (int i = 0; i < fleet.size(); ++i) {
      const Agent& agent = instance.agents[std::size_t(i)];
      cars.emplace_back(agent.vehicle, time, instance.map, obstacles, clearance);
      robots.push_back({&cars.back(), &fleet.cost_to_go(i), agent.start});
    }
    lower_bound = int(std::ceil(fleet.lower_bound() / time.dt - 1e-6));
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  TimeGrid time;
  Obstacles obstacles;
  Clearance clearance;
  std::vector<MacroCar> cars;
  std::vector<MacroRobot> robots;
  std::vector<TimedTrack> alone;
  int lower_bound = 0;  ///< [instants]
  int goal = 0;         ///< good enough [instants]
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
        motion_(scene.robots, scene.time),
        repair_(motion_, {}, seed_, deadline),
        exchange_(exchange),
        alone_(scene.alone),
        begin_(std::chrono::steady_clock::now()) {}

  /// Until the goal, the deadline, or nothing more to try.
  void run() {
    find_first_plan();
    improve();
    while (!ended_) meet(true);
  }

  [[nodiscard]] const Incumbent& best() const { return best_; }
  [[nodiscard]] double first_solution() const { return first_solution_; }
  /// Nothing was left to try.
  [[nodiscard]] bool exhausted() const { return exhausted_; }

  /// The longest way alone [s]; what the plan does, a robot can do alone.
  [[nodiscard]] double solo_makespan() const;

  /// Robots arrive earlier one by one, nobody later than the makespan.
  void shorten();

 private:
  void find_first_plan();
  [[nodiscard]] bool place_one_by_one();
  [[nodiscard]] bool resolve(double& limit);
  [[nodiscard]] bool resolve_by_windows(double limit);
  [[nodiscard]] int longest_way_alone() const;
  void improve();
  void straighten_longest_ways();
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
  JointMotion motion_;
  Repair repair_;
  Exchange& exchange_;
  std::vector<TimedTrack> alone_;  ///< as in the scene, the longest of them better
  std::chrono::steady_clock::time_point begin_;
  Incumbent best_;
  double first_solution_ = std::numeric_limits<double>::infinity();
  std::int64_t next_meeting_ = kExchangeEvery;
  bool adopted_ = false;  ///< the best plan is someone else's, and not worked on yet
  bool ended_ = false;
  bool exhausted_ = false;
};

/// The plan under way is free of conflicts: keeps it.
void Searcher::keep() {
  if (best_.tracks.empty()) {
    first_solution_ =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  Incumbent plan{motion_.tracks(), motion_.makespan(), motion_.flowtime()};
  if (plan.better_than(best_)) best_ = std::move(plan);
}

/// False if the time ran out before everyone was placed.
bool Searcher::place_one_by_one() {
  std::vector<int> order(scene_.robots.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater<>(),
                           [&](int i) { return alone_[std::size_t(i)].arrival(); });
  for (const int i : order) {
    if (deadline_.expired()) return false;
    if (!repair_.plan(i, kFirstExpansions)) motion_.place(i, alone_[std::size_t(i)]);
  }
  return true;
}

void Searcher::find_first_plan() {
  motion_.place_all(alone_);
  const bool crowded = double(motion_.conflicts().size()) > kCrowded * motion_.size();
  motion_.clear();
  double limit = (crowded ? kCrowdedLimit : kFirstLimit) * longest_way_alone();
  repair_.set_limit(int(limit));
  if (crowded ? resolve_by_windows(limit) : place_one_by_one() && resolve(limit)) keep();
}

/// Repairs until nobody overlaps before the horizon; `limit`, the deadline of all, is put off
/// whenever the repair comes to a halt. False if the time ran out.
bool Searcher::resolve(double& limit) {
  const std::int64_t patience = kPatiencePerRobot * motion_.size();
  while (!repair_.run(patience, [this] { return interrupted(); })) {
    if (deadline_.expired() || ended_ || adopted_) return false;
    limit = std::min(kRelax * limit, kNoLimit);
    repair_.set_limit(int(limit));
  }
  return true;
}

/// From the ways alone on: conflicts are resolved up to a horizon that is moved on.
bool Searcher::resolve_by_windows(double limit) {
  motion_.set_horizon(kWindow, kWindow + kSight);
  for (int i = 0; i < motion_.size(); ++i) motion_.place(i, alone_[std::size_t(i)]);
  for (int end = kWindow; resolve(limit); end += kWindow) {
    if (end * scene_.time.bucket > motion_.makespan()) return true;
    motion_.set_horizon(end + kWindow, end + kWindow + kSight);
  }
  return false;
}

/// The arrival of the last robot if each were alone [instants].
int Searcher::longest_way_alone() const {
  int longest = scene_.lower_bound;
  for (const TimedTrack& track : alone_) longest = std::max(longest, track.arrival());
  return longest;
}

/// Looks for better ways alone for the robots that would be too late even so.
void Searcher::straighten_longest_ways() {
  for (std::size_t i = 0; i < alone_.size(); ++i) {
    if (alone_[i].arrival() <= scene_.goal || deadline_.expired()) continue;
    std::optional<TimedTrack> better = repair_.plan_alone(int(i), kSoloWeight, kSoloExpansions);
    if (better && better->arrival() < alone_[i].arrival()) alone_[i] = *std::move(better);
  }
}

/// Lowers the deadline of all robots: boldly first, less so after each failure, and again with
/// twice the effort when nothing was too much to ask for.
void Searcher::improve() {
  if (best_.tracks.empty()) return;
  straighten_longest_ways();
  int floor = scene_.lower_bound;
  double part = 0.0;  // of the way from the floor to the best makespan that is not dared
  const std::int64_t patience = kPatience + kPatiencePerRobot * motion_.size();
  int doublings = 0;
  while (best_.makespan > scene_.goal && !ended_ && !deadline_.expired()) {
    adopted_ = false;
    const int best = best_.makespan;
    const int lowest = std::min(floor, best - 1);
    const int limit = lowest + int(part * (best - 1 - lowest));
    bool unreachable = false;
    motion_.place_all(best_.tracks);
    if (repair_.lower(
            limit, patience << doublings, kLateExpansions << doublings, alone_,
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
  motion_.place_all(best_.tracks);
  repair_.set_limit(best_.makespan);
  for (int round = 0; round < kShortenRounds; ++round) {
    bool shortened = false;
    for (int i = 0; i < motion_.size() && !deadline_.expired(); ++i) {
      const int driven = alone_[std::size_t(i)].arrival();
      if (motion_.track(i).arrival() <= driven) continue;
      shortened = repair_.shorten(i, kShortenExpansions) || shortened;
    }
    if (!shortened) break;
  }
  keep();
}

double Searcher::solo_makespan() const {
  int longest = 0;
  for (std::size_t i = 0; i < alone_.size(); ++i) {
    longest = std::max(longest, std::min(alone_[i].arrival(), best_.tracks[i].arrival()));
  }
  return longest * scene_.time.dt;
}

/// Every robot's way alone, by way of a searcher's tools; false if one was not found.
bool find_ways_alone(Scene& scene, const Deadline& deadline) {
  JointMotion motion(scene.robots, scene.time);
  Repair repair(motion, {}, 0, deadline);
  for (int i = 0; i < motion.size(); ++i) {
    if (deadline.expired()) return false;
    std::optional<TimedTrack> track = repair.plan_alone(i, kAloneWeight, kAloneExpansions);
    if (!track) return false;
    scene.alone.push_back(*std::move(track));
  }
  return true;
}

std::vector<Trajectory> trajectories(const Fleet& fleet, const Scene& scene,
                                     const Incumbent& plan) {
  std::vector<Trajectory> result;
  for (int i = 0; i < fleet.size(); ++i) {
    const TimedTrack& track = plan.tracks[std::size_t(i)];
    const Vehicle& vehicle = scene.cars[std::size_t(i)].vehicle();
    Trajectory trajectory(track.start());
    Pose pose = track.start();
    for (const Arc& arc : track.steps()) {
      pose = fleet.after(i, pose, arc);
      trajectory.push_back(
          {pose, arc.length / scene.time.dt, std::atan(arc.curvature * vehicle.wheelbase)});
    }
    result.push_back(std::move(trajectory));
  }
  return result;
}

}  // namespace

StepPlan solve_escot_star(const Fleet& fleet, const EscotStarOptions& options,
                          const Deadline& deadline) {
  const auto begin = std::chrono::steady_clock::now();
  StepPlan plan{Status::kExhausted, {}};
  if (fleet.size() == 0) return {Status::kSolved, {}};
  Scene scene(fleet);
  scene.goal =
      std::max(scene.lower_bound, int(fleet.lower_bound() * (1.0 + options.gap) / scene.time.dt));
  if (!find_ways_alone(scene, deadline)) {
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
  if (first.best().tracks.empty()) {
    plan.status = first.exhausted() ? Status::kExhausted : Status::kTimeout;
    return plan;
  }
  first.shorten();
  double soonest = std::numeric_limits<double>::infinity();
  for (const auto& searcher : searchers) soonest = std::min(soonest, searcher->first_solution());
  plan.status = Status::kSolved;
  plan.trajectories = trajectories(fleet, scene, first.best());
  plan.dt = scene.time.dt;
  plan.first_solution = soonest + std::chrono::duration<double>(searching - begin).count();
  plan.solo_makespan = first.solo_makespan();
  return plan;
}

}  // namespace mvtp
