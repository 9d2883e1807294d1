#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/toio/cube/mat_frame.hpp"
#include "tools/toio/device/bluetooth.hpp"

namespace mvtp {

/// Connected cubes, ready to drive; stopped and let go when this ends, whatever the reason.
///
/// Single messages may get lost. So whatever is said to a cube once is said again until the cube
/// confirms it, and stop commands until its reports show that it stands.
class CubeSession {
 public:
  explicit CubeSession(Bluetooth& bluetooth);
  CubeSession(const CubeSession&) = delete;
  CubeSession& operator=(const CubeSession&) = delete;
  ~CubeSession();

  /// Connects a cube, and asks it for positions all the time.
  /// @throws BluetoothError if it cannot be connected, its firmware is too old or its battery low.
  void add(const FoundCube& cube);
  /// Tries to get a cube back whose link is lost. Does not wait for the link: to be called again
  /// until it says true, once the cube is ready to drive.
  [[nodiscard]] bool regain(const FoundCube& cube);

  [[nodiscard]] const std::vector<FoundCube>& cubes() const { return cubes_; }
  [[nodiscard]] Bluetooth& bluetooth() const { return bluetooth_; }

  /// Called for whatever one of the cubes notifies.
  void on_notification(std::function<void(const std::string& path, const Notification&)> handler) {
    handler_ = std::move(handler);
  }

  /// Where a cube says that it is; nullopt if it does not see the mat or says nothing.
  [[nodiscard]] std::optional<MatPose> place(const std::string& path) const;
  /// Waits until every cube has told where it is, or that it does not see the mat; at most so long
  /// [s].
  void await_places(double seconds);

 private:
  using Clock = std::chrono::steady_clock;

  /// What a cube has told.
  struct Told {
    std::string version;
    std::map<std::uint8_t, std::uint8_t> settings;  ///< results by the answer's type byte
    std::optional<MatPose> place;
    Clock::time_point heard;  ///< when it last told its place
    MatPose rest;             ///< where it has hardly moved from since
    Clock::time_point moved;
    bool saw_or_missed = false;
  };

  void hear(const std::string& path, const Notification& notification);
  void hear_place(Told& told, const MatPose& place);
  /// Asks until the answer has come, or for kAskTime. @return whether it came.
  bool ask(const FoundCube& cube, const CubeCommand& question,
           const std::function<bool(const Told&)>& answered);
  void require_setting(const FoundCube& cube, const CubeCommand& setting, std::uint8_t answer);
  void listen_to(const FoundCube& cube);
  /// Has it report its position all the time, so that silence means trouble.
  void set_up(const FoundCube& cube);
  void refuse_unfit(const FoundCube& cube);
  [[nodiscard]] bool stands_since(const FoundCube& cube, Clock::time_point begin) const;
  /// Tells every cube to stop until all stand.
  void stop_all();

  Bluetooth& bluetooth_;
  std::vector<FoundCube> cubes_;
  std::map<std::string, Told> told_;  ///< by path
  std::function<void(const std::string& path, const Notification&)> handler_;
};

/// The cubes that answer, until there are `count`; those named are waited for.
/// @throws BluetoothError that says how many or which are missing.
[[nodiscard]] std::vector<FoundCube> find_cubes(Bluetooth& bluetooth, std::size_t count,
                                                const std::vector<std::string>& named,
                                                double seconds);

/// Is the cube called so, by address or name, whole or its last three signs?
[[nodiscard]] bool is_called(const FoundCube& cube, const std::string& name);

}  // namespace mvtp
