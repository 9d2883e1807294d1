#pragma once

#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "coordinator/traffic.hpp"

namespace mvtp {

/// Four arms with one lane each way, right-hand traffic, junction "C" in the middle.
///
///                |   ^            Edges "W_in", "W_out", ...; lanes "W_in_0", ...
///        <-------+   +-------     Arms W, S, E, N; the next one counter-clockwise is to the right
///        ------->+   +------->    of a vehicle that comes in.
///                v   |
[[nodiscard]] RoadNetwork make_crossroads(double arm = 200.0);

/// When a vehicle enters, and the two edges that it drives.
struct FakeTrip {
  std::string id;
  double depart = 0.0;
  std::string from;
  std::string to;
};

/// Vehicles that follow their leader on the lanes of a network and ignore everybody else.
class FakeTraffic : public Traffic {
 public:
  FakeTraffic(RoadNetwork network, std::vector<FakeTrip> trips, double step_length = 0.1);

  [[nodiscard]] const RoadNetwork& network() const override { return network_; }
  [[nodiscard]] std::vector<std::string> types() const override { return {"car"}; }
  [[nodiscard]] VehicleType type(const std::string& id) const override;
  [[nodiscard]] double time() const override { return time_; }
  [[nodiscard]] double step_length() const override { return step_length_; }
  [[nodiscard]] bool running() const override { return !cars_.empty() || next_ < trips_.size(); }
  [[nodiscard]] std::span<const VehicleState> vehicles() const override { return states_; }
  [[nodiscard]] std::vector<std::string> route(const std::string& id) const override;
  void take_over(const std::string& id) override { cars_.at(id).placed = true; }
  void hand_back(const std::string& id) override;
  void place(const std::string& id, const Pose& pose, double speed) override;
  void hold(const std::string& id, bool stop) override;
  void limit_speed(const std::string& lane, double speed) override {
    network_.lanes.at(lane).speed_limit = speed;
  }
  void step() override;
  [[nodiscard]] int collisions() const override { return 0; }

  [[nodiscard]] int arrived() const { return arrived_; }
  /// From now on this car, once handed back, stands still.
  void freeze(const std::string& id) { frozen_.insert(id); }

 private:
  struct Car {
    FakeTrip trip;
    std::vector<std::string> lanes;
    double front = 0.0;  ///< bumper along its lanes [m]
    double speed = 0.0;
    bool placed = false;
    Pose pose;
  };

  void insert_departures();
  void follow_leader(Car& car) const;
  void refresh();
  [[nodiscard]] Point point_at(const Car& car, double s) const;
  [[nodiscard]] std::pair<std::string, double> lane_at(const Car& car) const;
  [[nodiscard]] double length_of(const std::vector<std::string>& lanes) const;

  RoadNetwork network_;
  std::vector<FakeTrip> trips_;
  double step_length_;
  double time_ = 0.0;
  std::size_t next_ = 0;
  int arrived_ = 0;
  std::map<std::string, Car> cars_;
  std::set<std::string> held_;
  std::set<std::string> frozen_;
  std::vector<VehicleState> states_;
};

}  // namespace mvtp
