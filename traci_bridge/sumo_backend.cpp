// Compiled twice: against libsumo, and with LIBTRACI defined against libtraci. Their headers
// exclude each other; their functions are the same, in two namespaces.
#include "traci_bridge/sumo_backend.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#ifdef LIBTRACI
#include <libsumo/libtraci.h>
namespace api = libtraci;
#else
#include <libsumo/libsumo.h>
namespace api = libsumo;
#endif

#include "planner/problem/input_error.hpp"
#include "traci_bridge/sumo_frame.hpp"
#include "traci_bridge/sumo_log.hpp"
#include "traci_bridge/sumo_process.hpp"

namespace mvtp {
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
/// A vehicle that was just handed back first finds its place in its lane [s]; SUMO changes lanes at
/// once, 3 m aside, where its sublane model is off.
constexpr double kNoLaneChange = 1.0;
constexpr double kHoldGap = 1.0;    // from a held vehicle's front to the end of its lane [m]
constexpr double kForever = 1.0e6;  // [s]
constexpr double kOwnSpeed = -1.0;  // TraCI: the driver's choice again
constexpr int kStoppedBit = 1;      // of getStopState()
constexpr int kParkedBits = 129;    // of getStopState(): stopped, in a parking area
constexpr double kStanding = 0.1;   // [m/s]
// How far the tail is behind the begin of the lane where SUMO's idea of it cannot get stale within
// a step: for any speed up to 40 m/s.
constexpr double kTailRoom = 2.0;                     // [m]
constexpr double kTailTime = 40.0;                    // [m/s]
constexpr int kParkingAreaBit = 64;                   // of TraCINextStopData::stopFlags
const char* const kTurningRadius = "turning-radius";  // our parameter of a vType [m]

#ifdef LIBTRACI
class SumoConnection {
 public:
  SumoConnection(const std::vector<std::string>& arguments, const SumoLog& log)
      : process_(arguments, log.descriptor()) {
    const std::string port = std::to_string(process_.port());
    api::Simulation::init(process_.port(), 0, "127.0.0.1", "mvtp-" + port);
  }

  void close() {
    api::Simulation::close();
    if (!process_.wait()) throw std::runtime_error("it did not end well");
  }

 private:
  SumoProcess process_;
};
#else
class SumoConnection {
 public:
  SumoConnection(const std::vector<std::string>& arguments, const SumoLog& /*log*/) {
    api::Simulation::start(arguments);
  }

  void close() { api::Simulation::close(); }
};
#endif

class Backend final : public SumoTraffic {
 public:
  explicit Backend(SumoLaunch launch)
      : configuration_(std::move(launch.configuration)),
        network_(std::move(launch.network)),
        outputs_(std::move(launch.outputs)),
        log_(launch.log) {
    ask([&] {
      index_network();
      connection_ = std::make_unique<SumoConnection>(launch.arguments, log_);
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
    return ask([&] {
      VehicleType type{
          .id = id,
          .body = body_of(api::VehicleType::getLength(id), api::VehicleType::getWidth(id)),
          .min_gap = api::VehicleType::getMinGap(id),
          .tau = api::VehicleType::getTau(id),
          .vehicle_class = api::VehicleType::getVehicleClass(id)};
      type.body.max_speed = api::VehicleType::getMaxSpeed(id);
      type.body.max_accel = api::VehicleType::getAccel(id);
      type.body.max_decel = api::VehicleType::getDecel(id);
      if (const std::string radius = api::VehicleType::getParameter(id, kTurningRadius);
          !radius.empty()) {
        type.body.min_turning_radius = turning_radius(id, radius);
      }
      return type;
    });
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
    Route& route = routes_[id];
    if (route.seen != time_) look_up([&] { refresh(id, route); });
    return std::span(route.edges).subspan(route.done);
  }

  void take_over(const std::string& id) override {
    if (controlled_.contains(id)) return;
    hold(id, false);
    ask([&] {
      const Characteristics& vehicle = characteristics(id);
      const libsumo::TraCIPosition p = api::Vehicle::getPosition(id);
      controlled_[id] = {.front = vehicle.front,
                         .position = {p.x, p.y, api::Vehicle::getAngle(id)},
                         .speed = api::Vehicle::getSpeed(id),
                         .speed_mode = api::Vehicle::getSpeedMode(id),
                         .lane_change_mode = pending_lane_change_mode(id)};
      api::Vehicle::setSpeedMode(id, kObey);
      api::Vehicle::setLaneChangeMode(id, kObey);
    });
  }

  bool is_taken_over(const std::string& id) const override { return controlled_.contains(id); }

  void hand_back(const std::string& id) override {
    const auto found = controlled_.find(id);
    if (found == controlled_.end()) return;
    ask([&] {
      settle(id);
      restore_route(id, found->second);
      if (api::Vehicle::getLaneID(id).empty()) put_onto_route(id, found->second);
      // SUMO only knows a speed it has measured itself, cut off at the limit of the lane.
      api::Vehicle::setPreviousSpeed(id, found->second.speed);
      api::Vehicle::setSpeedMode(id, found->second.speed_mode);
    });
    lane_changes_[id] = {time_ + kNoLaneChange, found->second.lane_change_mode};
    controlled_.erase(found);
  }

  /// SUMO puts a vehicle onto the nearest lane of its whole route, those it has left behind
  /// included, and fails an assertion once that is another one than where it is: where a route
  /// meets itself, SUMO only knows the piece of it on which the vehicle is.
  void drive_along(const std::string& id, std::span<const std::string> edges) override {
    const auto found = controlled_.find(id);
    if (found == controlled_.end() || edges.empty()) return;
    const std::vector<std::string> rest = route(id);
    const Route& known = routes_.at(id);
    const std::size_t length = piece_length(rest, edges);
    const bool whole = !found->second.piece && !meets_itself(known);
    if (whole || length == 0) return;
    ask([&] {
      settle(id);
      cut_route(id, found->second, rest, length);
    });
  }

  /// SUMO puts a vehicle onto any lane of the rest of its route that it comes near, and fails an
  /// assertion once it has been near the inside of a junction.
  void leave_road(const std::string& id) override {
    const auto found = controlled_.find(id);
    if (found == controlled_.end() || !found->second.rest_of_route.empty()) return;
    Controlled& vehicle = found->second;
    vehicle.rest_of_route = route(id);
    ask([&] {
      restore_route(id, vehicle);
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
    const auto found = held_.find(id);
    if (stop == (found != held_.end())) return;
    if (!is_here(id)) {
      held_.erase(id);
      return;
    }
    ask([&] {
      if (stop) {
        stop_at_the_end_of_its_lane(id);
      } else {
        go_on(id, found->second);
        held_.erase(found);
      }
    });
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
      const auto controlled = controlled_.find(id);
      std::vector<libsumo::TraCINextStopData> stops = api::Vehicle::getStops(id, 0);
      if (const auto held = held_.find(id); held != held_.end()) {
        std::erase_if(stops, [&](const auto& stop) { return is_hold(held->second, stop); });
      }
      if (stops.empty() && controlled != controlled_.end() && controlled->second.piece) {
        stops = controlled->second.piece->stops;
      }
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
      for (const auto& [id, vehicle] : controlled_) {
        if (leaving_.contains(id)) continue;
        settle(id);
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

  /// A route, as SUMO names it: never two different ones alike.
  struct Route {
    std::string name;
    std::vector<std::string> edges;
    std::size_t done = 0;  ///< edges that the vehicle has left
    double seen = -1.0;    ///< [s] simulated time of the last look at it
  };

  /// What SUMO knows of a route that it may not know as a whole.
  struct Piece {
    std::string name;                               ///< of that route
    std::vector<std::string> rest;                  ///< the true one, from the same edge on
    std::vector<libsumo::TraCINextStopData> stops;  ///< behind the piece: SUMO forgets them
  };

  /// A vehicle that goes where we put it: there again in each step until put elsewhere, since SUMO
  /// loses a vehicle that is off the road and not put anywhere in a step.
  struct Controlled {
    double front = 0.0;  ///< Vehicle::front [m]
    SumoPosition position;
    double speed = 0.0;
    int speed_mode = 0;  ///< to restore
    int lane_change_mode = 0;
    std::optional<Piece> piece;              ///< the cut, if SUMO does not know the whole route
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

  struct LanePlace {
    std::string lane;
    double position = 0.0;  ///< [m]
  };

  struct NextStop {
    int index = 0;  ///< among the next stops
    libsumo::TraCINextStopData data;
  };

  /// The stop by which SUMO keeps a vehicle from leaving its lane.
  struct Hold {
    std::string edge;
    int lane = 0;
    double position = 0.0;
  };

  /// Runs an action on SUMO; what it throws, or says on stderr, becomes one InputError.
  template <class Action>
  auto ask(const Action& action) const -> decltype(action()) {
    std::string problem;
    try {
      const SumoLog::Redirection redirection(log_);
      return action();
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
  template <class Action>
  void look_up(const Action& action) const {
    try {
      action();
    } catch (const std::exception&) {
      ask(action);
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
      routes_.erase(id);
    }
    std::vector<std::string> ids = api::Vehicle::getIDList();
    std::ranges::sort(ids);
    forget_all_but(ids);
    std::erase_if(ids, [&](const std::string& id) { return is_about_to_be_parked(id); });
    vehicles_.resize(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) observe(std::move(ids[i]), vehicles_[i]);
    observe_pedestrians();
    collisions_ = count_collisions();
  }

  /// Vehicles that have arrived, or that SUMO has taken off the road.
  void forget_all_but(const std::vector<std::string>& ids) {
    const auto gone = [&](const std::string& id) { return !std::ranges::binary_search(ids, id); };
    const auto is_gone = [&](const auto& entry) { return gone(entry.first); };
    std::erase_if(controlled_, is_gone);
    std::erase_if(held_, is_gone);
    std::erase_if(lane_changes_, is_gone);
    std::erase_if(capped_, gone);
    std::erase_if(leaving_, gone);
  }

  /// Does it depart in a parking area? SUMO puts such a vehicle on the lane beside it for one step.
  [[nodiscard]] bool is_about_to_be_parked(const std::string& id) const {
    if (!std::ranges::binary_search(departed_, id)) return false;
    const std::optional<NextStop> stop = next_parking_stop(id);
    return stop && stop->index == 0 && stop->data.lane == api::Vehicle::getLaneID(id) &&
           stop->data.endPos == api::Vehicle::getLanePosition(id) && !is_parked(id);
  }

  static std::optional<NextStop> next_parking_stop(const std::string& id) {
    const auto stops = api::Vehicle::getStops(id, 0);
    for (std::size_t i = 0; i < stops.size(); ++i) {
      if ((stops[i].stopFlags & kParkingAreaBit) != 0) return NextStop{int(i), stops[i]};
    }
    return std::nullopt;
  }

  static bool is_parked(const std::string& id) {
    return (api::Vehicle::getStopState(id) & kParkedBits) == kParkedBits;
  }

  /// Puts a vehicle that we place onto the lane again where it is already, in SUMO's own way.
  ///
  /// As long as a placed vehicle stays on its lane, SUMO does not look again on which lanes its
  /// tail is, and inside a junction it may take an edge further on or back for the one before it.
  /// Once the vehicle or a follower of it asks, an assertion fails. SUMO looks when a vehicle
  /// enters a lane, so it goes onto another one first. Only where need be: each time, SUMO counts
  /// the lane once more as driven (routeLength of its tripinfo).
  void settle(const std::string& id) {
    const auto found = network_.lanes.find(api::Vehicle::getLaneID(id));
    if (found == network_.lanes.end()) return;
    const Lane& lane = found->second;
    const double position = std::min(api::Vehicle::getLanePosition(id), lane.length);
    if (!has_stale_tail(id, lane, position) && !is_misplaced(id, lane)) return;
    const std::optional<LanePlace> other = place_beside(id, lane, position);
    if (!other) return;
    try {
      api::Vehicle::moveTo(id, other->lane, other->position);
      api::Vehicle::moveTo(id, lane.id, position);
    } catch (const libsumo::TraCIException&) {
      static_cast<void>(log_.take_errors());  // not on the route: it is placed all the same
    }
  }

  /// May its tail have left a lane that lies between two others on which SUMO believes it to be?
  [[nodiscard]] bool has_stale_tail(const std::string& id, const Lane& lane,
                                    double position) const {
    const auto before = shortest_before_.find(lane.id);
    if (before == shortest_before_.end()) return false;
    const double length = api::Vehicle::getLength(id);
    return before->second < length &&
           position - length < std::max(kTailRoom, kTailTime * step_length_);
  }

  /// Does SUMO take another edge for the one that leads to this internal lane?
  [[nodiscard]] bool is_misplaced(const std::string& id, const Lane& lane) const {
    const auto inside = inside_.find(lane.id);
    if (inside == inside_.end()) return false;
    const std::span<const std::string> rest = route_edges(id);
    return rest.front() != network_.lanes.at(inside->second->from_lane).edge;
  }

  /// A place on another lane of the vehicle's route, near to where it is.
  [[nodiscard]] std::optional<LanePlace> place_beside(const std::string& id, const Lane& lane,
                                                      double position) const {
    if (const auto inside = inside_.find(lane.id); inside != inside_.end()) {
      const Lane& from = network_.lanes.at(inside->second->from_lane);
      return LanePlace{from.id, from.length};
    }
    for (const std::string& sibling : network_.edges.at(lane.edge)) {
      if (sibling == lane.id) continue;
      return LanePlace{sibling, std::min(position, network_.lanes.at(sibling).length)};
    }
    const std::span<const std::string> rest = route_edges(id);
    const auto [first, last] = leaving_lane_.equal_range(lane.id);
    for (auto way = first; way != last; ++way) {
      const Connection& c = *way->second;
      const bool follows = rest.size() > 1 && network_.lanes.at(c.to_lane).edge == rest[1];
      if (follows && !c.via.empty()) return LanePlace{c.via.front(), 0.0};
    }
    return std::nullopt;
  }

  /// From open ground onto the road, in the next step: SUMO's driver knows no way back.
  static void put_onto_route(const std::string& id, const Controlled& vehicle) {
    const SumoPosition& p = vehicle.position;
    api::Vehicle::moveToXY(id, "", -1, p.x_m, p.y_m, p.angle_deg, kOntoRoute, kAnyDistance);
  }

  void refresh(const std::string& id, Route& route) const {
    const auto controlled = controlled_.find(id);
    std::string name = api::Vehicle::getRouteID(id);
    if (name != route.name) {
      const bool cut = controlled != controlled_.end() && controlled->second.piece &&
                       controlled->second.piece->name == name;
      route.edges = cut ? controlled->second.piece->rest : api::Vehicle::getRoute(id);
      route.name = std::move(name);
    }
    const int done = api::Vehicle::getRouteIndex(id);  // negative before the departure
    route.done = std::min(std::size_t(std::max(done, 0)), route.edges.size() - 1);
    route.seen = time_;
  }

  /// How many edges of the rest of a route lie between its begin and the end of a piece of it;
  /// 0 if it has no such piece. Edges of the piece that the vehicle has left already do not count.
  static std::size_t piece_length(std::span<const std::string> rest,
                                  std::span<const std::string> piece) {
    for (; !piece.empty(); piece = piece.subspan(1)) {
      const auto found = std::ranges::search(rest, piece);
      if (!found.empty()) return std::size_t(found.end() - rest.begin());
    }
    return 0;
  }

  /// Does a route come to a junction twice, or back to where it began?
  [[nodiscard]] bool meets_itself(const Route& route) const {
    const auto known = meeting_.find(route.name);
    if (known != meeting_.end()) return known->second;
    std::set<std::string> seen;
    bool meets = false;
    for (std::size_t i = 0; i < route.edges.size(); ++i) {
      const auto [from, to] = ends_.at(route.edges[i]);
      if (i == 0 && !from.empty()) meets = !seen.insert(from).second || meets;
      if (!to.empty()) meets = !seen.insert(to).second || meets;
    }
    return meeting_[route.name] = meets;
  }

  /// Lets SUMO know the first edges of the rest of a route only.
  void cut_route(const std::string& id, Controlled& vehicle, const std::vector<std::string>& rest,
                 std::size_t length) {
    const std::vector<std::string> edges(rest.begin(), rest.begin() + std::ptrdiff_t(length));
    const std::string name = name_of(edges);
    if (vehicle.piece && vehicle.piece->name == name) return;
    std::vector<libsumo::TraCINextStopData> stops = api::Vehicle::getStops(id, 0);
    if (vehicle.piece) {
      stops.insert(stops.end(), vehicle.piece->stops.begin(), vehicle.piece->stops.end());
    }
    vehicle.piece = Piece{.name = name, .rest = rest, .stops = {}};
    api::Vehicle::setRouteID(id, name);
    const std::size_t kept = api::Vehicle::getStops(id, 0).size();
    vehicle.piece->stops.assign(stops.begin() + std::ptrdiff_t(std::min(kept, stops.size())),
                                stops.end());
    routes_.erase(id);
  }

  /// Lets SUMO know the whole rest of the route again.
  void restore_route(const std::string& id, Controlled& vehicle) {
    if (!vehicle.piece) return;
    const std::vector<std::string> rest = route(id);
    const bool still_cut = routes_.at(id).name == vehicle.piece->name;  // nobody has rerouted it
    const Piece piece = std::move(*vehicle.piece);
    vehicle.piece.reset();
    if (!still_cut) return;
    api::Vehicle::setRouteID(id, name_of(rest));
    for (const libsumo::TraCINextStopData& stop : piece.stops) add_stop(id, stop);
    routes_.erase(id);
  }

  static void add_stop(const std::string& id, const libsumo::TraCINextStopData& stop) {
    const bool named = !stop.stoppingPlaceID.empty();
    const std::size_t index = stop.lane.rfind('_');
    api::Vehicle::setStop(
        id, named ? stop.stoppingPlaceID : stop.lane.substr(0, index), named ? 1.0 : stop.endPos,
        named ? 0 : std::stoi(stop.lane.substr(index + 1)), stop.duration, stop.stopFlags,
        named ? libsumo::INVALID_DOUBLE_VALUE : stop.startPos, stop.until);
  }

  /// SUMO's id of a route of ours with these edges.
  const std::string& name_of(const std::vector<std::string>& edges) {
    std::string& name = named_pieces_[edges];
    if (name.empty()) {
      name = "mvtp:" + std::to_string(named_pieces_.size());
      api::Route::add(name, edges);
    }
    return name;
  }

  [[nodiscard]] bool is_hold(const Hold& hold, const libsumo::TraCINextStopData& stop) const {
    return stop.duration > kForever / 2.0 && stop.endPos == hold.position &&
           stop.lane == hold.edge + '_' + std::to_string(hold.lane);
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

  static bool is_lane_free_beside(const std::string& id) {
    constexpr double kAhead = 5.0;    // [m]
    constexpr double kBehind = 40.0;  // [m]
    const std::optional<NextStop> stop = next_parking_stop(id);
    if (!stop) return true;
    const double end = stop->data.endPos;
    const double begin = end - api::Vehicle::getLength(id);
    const std::vector<std::string> others = api::Lane::getLastStepVehicleIDs(stop->data.lane);
    return std::ranges::none_of(others, [&](const std::string& other) {
      if (other == id) return false;
      const double front = api::Vehicle::getLanePosition(other);
      return front > begin - kBehind && front - api::Vehicle::getLength(other) < end + kAhead;
    });
  }

  void observe_pedestrians() {
    std::vector<std::string> ids = api::Person::getIDList();
    std::ranges::sort(ids);
    pedestrians_.clear();
    for (const std::string& id : ids) {
      if (!api::Person::getVehicle(id).empty()) continue;  // rides
      const libsumo::TraCIPosition p = api::Person::getPosition(id);
      const double length = api::Person::getLength(id);
      // As of vehicles, SUMO's position is the middle of the front.
      const Pose middle = from_sumo({p.x, p.y, api::Person::getAngle(id)}, length / 2);
      pedestrians_.push_back({.id = id,
                              .position = {middle.x, middle.y},
                              .theta = middle.theta,
                              .speed = api::Person::getSpeed(id),
                              .radius = std::hypot(length, api::Person::getWidth(id)) / 2});
    }
  }

  static double turning_radius(const std::string& type, const std::string& text) {
    double radius = 0.0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, radius);
    if (error != std::errc() || rest != end || !std::isfinite(radius) || radius <= 0.0) {
      throw std::runtime_error("vType \"" + type + "\": the param " + kTurningRadius + " is \"" +
                               text + "\", not a number of metres above 0");
    }
    return radius;
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
                           !held_.contains(id) &&
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

  /// SUMO reports most pairs twice, once from each side.
  static int count_collisions() {
    if (api::Simulation::getCollidingVehiclesNumber() == 0) return 0;
    std::set<std::pair<std::string, std::string>> pairs;
    for (const libsumo::TraCICollision& c : api::Simulation::getCollisions()) {
      pairs.insert(std::minmax(c.collider, c.victim));
    }
    return static_cast<int>(pairs.size());
  }

  void stop_at_the_end_of_its_lane(const std::string& id) {
    const std::string lane = api::Vehicle::getLaneID(id);
    if (lane.empty() || network_.lanes.at(lane).internal) return;
    const Hold stop{.edge = network_.lanes.at(lane).edge,
                    .lane = network_.lanes.at(lane).index,
                    .position = std::max(network_.lanes.at(lane).length - kHoldGap, 0.1)};
    try {
      api::Vehicle::setStop(id, stop.edge, stop.position, stop.lane, kForever);
      held_[id] = stop;
    } catch (const libsumo::TraCIException&) {
      static_cast<void>(log_.take_errors());  // too close to brake: it goes on
    }
  }

  static void go_on(const std::string& id, const Hold& stop) {
    if ((api::Vehicle::getStopState(id) & kStoppedBit) != 0) {
      api::Vehicle::resume(id);
    } else {
      api::Vehicle::setStop(id, stop.edge, stop.position, stop.lane, 0.0);  // cancels it
    }
  }

  void end() {
    if (!connection_) return;
    const std::unique_ptr<SumoConnection> ending = std::move(connection_);
    const SumoLog::Redirection redirection(log_);
    ending->close();
  }

  /// The junctions where each edge begins and ends; "" where the network ends.
  using Ends = std::map<std::string, std::pair<std::string, std::string>>;

  void index_network() {
    for (const auto& [edge, lanes] : network_.edges) ends_[edge];
    for (const auto& [id, junction] : network_.junctions) {
      for (const std::string& lane : junction.incoming_lanes) {
        ends_[network_.lanes.at(lane).edge].second = id;
      }
      for (const Connection& c : junction.connections) {
        ends_[network_.lanes.at(c.to_lane).edge].first = id;
        leaving_lane_.emplace(c.from_lane, &c);
        const Lane* before = &network_.lanes.at(c.from_lane);
        for (const std::string& via : c.via) {
          inside_[via] = &c;
          note_before(via, *before);
          before = &network_.lanes.at(via);
        }
        note_before(c.to_lane, *before);
      }
    }
  }

  void note_before(const std::string& lane, const Lane& before) {
    double& shortest = shortest_before_.emplace(lane, before.length).first->second;
    shortest = std::min(shortest, before.length);
  }

  std::string configuration_;
  RoadNetwork network_;
  std::vector<OutputFile> outputs_;
  mutable SumoLog log_;
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
  std::map<std::string, Hold> held_;
  Ends ends_;
  std::multimap<std::string, const Connection*> leaving_lane_;  ///< by the lane they leave
  std::map<std::string, const Connection*> inside_;             ///< by internal lane
  std::map<std::string, double> shortest_before_;  ///< of the lanes that lead onto each lane [m]
  mutable std::map<std::string, Route> routes_;
  mutable std::map<std::string, bool> meeting_;  ///< by the name of a route
  std::map<std::vector<std::string>, std::string> named_pieces_;
  std::set<std::string> leaving_;  ///< parked, without a stop from the next step on
  std::map<std::string, Resumption> lane_changes_;
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
