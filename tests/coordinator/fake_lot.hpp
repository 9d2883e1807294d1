#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "coordinator/traffic.hpp"
#include "planner/problem/parking_lot.hpp"

namespace mvtp {

/// 16 slots of 2.5 x 5 m in two rows on both sides of an aisle of 6 m, closed at its far end;
/// entry lane "in_0" and exit lane "out_0" side by side at the other.
///
///     +-+-+-+-+-+-+-+-+----------+
///     | | | | | | | | |          |  s8 ... s15, open to the south
///   --+                          |
///   <- out_0                     |
///   -> in_0                      |
///   --+                          |
///     | | | | | | | | |          |  s0 ... s7, open to the north
///     +-+-+-+-+-+-+-+-+----------+
[[nodiscard]] ParkingLot make_lot();

/// A car of 4.5 x 1.8 m as SUMO's default.
[[nodiscard]] Vehicle lot_car();

struct FakeParkingEvent {
  std::string id;
  double depart = 0.0;
  double duration = 60.0;  ///< [s] in the slot
  int slot = -1;           ///< parked there at the start, nose in; -1: it comes by the entry lane
};

/// Cars that come along a lane of 60 m at 5 m/s, one behind the other, and go along another.
class FakeLotTraffic : public Traffic {
 public:
  FakeLotTraffic(const ParkingLot& lot, std::vector<FakeParkingEvent> events);

  [[nodiscard]] const RoadNetwork& network() const override { return network_; }
  [[nodiscard]] std::vector<std::string> types() const override { return {"car"}; }
  [[nodiscard]] VehicleType type(const std::string& id) const override;
  [[nodiscard]] double time() const override { return time_; }
  [[nodiscard]] double step_length() const override { return 0.1; }
  [[nodiscard]] bool running() const override { return !cars_.empty() || next_ < events_.size(); }
  [[nodiscard]] std::span<const VehicleState> vehicles() const override { return states_; }
  [[nodiscard]] std::vector<std::string> route(const std::string&) const override {
    return {"in", "out"};
  }
  void take_over(const std::string& id) override { cars_.at(id).placed = true; }
  void hand_back(const std::string& id) override;
  void place(const std::string& id, const Pose& pose, double speed) override;
  void hold(const std::string& id, bool stop) override { cars_.at(id).held = stop; }
  void cap_speed(const std::string& id, double speed) override { cars_.at(id).cap = speed; }
  void limit_speed(const std::string&, double) override {}
  [[nodiscard]] std::optional<ParkingStop> parking_stop(const std::string& id) const override;
  [[nodiscard]] std::span<const Pedestrian> pedestrians() const override { return people_; }
  void step() override;
  [[nodiscard]] int collisions() const override { return 0; }

  /// Walks on with its speed in every step.
  void add_person(const Pedestrian& person) { people_.push_back(person); }
  [[nodiscard]] int arrived() const { return arrived_; }
  void set_body(const Vehicle& body) { body_ = body; }

 private:
  struct Car {
    FakeParkingEvent event;
    Pose pose;
    double speed = 0.0;
    double front = 0.0;  ///< on its lane [m]
    double cap = 1e9;    ///< [m/s]
    bool placed = false;
    bool held = false;
    bool going = false;  ///< on the exit lane
  };

  void drive_own(Car& car, double room) const;
  void refresh();

  ParkingLot lot_;
  std::vector<FakeParkingEvent> events_;
  Vehicle body_ = lot_car();
  RoadNetwork network_;
  double time_ = 0.0;
  std::size_t next_ = 0;
  int arrived_ = 0;
  std::map<std::string, Car> cars_;
  std::vector<VehicleState> states_;
  std::vector<Pedestrian> people_;
};

}  // namespace mvtp
