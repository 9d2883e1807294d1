#include "planner/algorithms/lot_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "planner/motion/inertial_car.hpp"

namespace mvtp {
namespace {

constexpr double kHardPrice = 1e4;      ///< [s] per bucket: overlaps are no way
constexpr double kInstant = 0.05;       ///< [s]
constexpr double kAction = 1.0;         ///< [m] driven in one bucket
constexpr double kWallThickness = 0.2;  ///< [m], outside the ground
constexpr double kReach = 5.0;          ///< [m] of sweeps that are looked up quickly
constexpr double kRoom = 2.0;           ///< [m] around the ground
constexpr double kSpareRadius = 1.02;   ///< times the turning radius: no bend is the tightest
constexpr double kInflation = 0.8;      ///< of half the width, on the grid of the cost-to-go
constexpr double kNever = 1e9;
constexpr double kMouth = 0.5;         ///< [m] of an exit lane's begin that all may use
constexpr double kBeforeGoal = 0.4;    ///< [m] of it ahead of those who are at their goal there
constexpr float kNow = -1.0F;          ///< when a car is where it is: before all that is planned
constexpr int kEffortAmongOthers = 4;  ///< the same among others
constexpr int kMoreEffort = 8;         ///< times the expansions, where a way alone is not found
constexpr double kTail = 12.0;         ///< [m] before a slot that are driven as if alone
constexpr int kAttemptsAfterFailure = 10;
constexpr double kGain = 0.5;  ///< [s] that a new order must save at least

Polygon quad(const Point& a, const Point& b, double left, double right) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  const Point n{-(b.y - a.y) / length, (b.x - a.x) / length};
  return {{a.x - right * n.x, a.y - right * n.y},
          {b.x - right * n.x, b.y - right * n.y},
          {b.x + left * n.x, b.y + left * n.y},
          {a.x + left * n.x, a.y + left * n.y}};
}

double area(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& p = polygon[i];
    const Point& q = polygon[(i + 1) % polygon.size()];
    sum += p.x * q.y - q.x * p.y;
  }
  return sum / 2;
}

Polygon outline(const StandingCar& car) {
  Polygon result;
  const double half = car.body.width / 2;
  for (const Point& p : {Point{car.body.front, half}, Point{-car.body.rear, half},
                         Point{-car.body.rear, -half}, Point{car.body.front, -half}}) {
    const Pose corner = compose(car.pose, {p.x, p.y, 0.0});
    result.push_back({corner.x, corner.y});
  }
  return result;
}

Vehicle grown(Vehicle body, const LotPlannerOptions& options) {
  body.front += options.margin;
  body.rear += options.margin;
  body.width += 2 * options.margin;
  body.min_turning_radius *= kSpareRadius;
  body.max_speed = options.limits.speed;
  return body;
}

/// The strip of a lane on the ground between two places on it [m].
Polygon strip(const LotLane& lane, double from, double to) {
  constexpr double kHalfWidth = 1.2;  // [m]
  const Pose begin = drive(lane.begin, Arc{from, 0.0});
  const Pose end = drive(lane.begin, Arc{to, 0.0});
  return quad({begin.x, begin.y}, {end.x, end.y}, kHalfWidth, kHalfWidth);
}

Polygon entry_strip(const LotLane& lane) {
  constexpr double kBeyond = 0.5;  // [m]
  return strip(lane, 0.0, lane.length + kBeyond);
}

bool in_a_slot(const ParkingLot& lot, const Point& p) {
  constexpr double kAround = 0.3;  // [m]
  return std::ranges::any_of(lot.slots, [&](const ParkingSlot& slot) {
    const Pose local = relative(slot.middle, {p.x, p.y, 0.0});
    return std::abs(local.x) < slot.length / 2 + kAround &&
           std::abs(local.y) < slot.width / 2 + kAround;
  });
}

/// Where a footpath leads between two rows of slots no car drives: bars along its middle.
std::vector<Polygon> bars_between_slots(const ParkingLot& lot, const Footpath& path) {
  constexpr double kPiece = 0.5;    // [m]
  constexpr double kBeside = 0.5;   // [m]
  constexpr double kHalfBar = 0.1;  // [m]
  std::vector<Polygon> bars;
  for (std::size_t k = 1; k < path.line.size(); ++k) {
    const Point& a = path.line[k - 1];
    const Point& b = path.line[k];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const Pose begin{a.x, a.y, std::atan2(b.y - a.y, b.x - a.x)};
    for (double s = 0.0; s + kPiece <= length; s += kPiece) {
      const auto beside = [&](double side) {
        const double away = side * (path.width / 2 + kBeside);
        const Pose p = compose(begin, {s + kPiece / 2, away, 0.0});
        return in_a_slot(lot, {p.x, p.y});
      };
      if (!beside(1.0) || !beside(-1.0)) continue;
      const Pose from = compose(begin, {s, 0.0, 0.0});
      const Pose to = compose(begin, {s + kPiece, 0.0, 0.0});
      bars.push_back(quad({from.x, from.y}, {to.x, to.y}, kHalfBar, kHalfBar));
    }
  }
  return bars;
}

Map walls_of(const ParkingLot& lot) {
  Map map;
  const bool turns_left = area(lot.ground) > 0.0;
  for (std::size_t i = 0; i < lot.ground.size(); ++i) {
    const Point& a = lot.ground[i];
    const Point& b = lot.ground[(i + 1) % lot.ground.size()];
    map.width = std::max(map.width, a.x + kRoom);
    map.height = std::max(map.height, a.y + kRoom);
    map.polygons.push_back(
        quad(a, b, turns_left ? 0.0 : kWallThickness, turns_left ? kWallThickness : 0.0));
  }
  map.polygons.insert(map.polygons.end(), lot.obstacles.begin(), lot.obstacles.end());
  for (const Footpath& path : lot.footpaths) {
    const std::vector<Polygon> bars = bars_between_slots(lot, path);
    map.polygons.insert(map.polygons.end(), bars.begin(), bars.end());
  }
  return map;
}

Map entry_strips(const ParkingLot& lot, const Map& walls) {
  Map map{.width = walls.width, .height = walls.height};
  for (const LotLane& lane : lot.entries) map.polygons.push_back(entry_strip(lane));
  return map;
}

}  // namespace

/// One decision under way: everyone's motion from `ahead` seconds from now on.
///
/// Robots: the cars under way, the request once per goal, those who wait, the queue behind the
/// request in its entry lane.
class LotPlanner::Draft {
 public:
  Draft(LotPlanner& planner, const LotMotion& motion, const LotRequest* request,
        std::span<const StandingCar> waiting);

  [[nodiscard]] const LotForecast& forecast() const { return forecast_; }
  [[nodiscard]] int cars() const { return int(motion_.cars().size()); }
  [[nodiscard]] int robot_of_goal(std::size_t g) const { return cars() + int(g); }

  /// The robot's way as if nobody else moved.
  [[nodiscard]] std::optional<TimedTrack> alone(int robot);
  /// The robot, absent so far, gets a way that touches nobody present.
  /// @param alone  its way as if nobody else moved
  [[nodiscard]] bool plan(int robot, const TimedTrack& alone);
  [[nodiscard]] TimedTrack take(int robot) { return joint_->remove(robot); }
  [[nodiscard]] const TimedTrack& track(int robot) const { return joint_->track(robot); }
  /// The cars under way that stand in the way of a robot that moves like this.
  [[nodiscard]] std::vector<int> in_the_way(int robot, const TimedTrack& track);

  /// Must the car's way stay as it is? In an entry lane somebody follows; shortly before the end
  /// nothing is to be gained.
  [[nodiscard]] bool is_fixed(int i) const {
    const LotCar& car = motion_.cars()[std::size_t(i)];
    const double end = car.path.length() - (car.leaves ? kRunOut : 0.0);
    const Robot& robot = robots_[std::size_t(i)];
    return car.stranded || robot.prefix.length() >= end - kAction ||
           planner_.in_entry(car.body, macro_robots_[std::size_t(i)].start);
  }
  /// PreCheck: can these be planned anew together with one more?
  [[nodiscard]] bool may_replan(std::span<const int> robots) const {
    const auto under_way = [&](int i) { return i < cars() && !is_fixed(i); };
    return int(robots.size()) < planner_.options_.max_group &&
           std::ranges::all_of(robots, under_way);
  }

  /// Plans a robot, absent so far, and then the others anew.
  /// @return all of them; empty if one of them has no way
  [[nodiscard]] std::vector<int> plan_before(int robot, const TimedTrack& alone,
                                             std::span<const int> others);

  /// The motion in which the given robots drive as placed here, the others as before.
  [[nodiscard]] LotMotion result(std::span<const int> changed) const;
  /// Arrival of a robot that drives `track` with nobody else there [s from now].
  [[nodiscard]] double duration_alone(int robot, const TimedTrack& track) const;

 private:
  struct Robot {
    Vehicle body;    ///< true size
    ArcPath prefix;  ///< what it drives until the draft begins
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
  [[nodiscard]] TimedTrack forecast_track(int car) const;
  [[nodiscard]] bool comes_back_into_entry(int robot, const std::vector<Arc>& steps) const;
  [[nodiscard]] SoftProblem problem(int robot) const;
  [[nodiscard]] std::optional<SoftPath> search_alone(SoftProblem problem, int effort);
  [[nodiscard]] std::optional<SoftPath> search_alone_backwards(int robot, int effort);
  [[nodiscard]] std::vector<Arc> tail(const TimedTrack& alone) const;
  [[nodiscard]] ArcPath way(int robot, const TimedTrack& track) const;
  [[nodiscard]] LotCar car(int robot, const TimedTrack& track) const;
  [[nodiscard]] std::vector<float> times_of_kept(int car) const;
  [[nodiscard]] std::vector<float> times_of_planned(const LotCar& car, int robot) const;
  [[nodiscard]] double ahead() const { return planner_.options_.ahead; }

  LotPlanner& planner_;
  const LotMotion& motion_;
  LotForecast forecast_;
  std::vector<Robot> robots_;
  std::vector<std::unique_ptr<MacroCar>> macro_cars_;
  std::vector<MacroRobot> macro_robots_;
  std::optional<JointMotion> joint_;
};

LotPlanner::Draft::Draft(LotPlanner& planner, const LotMotion& motion, const LotRequest* request,
                         std::span<const StandingCar> waiting)
    : planner_(planner), motion_(motion), forecast_(motion.forecast()) {
  add_cars();
  if (request != nullptr) add_request(*request);
  const std::size_t first_standing = robots_.size();
  for (const StandingCar& car : waiting) add_standing(car);
  if (request != nullptr && request->entry >= 0) {
    add_queue(*request, macro_robots_[std::size_t(robot_of_goal(0))].start);
  }
  joint_.emplace(macro_robots_, planner_.time_);
  for (int i = 0; i < cars(); ++i) joint_->place(i, forecast_track(i));
  for (std::size_t i = first_standing; i < robots_.size(); ++i) {
    const MacroRobot& robot = macro_robots_[i];
    joint_->place(int(i), TimedTrack(robot.car->vehicle(), robot.start, {}, planner_.time_.bucket));
  }
}

void LotPlanner::Draft::add(Robot robot, const Pose& start, bool in_entry) {
  const Ground& ground = in_entry       ? planner_.open_
                         : robot.leaves ? planner_.ground_of_leaving(robot.body, robot.goal)
                                        : planner_.closed_;
  // Who stands needs no margin of its own, no more than those that are solid.
  const Vehicle body = robot.stands ? robot.body : grown(robot.body, planner_.options_);
  macro_cars_.push_back(std::make_unique<MacroCar>(body, planner_.time_, ground.map,
                                                   *ground.obstacles, planner_.clearance_));
  macro_robots_.push_back(
      {macro_cars_.back().get(), &planner_.cost_to_go(robot.body, robot.goal), start});
  robots_.push_back(std::move(robot));
}

void LotPlanner::Draft::add_cars() {
  for (std::size_t i = 0; i < motion_.cars().size(); ++i) {
    const LotCar& car = motion_.cars()[i];
    const double braking = car.v * car.v / (2 * motion_.limits().braking);
    const double end = std::clamp(std::max(forecast_.driven_at(i, ahead()), car.s + braking), car.s,
                                  std::max(car.s, car.path.length()));
    Robot robot{car.body, car.path, car.s, car.v, 0, car.key, car.goal, car.leaves};
    robot.prefix.truncate(end);
    const bool moves = forecast_.driven_at(i, ahead() + kInstant) > end + 1e-3;
    if (moves || car.v > 0.0) robot.direction = car.path.direction_from(std::max(0.0, end - 1e-3));
    const Pose start = car.path.at(end);
    add(std::move(robot), start, planner_.in_entry(car.body, start));
  }
}

void LotPlanner::Draft::add_request(const LotRequest& request) {
  ArcPath prefix(request.pose);
  prefix.append({Arc{planner_.prefix_length(request.speed), 0.0}});
  for (const Pose& goal : request.goals) {
    Robot robot{request.body, prefix, 0.0, request.speed, 0, request.key, goal, request.leaves};
    robot.direction = prefix.direction_from(0.0);
    add(std::move(robot), prefix.at(prefix.length()), request.entry >= 0);
  }
}

void LotPlanner::Draft::add_standing(const StandingCar& car) {
  add({.body = car.body, .prefix = ArcPath(car.pose), .goal = car.pose, .stands = true}, car.pose,
      false);
}

/// The lane behind a car that comes in: the next ones follow it there.
void LotPlanner::Draft::add_queue(const LotRequest& request, const Pose& start) {
  constexpr double kBehind = 0.4;  // [m]
  const LotLane& lane = planner_.lot_.entries[std::size_t(request.entry)];
  const double along = relative(lane.begin, start).x;
  const double length = along - request.body.rear - planner_.options_.margin - kBehind;
  if (length < 0.5) return;
  Vehicle body = request.body;
  body.rear = 0.0;
  body.front = length;
  add({.body = body, .prefix = ArcPath(lane.begin), .goal = lane.begin}, lane.begin, true);
}

TimedTrack LotPlanner::Draft::forecast_track(int i) const {
  const auto k = std::size_t(i);
  const LotCar& car = motion_.cars()[k];
  std::vector<Arc> steps;
  double s = robots_[k].prefix.length();
  Pose from = car.path.at(s);
  for (double t = ahead() + kInstant; t < forecast_.arrival(k) + kInstant; t += kInstant) {
    const double next = std::max(s, forecast_.driven_at(k, t));
    if (next - s < 1e-6) {
      steps.push_back({});
      continue;
    }
    const Pose to = car.path.at(next);
    const double length = car.path.direction_from((s + next) / 2) * (next - s);
    steps.push_back({length, wrap_to_pi(to.theta - from.theta) / length});
    from = to;
    s = next;
  }
  return {macro_robots_[k].car->vehicle(), macro_robots_[k].start, std::move(steps),
          planner_.time_.bucket, car.leaves};
}

SoftProblem LotPlanner::Draft::problem(int robot) const {
  const MacroRobot& macro = macro_robots_[std::size_t(robot)];
  SoftProblem problem;
  problem.car = macro.car;
  problem.cost_to_go = macro.cost_to_go;
  problem.start = macro.start;
  problem.direction = robots_[std::size_t(robot)].direction;
  problem.leaves = robots_[std::size_t(robot)].leaves;
  return problem;
}

namespace {

SoftOptions soft_options(const LotPlannerOptions& options) {
  SoftOptions soft;
  soft.weight = options.weight;
  soft.max_expansions = options.expansions;
  soft.cell = 0.8;
  soft.cell_heading = 0.25;
  soft.reversal = options.limits.speed / options.limits.braking;
  return soft;
}

}  // namespace

/// From both ends where it parks: one search may be lost where the other finds a way at once. A
/// tight place gets a longer search.
std::optional<TimedTrack> LotPlanner::Draft::alone(int robot) {
  std::optional<SoftPath> path;
  for (const int effort : {1, kMoreEffort}) {
    path = search_alone(problem(robot), effort);
    if (!robots_[std::size_t(robot)].leaves) {
      std::optional<SoftPath> other = search_alone_backwards(robot, effort);
      if (other && (!path || other->cost < path->cost)) path = std::move(other);
    }
    if (path) break;
  }
  if (!path) return std::nullopt;
  const MacroRobot& macro = macro_robots_[std::size_t(robot)];
  return TimedTrack(macro.car->vehicle(), macro.start, std::move(path->steps),
                    planner_.time_.bucket, robots_[std::size_t(robot)].leaves);
}

std::optional<SoftPath> LotPlanner::Draft::search_alone(SoftProblem problem, int effort) {
  const Occupancy nobody(1, planner_.time_);
  problem.others = {.occupancy = &nobody};
  SoftOptions options = soft_options(planner_.options_);
  options.max_expansions *= effort;
  return planner_.search_.search(problem, options, Deadline::never());
}

/// From the goal to the start, driven the other way round.
std::optional<SoftPath> LotPlanner::Draft::search_alone_backwards(int robot, int effort) {
  const Robot& r = robots_[std::size_t(robot)];
  SoftProblem reversed = problem(robot);
  const CostToGo to_start = planner_.make_cost_to_go(r.body, reversed.start);
  reversed.start = r.goal;
  reversed.cost_to_go = &to_start;
  reversed.direction = 0;
  std::optional<SoftPath> path = search_alone(reversed, effort);
  if (!path) return path;
  std::ranges::reverse(path->steps);
  for (Arc& arc : path->steps) arc.length = -arc.length;
  return path;
}

/// The last metres of a way: a search among others need only find the rest.
std::vector<Arc> LotPlanner::Draft::tail(const TimedTrack& alone) const {
  ArcPath way(alone.start());
  way.append(alone.steps());
  std::vector<Arc> result;
  double left = kTail;
  for (auto piece = way.pieces().rbegin(); piece != way.pieces().rend() && left > 0.0; ++piece) {
    const double length = std::min(left, std::abs(piece->arc.length));
    result.push_back({piece->direction() * length, piece->arc.curvature});
    left -= length;
  }
  std::ranges::reverse(result);
  return result;
}

bool LotPlanner::Draft::plan(int robot, const TimedTrack& alone) {
  SoftProblem soft = problem(robot);
  soft.others = joint_->others(robot, kHardPrice);
  const std::vector<Arc> tail = soft.leaves ? std::vector<Arc>{} : this->tail(alone);
  std::optional<CostToGo> to_tail;
  if (!tail.empty()) {
    Pose begin = robots_[std::size_t(robot)].goal;
    for (auto arc = tail.rbegin(); arc != tail.rend(); ++arc) {
      begin = drive(begin, Arc{-arc->length, arc->curvature});
    }
    to_tail.emplace(planner_.make_cost_to_go(robots_[std::size_t(robot)].body, begin));
    soft.cost_to_go = &*to_tail;
    soft.tail = tail;
  }
  std::optional<SoftPath> path;
  for (const int effort : {1, kEffortAmongOthers}) {
    SoftOptions options = soft_options(planner_.options_);
    options.max_expansions *= effort;
    path = planner_.search_.search(soft, options, Deadline::never());
    if (path && path->price == 0.0) break;
  }
  if (!path || path->price > 0.0 || comes_back_into_entry(robot, path->steps)) return false;
  joint_->place(robot, TimedTrack(soft.car->vehicle(), soft.start, std::move(path->steps),
                                  planner_.time_.bucket, soft.leaves));
  return true;
}

/// The next one follows in the lane: a car may leave it only forwards, and for good.
bool LotPlanner::Draft::comes_back_into_entry(int robot, const std::vector<Arc>& steps) const {
  const MacroRobot& macro = macro_robots_[std::size_t(robot)];
  const Vehicle& body = robots_[std::size_t(robot)].body;
  if (!planner_.in_entry(body, macro.start)) return false;
  constexpr std::size_t kEvery = 10;  // steps between two looks
  Pose pose = macro.start;
  bool out = false;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    pose = drive(pose, steps[k]);
    const bool reverses = steps[k].length < 0.0 && (k == 0 || steps[k - 1].length >= 0.0);
    if (k % kEvery != 0 && !reverses) continue;
    const bool in = planner_.in_entry(body, pose);
    if (in && (out || reverses)) return true;
    out = out || !in;
  }
  return false;
}

std::vector<int> LotPlanner::Draft::in_the_way(int robot, const TimedTrack& track) {
  joint_->place(robot, track);
  std::vector<int> result = joint_->conflicts_of(robot);
  (void)joint_->remove(robot);
  return result;
}

std::vector<int> LotPlanner::Draft::plan_before(int robot, const TimedTrack& alone,
                                                std::span<const int> others) {
  for (const int i : others) (void)take(i);
  if (!plan(robot, alone)) return {};
  std::vector<int> group = {robot};
  for (const int i : others) {
    const std::optional<TimedTrack> way = this->alone(i);
    if (!way || !plan(i, *way)) return {};
    group.push_back(i);
  }
  return group;
}

ArcPath LotPlanner::Draft::way(int robot, const TimedTrack& track) const {
  const Robot& r = robots_[std::size_t(robot)];
  ArcPath path = r.prefix;
  path.append(track.steps());
  if (r.leaves) path.append({Arc{kRunOut, 0.0}});
  return path;
}

LotCar LotPlanner::Draft::car(int robot, const TimedTrack& track) const {
  const Robot& r = robots_[std::size_t(robot)];
  LotCar car;
  car.key = r.key;
  car.body = r.body;
  car.path = way(robot, track);
  car.goal = r.goal;
  car.leaves = r.leaves;
  car.s = r.s;
  car.v = r.v;
  return car;
}

double LotPlanner::Draft::duration_alone(int robot, const TimedTrack& track) const {
  LotMotion motion(planner_.options_.limits);
  motion.put(car(robot, track));
  return motion.forecast().arrival(0);
}

std::vector<float> LotPlanner::Draft::times_of_kept(int i) const {
  const auto k = std::size_t(i);
  const LotCar& car = motion_.cars()[k];
  const std::vector<float>& driven = forecast_.driven[k];
  std::vector<float> times(std::size_t(car.cells.size()), float(kNever));
  std::size_t step = 0;
  for (std::size_t c = 0; c < times.size(); ++c) {
    const double middle = std::min((double(c) + 0.5) * PathCells::kLength, car.path.length());
    while (step < driven.size() && double(driven[step]) < middle - 1e-4) ++step;
    if (step == driven.size()) break;
    times[c] = float(double(step) * forecast_.dt);
  }
  times[std::size_t(car.cells.cell_at(car.s))] = kNow;
  return times;
}

std::vector<float> LotPlanner::Draft::times_of_planned(const LotCar& car, int robot) const {
  const Robot& r = robots_[std::size_t(robot)];
  const double prefix = r.prefix.length();
  std::vector<float> times(std::size_t(car.cells.size()), float(kNever));
  const std::vector<Arc>& steps = track(robot).steps();
  std::size_t step = 0;
  double s = prefix;
  for (std::size_t c = 0; c < times.size(); ++c) {
    const double middle = std::min((double(c) + 0.5) * PathCells::kLength, car.path.length());
    if (middle < prefix) {
      // Evenly over the time until the draft begins; the forecast knows better for cars under way.
      const double part = (middle - r.s) / std::max(prefix - r.s, 1e-6);
      times[c] = float(ahead() * std::max(0.0, part));
      if (robot < cars()) {
        const std::vector<float>& driven = forecast_.driven[std::size_t(robot)];
        const auto at = std::ranges::lower_bound(driven, float(middle));
        times[c] = float(double(at - driven.begin()) * forecast_.dt);
      }
      continue;
    }
    while (step < steps.size() && s < middle - 1e-4) s += std::abs(steps[step++].length);
    times[c] = float(ahead() + double(step) * planner_.time_.dt);
    if (s < middle - 1e-4) times[c] += float((middle - s) / planner_.options_.limits.speed);
  }
  times[std::size_t(car.cells.cell_at(car.s))] = kNow;
  return times;
}

LotMotion LotPlanner::Draft::result(std::span<const int> changed) const {
  LotMotion result = motion_;
  struct Way {
    std::int64_t key;
    std::vector<float> times;
    bool changed;
  };
  std::vector<Way> ways;
  for (int i = 0; i < cars(); ++i) {
    if (std::ranges::find(changed, i) != changed.end()) continue;
    ways.push_back({robots_[std::size_t(i)].key, times_of_kept(i), false});
  }
  for (const int i : changed) {
    LotCar now = car(i, track(i));
    now.cells = PathCells(now.path, now.body, planner_.options_.gap);
    now.cells.keep_clear(planner_.footpaths_);
    ways.push_back({now.key, times_of_planned(now, i), true});
    result.put(std::move(now));
  }
  const auto planned = [&](const Way& way) {
    const LotCar& car = result.cars()[std::size_t(result.find(way.key))];
    return PlannedWay{&car.cells, car.cells.cell_at(car.s), way.times};
  };
  for (std::size_t i = 0; i < ways.size(); ++i) {
    for (std::size_t j = i + 1; j < ways.size(); ++j) {
      if (!ways[i].changed && !ways[j].changed) continue;
      auto [first, second] = precedence(planned(ways[i]), planned(ways[j]));
      result.set_order(ways[i].key, ways[j].key, std::move(first));
      result.set_order(ways[j].key, ways[i].key, std::move(second));
    }
  }
  return result;
}

LotPlanner::LotPlanner(const ParkingLot& lot, const LotPlannerOptions& options)
    : lot_(lot),
      options_(options),
      walls_(walls_of(lot)),
      entries_(entry_strips(lot, walls_), kReach),
      footpaths_(lot.footpaths) {
  time_.dt = kInstant;
  time_.bucket = std::max(2, int(kAction / (options.limits.speed * kInstant)));
  set_standing({});
}

void LotPlanner::Ground::refresh() { obstacles = std::make_unique<Obstacles>(map, kReach); }

void LotPlanner::set_standing(std::vector<StandingCar> standing) {
  open_.map = walls_;
  for (const StandingCar& car : standing) open_.map.polygons.push_back(outline(car));
  exits_open_ = open_.map;
  for (const LotLane& lane : lot_.entries) exits_open_.polygons.push_back(entry_strip(lane));
  for (const LotLane& lane : lot_.exits) {
    open_.map.polygons.push_back(strip(lane, kMouth, lane.length));
  }
  closed_.map = open_.map;
  for (const LotLane& lane : lot_.entries) closed_.map.polygons.push_back(entry_strip(lane));
  open_.refresh();
  closed_.refresh();
  leaving_.clear();
}

/// Nobody drives past its goal in an exit lane and comes back: others have left there already, and
/// have their own drivers.
const LotPlanner::Ground& LotPlanner::ground_of_leaving(const Vehicle& body, const Pose& goal) {
  const auto [place, is_new] = leaving_.try_emplace({body.front, goal.x, goal.y});
  Ground& ground = place->second;
  if (!is_new) return ground;
  ground.map = exits_open_;
  for (const LotLane& lane : lot_.exits) {
    const Pose local = relative(lane.begin, goal);
    const bool its_own = std::abs(local.y) < kMouth && local.x > 0.0 && local.x < lane.length;
    const double end = its_own ? local.x + body.front + kBeforeGoal : kMouth;
    if (end < lane.length) ground.map.polygons.push_back(strip(lane, end, lane.length));
  }
  ground.refresh();
  return ground;
}

CostToGo LotPlanner::make_cost_to_go(const Vehicle& body, const Pose& goal) {
  std::shared_ptr<const ObstacleGrid>& grid = grids_[body.width];
  if (!grid) grid = std::make_shared<ObstacleGrid>(walls_, kInflation * body.width / 2);
  return {goal, body.min_turning_radius * kSpareRadius, ReedsSheppTable::shared(), grid};
}

const CostToGo& LotPlanner::cost_to_go(const Vehicle& body, const Pose& goal) {
  const GoalKey key{goal.x, goal.y, goal.theta, body.min_turning_radius, body.width};
  const auto known = costs_to_go_.find(key);
  if (known != costs_to_go_.end()) return known->second;
  return costs_to_go_.emplace(key, make_cost_to_go(body, goal)).first->second;
}

bool LotPlanner::in_entry(const Vehicle& body, const Pose& pose) const {
  return entries_.hit(Sweep(grown(body, options_), pose, {}));
}

double LotPlanner::distance(const Vehicle& body, const Pose& from, const Pose& goal) {
  return cost_to_go(body, goal)(from);
}

double LotPlanner::prefix_length(double speed) const {
  const LotLimits& limits = options_.limits;
  double driven = 0.0;
  double v = speed;
  for (double t = 0.0; t < options_.ahead && speed > 0.0; t += kInstant) {
    const double next = std::max(limits.speed, v - limits.braking * kInstant);
    driven += (v + next) / 2 * kInstant;
    v = next;
  }
  return std::max(driven, stopping_distance(speed, limits.braking));
}

std::optional<LotAdmission> LotPlanner::admit(LotMotion& motion, const LotRequest& request,
                                              std::span<const StandingCar> waiting) {
  Draft draft(*this, motion, &request, waiting);
  struct Choice {
    std::size_t goal = 0;
    TimedTrack alone;
    double duration = std::numeric_limits<double>::infinity();
  };
  std::vector<Choice> choices;
  for (std::size_t g = 0; g < request.goals.size(); ++g) {
    const int robot = draft.robot_of_goal(g);
    std::optional<TimedTrack> alone = draft.alone(robot);
    if (!alone) continue;
    const double duration = draft.duration_alone(robot, *alone);
    choices.push_back({g, *std::move(alone), duration});
  }
  if (choices.empty()) return std::nullopt;
  std::ranges::stable_sort(choices, {}, &Choice::duration);

  struct Candidate {
    LotMotion motion;
    double cost;
    std::size_t goal;
    int replanned;
  };
  std::optional<Candidate> best;
  const auto consider = [&](std::size_t goal, std::span<const int> changed) {
    LotMotion result = draft.result(changed);
    const LotForecast forecast = result.forecast();
    if (!forecast.complete || !forecast.gentle) return;
    const double cost = forecast.cost();
    if (!best || cost < best->cost) {
      best = Candidate{std::move(result), cost, goal, int(changed.size()) - 1};
    }
  };
  const double before = draft.forecast().cost();
  for (const Choice& choice : choices) {
    if (best && best->cost - before <= choice.duration) break;
    const int robot = draft.robot_of_goal(choice.goal);
    if (!draft.plan(robot, choice.alone)) continue;
    consider(choice.goal, std::array{robot});
    (void)draft.take(robot);
  }
  const Choice& wish = choices.front();
  const bool waits = !best || best->cost - before > wish.duration + options_.worth;
  if (options_.regroup && waits) {
    const int robot = draft.robot_of_goal(wish.goal);
    const std::vector<int> blockers = draft.in_the_way(robot, wish.alone);
    if (!blockers.empty() && draft.may_replan(blockers)) {
      const std::vector<int> group = draft.plan_before(robot, wish.alone, blockers);
      if (!group.empty()) consider(wish.goal, group);
    }
  }
  if (!best) return std::nullopt;
  motion = std::move(best->motion);
  failed_.clear();
  double alone = 0.0;
  for (const Choice& choice : choices) alone = choice.goal == best->goal ? choice.duration : alone;
  return LotAdmission{best->goal, alone, best->replanned};
}

int LotPlanner::improve(LotMotion& motion, std::span<const StandingCar> waiting) {
  if (!options_.regroup || motion.cars().size() < 2) return 0;
  ++improvements_;
  Draft draft(*this, motion, nullptr, waiting);
  int focus = -1;
  double most = options_.worth;
  for (int i = 0; i < draft.cars(); ++i) {
    const LotCar& car = motion.cars()[std::size_t(i)];
    const auto failed = failed_.find(car.key);
    const bool just_failed = failed != failed_.end() && improvements_ < failed->second;
    if (draft.is_fixed(i) || just_failed) continue;
    LotMotion alone(options_.limits);
    alone.put(car);
    const double lost = draft.forecast().arrival(std::size_t(i)) - alone.forecast().arrival(0);
    if (lost <= most) continue;
    most = lost;
    focus = i;
  }
  if (focus < 0) return 0;
  const std::int64_t key = motion.cars()[std::size_t(focus)].key;
  failed_[key] = improvements_ + kAttemptsAfterFailure;
  (void)draft.take(focus);
  const std::optional<TimedTrack> alone = draft.alone(focus);
  if (!alone) return 0;
  const std::vector<int> blockers = draft.in_the_way(focus, *alone);
  if (!draft.may_replan(blockers)) return 0;
  const std::vector<int> group = draft.plan_before(focus, *alone, blockers);
  if (group.empty()) return 0;
  LotMotion result = draft.result(group);
  const LotForecast forecast = result.forecast();
  if (!forecast.complete || !forecast.gentle) return 0;
  if (forecast.cost() > draft.forecast().cost() - kGain) return 0;
  motion = std::move(result);
  failed_.clear();
  return int(group.size());
}

}  // namespace mvtp
