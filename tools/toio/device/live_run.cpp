#include "tools/toio/device/live_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "tools/toio/device/cube_session.hpp"

namespace mvtp {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kFirstLook = 2.0;   // for the cubes to tell where they are, at most [s]
constexpr double kLookPeriod = 0.1;  // while cubes are placed [s]
constexpr double kHintPeriod = 3.0;  // between two hints about their places [s]
constexpr std::uint8_t kDim = 60;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Pose start_of(const ToioRun& run, std::size_t i) {
  return run.desk.to_desk(run.robots[i].waypoints.front().pose);
}

/// Which cube drives which robot: those that the run names, then the nearest pairs.
std::vector<std::size_t> assign(const ToioRun& run, const CubeSession& session) {
  const std::vector<FoundCube>& cubes = session.cubes();
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> cube_of(run.robots.size(), kNone);
  std::vector<bool> taken(cubes.size());
  for (std::size_t i = 0; i < run.robots.size(); ++i) {
    for (std::size_t c = 0; c < cubes.size() && !run.robots[i].cube.empty(); ++c) {
      if (taken[c] || cube_of[i] != kNone || !is_called(cubes[c], run.robots[i].cube)) continue;
      cube_of[i] = c;
      taken[c] = true;
    }
  }
  while (std::ranges::count(cube_of, kNone) > 0) {
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t robot = kNone;
    std::size_t cube = kNone;
    for (std::size_t i = 0; i < cube_of.size(); ++i) {
      for (std::size_t c = 0; c < cubes.size() && cube_of[i] == kNone; ++c) {
        if (taken[c]) continue;
        const std::optional<MatPose> place = session.place(cubes[c].path);
        const double away = place ? distance(run.desk.to_desk(*place), start_of(run, i))
                                  : 1e6;  // does not see the mat yet
        if (away >= nearest) continue;
        nearest = away;
        robot = i;
        cube = c;
      }
    }
    cube_of[robot] = cube;
    taken[cube] = true;
  }
  return cube_of;
}

/// How to move the cube so that it is on its start; empty if it is.
std::string hint(const ToioRun& run, std::size_t i, const std::optional<MatPose>& place,
                 const LiveOptions& options) {
  if (!place) return "does not see the mat: put it there";
  const Pose start = start_of(run, i);
  const Pose error = relative(run.desk.to_desk(*place), start);
  const double away = std::hypot(error.x, error.y);
  const double turn = std::abs(error.theta);
  if (away <= options.place_tolerance && turn <= options.place_turn_tolerance) return "";
  const MatPose there = rounded(run.desk.to_mat(start));
  return fmt::format(
      "is {:.0f} mm and {:.0f} degrees off; it belongs at x {:.0f}, y {:.0f}, {:.0f} "
      "degrees on the mat",
      away * 1000, turn * kDegreesPerRadian, there.x, there.y, there.degrees);
}

/// One live run, from the cubes in hand to the last stop.
class LiveRun {
 public:
  LiveRun(CubeSession& session, const ToioRun& run, const LiveOptions& options,
          const LiveHooks& hooks)
      : bluetooth_(session.bluetooth()),
        session_(session),
        run_(run),
        options_(options),
        hooks_(hooks) {}

  LiveOutcome drive() {
    session_.await_places(kFirstLook);
    assign_cubes();
    place_cubes();
    return play();
  }

 private:
  [[nodiscard]] const FoundCube& cube(std::size_t i) const { return session_.cubes()[cube_of_[i]]; }

  [[nodiscard]] std::optional<MatPose> place(std::size_t i) const {
    return session_.place(cube(i).path);
  }

  void require_link(std::size_t i) const {
    if (bluetooth_.connected(cube(i).path)) return;
    throw BluetoothError(fmt::format("{} ({}) {}; bring it nearer and try again", run_.robots[i].id,
                                     cube(i).name, to_string(Fault::kLinkLost)));
  }

  void light(std::size_t i, std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
    bluetooth_.write(cube(i).path, encode(LightOn{0, red, green, blue}));
  }

  void assign_cubes() {
    cube_of_ = assign(run_, session_);
    for (std::size_t i = 0; i < run_.robots.size(); ++i) {
      hooks_.say(fmt::format("{} is driven by {} ({}), MTU {}", run_.robots[i].id, cube(i).name,
                             cube(i).address, bluetooth_.mtu(cube(i).path)));
    }
  }

  /// Waits until each cube is on its start.
  void place_cubes() {
    std::vector<int> shown(run_.robots.size(), -1);
    double next_hint = 0.0;
    const Clock::time_point begin = Clock::now();
    while (true) {
      std::string problem;
      for (std::size_t i = 0; i < run_.robots.size(); ++i) {
        require_link(i);
        const std::string how = hint(run_, i, place(i), options_);
        if (shown[i] != int(how.empty())) {
          light(i, how.empty() ? 0 : kDim, how.empty() ? kDim : 0, 0);
          shown[i] = int(how.empty());
        }
        if (!how.empty()) problem += (problem.empty() ? "" : "; ") + run_.robots[i].id + " " + how;
      }
      if (problem.empty()) return;
      const double waited = seconds_since(begin);
      if (waited > options_.place_time) throw BluetoothError(problem);
      if (waited >= next_hint) {
        hooks_.say(problem);
        next_hint = waited + kHintPeriod;
        std::ranges::fill(shown, -1);  // once more, should a lamp have missed it
      }
      bluetooth_.wait(kLookPeriod);
    }
  }

  LiveOutcome play() {
    Player player(run_, options_.player);
    const Clock::time_point begin = Clock::now();
    hear_with(player, begin);
    for (std::size_t i = 0; i < run_.robots.size(); ++i) {
      light(i, run_.robots[i].color[0], run_.robots[i].color[1], run_.robots[i].color[2]);
    }
    lost_.assign(run_.robots.size(), false);
    std::vector<Fault> told(run_.robots.size(), Fault::kNone);
    double next = seconds_since(begin);
    while (!player.finished() && !player.stuck(seconds_since(begin))) {
      next += run_.timing.control;
      bluetooth_.wait(std::max(0.0, next - seconds_since(begin)));
      // After a hold-up of the computer: no burst of commands to catch up.
      next = std::max(next, seconds_since(begin) - run_.timing.control);
      take_pause(player);
      look_after_links(player, begin);
      send(player.tick(seconds_since(begin)), seconds_since(begin));
      tell_faults(player, told);
    }
    return outcome_of(player, seconds_since(begin));
  }

  /// Lets the player hear what the cubes of its robots notify.
  void hear_with(Player& player, Clock::time_point begin) {
    std::map<std::string, std::size_t> robot_of;
    for (std::size_t i = 0; i < run_.robots.size(); ++i) robot_of[cube(i).path] = i;
    session_.on_notification([this, &player, begin, robot_of](const std::string& path,
                                                              const Notification& notification) {
      const auto robot = robot_of.find(path);
      const auto event = decode_event(notification.from, notification.bytes);
      if (robot == robot_of.end() || !event) return;
      const double now = seconds_since(begin);
      log(now, robot->second, "from", notification.from, notification.bytes);
      if (const auto* button = std::get_if<Button>(&*event)) pressed_ = pressed_ || button->pressed;
      player.receive(robot->second, *event, now);
    });
  }

  /// Tells the player whose link is lost, and who is back; meanwhile tries to get them back.
  void look_after_links(Player& player, Clock::time_point begin) {
    for (std::size_t i = 0; i < lost_.size(); ++i) {
      if (lost_[i] && session_.regain(cube(i))) {
        lost_[i] = false;
        player.regain(i, seconds_since(begin));
      } else if (!lost_[i] && !bluetooth_.connected(cube(i).path)) {
        lost_[i] = true;
        player.lose(i);
      }
    }
  }

  void take_pause(Player& player) {
    const bool asked = hooks_.pause_asked && hooks_.pause_asked();
    if (!asked && !pressed_) return;
    pressed_ = false;
    player.pause(!player.paused());
    hooks_.say(player.paused() ? "paused: press Enter or a cube's button to go on" : "going on");
  }

  void send(const std::vector<std::optional<Write>>& writes, double now) {
    for (std::size_t i = 0; i < writes.size(); ++i) {
      if (!writes[i] || !bluetooth_.connected(cube(i).path)) continue;
      bluetooth_.write_now(cube(i).path, *writes[i]);
      log(now, i, "to", writes[i]->to, writes[i]->bytes);
    }
  }

  void log(double now, std::size_t robot, const char* direction, Characteristic characteristic,
           const Bytes& bytes) const {
    if (!hooks_.log) return;
    hooks_.log(fmt::format("{{\"t\": {:.3f}, \"robot\": {}, \"{}\": \"{}\", \"hex\": \"{}\"}}", now,
                           robot, direction, to_string(characteristic), to_hex(bytes)));
  }

  void tell_faults(const Player& player, std::vector<Fault>& told) const {
    for (std::size_t i = 0; i < told.size(); ++i) {
      const Fault fault = player.outcome(i).fault;
      if (fault == told[i]) continue;
      told[i] = fault;
      hooks_.say(fmt::format("{} ({}) {}", run_.robots[i].id, cube(i).name,
                             fault == Fault::kNone ? "is back" : to_string(fault)));
    }
  }

  [[nodiscard]] LiveOutcome outcome_of(const Player& player, double now) const {
    LiveOutcome outcome{.finished = player.finished(), .duration = now};
    for (std::size_t i = 0; i < run_.robots.size(); ++i) {
      outcome.robots.push_back(player.outcome(i));
      const RobotOutcome& robot = outcome.robots.back();
      if (robot.arrived) continue;
      outcome.reason += fmt::format(
          "{}{} ({}) {}", outcome.reason.empty() ? "" : "; ", run_.robots[i].id, cube(i).name,
          robot.fault == Fault::kNone ? "could not go on" : to_string(robot.fault));
    }
    return outcome;
  }

  Bluetooth& bluetooth_;
  CubeSession& session_;
  const ToioRun& run_;
  const LiveOptions& options_;
  const LiveHooks& hooks_;
  std::vector<std::size_t> cube_of_;
  std::vector<bool> lost_;  ///< by robot: is its cube's link?
  bool pressed_ = false;    ///< a button, since the last look
};

}  // namespace

LiveOutcome run_live(Bluetooth& bluetooth, const ToioRun& run, const LiveOptions& options,
                     const LiveHooks& hooks) {
  std::vector<std::string> named;
  for (const RunRobot& robot : run.robots) {
    if (!robot.cube.empty()) named.push_back(robot.cube);
  }
  std::vector<FoundCube> found = find_cubes(bluetooth, run.robots.size(), named, options.scan_time);
  // Those that the run names come first; of the others as many as it takes.
  std::ranges::stable_partition(found, [&](const FoundCube& cube) {
    return std::ranges::any_of(named, [&](const std::string& n) { return is_called(cube, n); });
  });
  found.resize(run.robots.size());
  CubeSession session(bluetooth);
  for (const FoundCube& cube : found) {
    hooks.say(fmt::format("connecting {} ({})", cube.name, cube.address));
    session.add(cube);
  }
  return LiveRun(session, run, options, hooks).drive();
}

}  // namespace mvtp
