#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "planner/problem/instance.hpp"
#include "planner/problem/pose.hpp"
#include "tools/view/replay_tubes.hpp"

namespace mvtp {

/// Who drives a vehicle and how, in the words of the page's legend.
enum class ReplayState : std::uint8_t {
  kCarFollowing,  ///< not under our control: SUMO's car following
  kCoordinated,   ///< follows our plan
  kWaiting,       ///< under our control, standing because its plan says so
  kArrived,       ///< at its goal for good
  kParked,        ///< stands in a slot or at a scheduled stop
  kWalking,       ///< a person on foot
};

// Members have initialisers, so that designated ones may be left out without a warning.

/// A vehicle, or a person on foot, who is drawn as a disc as wide as the body.
struct ReplayVehicle {
  std::string id{};
  std::string kind{};      ///< type of vehicle or preset; may be empty
  double length = 3.0;     ///< [m], > 0
  double width = 2.0;      ///< [m], > 0
  double front = 2.5;      ///< from the rear axle to the front bumper [m]
  double max_speed = 0.0;  ///< limit drawn in the speed plot [m/s]; 0: none
  std::optional<Pose> start{};
  std::optional<Pose> goal{};
  bool person = false;
  bool automated = true;   ///< false: it keeps its human driver wherever it goes
  std::string movement{};  ///< "FROM>TO", the first and the last edge of its route; may be empty
};

/// One vehicle at one moment.
struct ReplayVehicleState {
  std::size_t vehicle = 0;  ///< index returned by ReplayRecorder::add_vehicle
  Pose pose{};              ///< rear axle
  double speed = 0.0;       ///< [m/s], negative in reverse
  ReplayState state = ReplayState::kCarFollowing;
  /// The first vehicle of the group that it is planned with; none: it is planned alone, or not.
  std::optional<std::size_t> group{};
  int rank = 0;                 ///< in the group's order of passage, 1 first; 0: in no group
  std::optional<double> co2{};  ///< [g/s]; none: not known
  std::optional<ReplayTube> tube{};
};

enum class ReplayEventKind : std::uint8_t {
  kOverlap,
  kPersonTouched,
  kOffRoad,
  kJump,
  kAcceleration,
  kHardBraking,
  kNote,
};

/// Something worth jumping to.
struct ReplayEvent {
  ReplayEventKind kind = ReplayEventKind::kNote;
  double time = 0.0;                    ///< [s]
  Point place{};                        ///< [m]
  std::vector<std::size_t> vehicles{};  ///< indices of those concerned
  double value = 0.0;                   ///< of overlaps and touches: minus their depth [m]
  std::string text{};                   ///< one line more, may be empty
};

/// One figure of the report, as text that is ready to show.
struct ReplayFigure {
  std::string label{};
  std::string value{};
  std::string unit{};
};

/// Who a lane is for.
enum class ReplayLaneKind : std::uint8_t { kCars, kBuses, kBicycles, kRail, kFoot };

struct ReplayLane {
  std::vector<Point> shape{};  ///< centre line [m]
  double width = 3.2;          ///< [m]
  bool internal = false;       ///< inside a junction: drawn without markings
  bool stop_line = false;      ///< ends at a junction
  ReplayLaneKind kind = ReplayLaneKind::kCars;
};

/// A crossing for people on foot.
struct ReplayCrossing {
  std::vector<Point> shape{};  ///< its middle, from kerb to kerb [m]
  double width = 4.0;          ///< [m]
};

/// One light of a traffic signal where it is drawn: a piece of a stop line.
struct ReplayLight {
  std::size_t signal = 0;  ///< index returned by ReplayRecorder::add_signal
  int index = 0;           ///< which of its lights
  Point from{};            ///< [m]
  Point to{};              ///< [m]
  /// Where those who obey it come to behind the junction [m]; none: people on foot obey it.
  std::optional<Point> target{};
};

/// The path of a corridor, and which control zone it leads through.
struct ReplayCorridor {
  int zone = 0;
  std::vector<Point> shape{};  ///< of the rear axle [m]
};

/// What does not move.
struct ReplayScene {
  std::vector<ReplayLane> lanes{};
  std::vector<Polygon> junctions{};
  std::vector<Polygon> zones{};  ///< coordinated junctions, drawn as outlines
  std::vector<Polygon> slots{};  ///< of parking lots
  std::vector<ReplayCrossing> crossings{};
  std::vector<ReplayLight> lights{};
  std::vector<ReplayCorridor> corridors{};
  std::vector<Circle> circles{};
  std::vector<Polygon> polygons{};
  std::optional<Point> border{};  ///< the map is [0, border.x] x [0, border.y]
};

/// How the speed of a state is to be read between two frames.
enum class ReplayMotion : std::uint8_t {
  kContinuous,  ///< the speed at that moment (SUMO)
  kSteps,       ///< held during the step that ends in that state (plans)
};

struct ReplayInfo {
  std::string title{};
  std::string label{};    ///< short name beside another replay: "traffic light"
  std::string command{};  ///< the command line that made the run
  std::string version{};  ///< of all programs involved
  std::string seed{};
  ReplayMotion motion = ReplayMotion::kContinuous;
};

/// A finished recording: a header as JSON text and the frames as packed columns (replay.cpp says
/// how).
struct Replay {
  std::string title;
  std::string header;
  std::string frames;
};

/// Replaces the short name of a replay.
[[nodiscard]] Replay with_label(Replay replay, const std::string& label);

/// Integers in 1 to 2 bytes each as long as they change evenly: second differences, zigzag, varint.
class ReplayColumn {
 public:
  void push(std::int64_t value);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] std::int64_t last() const { return last_; }

 private:
  std::string bytes_;
  std::int64_t last_ = 0;
  std::int64_t last_difference_ = 0;
  bool empty_ = true;
};

/// Integers that seldom change: pairs (how often, value) in a ReplayColumn.
class ReplayRuns {
 public:
  void push(std::int64_t value);
  /// @return the packed column, the last run included.
  [[nodiscard]] std::string bytes() const;

 private:
  ReplayColumn pairs_;
  std::int64_t value_ = 0;
  std::int64_t length_ = 0;
};

/// Records a run for the page, sampled and packed while it happens.
///
/// Positions are kept to 1 cm, headings to 0.1 deg, speeds to 2 cm/s, times to 1 ms: about 3 bytes
/// per vehicle and frame in the page. Between the frames the page moves vehicles along arcs.
class ReplayRecorder {
 public:
  /// @param interval of the kept frames [s]; 0 keeps every frame.
  ReplayRecorder(ReplayInfo info, ReplayScene scene, double interval = 0.5);

  /// Makes a vehicle known and returns its index.
  std::size_t add_vehicle(const ReplayVehicle& vehicle);

  /// What is said later of a vehicle that was made known.
  ReplayVehicle& vehicle(std::size_t index) { return vehicles_.at(index); }

  /// Makes a traffic signal known and returns its index.
  std::size_t add_signal(const std::string& id);
  /// What it shows from `time` [s] on, a letter for each light; may be told at every step.
  void add_lights(double time, std::size_t signal, const std::string& lights);
  void add_corridor(ReplayCorridor corridor) { scene_.corridors.push_back(std::move(corridor)); }

  /// Where the paths of tubes are made known.
  [[nodiscard]] ReplayTubes& tubes() { return tubes_; }

  /// Will a frame at this time [s] be kept?
  [[nodiscard]] bool is_due(double time) const;

  /// The state of all vehicles present at `time` [s]; call it at every step, it drops what the
  /// sampling does not need, but for the last frame. A vehicle that is not listed is not on the
  /// map. States whose numbers are not finite, or of a vehicle already listed, are left out.
  /// @param clearance smallest distance between any two vehicles [m]; between two kept frames the
  ///   smallest counts.
  /// @throws std::invalid_argument if `time` is not after the frame before, or a vehicle is
  /// unknown.
  void add_frame(double time, std::span<const ReplayVehicleState> states,
                 std::optional<double> clearance = std::nullopt);

  /// Adds an event; the frame of that moment, if it is the last one added, is kept.
  /// An event of the same kind and vehicles as one that lasted until less than a second ago
  /// continues it, with the worse of the two values, so it may be reported at every step.
  void add_event(const ReplayEvent& event);

  void add_figure(const ReplayFigure& figure) { figures_.push_back(figure); }

  [[nodiscard]] Replay finish();

 private:
  struct Track {
    std::size_t vehicle = 0;
    std::size_t first_frame = 0;
    std::size_t count = 0;
    ReplayColumn x{}, y{}, heading{}, speed{}, co2{};
    ReplayRuns state{}, group{}, rank{};
  };
  struct Episode {
    ReplayEvent event;
    double end = 0.0;
  };
  /// What a signal shows, from when on.
  struct Signal {
    std::string id;
    std::vector<std::pair<double, std::string>> shown;
  };

  void keep_pending();
  void append(const ReplayVehicleState& state);
  [[nodiscard]] std::string columns() const;

  ReplayInfo info_;
  ReplayScene scene_;
  double interval_;
  std::vector<ReplayVehicle> vehicles_;
  std::vector<std::size_t> track_of_;  ///< per vehicle: its latest track, or kNone
  std::vector<Track> tracks_;
  std::vector<Episode> episodes_;
  std::vector<Signal> signals_;
  std::vector<ReplayFigure> figures_;
  ReplayTubes tubes_;

  std::size_t frames_ = 0;
  ReplayColumn times_;
  ReplayColumn clearances_;
  bool has_clearance_ = false;
  bool has_groups_ = false;
  bool has_emissions_ = false;
  double next_due_ = -std::numeric_limits<double>::infinity();
  double first_time_ = 0.0;
  std::optional<double> last_time_;
  std::optional<double> clearance_;  ///< since the last kept frame
  /// The latest frame, while the sampling has not asked for it.
  std::vector<ReplayVehicleState> pending_;
  bool is_pending_ = false;
};

}  // namespace mvtp
