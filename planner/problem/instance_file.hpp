#pragma once

#include <optional>
#include <string>

#include "planner/problem/instance.hpp"

namespace mvtp {

/// How a file means its yaw: counter-clockwise from +x (mathematical, as CSDO), or clockwise (as
/// the solver of CL-CBS reads the very same field).
enum class YawSense { kCounterClockwise, kClockwise };

/// What the user says about an instance file beside what stands in it.
struct InstanceReadOptions {
  YawSense yaw = YawSense::kCounterClockwise;
  /// What must stay inside the map; nullopt: as the file says in `map.bounds`, else kAxle for a
  /// file without our extensions (the peers' rule; some of their starts stick out), else
  /// kFootprint.
  std::optional<Bounds> bounds = std::nullopt;
  /// Replaces the `vehicle` of the whole file, and the step duration unless the file has a `dt`;
  /// an agent's own `vehicle` stays. nullopt: as the file says, else the preset "escot".
  std::optional<std::string> vehicle_preset = std::nullopt;
  /// Duration of one step [s]; nullopt: `dt` of the file, else that of the vehicle preset.
  std::optional<double> dt = std::nullopt;
  InitialOverlap initial_overlap = InitialOverlap::kRefuse;
};

/// Reads an instance: YAML in the format of CL-CBS and CSDO with our extensions, or JSON in the one
/// of Guo and Yu's CarLikePlanning; docs/file-formats.md has every key.
///
/// Only the form is judged here; whether starts and goals are free is check_instance()'s affair.
/// @throws InputError "FILE: agents[3].goal: ..." at the first value that is missing, of a wrong
/// type, not finite, out of range, or unknown.
[[nodiscard]] Instance read_instance(const std::string& path,
                                     const InstanceReadOptions& options = {});

/// The same for the text of such a file. @param name  stands for the file in messages
[[nodiscard]] Instance parse_instance(const std::string& name, const std::string& text,
                                      const InstanceReadOptions& options = {});

/// How an instance file is written.
struct InstanceWriteOptions {
  YawSense yaw = YawSense::kCounterClockwise;
  /// Names the vehicle even where it is the default, so that the file does not lean on it.
  bool name_vehicle = false;
  std::string description;  ///< kept in the file for its readers; empty: none
};

/// Writes the YAML format; read_instance() gives back the same instance, bit by bit.
///
/// A vehicle that all agents share is named by its preset where one fits, so that `vehicle_preset`
/// of InstanceReadOptions replaces it together with the step duration.
/// Without mixed vehicles, polygons and bounds kFootprint the file is one that CL-CBS can read.
void write_instance(const Instance& instance, const std::string& path,
                    const InstanceWriteOptions& options = {});

/// What write_instance() writes.
[[nodiscard]] std::string instance_text(const Instance& instance,
                                        const InstanceWriteOptions& options = {});

}  // namespace mvtp
