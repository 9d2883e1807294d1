#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/view/replay.hpp"

namespace mvtp {

/// A run to draw, with the name that its panel gets.
struct LabelledReplay {
  std::string label;
  std::string where;  ///< names the file in messages
  const Replay* replay = nullptr;
};

/// What to draw: see TimeSpaceDiagram.
struct TimeSpaceRequest {
  std::string movement;         ///< "FROM>TO"; empty: that of most vehicles
  std::optional<double> begin;  ///< [s]; none: the first frame
  std::optional<double> end;    ///< [s]; none: 300 s later, or the last frame
};

/// Where front bumpers are along a movement, over time: of one vehicle in an unbroken row of
/// frames with one driver.
struct TimeSpaceLine {
  std::string driver;            ///< "controlled", "sumo" (automated, away from junctions), "human"
  std::vector<double> times;     ///< [s], ascending
  std::vector<double> stations;  ///< [m] along the movement
};

/// [m] along the movement, or [s].
struct Stretch {
  double from = 0.0;
  double to = 0.0;
};

/// A light on the movement, with what it shows.
struct TimeSpaceSignal {
  double station = 0.0;  ///< [m]
  struct Shown {
    Stretch time;
    char light = 'r';  ///< SUMO's letter in lower case: r, y, g, o, ...
  };
  std::vector<Shown> shown;
};

/// One run.
struct TimeSpacePanel {
  std::string label;
  std::vector<TimeSpaceLine> lines;   ///< of the movement's vehicles
  std::vector<TimeSpaceLine> others;  ///< of others, as long as they drive where these do
  std::vector<TimeSpaceSignal> signals;
  std::vector<Stretch> zones;  ///< where this run had vehicles under control
};

/// The time-space diagram of a movement: how far each vehicle has come, over time, in one or more
/// runs on one road.
///
/// Stations are arc lengths along the path of the longest trip of the movement.
struct TimeSpaceDiagram {
  std::string movement;
  Stretch time;         ///< [s]
  double length = 0.0;  ///< of the movement [m]
  std::vector<double> stop_lines;
  std::vector<Stretch> junctions;
  std::vector<TimeSpacePanel> panels;
};

/// @pre !runs.empty()
/// @throws InputError if a run has no vehicle of the movement, or its replay is damaged.
[[nodiscard]] TimeSpaceDiagram time_space_of(std::span<const LabelledReplay> runs,
                                             const TimeSpaceRequest& request);

}  // namespace mvtp
