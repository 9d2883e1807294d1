#include "planner/algorithms/bucket_steps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "planner/algorithms/pbcr.hpp"
#include "planner/motion/frame.hpp"
#include "planner/search/noise.hpp"

namespace mvtp {
namespace {

constexpr int kGuide = -1;  ///< the action that follows the guide

/// A robot's place, and how far it has come along its guide; none: it was pushed off it.
struct StepState {
  Pose pose;
  int guide_bucket = 0;
  bool on_guide = true;
};

/// One bucket of motion; the safe stop after it is its end.
struct StepMotion {
  int action = MacroCar::kWait;
  std::vector<BoxPose> boxes;
  float travel = 0.0F;
  BoxPose middle;
  float radius = 0.0F;
  StepState end;
};

class StepperWorld {
 public:
  using State = StepState;
  using Motion = StepMotion;

  StepperWorld(std::span<const MacroRobot> robots, std::span<const TimedTrack> alone,
               SoftAstar& search, const StepsOptions& options, const Deadline& deadline)
      : robots_(robots),
        search_(search),
        options_(options),
        deadline_(deadline),
        empty_(1, robots.front().car->time()),
        guides_(alone.begin(), alone.end()),
        stuck_(robots.size(), 0) {}

  [[nodiscard]] int bucket() const { return robots_.front().car->time().bucket; }
  [[nodiscard]] bool at_goal(int i, const State& s) const {
    return s.on_guide && s.guide_bucket * bucket() >= guides_[std::size_t(i)].arrival();
  }

  /// To be called before each step: robots that were pushed off get new guides.
  void prepare(std::vector<State>& states, int step) {
    step_ = step;
    for (std::size_t i = 0; i < states.size(); ++i) {
      State& s = states[i];
      if (s.on_guide) continue;
      if (find_guide(i, s.pose)) {
        s.guide_bucket = 0;
        s.on_guide = true;
      }
    }
  }

  /// Where robots of higher priority go next is no place to stand: rank 0 is the highest.
  void look_ahead(const std::vector<State>& states, const std::vector<int>& order) {
    rank_.resize(order.size());
    ahead_.assign(order.size(), {});
    for (std::size_t k = 0; k < order.size(); ++k) rank_[std::size_t(order[k])] = int(k);
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (!states[i].on_guide || at_goal(int(i), states[i])) continue;
      for (int b = 1; b <= options_.look_ahead; ++b) {
        const int t = (states[i].guide_bucket + b) * bucket();
        ahead_[i].push_back(*guides_[i].boxes(t));
        if (t >= guides_[i].arrival()) break;
      }
    }
    here_.clear();
    for (std::size_t i = 0; i < states.size(); ++i) {
      here_.push_back(box_pose(robots_[i].car->vehicle(), states[i].pose));
    }
  }

  /// How many steps of robots of higher priority lead over the place.
  [[nodiscard]] double in_the_way(int i, const BoxPose& box) const {
    double sum = 0.0;
    const BoxShape& size = robots_[std::size_t(i)].car->shape();
    for (const int j : neighbours_) {
      for (const BoxPose& other : ahead_[std::size_t(j)]) {
        if (gap(box, size, other, robots_[std::size_t(j)].car->shape()) < options_.look_ahead_gap) {
          sum += 1.0;
        }
      }
    }
    return sum;
  }

  void find_neighbours(int i) const {
    neighbours_.clear();
    const BoxPose& box = here_[std::size_t(i)];
    for (std::size_t j = 0; j < here_.size(); ++j) {
      if (ahead_[j].empty() || rank_[j] >= rank_[std::size_t(i)]) continue;
      const float dx = here_[j].x - box.x;
      const float dy = here_[j].y - box.y;
      if (dx * dx + dy * dy < 144.0F) neighbours_.push_back(int(j));
    }
  }

  void advance(const std::vector<State>& before, const std::vector<Motion>& motions) {
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const bool home = at_goal(int(i), before[i]);
      stuck_[i] = home || motions[i].action == kGuide ? 0 : stuck_[i] + 1;
    }
  }

  [[nodiscard]] std::vector<Motion> candidates(int i, const State& s) const {
    const MacroCar& car = *robots_[std::size_t(i)].car;
    const double length = car.vehicle().max_speed * car.time().bucket_duration();
    struct Scored {
      double score;
      int action;
    };
    std::vector<Scored> scored;
    find_neighbours(i);
    if (s.on_guide) {
      const BoxPose end = *guides_[std::size_t(i)].boxes((s.guide_bucket + 1) * bucket());
      scored.push_back({(*robots_[std::size_t(i)].cost_to_go)(
                            guides_[std::size_t(i)].pose((s.guide_bucket + 1) * bucket())) -
                            options_.guide_bonus + options_.in_the_way * in_the_way(i, end),
                        kGuide});
    }
    // A robot that has long been kept from its way tries something else.
    const double spread = length * std::min(2.0, 0.1 * (1 + stuck_[std::size_t(i)]));
    for (int a = 0; a < int(car.actions().size()); ++a) {
      const Pose end = drive(s.pose, car.actions()[std::size_t(a)].arc);
      const double h = (*robots_[std::size_t(i)].cost_to_go)(end) +
                       options_.in_the_way * in_the_way(i, box_pose(car.vehicle(), end));
      scored.push_back({h + spread * noise(options_.seed, std::uint64_t(step_), std::uint64_t(i),
                                           std::uint64_t(a)),
                        a});
    }
    std::ranges::stable_sort(scored, {}, &Scored::score);
    std::vector<Motion> result;
    for (const Scored& candidate : scored) {
      if (candidate.action == kGuide) {
        result.push_back(along_guide(i, s));
        continue;
      }
      if (candidate.action == MacroCar::kWait) {
        result.push_back(safe_stop(i, s));
        continue;
      }
      std::optional<Motion> motion = take(i, s, candidate.action);
      if (motion) result.push_back(*std::move(motion));
    }
    return result;
  }

  [[nodiscard]] Motion safe_stop(int i, const State& s) const {
    const MacroCar& car = *robots_[std::size_t(i)].car;
    Motion motion;
    motion.boxes.assign(std::size_t(bucket()) + 1, box_pose(car.vehicle(), s.pose));
    motion.middle = motion.boxes.front();
    motion.radius = car.shape().half_diagonal();
    motion.end = s;
    return motion;
  }

  [[nodiscard]] bool conflict(int i, const Motion& a, int j, const Motion& b) const {
    const float dx = a.middle.x - b.middle.x;
    const float dy = a.middle.y - b.middle.y;
    const float reach = a.radius + b.radius;
    if (dx * dx + dy * dy >= reach * reach) return false;
    BoxShape size_a = robots_[std::size_t(i)].car->shape();
    BoxShape size_b = robots_[std::size_t(j)].car->shape();
    size_a.travel = a.travel;
    size_b.travel = b.travel;
    return meet(a.boxes.data(), size_a, b.boxes.data(), size_b, bucket());
  }

  /// The arcs of a motion, one per instant.
  void append_arcs(int i, const State& from, const Motion& motion, std::vector<Arc>& steps) const {
    const int instants = bucket();
    if (motion.action == kGuide) {
      const TimedTrack& guide = guides_[std::size_t(i)];
      for (int t = from.guide_bucket * instants; t < (from.guide_bucket + 1) * instants; ++t) {
        steps.push_back(t < guide.arrival() ? guide.steps()[std::size_t(t)] : Arc{});
      }
      return;
    }
    const Arc& arc = robots_[std::size_t(i)].car->actions()[std::size_t(motion.action)].arc;
    steps.insert(steps.end(), std::size_t(instants), Arc{arc.length / instants, arc.curvature});
  }

 private:
  [[nodiscard]] Motion along_guide(int i, const State& s) const {
    const MacroCar& car = *robots_[std::size_t(i)].car;
    const TimedTrack& guide = guides_[std::size_t(i)];
    const int t = s.guide_bucket * bucket();
    Motion motion;
    motion.action = kGuide;
    motion.boxes.assign(guide.boxes(t), guide.boxes(t) + bucket() + 1);
    motion.travel = t >= guide.arrival() ? 0.0F : car.shape().travel;
    motion.middle = motion.boxes[std::size_t(bucket() / 2)];
    motion.radius = car.reach();
    motion.end = {guide.pose(t + bucket()), s.guide_bucket + 1, true};
    return motion;
  }

  [[nodiscard]] std::optional<Motion> take(int i, const State& s, int a) const {
    const MacroCar& car = *robots_[std::size_t(i)].car;
    const MacroCar::Action& action = car.actions()[std::size_t(a)];
    const Frame frame(s.pose);
    Motion motion;
    motion.action = a;
    for (const BoxPose& box : action.boxes) {
      motion.boxes.push_back(box_pose(
          frame.then({double(box.x), double(box.y), double(box.ux), double(box.uy)}), 0.0));
    }
    motion.middle = motion.boxes[std::size_t(bucket() / 2)];
    if (!car.is_free(s.pose, action.arc, motion.middle)) return std::nullopt;
    motion.travel = action.travel;
    motion.radius = action.radius;
    motion.end = {drive(s.pose, action.arc), 0, false};
    return motion;
  }

  bool find_guide(std::size_t i, const Pose& pose) {
    SoftProblem problem;
    problem.car = robots_[i].car;
    problem.cost_to_go = robots_[i].cost_to_go;
    problem.others.occupancy = &empty_;
    problem.start = pose;
    SoftOptions options;
    options.max_expansions = 300;
    const std::optional<SoftPath> path = search_.search(problem, options, deadline_);
    if (!path) return false;
    guides_[i] = TimedTrack(robots_[i].car->vehicle(), pose, path->steps, bucket());
    return true;
  }

  std::span<const MacroRobot> robots_;
  SoftAstar& search_;
  StepsOptions options_;
  const Deadline& deadline_;
  Occupancy empty_;
  std::vector<TimedTrack> guides_;
  std::vector<int> stuck_;  ///< steps since the robot last was at home or went along its guide
  std::vector<int> rank_;
  std::vector<std::vector<BoxPose>> ahead_;
  std::vector<BoxPose> here_;
  mutable std::vector<int> neighbours_;
  int step_ = 0;
};

}  // namespace

StepsResult plan_by_steps(std::span<const MacroRobot> robots, std::span<const TimedTrack> alone,
                          SoftAstar& search, const StepsOptions& options,
                          const Deadline& deadline) {
  StepperWorld world(robots, alone, search, options, deadline);
  const int n = int(robots.size());
  std::vector<StepState> states;
  for (const MacroRobot& robot : robots) states.push_back({robot.start, 0, true});
  std::vector<int> waiting(std::size_t(n), 0);  // steps since the robot was last at its goal

  StepsResult result;
  result.steps.resize(std::size_t(n));
  int best_home = -1;
  int best_step = 0;
  int home = 0;
  for (int step = 0; step < options.max_steps && home < n && !deadline.expired(); ++step) {
    world.prepare(states, step);
    std::vector<int> order(robots.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater<>(),
                             [&](int i) { return waiting[std::size_t(i)]; });
    world.look_ahead(states, order);
    const Pbcr<StepperWorld> pbcr(world, {.max_withdrawn = options.max_withdrawn});
    const std::optional<std::vector<StepMotion>> motions = pbcr.step(states, order);
    world.advance(states, *motions);
    home = 0;
    for (int i = 0; i < n; ++i) {
      const std::size_t k = std::size_t(i);
      world.append_arcs(i, states[k], (*motions)[k], result.steps[k]);
      states[k] = (*motions)[k].end;
      const bool arrived = world.at_goal(i, states[k]);
      home += arrived ? 1 : 0;
      waiting[k] = arrived ? 0 : waiting[k] + 1;
    }
    if (home > best_home) {
      best_home = home;
      best_step = step + 1;
      result.at_goal.assign(std::size_t(n), 0);
      for (int i = 0; i < n; ++i) {
        result.at_goal[std::size_t(i)] = world.at_goal(i, states[std::size_t(i)]);
      }
    }
    if (step + 1 - best_step >= options.patience) break;
  }
  for (std::vector<Arc>& steps : result.steps) {
    steps.resize(std::size_t(best_step) * std::size_t(world.bucket()));
  }
  return result;
}

}  // namespace mvtp
