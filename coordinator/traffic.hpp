#pragma once

#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coordinator/network/road_network.hpp"
#include "planner/problem/pose.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// What the drivers of one type of vehicle do, beside the body's own limits.
struct VehicleType {
  std::string id;
  Vehicle body;          ///< max_speed, max_accel, max_decel are those of the type
  double min_gap = 2.5;  ///< [m] to the leader at rest
  double tau = 1.0;      ///< [s] desired headway
  std::string vehicle_class = "passenger";  ///< SUMO's vClass: which lanes are open to it
};

/// One vehicle on the road after a step.
struct VehicleState {
  std::string id;
  std::string type;           ///< VehicleType::id
  Pose pose;                  ///< rear axle
  double speed = 0.0;         ///< [m/s]
  double speed_factor = 1.0;  ///< its own multiple of every speed limit
  /// [m/s] that its driver does not exceed, whatever the limit and though it could: bicycles
  double top_speed = std::numeric_limits<double>::infinity();
  std::string lane;             ///< empty while off every lane
  double lane_position = 0.0;   ///< of the front bumper from the start of the lane [m]
  bool halted_by_stop = false;  ///< it stands at a scheduled stop, and waits there for its time
  double age = 0.0;             ///< [s] since it was like this
};

/// Where a vehicle is to be at the end of a step.
struct PlannedPose {
  Pose pose;           ///< rear axle
  double speed = 0.0;  ///< [m/s]
};

/// The next stop that a vehicle's demand schedules, of any kind: beside the road or on it.
struct Stop {
  std::string lane;
  std::string edge;       ///< of that lane
  double position = 0.0;  ///< where it ends, from the start of the lane [m]
  double duration = 0.0;  ///< [s] that the vehicle stays; 0: no least time
  double until = -1.0;    ///< [s] simulated time before which it does not leave; < 0: none
  bool reached = false;   ///< the vehicle stands there now
};

/// The next stop of a vehicle in a parking area.
struct ParkingStop {
  std::string area;       ///< id
  double duration = 0.0;  ///< [s] that it stays, from its arrival in a slot on; and
  double until = -1.0;    ///< [s] simulated time before which it does not leave; < 0: none
  bool parked = false;    ///< it stands there now
};

/// A person on foot.
struct Pedestrian {
  std::string id;
  Point position;         ///< of the middle of the body
  double theta = 0.0;     ///< where it walks [rad]
  double speed = 0.0;     ///< [m/s]
  double radius = 0.3;    ///< of the body [m]
  std::string edge = {};  ///< the sidewalk, crossing or other edge that it is on; empty: none
  std::string next = {};  ///< the edge or crossing that it walks onto next; empty: none, or unknown
};

/// What one light of a traffic signal shows; green protects: nobody who crosses has green too.
enum class Light : char { kRed = 'r', kYellow = 'y', kGreen = 'G' };

/// One phase of a signal's program.
struct SignalPhase {
  double duration = 0.0;  ///< [s] in a fixed program
  double least = 0.0;     ///< [s] that it lasts if it is ended by traffic, and
  double most = 0.0;      ///< at most [s]
  std::string lights;     ///< a letter each as SUMO writes them: G g y r s ...
};

/// Who runs the phases of a signal's program.
enum class SignalControl {
  kFixed,     ///< the clock: each phase lasts its duration
  kActuated,  ///< the traffic's own detectors: a phase lasts until nobody comes any more
  kOff,       ///< nobody: right of way holds
};

/// What a driver need not heed.
enum class Passage {
  kNone,     ///< he heeds right of way and signals
  kOneLine,  ///< no right of way; nor the signal at the end of his lane, if there is one
  kAll,      ///< neither right of way nor any signal
};

/// The traffic that a coordinator drives: SUMO in production, a fake in tests.
///
/// Time advances in steps. A vehicle is driven by the traffic's own car following until taken over;
/// then it goes only where place() puts it, once before every step(), until handed back.
/// A vehicle that the traffic takes off the road for good, or for a while, is not taken over any
/// longer: it is missing in vehicles(), is_taken_over() is false, and what is said of it has no
/// effect. Every function may throw InputError for a scenario that turns out to be broken. Not
/// thread-safe.
class Traffic {
 public:
  virtual ~Traffic() = default;

  [[nodiscard]] virtual const RoadNetwork& network() const = 0;
  /// The vehicle types that the scenario has loaded, its defaults not included.
  [[nodiscard]] virtual std::vector<std::string> types() const = 0;
  [[nodiscard]] virtual VehicleType type(const std::string& id) const = 0;

  [[nodiscard]] virtual double time() const = 0;         ///< [s]
  [[nodiscard]] virtual double step_length() const = 0;  ///< [s]
  /// False once no vehicle is left and none will enter.
  [[nodiscard]] virtual bool running() const = 0;

  /// Vehicles that wait to enter the network, ordered by id; route() knows them too.
  [[nodiscard]] virtual std::vector<std::string> pending() const { return {}; }

  /// All vehicles on the road after the last step, ordered by id.
  [[nodiscard]] virtual std::span<const VehicleState> vehicles() const = 0;
  /// The edges of its route, the one it is on (or, inside a junction, the one before) first.
  [[nodiscard]] virtual std::vector<std::string> route(const std::string& id) const = 0;
  /// The same without a copy; valid until the next step().
  [[nodiscard]] virtual std::span<const std::string> route_edges(const std::string& id) const {
    return routes_[id] = route(id);
  }

  /// The lane of the next edge onto which the driver of a vehicle that is not taken over means to
  /// go from its lane; empty if nobody knows.
  [[nodiscard]] virtual std::string next_lane(const std::string& /*id*/) const { return {}; }

  virtual void take_over(const std::string& id) = 0;
  /// Gives the vehicle back to the car-following model, which goes on from its pose and speed.
  virtual void hand_back(const std::string& id) = 0;
  /// Is it taken over, by whichever controller?
  [[nodiscard]] virtual bool is_taken_over(const std::string& /*id*/) const { return false; }
  /// The normal edges, a piece of its route, along which a taken-over vehicle will be placed until
  /// the next such call or hand_back(). Where a route comes to a place more than once, the traffic
  /// cannot tell by a pose alone how far the vehicle is. route() stays what it is.
  virtual void drive_along(const std::string& /*id*/, std::span<const std::string> /*edges*/) {}
  /// A taken-over vehicle is about to leave its lanes for open ground: from now on the traffic
  /// expects it on none of those that lie ahead, however near it comes to them, until
  virtual void leave_road(const std::string& /*id*/) {}
  /// it is on a lane of its route again after the next step, from where the route goes on.
  virtual void enter_road(const std::string& /*id*/, const std::string& /*lane*/) {}
  /// Where a taken-over vehicle is after the next step.
  virtual void place(const std::string& id, const Pose& pose, double speed) = 0;
  /// Does the traffic want to be told plans ahead of time? Then
  [[nodiscard]] virtual bool wants_plans() const { return false; }
  /// where a taken-over vehicle is now, and where it will be placed in each of the next steps.
  /// Behind the end of a complete plan the car-following model goes on; else it stays there.
  virtual void announce_plan(const std::string& /*id*/, std::vector<PlannedPose> /*poses*/,
                             bool /*complete*/) {}
  /// Makes a vehicle that is not taken over stop before the end of its lane (true), or go on.
  virtual void hold(const std::string& id, bool stop) = 0;
  /// What the driver of a vehicle that is not taken over need not heed from now on.
  virtual void let_through(const std::string& /*id*/, Passage /*passage*/) {}
  /// Keeps a vehicle that is not taken over from driving faster [m/s]; infinity: no matter.
  virtual void cap_speed(const std::string& /*id*/, double /*speed*/) {}
  /// The driver of a vehicle that is not taken over relies on his signal: he does not yield at
  /// junctions to these vehicles, which wait for him there. Nobody named: he yields as ever.
  virtual void rely_on_signal(const std::string& /*id*/,
                              const std::vector<std::string>& /*waiting*/) {}
  /// Keeps a vehicle that is not taken over in its lane (true), as a solid line does.
  virtual void keep_lane(const std::string& /*id*/, bool /*keep*/) {}
  /// Two vehicles that are not taken over, and stand level on lanes of the same edge, each go on
  /// from where the other stands.
  virtual void swap_lanes(const std::string& /*id*/, const std::string& /*other*/) {}
  /// The driver of a vehicle that is not taken over gives up its route: it drives on where its lane
  /// leads, and from there by the fastest path to where the route ends. False: there is no path, or
  /// stops are left on the route.
  virtual bool detour(const std::string& /*id*/) { return false; }
  /// From the next step on a light shows this, until the signal is shown otherwise or freed.
  virtual void show(const std::string& /*signal*/, int /*index*/, Light /*light*/) {}
  /// The same for all lights of a signal: a letter each, as in SignalPhase.
  virtual void show_all(const std::string& /*signal*/, const std::string& /*lights*/) {}
  /// The signal runs its own program again.
  virtual void free_signal(const std::string& /*signal*/) {}
  /// The phases of the program that a signal came with, in their order; none if it is not known.
  [[nodiscard]] virtual std::vector<SignalPhase> signal_phases(
      const std::string& /*signal*/) const {
    return {};
  }
  /// Who runs that program.
  [[nodiscard]] virtual SignalControl signal_control(const std::string& /*signal*/) const {
    return SignalControl::kFixed;
  }
  /// What a signal shows now: a letter each, as in SignalPhase; empty if it is not known.
  [[nodiscard]] virtual std::string shown(const std::string& /*signal*/) const { return {}; }
  /// Has a signal's phases run in this way from now on.
  virtual void control_signal(const std::string& /*signal*/, SignalControl /*control*/) {}
  /// Lowers the limit of a lane for every driver [m/s].
  virtual void limit_speed(const std::string& lane, double speed) = 0;

  /// What the vehicle's motor gave off in the last step [g/s of CO2]; none: not known.
  [[nodiscard]] virtual std::optional<double> co2(const std::string& /*id*/) const {
    return std::nullopt;
  }
  /// The next stop of the vehicle, if it has one.
  [[nodiscard]] virtual std::optional<Stop> next_stop(const std::string& /*id*/) const {
    return std::nullopt;
  }
  /// The next stop of the vehicle in a parking area, if it has one.
  [[nodiscard]] virtual std::optional<ParkingStop> parking_stop(const std::string& /*id*/) const {
    return std::nullopt;
  }
  /// Takes that stop off the vehicle's plans; if it is parked, it may be taken over from now on,
  virtual void drop_parking_stop(const std::string& /*id*/) {}
  /// but stays where it stands as long as this is false.
  [[nodiscard]] virtual bool can_move(const std::string& /*id*/) const { return true; }
  /// Everyone on foot after the last step, ordered by id.
  [[nodiscard]] virtual std::span<const Pedestrian> pedestrians() const { return {}; }

  virtual void step() = 0;

  /// Pairs of vehicles that the traffic itself saw collide in the last step.
  [[nodiscard]] virtual int collisions() const = 0;

 private:
  mutable std::map<std::string, std::vector<std::string>> routes_;  ///< behind route_edges()
};

}  // namespace mvtp
