#pragma once

#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "coordinator/controller.hpp"
#include "coordinator/faults/connected_vehicle.hpp"
#include "coordinator/faults/fault_model.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// A traffic as a controller sees it through the air: vehicles report late, with noise, or not at
/// all, and follow the last plan that they have got, more or less. Lights, gates and limits are
/// beside the road: what is said to them holds at once. A vehicle of which no plan is announced
/// goes where it is placed, as ever.
///
/// Who watches the run looks at the traffic itself. Whoever steps that has `radio()` act after all
/// controllers. Everything follows from the seed.
class FaultyTraffic : public Traffic {
 public:
  /// @param world  outlives this
  FaultyTraffic(Traffic& world, FaultPlan plan);
  FaultyTraffic(const FaultyTraffic&) = delete;
  FaultyTraffic& operator=(const FaultyTraffic&) = delete;

  /// Takes messages to and fro in a Simulation of the world; to be added last.
  [[nodiscard]] Controller& radio() { return radio_; }
  [[nodiscard]] const FaultFigures& figures() const { return figures_; }

  [[nodiscard]] const RoadNetwork& network() const override { return world_.network(); }
  [[nodiscard]] std::vector<std::string> types() const override { return world_.types(); }
  [[nodiscard]] VehicleType type(const std::string& id) const override { return world_.type(id); }
  [[nodiscard]] double time() const override { return world_.time(); }
  [[nodiscard]] double step_length() const override { return world_.step_length(); }
  [[nodiscard]] bool running() const override { return world_.running(); }
  [[nodiscard]] std::vector<std::string> pending() const override { return world_.pending(); }
  [[nodiscard]] std::span<const VehicleState> vehicles() const override { return reports_; }
  [[nodiscard]] std::vector<std::string> route(const std::string& id) const override {
    return world_.route(id);
  }
  [[nodiscard]] std::span<const std::string> route_edges(const std::string& id) const override {
    return world_.route_edges(id);
  }
  [[nodiscard]] std::string next_lane(const std::string& id) const override {
    return world_.next_lane(id);
  }
  void take_over(const std::string& id) override;
  void hand_back(const std::string& id) override;
  [[nodiscard]] bool is_taken_over(const std::string& id) const override;
  void drive_along(const std::string& id, std::span<const std::string> edges) override;
  void leave_road(const std::string& id) override { world_.leave_road(id); }
  void enter_road(const std::string& id, const std::string& lane) override {
    world_.enter_road(id, lane);
  }
  void place(const std::string& id, const Pose& pose, double speed) override;
  [[nodiscard]] bool wants_plans() const override { return true; }
  void announce_plan(const std::string& id, std::vector<PlannedPose> poses, bool complete) override;
  void hold(const std::string& id, bool stop) override { world_.hold(id, stop); }
  void let_through(const std::string& id, Passage passage) override {
    world_.let_through(id, passage);
  }
  void cap_speed(const std::string& id, double speed) override { world_.cap_speed(id, speed); }
  void rely_on_signal(const std::string& id, const std::vector<std::string>& waiting) override {
    world_.rely_on_signal(id, waiting);
  }
  void keep_lane(const std::string& id, bool keep) override { world_.keep_lane(id, keep); }
  void swap_lanes(const std::string& id, const std::string& other) override {
    world_.swap_lanes(id, other);
  }
  bool detour(const std::string& id) override { return world_.detour(id); }
  void show(const std::string& signal, int index, Light light) override {
    world_.show(signal, index, light);
  }
  void show_all(const std::string& signal, const std::string& lights) override {
    world_.show_all(signal, lights);
  }
  void free_signal(const std::string& signal) override { world_.free_signal(signal); }
  [[nodiscard]] std::vector<SignalPhase> signal_phases(const std::string& signal) const override {
    return world_.signal_phases(signal);
  }
  [[nodiscard]] SignalControl signal_control(const std::string& signal) const override {
    return world_.signal_control(signal);
  }
  [[nodiscard]] std::string shown(const std::string& signal) const override {
    return world_.shown(signal);
  }
  void control_signal(const std::string& signal, SignalControl control) override {
    world_.control_signal(signal, control);
  }
  void limit_speed(const std::string& lane, double speed) override {
    world_.limit_speed(lane, speed);
  }
  [[nodiscard]] std::optional<Stop> next_stop(const std::string& id) const override {
    return world_.next_stop(id);
  }
  [[nodiscard]] std::optional<ParkingStop> parking_stop(const std::string& id) const override {
    return world_.parking_stop(id);
  }
  void drop_parking_stop(const std::string& id) override { world_.drop_parking_stop(id); }
  [[nodiscard]] bool can_move(const std::string& id) const override { return world_.can_move(id); }
  [[nodiscard]] std::span<const Pedestrian> pedestrians() const override {
    return world_.pedestrians();
  }
  void step() override { world_.step(); }
  [[nodiscard]] int collisions() const override { return world_.collisions(); }

 private:
  /// What a vehicle is told; sent again at every step, the whole of it.
  struct Message {
    bool released = false;                    ///< it has its driver back
    std::shared_ptr<const PlanMessage> plan;  ///< none: as it is placed
    std::vector<std::string> edges;           ///< along which it will be driven
  };
  /// A message on its way.
  struct OnAir {
    std::int64_t due = 0;  ///< step in which it arrives
    std::shared_ptr<const Message> message;
  };
  /// What is said to a vehicle, and what has come of it.
  struct Link {
    std::shared_ptr<const Message> said = std::make_shared<Message>();
    std::deque<OnAir> on_air;
    std::shared_ptr<const Message> heard;
    std::shared_ptr<const Message> obeyed;  ///< the last that it has begun to follow
    std::optional<PlannedPose> placed;      ///< of a vehicle without a plan
    std::optional<ConnectedVehicle> vehicle;
    double stopped = 0.0;  ///< [s] since it stopped dead
    Draws draws;
  };
  /// The reports of one vehicle.
  struct Reports {
    Draws draws;
    Noise along;
    Noise across;
    Noise turn;
    std::deque<std::pair<std::int64_t, VehicleState>> on_air;  ///< and when each arrives
    std::optional<VehicleState> newest;
    std::int64_t seen = 0;  ///< step
  };
  class Radio : public HumanDriversOnly {
   public:
    explicit Radio(FaultyTraffic& traffic) : traffic_(traffic) {}
    void act() override { traffic_.command(); }
    void observe() override { traffic_.receive_reports(); }

   private:
    FaultyTraffic& traffic_;
  };

  void command();
  void send(Link& link);
  /// Returns whether the vehicle is its driver's again.
  [[nodiscard]] bool drive(const std::string& id, Link& link, const VehicleState& state);
  void misbehave(const std::string& id, Link& link, const VehicleState& state);
  [[nodiscard]] bool goes_wrong(const std::string& id, VehicleFault::Kind kind, double share) const;
  void say(Link& link, Message message) {
    link.said = std::make_shared<Message>(std::move(message));
  }
  void receive_reports();
  void receive(const VehicleState& state);
  [[nodiscard]] Draws draws_for(const std::string& id, std::uint64_t purpose) const;
  void note(const std::string& id, const std::string& what);
  [[nodiscard]] std::int64_t steps(double seconds) const;

  Traffic& world_;
  FaultPlan plan_;
  Radio radio_{*this};
  FaultFigures figures_;
  std::int64_t step_ = 0;
  std::map<std::string, Link> links_;
  std::map<std::string, Reports> air_;
  std::set<std::string> went_wrong_;  ///< vehicles, each only once
  std::vector<VehicleState> reports_;
};

}  // namespace mvtp
