// Compiled twice: against libsumo, and with LIBTRACI defined against libtraci (sumo_api.hpp).
#include "traci_bridge/sumo_backend.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_connection.hpp"
#include "traci_bridge/sumo_frame.hpp"
#include "traci_bridge/sumo_holds.hpp"
#include "traci_bridge/sumo_lanes.hpp"
#include "traci_bridge/sumo_log.hpp"
#include "traci_bridge/sumo_reading.hpp"
#include "traci_bridge/sumo_routes.hpp"
#include "traci_bridge/sumo_signals.hpp"

namespace mvtp {

using namespace MVTP_SUMO_NAMESPACE;

namespace {

// moveToXY's bits "keep the route" and "off the road is allowed": poses are exact and the route
// stays. Every other value snaps to lanes, or rewrites the route.
constexpr int kKeepRoute = 3;
constexpr int kNewRoute = 2;          // the same, but the route is that of the lane it comes to
constexpr int kOntoRoute = 1;         // onto the nearest lane of the route, and its middle
constexpr double kAnyDistance = 1e6;  // [m]
// Speed and lane-change modes in which SUMO neither corrects the commanded pose nor the speed.
constexpr int kObey = 0;
// Safe speed, acceleration and braking as ever, but no right of way, no signal, no foe inside.
constexpr int kHeedNobody = 39;
constexpr int kOwnSpeedMode = 31;
// No lane change but those that avoid a collision, which are none where nobody changes.
constexpr int kKeepLane = 512;
constexpr double kSwerve = 1.0;  ///< [s] for which a swerving driver stays on his new lane
/// A vehicle that was just handed back first finds its place in its lane [s]; SUMO changes lanes at
/// once, 3 m aside, where its sublane model is off.
constexpr double kNoLaneChange = 1.0;
constexpr double kOwnSpeed = -1.0;  // TraCI: the driver's choice again
constexpr int kStoppedBit = 1;      // of getStopState()
constexpr double kStanding = 0.1;   // [m/s]

class Backend final : public SumoTraffic {
 public:
  explicit Backend(SumoLaunch launch)
      : configuration_(launch.configuration),
        joined_(launch.remote.has_value()),
        network_(std::move(launch.network)),
        outputs_(std::move(launch.outputs)),
        log_(launch.log),
        lanes_(network_, log_),
        routes_(network_, log_),
        holds_(network_, log_) {
    ask([&] {
      connection_ = std::make_unique<SumoConnection>(launch, log_);
      step_length_ = api::Simulation::getDeltaT();
      observe();
    });
  }
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  ~Backend() override {
    try {
      end();
    } catch (const std::exception&) {  // the files are dropped anyway
    }
  }

  const RoadNetwork& network() const override { return network_; }

  std::vector<std::string> types() const override {
    std::vector<std::string> ids = ask([] { return api::VehicleType::getIDList(); });
    std::erase_if(ids, [](const std::string& id) { return id.starts_with("DEFAULT_"); });
    std::ranges::sort(ids);
    return ids;
  }

  VehicleType type(const std::string& id) const override {
    return ask([&] { return read_type(id); });
  }

  double time() const override { return time_; }
  double step_length() const override { return step_length_; }
  bool running() const override { return running_; }
  std::span<const VehicleState> vehicles() const override { return vehicles_; }
  std::span<const Pedestrian> pedestrians() const override { return pedestrians_; }
  const std::vector<std::string>& departed() const override { return departed_; }
  const std::vector<std::string>& arrived() const override { return arrived_; }
  int collisions() const override { return collisions_; }

  std::vector<std::string> pending() const override {
    std::vector<std::string> ids = ask([] { return api::Simulation::getPendingVehicles(); });
    std::ranges::sort(ids);
    return ids;
  }

  std::vector<std::string> route(const std::string& id) const override {
    const std::span<const std::string> edges = route_edges(id);
    return {edges.begin(), edges.end()};
  }

  std::span<const std::string> route_edges(const std::string& id) const override {
    return look_up([&] { return routes_.rest(id, time_); });
  }

  void take_over(const std::string& id) override {
    if (controlled_.contains(id)) return;
    hold(id, false);
    rely_on_signal(id, {});
    keep_lane(id, false);
    unrestored_.erase(id);
    ask([&] {
      const Characteristics& vehicle = characteristics(id);
      const libsumo::TraCIPosition p = api::Vehicle::getPosition(id);
      controlled_[id] = {.front = vehicle.front,
                         .position = {p.x, p.y, api::Vehicle::getAngle(id)},
                         .speed = api::Vehicle::getSpeed(id),
                         .speed_mode = own_speed_mode(id),
                         .lane_change_mode = pending_lane_change_mode(id)};
      api::Vehicle::setSpeedMode(id, kObey);
      api::Vehicle::setLaneChangeMode(id, kObey);
    });
  }

  bool is_taken_over(const std::string& id) const override {
    if (controlled_.contains(id)) return true;
    // A vehicle that another client drives obeys as ours do.
    return joined_ && is_here(id) &&
           look_up([&] { return api::Vehicle::getSpeedMode(id); }) == kObey;
  }

  void hand_back(const std::string& id) override {
    const auto found = controlled_.find(id);
    if (found == controlled_.end()) return;
    ask([&] {
      settle(id);
      if (!routes_.restore(id, time_)) unrestored_.insert(id);
      if (api::Vehicle::getLaneID(id).empty()) put_onto_route(id, found->second);
      // SUMO only knows a speed it has measured itself, cut off at the limit of the lane.
      api::Vehicle::setPreviousSpeed(id, found->second.speed);
      api::Vehicle::setSpeedMode(id, found->second.speed_mode);
    });
    lane_changes_[id] = {time_ + kNoLaneChange, found->second.lane_change_mode};
    controlled_.erase(found);
  }

  void drive_along(const std::string& id, std::span<const std::string> edges) override {
    if (!controlled_.contains(id) || edges.empty()) return;
    const std::size_t length = look_up([&] { return routes_.length_to_cut(id, edges, time_); });
    if (length > 0) ask([&] { cut_route(id, length); });
  }

  /// SUMO puts a vehicle onto any lane of the rest of its route that it comes near, and fails an
  /// assertion once it has been near the inside of a junction.
  void leave_road(const std::string& id) override {
    const auto found = controlled_.find(id);
    if (found == controlled_.end() || !found->second.rest_of_route.empty()) return;
    Controlled& vehicle = found->second;
    vehicle.rest_of_route = route(id);
    ask([&] {
      (void)routes_.restore(id, time_);
      api::Vehicle::setRoute(id, std::vector<std::string>{vehicle.rest_of_route.front()});
    });
  }

  void enter_road(const std::string& id, const std::string& lane) override {
    const auto found = controlled_.find(id);
    if (found == controlled_.end()) return;
    Controlled& vehicle = found->second;
    const std::string& edge = network_.lanes.at(lane).edge;
    std::vector<std::string>& rest = vehicle.rest_of_route;
    const auto here = std::ranges::find(rest, edge);
    if (here == rest.end()) return;
    rest.erase(rest.begin(), here);
    vehicle.lane_index = network_.lanes.at(lane).index;
    vehicle.enters = true;
  }

  void place(const std::string& id, const Pose& pose, double speed) override {
    if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.theta) ||
        !std::isfinite(speed)) {
      throw std::invalid_argument("place: the pose of vehicle \"" + id + "\" is not finite");
    }
    const auto found = controlled_.find(id);
    if (found == controlled_.end()) return;
    found->second.position = to_sumo(pose, found->second.front);
    found->second.speed = speed;
  }

  void hold(const std::string& id, bool stop) override {
    if (stop == holds_.contains(id)) return;
    if (!is_here(id)) {
      holds_.forget(id);
    } else if (stop) {
      ask([&] { holds_.hold(id); });
    } else {
      ask([&] { holds_.release(id); });
    }
  }

  void let_through(const std::string& id, bool pass) override {
    if (controlled_.contains(id) || !is_here(id)) return;
    ask([&] {
      if (pass) {
        api::Vehicle::setSpeedMode(id, kHeedNobody);
      } else {
        api::Vehicle::setSpeedMode(id, kOwnSpeedMode);
      }
    });
  }

  void rely_on_signal(const std::string& id, const std::vector<std::string>& waiting) override {
    if (!is_here(id) || (waiting.empty() && !relying_.contains(id))) return;
    std::string words;
    for (const std::string& other : waiting) words += (words.empty() ? "" : " ") + other;
    ask([&] { api::Vehicle::setParameter(id, "junctionModel.ignoreIDs", words); });
    if (waiting.empty()) {
      relying_.erase(id);
    } else {
      relying_.insert(id);
    }
  }

  void keep_lane(const std::string& id, bool keep) override {
    if (controlled_.contains(id) || !is_here(id) || keep == lane_keepers_.contains(id)) return;
    ask([&] {
      if (keep) {
        lane_keepers_[id] = pending_lane_change_mode(id);
        api::Vehicle::setLaneChangeMode(id, kKeepLane);
      } else {
        api::Vehicle::setLaneChangeMode(id, lane_keepers_.extract(id).mapped());
      }
    });
  }

  void swerve(const std::string& id) override {
    if (controlled_.contains(id) || !is_here(id)) return;
    ask([&] {
      const int lane = api::Vehicle::getLaneIndex(id);
      const int lanes = api::Edge::getLaneNumber(api::Vehicle::getRoadID(id));
      const int beside = lane + 1 < lanes ? lane + 1 : lane - 1;
      if (beside < 0) return;
      api::Vehicle::setLaneChangeMode(id, kObey);
      api::Vehicle::changeLane(id, beside, kSwerve);
    });
  }

  void react_late(const std::string& id, double seconds) override {
    if (controlled_.contains(id) || !is_here(id)) return;
    ask([&] { api::Vehicle::setActionStepLength(id, std::max(seconds, step_length())); });
  }

  void show(const std::string& signal, int index, Light light) override {
    ask([&] { signals_.show(signal, index, light); });
  }

  void show_all(const std::string& signal, const std::string& lights) override {
    ask([&] { signals_.show_all(signal, lights); });
  }

  void free_signal(const std::string& signal) override {
    ask([&] { signals_.free(signal); });
  }

  std::vector<SignalPhase> signal_phases(const std::string& signal) const override {
    return ask([&] { return signals_.phases(signal); });
  }

  SignalControl signal_control(const std::string& signal) const override {
    return ask([&] { return signals_.control_of(signal); });
  }

  std::string shown(const std::string& signal) const override {
    return look_up([&] { return api::TrafficLight::getRedYellowGreenState(signal); });
  }

  std::optional<double> co2(const std::string& id) const override {
    constexpr double kMilligrams = 1e-3;
    return look_up([&] { return api::Vehicle::getCO2Emission(id) * kMilligrams; });
  }

  void control_signal(const std::string& signal, SignalControl control) override {
    ask([&] { signals_.control(signal, control); });
  }

  void cap_speed(const std::string& id, double speed) override {
    ask([&] {
      const bool slower = speed < api::Vehicle::getAllowedSpeed(id);
      if (slower) {
        api::Vehicle::setSpeed(id, speed);
        capped_.insert(id);
      } else if (capped_.erase(id) > 0) {
        api::Vehicle::setSpeed(id, kOwnSpeed);
      }
    });
  }

  void limit_speed(const std::string& lane, double speed) override {
    Lane& limited = network_.lanes.at(lane);
    if (speed >= limited.speed_limit) return;
    ask([&] { api::Lane::setMaxSpeed(lane, speed); });
    limited.speed_limit = speed;
  }

  std::optional<Stop> next_stop(const std::string& id) const override {
    return ask([&]() -> std::optional<Stop> {
      std::vector<libsumo::TraCINextStopData> stops = api::Vehicle::getStops(id, 0);
      std::erase_if(stops, [&](const auto& stop) { return holds_.is_hold(id, stop); });
      if (stops.empty()) stops = routes_.stops_behind(id);
      if (stops.empty()) return std::nullopt;
      const libsumo::TraCINextStopData& next = stops.front();
      return Stop{.lane = next.lane,
                  .edge = network_.lanes.contains(next.lane)
                              ? network_.lanes.at(next.lane).edge
                              : next.lane.substr(0, next.lane.rfind('_')),
                  .position = next.endPos,
                  .duration = std::max(next.duration, 0.0),
                  .until = next.until < 0.0 ? -1.0 : next.until,
                  .reached = next.arrival >= 0.0};
    });
  }

  std::optional<ParkingStop> parking_stop(const std::string& id) const override {
    if (leaving_.contains(id)) return std::nullopt;
    return ask([&]() -> std::optional<ParkingStop> {
      const std::optional<NextStop> next = next_parking_stop(id);
      if (!next) return std::nullopt;
      ParkingStop stop{.area = next->data.stoppingPlaceID,
                       .duration = std::max(next->data.duration, 0.0),
                       .until = next->data.until < 0.0 ? -1.0 : next->data.until,
                       .parked = is_parked(id)};
      // SUMO counts it down, from the step after the one in which the stop was reached.
      if (stop.parked) {
        stop.duration = next->data.duration + time_ - step_length_ - next->data.arrival;
      }
      return stop;
    });
  }

  void drop_parking_stop(const std::string& id) override {
    ask([&] {
      const std::optional<NextStop> stop = next_parking_stop(id);
      if (!stop) return;
      if (is_parked(id)) {
        leaving_.insert(id);
      } else {
        api::Vehicle::replaceStop(id, stop->index, "");
      }
    });
  }

  bool can_move(const std::string& id) const override { return !leaving_.contains(id); }

  void step() override {
    ask([&] {
      resume_lane_changes();
      leave_parking_areas();
      signals_.send();
      std::erase_if(unrestored_, [&](const std::string& id) { return routes_.restore(id, time_); });
      for (const auto& [id, vehicle] : controlled_) {
        if (leaving_.contains(id)) continue;
        settle(id);
        if (const std::size_t next = routes_.next_cut(id, time_)) routes_.cut(id, next, time_);
        const SumoPosition& p = vehicle.position;
        api::Vehicle::moveToXY(id, vehicle.enters ? vehicle.rest_of_route.front() : "",
                               vehicle.enters ? vehicle.lane_index : -1, p.x_m, p.y_m, p.angle_deg,
                               vehicle.enters ? kNewRoute : kKeepRoute, kAnyDistance);
      }
      api::Simulation::step();
      resume_routes();
      observe();
    });
  }

  void close() override {
    ask([&] { end(); });
    for (OutputFile& output : outputs_) output.commit();
    outputs_.clear();
  }

  void keep_outputs() override {
    for (OutputFile& output : outputs_) output.keep();
  }

  SumoWarnings warnings() const override { return log_.warnings(); }

 private:
  /// Is it on the road after the last step?
  [[nodiscard]] bool is_here(const std::string& id) const {
    return std::ranges::binary_search(vehicles_, id, {}, &VehicleState::id);
  }

  /// A vehicle that goes where we put it: there again in each step until put elsewhere, since SUMO
  /// loses a vehicle that is off the road and not put anywhere in a step.
  struct Controlled {
    double front = 0.0;  ///< Vehicle::front [m]
    SumoPosition position;
    double speed = 0.0;
    int speed_mode = 0;  ///< to restore
    int lane_change_mode = 0;
    std::vector<std::string> rest_of_route;  ///< edges, of a vehicle that has left the road
    bool enters = false;                     ///< it is to be on the first of them again, in
    int lane_index = -1;                     ///< this lane
  };

  /// What does not change while a vehicle is on the road.
  struct Characteristics {
    std::string type;
    double front = 0.0;  ///< Vehicle::front [m]
    double speed_factor = 1.0;
  };

  /// When a vehicle that was handed back may change lanes again, and in which mode.
  struct Resumption {
    double time = 0.0;
    int mode = 0;
  };

  /// Calls SUMO; what it throws, or says on stderr, becomes one InputError.
  template <class Call>
  auto ask(const Call& call) const -> decltype(call()) {
    std::string problem;
    try {
      const SumoLog::Redirection redirection(log_);
      return call();
    } catch (const std::exception& error) {
      problem = error.what();
    }
    if (const std::string said = log_.take_errors(); !said.empty()) problem = said;
    std::ranges::replace(problem, '\n', ' ');
    if (problem.ends_with('.')) problem.pop_back();
    const std::string when =
        time_ < 0.0 ? "SUMO does not start: " : "SUMO stopped after " + seconds(time_) + ": ";
    throw InputError(configuration_, when + problem + "; correct the scenario or SUMO's options");
  }

  /// The same for what is asked often and only reads.
  template <class Call>
  auto look_up(const Call& call) const -> decltype(call()) {
    try {
      return call();
    } catch (const std::exception&) {
      return ask(call);
    }
  }

  static std::string seconds(double time) {
    const std::string text = std::to_string(time);
    return text.substr(0, text.find('.') + 3) + " s";
  }

  /// Reads the state after a step, each value once.
  void observe() {
    time_ = api::Simulation::getTime();
    running_ = api::Simulation::getMinExpectedNumber() > 0;
    departed_ = api::Simulation::getDepartedIDList();
    arrived_ = api::Simulation::getArrivedIDList();
    std::ranges::sort(departed_);
    std::ranges::sort(arrived_);
    for (const std::string& id : arrived_) {
      characteristics_.erase(id);
      routes_.forget(id);
    }
    std::vector<std::string> ids = api::Vehicle::getIDList();
    std::ranges::sort(ids);
    forget_all_but(ids);
    std::erase_if(ids, [&](const std::string& id) { return is_about_to_be_parked(id); });
    vehicles_.resize(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) observe(std::move(ids[i]), vehicles_[i]);
    pedestrians_ = read_pedestrians();
    collisions_ = count_collisions();
  }

  /// Vehicles that have arrived, or that SUMO has taken off the road.
  void forget_all_but(const std::vector<std::string>& ids) {
    const auto has_left = [&](const std::string& id) {
      return !std::ranges::binary_search(ids, id);
    };
    const auto entry_has_left = [&](const auto& entry) { return has_left(entry.first); };
    std::erase_if(controlled_, [&](const auto& entry) {
      if (!has_left(entry.first)) return false;
      routes_.forget(entry.first);
      return true;
    });
    holds_.forget_if(has_left);
    std::erase_if(lane_changes_, entry_has_left);
    std::erase_if(capped_, has_left);
    std::erase_if(unrestored_, has_left);
    std::erase_if(leaving_, has_left);
    std::erase_if(relying_, has_left);
    std::erase_if(lane_keepers_, entry_has_left);
  }

  /// Does it depart in a parking area? SUMO puts such a vehicle on the lane beside it for one step.
  [[nodiscard]] bool is_about_to_be_parked(const std::string& id) const {
    if (!std::ranges::binary_search(departed_, id)) return false;
    return is_placed_beside_its_parking(id);
  }

  void settle(const std::string& id) { lanes_.settle(id, route_edges(id), step_length_); }

  void cut_route(const std::string& id, std::size_t length) {
    settle(id);
    routes_.cut(id, length, time_);
  }

  /// From open ground onto the road, in the next step: SUMO's driver cannot go back.
  static void put_onto_route(const std::string& id, const Controlled& vehicle) {
    const SumoPosition& p = vehicle.position;
    api::Vehicle::moveToXY(id, "", -1, p.x_m, p.y_m, p.angle_deg, kOntoRoute, kAnyDistance);
  }

  /// Those who came onto a lane again in this step go on along their own routes.
  void resume_routes() {
    for (auto& [id, vehicle] : controlled_) {
      if (!vehicle.enters || api::Vehicle::getRoadID(id) != vehicle.rest_of_route.front()) continue;
      api::Vehicle::setRoute(id, vehicle.rest_of_route);
      vehicle.rest_of_route.clear();
      vehicle.enters = false;
    }
  }

  /// A vehicle that leaves goes by the lane beside its area, if only for a moment: moveToXY in the
  /// same step takes it away from there. It waits for room, as SUMO would try it again in later
  /// steps, when it is long under control, and in the end remove it twice.
  void leave_parking_areas() {
    std::erase_if(leaving_, [&](const std::string& id) {
      if (is_parked(id) && !is_lane_free_beside(id)) return false;
      if (is_parked(id)) api::Vehicle::resume(id);
      return true;
    });
  }

  void observe(std::string id, VehicleState& state) {
    const Characteristics& vehicle = characteristics(id);
    const libsumo::TraCIPosition p = api::Vehicle::getPosition(id);
    const auto controlled = controlled_.find(id);
    state.type = vehicle.type;
    state.pose = from_sumo({p.x, p.y, api::Vehicle::getAngle(id)}, vehicle.front);
    state.speed =
        controlled == controlled_.end() ? api::Vehicle::getSpeed(id) : controlled->second.speed;
    state.speed_factor = vehicle.speed_factor;
    state.lane = api::Vehicle::getLaneID(id);
    state.lane_position = state.lane.empty() ? 0.0 : api::Vehicle::getLanePosition(id);
    state.halted_by_stop = state.speed < kStanding && controlled == controlled_.end() &&
                           !holds_.contains(id) &&
                           (api::Vehicle::getStopState(id) & kStoppedBit) != 0;
    state.id = std::move(id);
  }

  const Characteristics& characteristics(const std::string& id) {
    const auto known = characteristics_.find(id);
    if (known != characteristics_.end()) return known->second;
    const double length = api::Vehicle::getLength(id);
    return characteristics_[id] = {.type = api::Vehicle::getTypeID(id),
                                   .front = body_of(length, api::Vehicle::getWidth(id)).front,
                                   .speed_factor = api::Vehicle::getSpeedFactor(id)};
  }

  /// The vehicle's own mode, even while it is let through.
  static int own_speed_mode(const std::string& id) {
    const int mode = api::Vehicle::getSpeedMode(id);
    return mode == kHeedNobody ? kOwnSpeedMode : mode;
  }

  /// The vehicle's own mode, even if it has not got it back yet.
  [[nodiscard]] int pending_lane_change_mode(const std::string& id) {
    const auto pending = lane_changes_.extract(id);
    return pending ? pending.mapped().mode : api::Vehicle::getLaneChangeMode(id);
  }

  /// Gives vehicles that were handed back a while ago their own lane-change mode again.
  void resume_lane_changes() {
    std::erase_if(lane_changes_, [&](const auto& entry) {
      const auto& [id, resumption] = entry;
      if (time_ < resumption.time) return false;
      if (!controlled_.contains(id)) api::Vehicle::setLaneChangeMode(id, resumption.mode);
      return true;
    });
  }

  void end() {
    if (!connection_) return;
    const std::unique_ptr<SumoConnection> ending = std::move(connection_);
    const SumoLog::Redirection redirection(log_);
    ending->close();
  }

  std::string configuration_;
  bool joined_;  ///< somebody else runs this SUMO
  RoadNetwork network_;
  std::vector<OutputFile> outputs_;
  mutable SumoLog log_;
  SumoLanes lanes_;
  SumoRoutes routes_;
  SumoHolds holds_;
  std::unique_ptr<SumoConnection> connection_;

  double time_ = -1.0;  ///< before the start
  double step_length_ = 0.0;
  bool running_ = false;
  std::vector<VehicleState> vehicles_;
  std::vector<Pedestrian> pedestrians_;
  std::vector<std::string> departed_;
  std::vector<std::string> arrived_;
  int collisions_ = 0;

  std::map<std::string, Characteristics> characteristics_;
  std::map<std::string, Controlled> controlled_;
  std::set<std::string> capped_;
  std::set<std::string> unrestored_;  ///< handed back, but SUMO does not know the whole route yet
  std::set<std::string> leaving_;     ///< parked, without a stop from the next step on
  std::map<std::string, Resumption> lane_changes_;
  std::set<std::string> relying_;            ///< on protected greens
  std::map<std::string, int> lane_keepers_;  ///< their own lane-change modes
  SumoSignals signals_;
};

}  // namespace

#ifdef LIBTRACI
std::unique_ptr<SumoTraffic> launch_libtraci(SumoLaunch launch) {
  return std::make_unique<Backend>(std::move(launch));
}
#else
std::unique_ptr<SumoTraffic> launch_libsumo(SumoLaunch launch) {
  return std::make_unique<Backend>(std::move(launch));
}

std::string sumo_version() { return api::Simulation::getVersion().second; }
#endif

}  // namespace mvtp
