// Compiled twice: against libsumo, and with LIBTRACI defined against libtraci (sumo_api.hpp).
#include "traci_bridge/sumo_backend.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_calls.hpp"
#include "traci_bridge/sumo_connection.hpp"
#include "traci_bridge/sumo_controlled.hpp"
#include "traci_bridge/sumo_drivers.hpp"
#include "traci_bridge/sumo_holds.hpp"
#include "traci_bridge/sumo_lanes.hpp"
#include "traci_bridge/sumo_log.hpp"
#include "traci_bridge/sumo_reading.hpp"
#include "traci_bridge/sumo_routes.hpp"
#include "traci_bridge/sumo_signals.hpp"
#include "traci_bridge/sumo_stops.hpp"
#include "traci_bridge/sumo_vehicles.hpp"

namespace mvtp {

using namespace MVTP_SUMO_NAMESPACE;

namespace {

class Backend final : public SumoTraffic {
 public:
  explicit Backend(SumoLaunch launch)
      : joined_(launch.remote.has_value()),
        network_(std::move(launch.network)),
        outputs_(std::move(launch.outputs)),
        log_(launch.log),
        calls_(launch.configuration, log_, clock_),
        lanes_(network_, log_),
        routes_(network_, log_),
        holds_(network_, drivers_, log_),
        stops_(network_, holds_, routes_, clock_),
        controlled_(network_, lanes_, routes_, drivers_, clock_),
        states_(controlled_, holds_) {
    ask([&] {
      connection_ = std::make_unique<SumoConnection>(launch, log_);
      clock_.step_length = api::Simulation::getDeltaT();
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
    const std::set<std::string> all(ids.begin(), ids.end());
    std::erase_if(ids, [&](const std::string& id) {
      // TYPE@ID is that of one vehicle, whose parameters were changed.
      const std::size_t at = id.find('@');
      const bool is_of_one = at != std::string::npos && all.contains(id.substr(0, at));
      return id.starts_with("DEFAULT_") || is_of_one;
    });
    std::ranges::sort(ids);
    return ids;
  }

  VehicleType type(const std::string& id) const override {
    return ask([&] { return read_type(id); });
  }

  double time() const override { return clock_.now; }
  double step_length() const override { return clock_.step_length; }
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
    return look_up([&] { return routes_.rest(id, clock_.now); });
  }

  std::string next_lane(const std::string& id) const override {
    return look_up([&]() -> std::string {
      const std::string here = api::Vehicle::getLaneID(id);
      for (const auto& lane : api::Vehicle::getBestLanes(id)) {
        if (lane.laneID != here) continue;
        return lane.continuationLanes.size() > 1 ? lane.continuationLanes[1] : std::string();
      }
      return {};
    });
  }

  void take_over(const std::string& id) override {
    if (controlled_.contains(id)) return;
    hold(id, false);
    rely_on_signal(id, {});
    keep_lane(id, false);
    cap_speed(id, std::numeric_limits<double>::infinity());
    ask([&] { controlled_.take_over(id, states_.front(id)); });
  }

  bool is_taken_over(const std::string& id) const override {
    if (controlled_.contains(id)) return true;
    // A vehicle that another client drives obeys as ours do.
    return joined_ && is_here(id) &&
           look_up([&] { return api::Vehicle::getSpeedMode(id); }) == kObey;
  }

  void hand_back(const std::string& id) override {
    if (!controlled_.contains(id)) return;
    ask([&] { controlled_.hand_back(id); });
  }

  void drive_along(const std::string& id, std::span<const std::string> edges) override {
    if (!controlled_.contains(id) || edges.empty()) return;
    ask([&] { controlled_.drive_along(id, edges); });
  }

  void leave_road(const std::string& id) override {
    if (!controlled_.contains(id)) return;
    ask([&] { controlled_.leave_road(id); });
  }

  void enter_road(const std::string& id, const std::string& lane) override {
    if (!controlled_.contains(id)) return;
    controlled_.enter_road(id, lane);
  }

  void place(const std::string& id, const Pose& pose, double speed) override {
    if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.theta) ||
        !std::isfinite(speed)) {
      throw std::invalid_argument("place: the pose of vehicle \"" + id + "\" is not finite");
    }
    if (controlled_.contains(id)) controlled_.place(id, pose, speed);
  }

  void hold(const std::string& id, bool stop) override {
    if (!is_here(id)) return holds_.forget(id);
    if (holds_.contains(id)) ask([&] { holds_.forget_if_passed(id); });
    if (stop == holds_.contains(id)) return;
    if (stop) {
      ask([&] { holds_.hold(id); });
    } else {
      ask([&] { holds_.release(id); });
    }
  }

  void let_through(const std::string& id, Passage passage) override {
    if (!is_driven_by_sumo(id)) return;
    ask([&] { drivers_.let_through(id, passage); });
  }

  void rely_on_signal(const std::string& id, const std::vector<std::string>& waiting) override {
    if (!is_here(id) || (waiting.empty() && !drivers_.relies_on_signal(id))) return;
    ask([&] { drivers_.rely_on_signal(id, waiting); });
  }

  void keep_lane(const std::string& id, bool keep) override {
    if (!is_driven_by_sumo(id) || keep == drivers_.keeps_lane(id)) return;
    ask([&] { drivers_.keep_lane(id, keep); });
  }

  void swap_lanes(const std::string& id, const std::string& other) override {
    if (!is_driven_by_sumo(id) || !is_driven_by_sumo(other)) return;
    ask([&] { SumoDrivers::swap_lanes(id, other); });
  }

  bool detour(const std::string& id) override {
    if (!is_driven_by_sumo(id)) return false;
    return ask([&] { return routes_.detour(id); });
  }

  void swerve(const std::string& id) override {
    if (!is_driven_by_sumo(id)) return;
    ask([&] { drivers_.swerve(id); });
  }

  void react_late(const std::string& id, double seconds) override {
    if (!is_driven_by_sumo(id)) return;
    ask([&] { drivers_.react_late(id, std::max(seconds, step_length())); });
  }

  void cap_speed(const std::string& id, double speed) override {
    ask([&] { drivers_.cap_speed(id, speed); });
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

  void limit_speed(const std::string& lane, double speed) override {
    Lane& limited = network_.lanes.at(lane);
    if (speed >= limited.speed_limit) return;
    ask([&] { api::Lane::setMaxSpeed(lane, speed); });
    limited.lower_limit(speed);
  }

  std::optional<Stop> next_stop(const std::string& id) const override {
    return ask([&] { return stops_.next(id); });
  }

  std::optional<ParkingStop> parking_stop(const std::string& id) const override {
    return ask([&] { return stops_.parking(id); });
  }

  void drop_parking_stop(const std::string& id) override {
    ask([&] { stops_.drop_parking(id); });
  }

  bool can_move(const std::string& id) const override { return !stops_.leaving().contains(id); }

  void step() override {
    ask([&] {
      drivers_.resume_lane_changes(clock_.now);
      stops_.leave_parking_areas();
      signals_.send();
      controlled_.send(stops_.leaving());
      api::Simulation::step();
      controlled_.resume_routes();
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

  [[nodiscard]] bool is_driven_by_sumo(const std::string& id) const {
    return is_here(id) && !controlled_.contains(id);
  }

  template <class Call>
  auto ask(const Call& call) const -> decltype(call()) {
    return calls_.ask(call);
  }
  template <class Call>
  auto look_up(const Call& call) const -> decltype(call()) {
    return calls_.look_up(call);
  }

  /// Reads the state after a step, each value once.
  void observe() {
    clock_.now = api::Simulation::getTime();
    running_ = api::Simulation::getMinExpectedNumber() > 0;
    departed_ = api::Simulation::getDepartedIDList();
    arrived_ = api::Simulation::getArrivedIDList();
    std::ranges::sort(departed_);
    std::ranges::sort(arrived_);
    for (const std::string& id : arrived_) {
      states_.forget(id);
      routes_.forget(id);
    }
    std::vector<std::string> ids = api::Vehicle::getIDList();
    std::ranges::sort(ids);
    forget_all_but(ids);
    std::erase_if(ids, [&](const std::string& id) { return is_about_to_be_parked(id); });
    vehicles_.resize(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) states_.read(std::move(ids[i]), vehicles_[i]);
    pedestrians_ = read_pedestrians();
    collisions_ = count_collisions();
  }

  /// Vehicles that have arrived, or that SUMO has taken off the road.
  void forget_all_but(const std::vector<std::string>& ids) {
    const auto has_left = [&](const std::string& id) {
      return !std::ranges::binary_search(ids, id);
    };
    controlled_.forget_if(has_left);
    drivers_.forget_if(has_left);
    holds_.forget_if(has_left);
    stops_.forget_if(has_left);
  }

  /// Does it depart in a parking area? SUMO puts such a vehicle on the lane beside it for one step.
  [[nodiscard]] bool is_about_to_be_parked(const std::string& id) const {
    if (!std::ranges::binary_search(departed_, id)) return false;
    return is_placed_beside_its_parking(id);
  }

  void end() {
    if (!connection_) return;
    const std::unique_ptr<SumoConnection> ending = std::move(connection_);
    const SumoLog::Redirection redirection(log_);
    ending->close();
  }

  bool joined_;  ///< somebody else runs this SUMO
  RoadNetwork network_;
  std::vector<OutputFile> outputs_;
  SumoLog log_;
  SumoClock clock_;
  SumoCalls calls_;
  SumoLanes lanes_;
  SumoRoutes routes_;
  SumoHolds holds_;
  SumoStops stops_;
  SumoDrivers drivers_;
  SumoControlled controlled_;
  SumoVehicles states_;
  SumoSignals signals_;
  std::unique_ptr<SumoConnection> connection_;

  bool running_ = false;
  std::vector<VehicleState> vehicles_;
  std::vector<Pedestrian> pedestrians_;
  std::vector<std::string> departed_;
  std::vector<std::string> arrived_;
  int collisions_ = 0;
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
