#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/problem/instance_file.hpp"
#include "tools/view/replay.hpp"

namespace mvtp {

/// What `mvtp view` shows.
struct ViewRequest {
  /// Plans, instances, and pages of replays, shown side by side in this order.
  std::vector<std::string> files{};
  /// The instances of the plans: one for each plan, or one for all. Without any, files that are no
  /// pages are instances.
  std::vector<std::string> instances{};
  /// Short names, one for each replay; empty: those that the replays have, else the files' names.
  std::vector<std::string> labels{};
  std::string title{};  ///< empty: the file's name
  InstanceReadOptions reading{};
};

/// Reads everything that the request names.
/// @throws InputError if a file is none of the three kinds, or the counts do not fit.
[[nodiscard]] std::vector<Replay> load_replays(const ViewRequest& request);

}  // namespace mvtp
