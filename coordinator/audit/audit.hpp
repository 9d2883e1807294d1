#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/audit/footprint_motion.hpp"
#include "coordinator/network/drivable_area.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// A vehicle as the audit sees it after a step.
struct Observation {
  const VehicleState* state = nullptr;
  const VehicleType* type = nullptr;
  bool coordinated = false;  ///< placed by us in this step
};

/// What the audit found over a whole run; the keys of summary.json.
struct AuditFigures {
  bool between_steps = true;       ///< overlaps and clearances are those at and between the steps
  std::int64_t overlap_pairs = 0;  ///< pairs of vehicles that ever overlapped
  std::int64_t overlap_pairs_coordinated = 0;  ///< those with a coordinated vehicle
  std::int64_t overlap_vehicle_steps = 0;      ///< steps at whose end or before it one overlapped
  double min_clearance = std::numeric_limits<double>::infinity();  ///< [m] between two footprints
  std::int64_t people_touched = 0;      ///< pairs of a coordinated vehicle and a person
  std::int64_t people_touched_all = 0;  ///< pairs of any vehicle and a person
  double min_person_clearance = std::numeric_limits<double>::infinity();  ///< [m], coordinated
  std::int64_t off_road_steps = 0;  ///< vehicle-steps with part of the footprint off the road
  std::int64_t off_road_steps_coordinated = 0;

  // Coordinated vehicles in their control zone, at the rear axle, from the poses alone.
  double max_accel = 0.0;             ///< [m/s^2]
  double max_decel = 0.0;             ///< [m/s^2]
  double max_lateral_accel = 0.0;     ///< [m/s^2], over the last metre or second
  double max_curvature_ratio = 0.0;   ///< curvature x smallest turning radius
  double max_speed = 0.0;             ///< [m/s]
  std::int64_t accel_violations = 0;  ///< vehicle-steps beyond the vehicle's own accel or decel

  /// [m] moved in a way that no driving explains: sideways or by turning on the spot; at takeover
  /// and hand-back also along, beyond what the speed explains.
  double max_jump = 0.0;
  std::int64_t hard_brakings_after_handback = 0;  ///< vehicle-steps
};

enum class AuditEventKind : std::uint8_t {
  kOverlap,
  kPersonTouched,
  kOffRoad,
  kJump,          ///< more than any driving explains
  kAcceleration,  ///< beyond the vehicle's own limits
  kHardBraking,   ///< after a hand-back
};

/// Something that should not have happened, for the replay.
struct AuditEvent {
  AuditEventKind kind = AuditEventKind::kOverlap;
  double time = 0.0;  ///< [s]
  std::string what;   ///< in one line
  Point where;
  std::vector<std::string> who;  ///< ids of the vehicles, and of the person
  double depth = 0.0;            ///< [m] of an overlap or a touch
  bool coordinated = false;      ///< an overlap with a vehicle that we placed
};

/// The footprint audit: every vehicle at every step of the traffic and between the steps,
/// coordinated or not.
///
/// Works on what the traffic shows, and knows nothing of any plan. Who overlaps, and how deep, the
/// referee's geometry says (FCL), which shares nothing with what plans; how far apart others are is
/// measured by clearance().
///
/// Between two steps a body moves with a constant twist (footprint_motion.hpp), and overlaps deeper
/// than 1.1 mm are found at any moment, none of less than 1 mm is reported. Two cases are no motion
/// and count at the step only: who was not there in the last step, and a vehicle under the
/// traffic's own control that leaps by more than kLeap (a lane change within one step, a teleport).
class Audit {
 public:
  static constexpr double kTolerance = 1e-3;      ///< [m] of overlap that counts as touching
  static constexpr double kRoadTolerance = 0.05;  ///< [m] beside the road that counts as on it
  static constexpr double kAfterHandback = 3.0;   ///< [s]
  static constexpr double kJump = 0.05;           ///< [m] that show at a takeover or hand-back
  /// Sideways at the rear axle, or along beyond what its speed explains [m].
  static constexpr double kLeap = 1.0;

  /// All vehicles belong on `area`, the ground of motor vehicles. @param area  outlives the audit
  Audit(const DrivableArea& area, double step_length) : area_(area), dt_(step_length) {}
  /// Vehicles of a class with lanes of its own, e.g. bicycles, may be on these as well.
  /// @param area, network, lots  outlive the audit
  Audit(const DrivableArea& area, double step_length, const RoadNetwork& network,
        std::span<const ParkingLot> lots);

  /// @param sightings ordered by id.
  void observe(double time, std::span<const Observation> observations,
               std::span<const Pedestrian> people = {});

  [[nodiscard]] const AuditFigures& figures() const { return figures_; }
  [[nodiscard]] const std::vector<AuditEvent>& events() const { return events_; }
  /// Smallest distance between two vehicles in the last step [m]; none if all are 3 m apart.
  [[nodiscard]] std::optional<double> latest_clearance() const { return latest_clearance_; }
  /// Of each vehicle that ever was within 3 m of another [m].
  [[nodiscard]] const std::map<std::string, double>& clearances() const { return clearances_; }

 private:
  /// What a coordinated vehicle did in one step, at the rear axle.
  struct Stretch {
    double driven = 0.0;  ///< [m], negative in reverse
    double turned = 0.0;  ///< [rad]
  };

  struct Track {
    Pose pose;                    ///< rear axle
    double speed = 0.0;           ///< as the traffic says [m/s]
    std::optional<double> along;  ///< [m] that it drove in the last step
    std::vector<Stretch> recent;  ///< the last metre or second in one direction, oldest first
    bool coordinated = false;
    bool off_road = false;
    double handed_back = -1e9;  ///< when [s]
  };

  /// An observation with the motion that led there.
  struct Passage {
    const Observation* seen = nullptr;
    StepMotion motion;
    double from = 1.0;   ///< share of the step from which on the motion counts: 0, or 1 for none
    Pose middle;         ///< the rear axle half way
    double reach = 0.0;  ///< of the body around it during the step [m]
  };

  [[nodiscard]] std::vector<Passage> passages(std::span<const Observation> observations) const;
  [[nodiscard]] bool leaps(const Observation& now, const Track& before) const;
  void compare_with_people(double time, std::span<const Passage> passages,
                           std::span<const Pedestrian> people);
  void compare_with_person(double time, const Passage& passage, const Pedestrian& person,
                           bool walks, const Point& before);
  void compare_pairs(double time, std::span<const Passage> passages);
  /// @return whether the two overlap.
  bool compare(double time, const Passage& a, const Passage& b);
  void report_overlap(double time, const Passage& a, const Passage& b, const Pose& where,
                      double depth);
  void report(AuditEventKind kind, double time, const Observation& s, const std::string& what);
  void follow(double time, const Observation& observation);
  [[nodiscard]] const DrivableArea& ground_of(const std::string& vehicle_class);
  void judge_motion(double time, const Observation& s, const Track& before, Track& now);
  void judge_acceleration(double time, const Observation& s, double before, double now);
  [[nodiscard]] double jump(const Track& before, const Track& now, const Vehicle& body) const;

  const DrivableArea& area_;
  double dt_;
  const RoadNetwork* network_ = nullptr;  ///< none: no class has lanes of its own
  std::span<const ParkingLot> lots_;
  /// Of each class that was seen; none: `area_`.
  std::map<std::string, std::optional<DrivableArea>> grounds_;
  AuditFigures figures_;
  std::optional<double> latest_clearance_;
  std::vector<AuditEvent> events_;
  std::map<std::string, double> clearances_;
  std::map<std::string, Track> tracks_;
  std::map<std::string, Point> people_;  ///< in the last step
  std::set<std::pair<std::string, std::string>> overlapping_;
  std::set<std::pair<std::string, std::string>> overlapping_coordinated_;
  std::map<std::pair<std::string, std::string>, bool> touched_people_;  ///< by a coordinated one?
};

}  // namespace mvtp
