#pragma once

#include <string>
#include <vector>

namespace mvtp {

/// An instance file to run on.
struct InstancePath {
  std::string file;  ///< to open it
  std::string name;  ///< relative to the deepest folder that holds all that was asked for

  friend bool operator==(const InstancePath&, const InstancePath&) = default;
};

/// The files named by `paths`, and those below folders that are named: *.yaml, *.yml and *.json but
/// for plans and hidden files. Each once, ordered by name, numbers in names by their value.
/// @throws InputError if a path does not exist, or a folder holds no instance.
[[nodiscard]] std::vector<InstancePath> find_instances(const std::vector<std::string>& paths);

}  // namespace mvtp
