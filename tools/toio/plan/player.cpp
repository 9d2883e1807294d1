#include "tools/toio/plan/player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/problem/input_error.hpp"
#include "tools/toio/plan/frames.hpp"
#include "tools/toio/plan/release_graph.hpp"

namespace mvtp {
namespace {

// Of the tracking law: how fast an error along the path dies out [1/s], and over which length one
// beside it and one of the heading do [1/m^2], [1/m].
constexpr double kAlongGain = 2.5;
constexpr double kLateralGain = 2500.0;
constexpr double kHeadingGain = 80.0;

/// A cube at rest is moved only for more than this [m], and then by at least so many units: the
/// command for a small error would be in the wheels' dead zone, and clock and cube would wait for
/// each other for ever.
constexpr double kRest = 0.003;
constexpr int kLeastNudge = 9;

/// The clock is taken back where the cube is further behind than this [m] and so many seconds of
/// its speed.
constexpr double kLate = 0.005;
constexpr double kLateTime = 0.16;

/// A place on the path counts as reached this far before it [m]; more than what the cube leaves
/// when it rests, less than the margin along the path.
constexpr double kReach = 0.0045;
constexpr double kTargetReach = 0.0205;  // a target command promises 15 dots
constexpr double kTargetMargin = 0.0204;
/// And not from so much further beside it [m]: round a tight bend, that would be another place.
constexpr double kBeside = 0.015;

constexpr double kSilence = 0.3;     // without a report [s]
constexpr double kStray = 0.03;      // from the path [m]
constexpr double kGiveUp = 20.0;     // without progress [s]
constexpr double kGiveUpLost = 8.0;  // the same if a link is lost
constexpr double kBumpRest = 1.0;    // of a cube that felt a collision [s]

constexpr double kMarch = 0.01;      // of the search for what was reached [s]
constexpr double kLeastRate = 0.15;  // of a clock that may go on at all

double sign_of(double value) { return value > 0.0 ? 1.0 : (value < 0.0 ? -1.0 : 0.0); }

}  // namespace

void require_mode(const ToioRun& run, DriveMode mode, const std::string& where) {
  if (mode == DriveMode::kList) {
    throw InputError("--mode", "is list, which cannot be stopped half-way; choose track or target");
  }
  const double least = std::min(run.margins.lateral, run.margins.along);
  if (mode == DriveMode::kTrack || least >= kTargetMargin) return;
  throw InputError(where, fmt::format("has margins of {:.1f} mm, but a cube comes to its targets "
                                      "only within 15 dots = 20.4 mm; export with "
                                      "--margin-lateral 20.4 --margin-along 20.4",
                                      least * 1000));
}

const char* to_string(Fault fault) {
  switch (fault) {
    case Fault::kNone:
      return "none";
    case Fault::kSilent:
      return "is silent";
    case Fault::kOffMat:
      return "does not see the mat";
    case Fault::kBumped:
      return "bumped into something";
    case Fault::kOffPath:
      return "is off its path";
    case Fault::kLinkLost:
      return "lost its link";
  }
  return "";
}

Player::Player(const ToioRun& run, const PlayerOptions& options)
    : run_(run),
      options_(options),
      clocks_(run.robots.size(), 0.0),
      reached_(run.robots.size(), 0.0) {
  for (const RunRobot& robot : run.robots) {
    references_.emplace_back(robot, run.desk);
    robots_.push_back({.predictor = Predictor(run.desk.cube, run.desk.facing, options.lag)});
  }
}

void Player::receive(std::size_t i, const CubeEvent& event, double now) {
  Robot& robot = robots_[i];
  if (const auto* position = std::get_if<PositionId>(&event)) {
    const MatPose mat{double(position->x), double(position->y), double(position->degrees)};
    const Pose pose = run_.desk.to_desk(mat);
    robot.seen = pose;
    robot.heard_at = now;
    robot.off_mat = false;
    robot.outcome.last_seen = mat;
    robot.predictor.measured(pose, now);
  } else if (std::holds_alternative<PositionMissed>(event)) {
    robot.off_mat = true;
  } else if (const auto* motion = std::get_if<Motion>(&event)) {
    if (motion->collision) robot.bumped_until = now + kBumpRest;
  } else if (const auto* done = std::get_if<TargetDone>(&event)) {
    const bool last = reached_[i] >= references_[i].end();
    robot.at_target = last && done->result == TargetResult::kReached;
  }
}

void Player::lose(std::size_t i) { robots_[i].lost = true; }

void Player::regain(std::size_t i, double now) {
  robots_[i].lost = false;
  robots_[i].heard_at = now;
}

/// Marches along the path as far as the report shows that the cube has come, but not past its
/// clock.
void Player::note_progress(std::size_t i, double now) {
  const Reference& reference = references_[i];
  Robot& robot = robots_[i];
  if (!robot.seen) return;
  const double reach = options_.mode == DriveMode::kTarget ? kTargetReach : kReach;
  double& reached = reached_[i];
  while (reached < clocks_[i]) {
    // One step at a time, and never past a cusp: paths come back to where they were.
    const double cusp = reference.next_cusp(std::nextafter(reached, reference.end()));
    const double next = std::min({reached + kMarch, clocks_[i], cusp});
    const double direction = sign_of(reference.at((reached + next) / 2).twist.v);
    const Pose seen = relative(reference.at(next).pose, *robot.seen);
    if (direction * seen.x < -reach || std::abs(seen.y) > kBeside + reach) break;
    reached = next;
    last_progress_ = now;
  }
  const double beside = std::abs(relative(reference.at(reached).pose, *robot.seen).y);
  robot.outcome.most_lateral = std::max(robot.outcome.most_lateral, beside);
  // With targets, what is left is up to the cube: the last dots, and the angle.
  const bool there = options_.mode == DriveMode::kTrack || robot.at_target;
  if (!robot.outcome.arrived && there && reached >= reference.end()) {
    robot.outcome.arrived = true;
    robot.outcome.arrival = now;
  }
}

Fault Player::fault_of(std::size_t i, double now) const {
  const Robot& robot = robots_[i];
  if (robot.lost) return Fault::kLinkLost;
  if (robot.off_mat) return Fault::kOffMat;
  if (now < robot.bumped_until) return Fault::kBumped;
  if (now - robot.heard_at > kSilence) return Fault::kSilent;
  if (robot.seen) {
    const Pose& on_path = references_[i].at(reached_[i]).pose;
    if (distance(on_path, *robot.seen) >
        kStray + (options_.mode == DriveMode::kTarget ? kStray : 0)) {
      return Fault::kOffPath;
    }
  }
  return Fault::kNone;
}

/// How far the clock may go: to what is released, and not past a cusp that is not reached.
double Player::limit_of(std::size_t i) const {
  const double end = references_[i].end();
  const double cusp = references_[i].next_cusp(std::nextafter(reached_[i], end));
  if (!options_.gating) return cusp;
  return std::min(cusp, released_until(run_.robots[i].requirements, references_, i, reached_));
}

/// Takes the clock back to where the cube can still follow it. A cube that is blocked, or slower
/// than it should be, thus finds its reference right ahead on the path, not round the next bend.
bool Player::pull_back(std::size_t i, double now) {
  const std::optional<Pose> predicted = robots_[i].predictor.at(now);
  if (!predicted) return true;
  const Reference& reference = references_[i];
  const Reference::State state = reference.at(clocks_[i]);
  const double behind = -sign_of(state.twist.v) * relative(state.pose, *predicted).x;
  robots_[i].outcome.most_along = std::max(robots_[i].outcome.most_along, std::abs(behind));
  const double excess = behind - kLate - kLateTime * std::abs(state.twist.v);
  if (excess <= 0.0) return false;
  while (clocks_[i] > reached_[i] && reference.at(clocks_[i]).arc > state.arc - excess) {
    clocks_[i] = std::max(reached_[i], clocks_[i] - kMarch);
  }
  return true;
}

/// Moves the clock on; its rate falls in time for the cube to stop at the limit.
void Player::advance(std::size_t i, double limit, double period) {
  const Reference& reference = references_[i];
  const Reference::State state = reference.at(clocks_[i]);
  const double speed = std::abs(state.twist.v);
  const double room = reference.at(limit).arc - state.arc;
  double rate = std::min(1.0, robots_[i].rate + run_.timing.accel * period / std::max(speed, 1e-3));
  if (speed > 0.0) rate = std::min(rate, std::sqrt(2.0 * run_.timing.accel * room) / speed);
  rate = std::max(rate, kLeastRate);
  const double next = std::min(limit, clocks_[i] + rate * period);
  robots_[i].rate = (next - clocks_[i]) / period;
  clocks_[i] = std::max(clocks_[i], next);
}

Twist Player::steer(std::size_t i, const Pose& predicted) const {
  const Reference::State state = references_[i].at(clocks_[i]);
  const Pose error = relative(predicted, state.pose);
  const double v = robots_[i].rate * state.twist.v;
  const double omega = robots_[i].rate * state.twist.omega;
  Twist twist;
  twist.v = v * std::cos(error.theta) + kAlongGain * error.x;
  twist.omega =
      omega + kLateralGain * v * error.y + kHeadingGain * std::abs(v) * std::sin(error.theta);
  const double nudge = kLeastNudge * run_.desk.cube.speed_per_unit;
  if (std::abs(v) < 1e-3) {
    if (std::abs(error.x) < kRest) return {};
    twist = {std::copysign(std::max(std::abs(twist.v), nudge), error.x), 0.0};
  } else if (std::abs(error.x) > kRest && std::abs(twist.v) < nudge && twist.v * error.x > 0.0) {
    twist.v = std::copysign(nudge, error.x);
  }
  const double top = run_.desk.cube.top_speed();
  twist.v = std::clamp(twist.v, -top, top);
  return twist;
}

Write Player::command(std::size_t i, double limit, double now) {
  Robot& robot = robots_[i];
  if (options_.mode == DriveMode::kTarget) {
    robot.next_target = now + kTargetPeriod;
    return target_frame(run_, references_[i], reached_[i], limit, kTargetAhead);
  }
  const std::optional<Pose> predicted = robot.predictor.at(now);
  const Twist twist = predicted ? steer(i, *predicted) : Twist{};
  robot.predictor.sent(wheel_units(run_.desk.cube, run_.desk.facing, twist), now);
  return track_frame(run_, twist);
}

std::vector<std::optional<Write>> Player::tick(double now) {
  const double period = std::clamp(now - last_tick_, 0.0, 2.0 * run_.timing.control);
  last_tick_ = now;
  if (paused_) last_progress_ = now;
  for (std::size_t i = 0; i < robots_.size(); ++i) note_progress(i, now);

  std::vector<std::optional<Write>> writes(robots_.size());
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    Robot& robot = robots_[i];
    robot.outcome.fault = fault_of(i, now);
    if (robot.lost) {
      robot.rate = 0.0;
      robot.predictor.sent({}, now);  // its last command ends by itself
      continue;
    }
    const bool stop = paused_ || robot.outcome.fault != Fault::kNone;
    if (stop || (robot.outcome.arrived && options_.mode == DriveMode::kTrack)) {
      robot.rate = 0.0;
      robot.predictor.sent({}, now);
      writes[i] = track_frame(run_, {});
      continue;
    }
    const double limit = limit_of(i);
    const double before = clocks_[i];
    if (options_.mode == DriveMode::kTarget) {
      clocks_[i] = std::max(clocks_[i], limit);
    } else {
      if (pull_back(i, now)) robot.outcome.held += period;
      advance(i, limit, period);
      if (clocks_[i] == before && limit < references_[i].end()) robot.outcome.waited += period;
    }
    if (clocks_[i] > before) last_progress_ = now;
    if (options_.mode == DriveMode::kTrack ||
        (now >= robot.next_target && !robot.outcome.arrived)) {
      writes[i] = command(i, limit, now);
    }
  }
  return writes;
}

bool Player::finished() const {
  return std::ranges::all_of(robots_, [](const Robot& r) { return r.outcome.arrived; });
}

bool Player::stuck(double now) const {
  const bool any_lost = std::ranges::any_of(robots_, &Robot::lost);
  return now - last_progress_ > (any_lost ? kGiveUpLost : kGiveUp);
}

RobotOutcome Player::outcome(std::size_t i) const { return robots_[i].outcome; }

}  // namespace mvtp
