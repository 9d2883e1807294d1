#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/toio/cube/predictor.hpp"
#include "tools/toio/plan/reference.hpp"
#include "tools/toio/plan/run_file.hpp"

namespace mvtp {

/// @throws InputError unless the margins of the run allow for how exactly cubes follow in `mode`.
/// @param where names the run in the message.
void require_mode(const ToioRun& run, DriveMode mode, const std::string& where);

struct PlayerOptions {
  DriveMode mode = DriveMode::kTrack;  ///< kTrack or kTarget
  bool gating = true;                  ///< keep the release graph; false only to show its worth
  double lag = 0.13;                   ///< see Predictor [s]
};

/// Why a cube does not follow its path for now.
enum class Fault { kNone, kSilent, kOffMat, kBumped, kOffPath, kLinkLost };
[[nodiscard]] const char* to_string(Fault fault);

/// How one robot fared.
struct RobotOutcome {
  bool arrived = false;
  double arrival = 0.0;       ///< since the start [s]
  double waited = 0.0;        ///< for others to leave [s]
  double held = 0.0;          ///< while its own cube was late [s]
  double most_lateral = 0.0;  ///< beside its path, as reported [m]
  double most_along = 0.0;    ///< from where it should be, as predicted [m]
  Fault fault = Fault::kNone;
  std::optional<MatPose> last_seen;
};

/// Drives cubes along a run: the one and same code for emulated and real ones.
///
/// Each robot has a clock of its own on its schedule. It runs as time does, but not into a segment
/// that the release graph holds back, nor past a cusp before the cube has come there, and it goes
/// back where the cube is late. Whom others wait for is judged by what his cube reports, never by
/// the clock. The cube tracks its reference with the law of Kanayama et al., "A stable tracking
/// control method for an autonomous mobile robot", ICRA 1990, from the predicted pose.
///
/// Every command carries an end (RunTiming::dead_man): a cube that hears nothing stops.
class Player {
 public:
  Player(const ToioRun& run, const PlayerOptions& options);

  /// Robot i's cube notified something.
  void receive(std::size_t i, const CubeEvent& event, double now);
  /// The link to robot i's cube is lost.
  void lose(std::size_t i);
  /// It is there again.
  void regain(std::size_t i, double now);
  void pause(bool paused) { paused_ = paused; }
  [[nodiscard]] bool paused() const { return paused_; }

  /// What to write to each cube now, by robot; nothing to lost ones. To be called every
  /// RunTiming::control seconds; `now` is the time since the start, pauses included.
  [[nodiscard]] std::vector<std::optional<Write>> tick(double now);

  [[nodiscard]] bool finished() const;
  /// Nobody has got anywhere for long, and nobody will: a cube is lost or blocked.
  [[nodiscard]] bool stuck(double now) const;
  [[nodiscard]] RobotOutcome outcome(std::size_t i) const;
  /// Robot i's clock: where on its schedule it is to be [s].
  [[nodiscard]] double clock(std::size_t i) const { return clocks_[i]; }
  [[nodiscard]] const Reference& reference(std::size_t i) const { return references_[i]; }

 private:
  struct Robot {
    Predictor predictor;
    RobotOutcome outcome;
    std::optional<Pose> seen;  ///< as last reported
    double heard_at = 0.0;     ///< when
    bool off_mat = false;
    double bumped_until = 0.0;  ///< stays where it is until then [s]
    bool at_target = false;     ///< the cube says that it came to the last target
    bool lost = false;
    double rate = 0.0;         ///< of the clock, 0 ... 1
    double next_target = 0.0;  ///< when to send the next target [s]
  };

  void note_progress(std::size_t i, double now);
  [[nodiscard]] Fault fault_of(std::size_t i, double now) const;
  [[nodiscard]] double limit_of(std::size_t i) const;
  void advance(std::size_t i, double limit, double period);
  [[nodiscard]] Write command(std::size_t i, double limit, double now);
  [[nodiscard]] Twist steer(std::size_t i, const Pose& predicted) const;
  bool pull_back(std::size_t i, double now);

  const ToioRun& run_;
  PlayerOptions options_;
  std::vector<Reference> references_;
  std::vector<Robot> robots_;
  std::vector<double> clocks_;   ///< by robot: where the cube is to be at most
  std::vector<double> reached_;  ///< by robot: where it is at least
  double last_tick_ = 0.0;
  double last_progress_ = 0.0;
  bool paused_ = false;
};

}  // namespace mvtp
