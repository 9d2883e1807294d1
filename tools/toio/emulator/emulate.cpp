#include "tools/toio/emulator/emulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/problem/referee_geometry.hpp"
#include "tools/toio/emulator/air.hpp"
#include "tools/toio/emulator/cube_model.hpp"

namespace mvtp {
namespace {

constexpr double kStep = 0.005;       // of the physics [s]
constexpr double kEnough = 10.0;      // times the schedule, and
constexpr double kEnoughMore = 60.0;  // so many seconds: no run takes longer [s]

struct Station {
  CubeModel cube;
  Air<Write> to_cube;
  Air<Notification> from_cube;
};

/// Half of the delay is on the way to the cube, half on the way back.
AirQuality air_of(const EmulateOptions& options) {
  return {options.delay / 2.0, options.jitter, options.loss};
}

std::vector<Station> place_cubes(const ToioRun& run, const EmulateOptions& options,
                                 WorldDice& dice) {
  std::vector<Station> stations;
  for (const RunRobot& robot : run.robots) {
    const auto error = [&](double most) { return dice.between(-most, most); };
    const Pose start = compose(
        run.desk.to_desk(robot.waypoints.front().pose),
        {error(options.placement), error(options.placement), error(options.placement_turn)});
    const CubeFlaws flaws{1.0 + error(options.wheel_error), 1.0 + error(options.wheel_error)};
    CubeModel cube(run.desk.mat, run.desk.cube, run.desk.own_heading(start), flaws);
    const Write always = encode(NotifyId{1, NotifyWhen::kAlways});
    cube.write(always.to, always.bytes);
    stations.push_back({std::move(cube), {}, {}});
  }
  return stations;
}

/// Watches the true bodies.
void look_for_touches(const ToioRun& run, const std::vector<Station>& stations,
                      std::vector<std::vector<bool>>& touched, EmulateReport& report) {
  const Vehicle body = body_of(run.desk.cube, Facing::kNoseFirst, {0.0, 0.0});
  std::vector<referee::Box> boxes;
  for (const Station& s : stations) boxes.push_back(referee::footprint(body, s.cube.pose()));
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      const double gap = referee::separation(boxes[i], boxes[j]);
      report.least_clearance = std::min(report.least_clearance, gap);
      if (gap >= 0.0 || touched[i][j]) continue;
      touched[i][j] = true;
      report.touching.push_back(fmt::format("{} and {}", run.robots[i].id, run.robots[j].id));
    }
  }
}

double schedule_of(const ToioRun& run) {
  double end = 0.0;
  for (const RunRobot& robot : run.robots) end = std::max(end, robot.waypoints.back().time);
  return end;
}

/// One step of the world: what has arrived is taken, wheels turn, reports are sent.
void step(Station& station, std::size_t i, double now, const EmulateOptions& options,
          WorldDice& dice, Player& player, EmulateReport& report) {
  station.to_cube.deliver(now,
                          [&](const Write& write) { station.cube.write(write.to, write.bytes); });
  if (dice.happens(options.stalls_per_minute / 60.0 * kStep)) {
    station.cube.block(dice.between(options.shortest_stall, options.longest_stall));
    ++report.stalls;
  }
  station.cube.step(kStep);
  for (Notification& notification : station.cube.take_notifications()) {
    station.from_cube.send(std::move(notification), now, air_of(options), dice);
  }
  station.from_cube.deliver(now, [&](const Notification& notification) {
    const auto event = decode_event(notification.from, notification.bytes);
    if (event) player.receive(i, *event, now);
  });
}

}  // namespace

double EmulateReport::waited() const {
  double sum = 0.0;
  for (const RobotOutcome& robot : robots) sum += robot.waited;
  return sum;
}

double EmulateReport::most_lateral() const {
  double most = 0.0;
  for (const RobotOutcome& robot : robots) most = std::max(most, robot.most_lateral);
  return most;
}

double EmulateReport::most_along() const {
  double most = 0.0;
  for (const RobotOutcome& robot : robots) most = std::max(most, robot.most_along);
  return most;
}

EmulateReport emulate(const ToioRun& run, const EmulateOptions& options) {
  WorldDice dice(options.seed);
  Player player(run, options.player);
  std::vector<Station> stations = place_cubes(run, options, dice);
  EmulateReport report;
  report.tracks.resize(stations.size());
  std::vector touched(stations.size(), std::vector<bool>(stations.size()));
  const auto steps_per_tick = std::max(1L, std::lround(run.timing.control / kStep));
  const double latest = kEnough * schedule_of(run) + kEnoughMore;

  double now = 0.0;
  for (long n = 0; now < latest && !player.finished() && !player.stuck(now); ++n) {
    now = double(n) * kStep;
    for (std::size_t i = 0; i < stations.size(); ++i) {
      step(stations[i], i, now, options, dice, player, report);
    }
    look_for_touches(run, stations, touched, report);
    if (n % steps_per_tick != 0) continue;
    const std::vector<std::optional<Write>> writes = player.tick(now);
    for (std::size_t i = 0; i < stations.size(); ++i) {
      report.tracks[i].push_back(run.desk.own_heading(stations[i].cube.pose()));
      if (writes[i]) stations[i].to_cube.send(*writes[i], now, air_of(options), dice);
    }
  }
  report.finished = player.finished();
  report.duration = now;
  for (std::size_t i = 0; i < stations.size(); ++i) report.robots.push_back(player.outcome(i));
  return report;
}

}  // namespace mvtp
