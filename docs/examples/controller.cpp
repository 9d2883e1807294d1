// A controller of one's own in the closed loop. The traffic here is a straight road in memory; any
// other that implements mvtp::Traffic does as well.
#include <algorithm>
#include <cstdio>
#include <map>
#include <mvtp/controller.hpp>
#include <mvtp/simulation.hpp>

namespace {

constexpr double kRoad = 300.0;  // [m]
constexpr double kStep = 0.1;    // [s]

/// Three cars on one lane. Their human drivers go 10 m/s, whoever is ahead.
class Road : public mvtp::Traffic {
 public:
  Road() {
    network_.lanes["road_0"] = {.id = "road_0", .edge = "road", .length = kRoad};
    network_.edges["road"] = {"road_0"};
    for (const char* id : {"a", "b", "c"}) {
      cars_.push_back({.id = id,
                       .type = "car",
                       .pose = {30.0 * double(cars_.size()), 0, 0},
                       .speed = 10.0,
                       .lane = "road_0"});
    }
  }

  const mvtp::RoadNetwork& network() const override { return network_; }
  std::vector<std::string> types() const override { return {"car"}; }
  mvtp::VehicleType type(const std::string& id) const override { return {.id = id}; }
  double time() const override { return time_; }
  double step_length() const override { return kStep; }
  bool running() const override { return !cars_.empty(); }
  std::span<const mvtp::VehicleState> vehicles() const override { return cars_; }
  std::vector<std::string> route(const std::string&) const override { return {"road"}; }
  void take_over(const std::string& id) override { placed_[id]; }
  void hand_back(const std::string& id) override { placed_.erase(id); }
  bool is_taken_over(const std::string& id) const override { return placed_.contains(id); }
  void place(const std::string& id, const mvtp::Pose& pose, double speed) override {
    placed_[id] = {pose, speed};
  }
  void hold(const std::string&, bool) override {}
  void limit_speed(const std::string&, double) override {}
  int collisions() const override { return 0; }

  void step() override {
    time_ += kStep;
    for (mvtp::VehicleState& car : cars_) {
      const auto ours = placed_.find(car.id);
      if (ours == placed_.end()) {
        car.pose.x += car.speed * kStep;
      } else {
        std::tie(car.pose, car.speed) = ours->second;
      }
    }
    std::erase_if(cars_, [](const auto& car) { return car.pose.x > kRoad; });
  }

 private:
  mvtp::RoadNetwork network_;
  std::vector<mvtp::VehicleState> cars_;
  std::map<std::string, std::pair<mvtp::Pose, double>> placed_;
  double time_ = 0.0;
};

/// Takes over the car "a" and lets it drive 15 m/s, but no closer than 10 m to where b is now.
class CatchUp : public mvtp::Controller {
 public:
  explicit CatchUp(mvtp::Traffic& traffic) : traffic_(traffic) {}

  void decide() override {
    if (!traffic_.is_taken_over("a")) traffic_.take_over("a");
  }
  void act() override {
    const auto cars = traffic_.vehicles();
    const auto a = std::ranges::find(cars, "a", &mvtp::VehicleState::id);
    const auto b = std::ranges::find(cars, "b", &mvtp::VehicleState::id);
    if (a == cars.end()) return;
    double x = a->pose.x + 15.0 * kStep;
    if (b != cars.end()) x = std::min(x, std::max(a->pose.x, b->pose.x - 10.0));
    traffic_.place("a", {x, 0, 0}, (x - a->pose.x) / kStep);
  }
  bool drives(const std::string& id) const override { return id == "a"; }
  const std::vector<mvtp::Replan>& replans() const override { return replans_; }

 private:
  mvtp::Traffic& traffic_;
  std::vector<mvtp::Replan> replans_;
};

}  // namespace

int main() {
  Road road;
  CatchUp controller(road);
  double least_gap = kRoad;  // between a and b [m]
  mvtp::Simulation simulation(road);
  simulation.add(controller);
  simulation.add([&](const mvtp::Snapshot& now) {
    if (now.vehicles.size() < 3) return;
    least_gap = std::min(least_gap, now.vehicles[1].state->pose.x - now.vehicles[0].state->pose.x);
  });
  const mvtp::RunStatus status = simulation.run({.end = 60.0});
  std::printf("%s after %.1f s; a came within %.1f m of b\n", to_string(status).c_str(),
              road.time(), least_gap);
  return status == mvtp::RunStatus::kFinished ? 0 : 1;
}
