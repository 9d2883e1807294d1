#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/network/lane_graph.hpp"
#include "coordinator/traffic.hpp"
#include "tests/coordinator/fake_walkers.hpp"
#include "tests/coordinator/shapes.hpp"

namespace mvtp {

/// Where a fake vehicle stops on its route, and for how long.
struct FakeStop {
  std::string lane;
  double position = 0.0;  ///< [m]
  double duration = 0.0;  ///< [s]
};

/// When a vehicle enters, and where it drives.
struct FakeTrip {
  std::string id;
  double depart = 0.0;
  std::string from;  ///< edge
  std::string to;    ///< edge
  std::string type = "car";
  int lane = 0;                         ///< index of the lane on which it enters
  std::vector<std::string> edges = {};  ///< its whole route; none: the shortest
  std::optional<FakeStop> stop = {};
  /// Where on its first lane [m] and how fast [m/s] it appears, whoever is there; none: at its
  /// begin, when there is room.
  std::optional<std::pair<double, double>> at = {};
  std::string onto = {};  ///< lane of its second edge on which it goes on, if several lead there
  double aside = 0.0;     ///< [m] to the left of its lanes that it keeps, until it is taken over
};

/// The types of fake vehicles: "car" 4.5 m, "bus" 12 m, "truck" 18 m; "bike" is left to its driver
/// whatever happens.
[[nodiscard]] VehicleType fake_type(const std::string& id);

/// The edges of the shortest route; none if there is no path.
[[nodiscard]] std::vector<std::string> shortest_route(const RoadNetwork& network,
                                                      const std::string& from,
                                                      const std::string& to);

/// Vehicles on any road network. Their drivers follow their routes and their leaders [Krauss 1998],
/// change lanes only just before they have to, and enter a junction with conflicts only when nobody
/// from elsewhere is on it or near it. Like those of SUMO they move both bumpers along the lanes.
class FakeTraffic : public Traffic {
 public:
  /// @param programs  of its signals; without one nobody knows its phases.
  FakeTraffic(RoadNetwork network, std::vector<FakeTrip> trips, double step_length = 0.1,
              std::map<std::string, std::vector<SignalPhase>> programs = {});
  FakeTraffic(const FakeTraffic&) = delete;
  FakeTraffic& operator=(const FakeTraffic&) = delete;

  [[nodiscard]] const RoadNetwork& network() const override { return network_; }
  [[nodiscard]] std::vector<std::string> types() const override { return {"car"}; }
  [[nodiscard]] VehicleType type(const std::string& id) const override { return fake_type(id); }
  [[nodiscard]] double time() const override { return time_; }
  [[nodiscard]] double step_length() const override { return step_length_; }
  [[nodiscard]] bool running() const override {
    return !cars_.empty() || !waiting_.empty() || !walkers_.all_arrived();
  }
  [[nodiscard]] std::vector<std::string> pending() const override;
  [[nodiscard]] std::span<const VehicleState> vehicles() const override { return states_; }
  [[nodiscard]] std::vector<std::string> route(const std::string& id) const override;
  [[nodiscard]] std::string next_lane(const std::string& id) const override;
  void take_over(const std::string& id) override;
  void hand_back(const std::string& id) override { cars_.at(id).placed = false; }
  [[nodiscard]] bool is_taken_over(const std::string& id) const override;
  /// Vehicles to which its driver does not yield, as he was told. @pre it is there
  [[nodiscard]] const std::set<std::string>& goes_before(const std::string& id) const {
    return cars_.at(id).waiting;
  }
  void place(const std::string& id, const Pose& pose, double speed) override;
  void hold(const std::string& id, bool stop) override;
  void let_through(const std::string& id, Passage passage) override;
  void rely_on_signal(const std::string& id, const std::vector<std::string>& waiting) override;
  void keep_lane(const std::string& id, bool keep) override {
    keep ? (void)kept_in_lane_.insert(id) : (void)kept_in_lane_.erase(id);
  }
  void show(const std::string& signal, int index, Light light) override {
    lights_[{signal, index}] = light;
  }
  /// nullopt: nobody shows one, and the signal runs its own program.
  [[nodiscard]] std::optional<Light> light(const std::string& signal, int index) const {
    const auto shown = lights_.find({signal, index});
    return shown == lights_.end() ? std::nullopt : std::optional(shown->second);
  }
  void free_signal(const std::string& signal) override {
    std::erase_if(lights_, [&](const auto& shown) { return shown.first.first == signal; });
  }
  [[nodiscard]] std::vector<SignalPhase> signal_phases(const std::string& signal) const override {
    const auto known = programs_.find(signal);
    return known == programs_.end() ? std::vector<SignalPhase>() : known->second;
  }
  void limit_speed(const std::string& lane, double speed) override {
    network_.lanes.at(lane).lower_limit(speed);
  }
  [[nodiscard]] std::optional<Stop> next_stop(const std::string& id) const override;
  [[nodiscard]] std::span<const Pedestrian> pedestrians() const override {
    return walkers_.people();
  }
  void step() override;
  [[nodiscard]] int collisions() const override { return 0; }

  [[nodiscard]] FakeWalkers& walkers() { return walkers_; }
  [[nodiscard]] int arrived() const { return arrived_; }
  /// From now on this vehicle, once handed back, stands still.
  void freeze(const std::string& id) { frozen_.insert(id); }
  /// Takes a vehicle off the road for good.
  void remove(const std::string& id);
  /// A vehicle that enters later, or comes back after remove().
  void add(FakeTrip trip);
  /// Those that are due enter without a step.
  void insert_now();
  [[nodiscard]] bool is_held(const std::string& id) const;
  [[nodiscard]] bool passes(const std::string& id) const { return cars_.at(id).passes; }
  [[nodiscard]] bool is_kept_in_lane(const std::string& id) const {
    return kept_in_lane_.contains(id);
  }
  /// How often drivers were told to pass, by vehicle.
  [[nodiscard]] const std::map<std::string, int>& passages() const { return passages_; }

 private:
  struct Car {
    FakeTrip trip;
    VehicleType type;
    std::vector<int> route;  ///< edges
    std::size_t edge = 0;    ///< in `route`; inside a junction: the one before
    int lane = LaneGraph::kNone;
    double position = 0.0;   ///< of the front bumper on its lane [m]
    std::vector<int> trail;  ///< lanes behind, the nearest last
    double speed = 0.0;
    double next_speed = 0.0;
    bool placed = false;
    bool passes = false;
    std::set<std::string> waiting;   ///< vehicles that it does not yield to
    int held_on = LaneGraph::kNone;  ///< lane before the end of which it stops
    int granted = LaneGraph::kNone;  ///< junction that it may enter
    double stood = 0.0;              ///< [s] at its stop
    Pose pose;
  };
  /// A body on a lane, from its rear to its front or the end of the lane.
  struct Span {
    const Car* car = nullptr;
    double rear = 0.0;
    double front = 0.0;
  };
  /// A lane ahead of a vehicle, and how far from its front bumper it begins [m].
  struct Ahead {
    int lane = LaneGraph::kNone;
    int link = LaneGraph::kNone;  ///< by which it is entered, if from a normal lane
    double distance = 0.0;
  };

  [[nodiscard]] Car make_car(const FakeTrip& trip) const;
  void insert_departures();
  [[nodiscard]] bool has_room(const Car& car) const;
  void find_occupants();
  [[nodiscard]] bool is_normal(int lane) const { return graph_.edge_of(lane) != LaneGraph::kNone; }
  [[nodiscard]] int link_from(const Car& car, int lane, std::size_t edge) const;
  [[nodiscard]] std::vector<Ahead> lanes_ahead(const Car& car, double reach) const;
  void plan_speed(Car& car);
  [[nodiscard]] double room_to_leader(const Car& car, const Ahead& on, double& speed) const;
  [[nodiscard]] double room_to_bodies(const Car& car, double reach, double& speed) const;
  [[nodiscard]] bool may_enter(Car& car, int link, double distance);
  [[nodiscard]] bool is_clear(const Car& car, int link) const;
  [[nodiscard]] bool must_yield(const Car& car, int link) const;
  void change_lane(Car& car);
  void drive(Car& car);
  void locate(Car& car, const Pose& before);
  void enter(Car& car, int lane);
  void set_pose(Car& car) const;
  [[nodiscard]] Point point_behind(const Car& car, double distance) const;
  [[nodiscard]] Point point_on(int lane, double position) const;
  void refresh();

  RoadNetwork network_;
  LaneGraph graph_;
  FakeWalkers walkers_{graph_};
  double step_length_;
  double time_ = 0.0;
  int arrived_ = 0;
  std::vector<FakeTrip> waiting_;  ///< in the order of departure
  std::map<std::string, Car> cars_;
  std::map<int, std::vector<Span>> occupants_;  ///< of lanes
  std::set<std::string> frozen_;
  std::set<std::string> kept_in_lane_;
  std::map<std::pair<std::string, int>, Light> lights_;  ///< of signals that are shown
  std::map<std::string, std::vector<SignalPhase>> programs_;
  std::map<std::string, int> passages_;
  std::vector<VehicleState> states_;
};

}  // namespace mvtp
