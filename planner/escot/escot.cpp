#include "planner/escot/escot.hpp"

#include <cmath>
#include <random>
#include <unordered_map>

namespace mvtp {
namespace {

/// Q_0 ... Q_back of Algorithm 2 with the arcs between them, and where each configuration is found.
class History {
 public:
  explicit History(const PlanningProblem& problem) : problem_(problem) {
    for (const Pose& start : problem.starts()) trajectories_.emplace_back(start);
    remember();
  }

  [[nodiscard]] Configuration back() const { return at(length()); }

  [[nodiscard]] bool at_goals() const {
    for (int i = 0; i < problem_.size(); ++i) {
      if (trajectories_[std::size_t(i)].waypoints().back().pose != problem_.goal(i)) return false;
    }
    return true;
  }

  void add(const std::vector<SteppedWorld::Motion>& motions) {
    for (int i = 0; i < problem_.size(); ++i) {
      const SteppedWorld::Motion& m = motions[std::size_t(i)];
      trajectories_[std::size_t(i)].push_back(problem_.car(i).waypoint(m.arc, m.end));
    }
    remember();
  }

  /// If the last configuration was there before, at i: forgets everything after Q_i.
  ///
  /// The paper removes Q_i as well and puts the new one in its place; equal they are only up to
  /// quantisation, so that Q_i is kept for its steps to stay exact arcs.
  bool cut_duplicate() {
    const std::size_t t = length();
    const auto [first, last] = times_.equal_range(hash(t));
    for (auto found = first; found != last; ++found) {
      if (found->second == t || !same(found->second, t)) continue;
      const std::size_t back_to = found->second;
      for (std::size_t k = back_to + 1; k <= t; ++k) forget(k);
      for (Trajectory& trajectory : trajectories_) trajectory.truncate(back_to);
      return true;
    }
    return false;
  }

  [[nodiscard]] std::vector<Trajectory> trajectories() && { return std::move(trajectories_); }

 private:
  using Key = std::uint64_t;

  [[nodiscard]] std::size_t length() const { return trajectories_.front().makespan(); }

  [[nodiscard]] Configuration at(std::size_t t) const {
    Configuration q;
    for (const Trajectory& trajectory : trajectories_) q.push_back(trajectory.at(t).pose);
    return q;
  }

  static std::int64_t quantised(double value) { return std::int64_t(std::llround(value / 0.001)); }

  [[nodiscard]] Key hash(std::size_t t) const {
    Key key = 0xcbf29ce484222325U;  // FNV-1a over the quantised poses
    for (const Trajectory& trajectory : trajectories_) {
      const Pose& pose = trajectory.at(t).pose;
      for (const double value : {pose.x, pose.y, pose.theta}) {
        key = (key ^ Key(quantised(value))) * 0x100000001b3U;
      }
    }
    return key;
  }

  [[nodiscard]] bool same(std::size_t s, std::size_t t) const {
    for (int i = 0; i < problem_.size(); ++i) {
      const Pose& a = trajectories_[std::size_t(i)].at(s).pose;
      const Pose& b = trajectories_[std::size_t(i)].at(t).pose;
      if (quantised(a.x) != quantised(b.x) || quantised(a.y) != quantised(b.y) ||
          quantised(a.theta) != quantised(b.theta)) {
        return false;
      }
      // A last step of a centimetre is progress.
      if ((a == problem_.goal(i)) != (b == problem_.goal(i))) return false;
    }
    return true;
  }

  void remember() { times_.emplace(hash(length()), length()); }

  void forget(std::size_t t) {
    const auto [first, last] = times_.equal_range(hash(t));
    for (auto entry = first; entry != last; ++entry) {
      if (entry->second != t) continue;
      times_.erase(entry);
      return;
    }
  }

  const PlanningProblem& problem_;
  std::vector<Trajectory> trajectories_;
  std::unordered_multimap<Key, std::size_t> times_;
};

}  // namespace

PlannerResult solve_escot(const PlanningProblem& problem, const EscotOptions& options,
                          const Deadline& deadline) {
  if (problem.size() == 0) return {Status::kSolved, {}};
  SteppedWorld world(problem, options.world, deadline);
  std::mt19937_64 rng(options.seed);
  History history(problem);  // line 1

  for (int step = 0; !history.at_goals(); ++step) {  // line 2
    if (deadline.expired()) return {Status::kTimeout, std::move(history).trajectories()};
    if (step == options.max_steps) {
      return {Status::kExhausted, std::move(history).trajectories()};
    }
    const Configuration q = history.back();
    world.update_reference_paths(q);
    const std::vector<SteppedWorld::Motion> motions = generate_config(world, q);  // line 3
    world.advance(motions);
    history.add(motions);                                        // line 7
    if (options.replan_duplicates && history.cut_duplicate()) {  // lines 4-5
      world.add_randomness(history.back(), rng);                 // line 6
    }
  }
  return {Status::kSolved, std::move(history).trajectories()};
}

}  // namespace mvtp
