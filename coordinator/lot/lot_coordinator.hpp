#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "coordinator/controller.hpp"
#include "coordinator/lot/lot_controller.hpp"
#include "coordinator/lot/lot_lookout.hpp"
#include "planner/lot.hpp"
#include "planner/problem/parking_lot.hpp"

namespace mvtp {

/// How vehicles stand in their slots.
enum class ParkingDirection { kForward, kReverse, kAny };

/// A slot that a vehicle could take, and what getting there takes.
struct SlotOffer {
  std::size_t slot = 0;   ///< index in ParkingLot::slots
  double distance = 0.0;  ///< [m] cost-to-go from the vehicle, of the better way round
};

/// Puts the free slots in the order in which a vehicle should try them.
using SlotPolicy = std::function<void(std::vector<SlotOffer>& offers)>;

struct LotOptions {
  LotController controller = LotController::kEscot;
  ParkingDirection parking = ParkingDirection::kAny;
  LotPlannerOptions planner;
  double decision = 0.5;  ///< [s] between two decisions; rounded to whole steps of the traffic
  int tries = 4;          ///< vehicles that are planned for in one decision, at most
  int slots_tried = 2;    ///< slots among which an arriving vehicle takes the quickest
  SlotPolicy policy;      ///< none: the nearest first
  /// Vehicles that break down, and when [s]: they brake to rest and stay.
  std::map<std::string, double> breakdowns;
};

/// One vehicle's parking event; all times simulated [s].
struct ParkingEvent {
  std::string id;
  bool there_at_start = false;        ///< it was parked when the run began
  std::string slot;                   ///< its id; empty before it has one
  std::optional<double> asked_in;     ///< first seen at the gate, waiting to be let in
  std::optional<double> admitted_in;  ///< it got its path to the slot
  std::optional<double> parked;
  std::optional<double> wished_out;  ///< its time in the slot was over
  std::optional<double> admitted_out;
  std::optional<double> handed_back;  ///< on the exit lane
  double alone_in = 0.0;              ///< what the path in would take with nobody else moving
  double alone_out = 0.0;
  double distance = 0.0;  ///< driven under control [m]
  double waited = 0.0;    ///< standing on the way
  int reversals = 0;
  bool broken = false;
  bool stopped_permanently = false;  ///< it once had no path any more
};

/// The lot at one moment.
struct Occupied {
  double time = 0.0;  ///< [s]
  int parked = 0;
  int under_way = 0;
  int at_gate = 0;  ///< waiting in the entry lanes
};

/// Where a vehicle is.
struct LotObservation {
  std::string id;
  Vehicle body;
  Pose pose;  ///< rear axle
  bool leaving = false;
};

/// The closed loop on an open parking lot: takes vehicles over in the entry lanes, gives each a
/// slot, brings it there, and, when its time in the slot is over, to an exit lane and back to a
/// human driver.
///
/// Two properties hold at every step: everyone braking now is free of contact, and
/// everyone under way has a complete path in an order that lets all arrive (LotMotion). A breakdown
/// is the one thing that ends the second; who cannot go on then stops, and asks for a new path.
class LotCoordinator : public Controller {
 public:
  LotCoordinator(Traffic& traffic, const ParkingLot& lot, const LotOptions& options);

  /// @throws InputError for a vehicle for which every slot is too small
  void decide() override;
  void act() override;
  void observe() override { arrive(); }

  [[nodiscard]] bool drives(const std::string& id) const override;
  [[nodiscard]] bool rests(const std::string& id) const override;
  [[nodiscard]] const std::vector<Replan>& replans() const override { return replans_; }
  [[nodiscard]] const std::map<std::string, ParkingEvent>& events() const { return events_; }
  [[nodiscard]] const LotMotion& motion() const { return motion_; }
  [[nodiscard]] const ParkingLot& lot() const { return original_; }
  /// How many are where now.
  [[nodiscard]] Occupied occupied(double time) const;
  /// Who drives on the lot now, ordered by id, and
  [[nodiscard]] std::vector<LotObservation> under_way() const;
  /// who stands in a slot; poses as the traffic has them.
  [[nodiscard]] std::vector<LotObservation> parked() const;

 private:
  enum class Phase { kAtGate, kUnderWay, kParked, kStoppedPermanently };
  struct Guest {
    std::int64_t key = 0;
    Phase phase = Phase::kAtGate;
    Vehicle body;
    Pose pose;           ///< in the lot's frame
    double speed = 0.0;  ///< [m/s], at the gate
    int entry = -1;      ///< the lane in which it is first and may be let in
    int slot = -1;       ///< taken or promised
    bool wants_out = false;
    bool held = false;  ///< at the gate, for good
    bool taken_over = false;
    double stay = 0.0;          ///< [s]
    double until = -1.0;        ///< [s] simulated
    std::int64_t asked = -1;    ///< the decision in which it last asked for a path, and
    int failures = 0;           ///< in a row
    std::int64_t next_try = 0;  ///< from which on it may ask again
  };

  void welcome();
  void check_size(const std::string& id, const Vehicle& body) const;
  void adopt_parked(const std::string& id, Guest& guest);
  void watch_the_gates();
  [[nodiscard]] double speed_behind_the_last(const LotLane& lane, const Guest& guest) const;
  void replan();
  void take_over_the_parked();
  void end_parking();
  void break_down();
  void take_over(const std::string& id, Guest& guest);
  [[nodiscard]] const std::string& exit_at(const Pose& goal) const;
  [[nodiscard]] bool wants_a_path(const std::string& id, const Guest& guest) const;
  [[nodiscard]] std::vector<std::string> those_who_ask() const;
  [[nodiscard]] std::optional<LotAdmission> ask(const std::string& id, Guest& guest);
  [[nodiscard]] std::vector<int> slots_for(const Guest& guest);
  [[nodiscard]] std::vector<int> slots_around(const Guest& guest) const;
  [[nodiscard]] bool fits(const Vehicle& body, const ParkingSlot& slot) const;
  [[nodiscard]] std::vector<Pose> places(const Vehicle& body, const ParkingSlot& slot) const;
  [[nodiscard]] std::vector<StandingCar> standing(bool asking, const std::string& except) const;
  [[nodiscard]] std::vector<StandingCar> in_place(const std::string& except) const;
  [[nodiscard]] std::vector<StandingCar> solid(std::span<const int> free_to_use,
                                               const std::string& except) const;
  [[nodiscard]] std::vector<double> stopping_points();
  void advance();
  void leave_slot(Guest& guest, const LotCar& car) const;
  void place_all();
  void arrive();

  [[nodiscard]] std::vector<LotObservation> observations(Phase phase) const;
  [[nodiscard]] const VehicleType& type_of(const std::string& id);
  [[nodiscard]] Pose to_lot(const Pose& pose) const;
  [[nodiscard]] Pose from_lot(const Pose& pose) const;

  Traffic& traffic_;
  ParkingLot original_;
  Point origin_;    ///< of the lot's frame
  ParkingLot lot_;  ///< in it
  LotOptions options_;
  LotPlanner planner_;
  LotMotion motion_;
  std::int64_t step_ = 0;
  std::int64_t decisions_ = 0;
  int steps_per_decision_ = 5;
  std::int64_t next_key_ = 0;
  std::set<std::string> seen_;
  std::map<std::string, Guest> guests_;
  std::map<std::int64_t, std::string> ids_;
  std::map<std::string, ParkingEvent> events_;
  std::map<std::string, VehicleType> types_;
  std::vector<Replan> replans_;
};

}  // namespace mvtp
