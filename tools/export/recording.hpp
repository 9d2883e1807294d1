#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/problem/instance_file.hpp"
#include "planner/problem/plan.hpp"
#include "planner/problem/vehicle.hpp"
#include "tools/view/replay.hpp"

namespace mvtp {

/// A vehicle at one moment. The speed and the steering angle are those of the step that ends there,
/// and 0 at the first moment.
struct RecordedState {
  double time = 0.0;   ///< [s]
  Pose pose;           ///< rear axle
  double v = 0.0;      ///< [m/s], negative in reverse
  double steer = 0.0;  ///< [rad], positive to the left
};

struct RecordedVehicle {
  std::string id;
  std::string kind;  ///< type of vehicle in SUMO; may be empty
  Vehicle body;
  std::vector<RecordedState> states;  ///< in order of time, one per step while it was there
};

/// The motion of many vehicles, out of a plan or a SUMO run: what mvtp export writes.
struct Recording {
  std::string name;  ///< of the file or folder that it is from
  std::string date;  ///< when that was written, "2026-01-31"
  double dt = 1.0;   ///< [s] between two steps
  std::vector<RecordedVehicle> vehicles;
  ReplayScene scene;
  std::string network;  ///< SUMO network of the run; empty: unknown
};

/// @param vehicles  one for each name of the plan
[[nodiscard]] Recording recording_of(const Plan& plan, const std::vector<Vehicle>& vehicles);

/// Fills in the motion of every state from the arc that joins it with the one before: steer, the
/// sign of v, and v itself where it is NaN.
void fill_in_motion(RecordedVehicle& vehicle);

/// What mvtp export reads.
struct RecordingRequest {
  std::string input;     ///< a plan, or the folder of a run
  std::string instance;  ///< of the plan; empty: none
  InstanceReadOptions reading;
};

/// Reads a plan, or the folder that mvtp coordinate wrote. @throws InputError
[[nodiscard]] Recording read_recording(const RecordingRequest& request);

/// Reads the folder of a run: fcd.xml, and view.html for the vehicles' bodies and the lanes.
/// @throws InputError
[[nodiscard]] Recording read_run_recording(const std::string& folder);

/// The part from `begin` to `end` [s]; vehicles that are not there in it are left out.
void cut(Recording& recording, double begin, double end);

/// Vehicles that were away for a while become several, one for each stay: "a", "a+2", "a+3",
/// or the next number that nobody has. For formats in which a motion has no gaps.
void split_stays(Recording& recording);

}  // namespace mvtp
