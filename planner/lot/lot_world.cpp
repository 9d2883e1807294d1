#include "planner/lot/lot_world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "planner/motion/inertial_car.hpp"

namespace mvtp {
namespace {

constexpr int kAttemptsAfterFailure = 10;
constexpr double kGain = 0.5;  ///< [s] that a new order must save at least

}  // namespace

LotPlanner::World::World(LotPlanner& planner, const LotMotion& motion, const LotRequest* request,
                         std::span<const StandingCar> waiting)
    : planner_(planner),
      options_(planner.options_),
      motion_(motion),
      request_(request),
      session_(planner, motion, request, waiting) {
  static_assert(GroupWorld<World>);
  for (const StandingCar& car : waiting) {
    const double half_length = car.body.length() / 2 + options_.gap;
    const double half_width = car.body.width / 2 + options_.gap;
    waiting_.push_back({box_pose(car.body, car.pose), {float(half_length), float(half_width)}});
  }
  if (request_ == nullptr) return;
  find_choices(Effort::kQuick);
  if (choices_.empty()) find_choices(Effort::kThorough);
  std::ranges::stable_sort(choices_, {}, &Choice::duration);
  place_the_asking();
}

void LotPlanner::World::find_choices(Effort effort) {
  for (std::size_t g = 0; g < request_->goals.size(); ++g) {
    const int robot = session_.robot_of_goal(g);
    std::optional<ArcTrajectory> alone = session_.alone(robot, effort);
    if (!alone) continue;
    const double duration = session_.duration_alone(robot, *alone);
    choices_.push_back({g, *std::move(alone), duration});
  }
}

/// On its path alone, if PBCR is to move it; else it stands where it is until it has a plan.
void LotPlanner::World::place_the_asking() {
  const auto stays_out = [&](const Choice& choice) {
    return !session_.comes_back_into_entry(session_.robot_of_goal(choice.goal),
                                           choice.alone.steps());
  };
  std::erase_if(choices_, [&](const Choice& c) { return !options_.plans_groups && !stays_out(c); });
  if (!options_.plans_groups && !choices_.empty()) {
    const Choice& wish = choices_.front();
    asking_ = session_.car(session_.robot_of_goal(wish.goal), wish.alone);
  } else {
    asking_.emplace();
    asking_->key = request_->key;
    asking_->body = request_->body;
    asking_->path = ArcPath(request_->pose);
  }
  asking_->planned = false;
  asking_->since = planner_.decisions_;
  asking_->granted = 0.0;
  const double gap = options_.plans_groups ? 0.0 : options_.gap;  // plans keep off who stands
  asking_->cells = PathCells(asking_->path, asking_->body, gap);
  asking_->cells.keep_clear(planner_.footpaths_);
}

const LotCar& LotPlanner::World::car(int i) const {
  if (asks(i) && !best_) return *asking_;
  const std::int64_t key = asks(i) ? request_->key : motion_.cars()[std::size_t(i)].key;
  const LotMotion& now = best_ ? best_->motion : motion_;
  return now.cars()[std::size_t(now.find(key))];
}

std::vector<LotPlanner::World::State> LotPlanner::World::states() const {
  std::vector<State> states;
  for (const LotCar& car : motion_.cars()) states.push_back({car.s, car.v});
  if (asking_) states.push_back({asking_->s, asking_->v});
  return states;
}

// ---- PBCR: those without a complete plan, along their paths

/// Where a car that would stand on a footpath at `stop` is behind it [m]; else `stop`.
double LotPlanner::World::beyond_footpath(const LotCar& car, double stop) const {
  const int cell = car.cells.cell_at(stop);
  for (const PathCells::Range& stretch : car.cells.kept_clear()) {
    if (stretch.first <= cell && cell <= stretch.last) {
      return std::min((stretch.last + 1) * PathCells::kLength, car.path.stop_after(stop));
    }
  }
  return stop;
}

/// Does a car that drives on to `stop` come onto a footpath, or is it on one?
bool LotPlanner::World::reaches_footpath(const LotCar& car, double stop) {
  const auto [here, there] = car.cells.between(car.s, stop);
  return std::ranges::any_of(car.cells.kept_clear(), [&](const PathCells::Range& stretch) {
    return stretch.first <= there && here <= stretch.last;
  });
}

/// Looked at closely: paths keep off those who stand by less than the width that cells have to
/// spare in bends.
bool LotPlanner::World::is_free(const LotCar& car, const Motion& motion) const {
  constexpr double kStep = 0.1;  // [m]; in between no point comes closer by more than 2 mm
  const BoxShape body{float(car.body.length() / 2), float(car.body.width / 2)};
  const int steps = int(std::ceil((motion.stop - motion.from) / kStep));
  for (int k = 0; k <= steps; ++k) {
    const BoxPose here =
        box_pose(car.body, car.path.at(std::min(motion.stop, motion.from + k * kStep)));
    const auto meets = [&](const StandingBox& other) {
      return gap(here, body, other.pose, other.shape) < 0.0F;
    };
    if (std::ranges::any_of(waiting_, meets)) return false;
  }
  return true;
}

std::vector<LotPlanner::World::Motion> LotPlanner::World::candidates(int i,
                                                                     const State& state) const {
  const LotCar& car = this->car(i);
  if (car.planned) return {Motion{state.s, car.path.length(), true}};
  const double least = safe_stop(i, state).stop;
  std::vector<Motion> motions;
  if (asks(i) && reaches_footpath(car, least)) return motions;
  for (const double part : {1.0, 0.5}) {
    const double most = motion_.rest_after(car, options_.decision);
    const Motion motion{state.s, beyond_footpath(car, std::lerp(least, most, part)), false};
    if (motion.stop > least && is_free(car, motion)) motions.push_back(motion);
  }
  if (asks(i) || keeps_clear(i, least)) {
    std::erase_if(motions, [&](const Motion& motion) { return !keeps_clear(i, motion.stop); });
  }
  return motions;
}

/// Does it rest off all that those who got under way earlier have still before them? So the first
/// can always go on, and after it the next.
bool LotPlanner::World::keeps_clear(int i, double stop) const {
  const PathCells& own = car(i).cells;
  for (int j = 0; j < session_.cars(); ++j) {
    const LotCar& earlier = car(j);
    if (earlier.since >= car(i).since) continue;
    const PathCells::Range ahead = earlier.cells.from(earlier.cells.cell_at(earlier.s));
    if (own.touch(own.between(stop, stop), earlier.cells, ahead)) return false;
  }
  return true;
}

LotPlanner::World::Motion LotPlanner::World::safe_stop(int i, const State& state) const {
  const LotCar& car = this->car(i);
  const double rest =
      std::min(state.s + stopping_distance(state.v, options_.limits.braking), car.path.length());
  const double beyond = beyond_footpath(car, rest);
  // Once it has been let onto a footpath it drives on to behind it.
  return {state.s, car.granted >= beyond ? beyond : rest, false};
}

bool LotPlanner::World::conflict(int i, const Motion& a, int j, const Motion& b) const {
  if (i == j || (a.planned && b.planned)) return false;
  const PathCells& own = car(i).cells;
  const PathCells& theirs = car(j).cells;
  return own.touch(own.between(a.from, a.stop), theirs, theirs.between(b.from, b.stop));
}

// ---- Groups

std::vector<Group> LotPlanner::World::group_robots(const std::vector<State>& q) {
  std::vector<Group> groups;
  if (!options_.plans_groups) return groups;
  Group first = request_ != nullptr ? group_of_asking() : group_of_loser();
  if (!first.empty()) groups.push_back(std::move(first));
  for (int i = 0; i < int(q.size()); ++i) {
    const bool is_in = !groups.empty() && std::ranges::count(groups.front(), i) > 0;
    if (!is_in) groups.push_back({i});
  }
  return groups;
}

/// It alone, if those on its path cannot be planned anew.
Group LotPlanner::World::group_of_asking() {
  Group group = {session_.cars()};
  if (!options_.regroup || choices_.empty()) return group;
  const Choice& wish = choices_.front();
  const std::vector<int> blockers =
      session_.blockers_of(session_.robot_of_goal(wish.goal), wish.alone);
  if (session_.may_replan(blockers)) group.insert(group.begin(), blockers.begin(), blockers.end());
  return group;
}

int LotPlanner::World::who_loses_most() const {
  int loser = -1;
  double most = options_.worth;
  for (int i = 0; i < session_.cars(); ++i) {
    const LotCar& car = motion_.cars()[std::size_t(i)];
    if (session_.is_fixed(i) || planner_.failed_.contains(car.key)) continue;
    LotMotion alone(options_.limits);
    alone.put(car);
    const double lost = session_.forecast().arrival(std::size_t(i)) - alone.forecast().arrival(0);
    if (lost <= most) continue;
    most = lost;
    loser = i;
  }
  return loser;
}

/// None if no car loses much, or those on its path cannot be planned anew.
Group LotPlanner::World::group_of_loser() {
  ++planner_.improvements_;
  const int loser = who_loses_most();
  if (loser < 0) return {};
  const std::int64_t key = motion_.cars()[std::size_t(loser)].key;
  planner_.failed_[key] = planner_.improvements_ + kAttemptsAfterFailure;
  (void)session_.take(loser);
  wish_ = session_.alone(loser);
  if (!wish_) return {};
  const std::vector<int> blockers = session_.blockers_of(loser, *wish_);
  if (!session_.may_replan(blockers)) return {};
  focus_ = loser;
  Group group = blockers;
  group.push_back(loser);
  std::ranges::sort(group);
  return group;
}

/// A group of more than one has been found fit to be planned anew.
bool LotPlanner::World::pre_check(const Group& group) const {
  return !asks(group.back()) || !choices_.empty();
}

std::vector<std::optional<LotPlanner::World::Motion>> LotPlanner::World::get_opt_traj(
    const std::vector<State>& q, const Group& group) {
  const int first = asks(group.back()) ? group.back() : focus_;
  std::vector<int> others = group;
  std::erase(others, first);
  const bool is_new = others.size() < group.size() && !best_;
  if (is_new && asks(first)) plan_asking(others);
  if (is_new && !asks(first)) plan_loser(others);
  std::vector<std::optional<Motion>> motions;
  for (const int i : group) {
    const bool has_plan = car(i).planned;
    const Motion rest{q[std::size_t(i)].s, car(i).path.length(), true};
    motions.push_back(has_plan ? std::optional(rest) : std::nullopt);
  }
  return motions;
}

/// As things are: the quickest place first, and that one again with more effort if none will do.
/// If it would have to wait for the quickest place: before those who are on its path there.
void LotPlanner::World::plan_asking(std::span<const int> blockers) {
  for (const Choice& choice : choices_) try_place(choice, Effort::kQuick);
  const Choice& wish = choices_.front();
  if (!best_) try_place(wish, Effort::kThorough);
  const double before = session_.forecast().cost();
  if (best_ && best_->cost - before <= wish.duration + options_.worth) return;
  if (blockers.empty()) return;
  const int robot = session_.robot_of_goal(wish.goal);
  const std::vector<int> group = session_.plan_before(robot, wish.alone, blockers);
  if (!group.empty()) consider(wish, group);
}

void LotPlanner::World::try_place(const Choice& choice, Effort effort) {
  const double before = session_.forecast().cost();
  if (best_ && best_->cost - before <= choice.duration) return;  // it cannot get better
  const int robot = session_.robot_of_goal(choice.goal);
  if (!session_.plan(robot, choice.alone, effort)) return;
  consider(choice, std::array{robot});
  (void)session_.take(robot);
}

void LotPlanner::World::consider(const Choice& choice, std::span<const int> changed) {
  LotMotion result = session_.result(changed);
  const LotForecast forecast = result.forecast();
  if (!forecast.complete || !forecast.gentle) return;
  const double cost = forecast.cost();
  if (best_ && cost >= best_->cost) return;
  best_ = Candidate{std::move(result), cost, choice.goal, choice.duration, int(changed.size()) - 1};
}

void LotPlanner::World::plan_loser(std::span<const int> blockers) {
  const std::vector<int> group = session_.plan_before(focus_, *wish_, blockers);
  if (group.empty()) return;
  LotMotion result = session_.result(group);
  const LotForecast forecast = result.forecast();
  if (!forecast.complete || !forecast.gentle) return;
  if (forecast.cost() > session_.forecast().cost() - kGain) return;
  best_ = Candidate{std::move(result), forecast.cost(), 0, 0.0, int(group.size())};
}

std::vector<int> LotPlanner::World::order(const std::vector<State>& q) const {
  std::vector<int> order(q.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [this](int i) { return car(i).since; });
  return order;
}

// ---- The result

std::optional<LotAdmission> LotPlanner::World::carry_out(const std::vector<Motion>& motions,
                                                         LotMotion& motion) {
  std::optional<LotAdmission> admission;
  if (best_) {
    admission = LotAdmission{best_->goal, best_->alone, best_->replanned};
  } else if (request_ != nullptr) {
    const State now{asking_->s, asking_->v};
    if (motions.back().stop <= safe_stop(session_.cars(), now).stop) return std::nullopt;
    const Choice& wish = choices_.front();
    admission = LotAdmission{wish.goal, wish.duration, 0};
  }
  std::vector<std::int64_t> keys;
  for (const LotCar& car : motion_.cars()) keys.push_back(car.key);
  if (request_ != nullptr) keys.push_back(request_->key);
  if (best_) {
    motion = std::move(best_->motion);
  } else if (request_ != nullptr) {
    motion.put(*asking_);
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    motion.grant(keys[i], motions[i].planned ? kInfinity : motions[i].stop);
  }
  return request_ != nullptr ? admission : std::nullopt;
}

int LotPlanner::World::replanned() const { return best_ ? best_->replanned : 0; }

}  // namespace mvtp
