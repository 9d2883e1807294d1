#pragma once

#include <stdexcept>
#include <string>

namespace mvtp {

/// Bad input from outside: a file, an option, a scenario. The tools print it in one line and exit 2.
///
/// what() reads "WHERE: WHAT; REMEDY", e.g.
/// "cross.yaml: agents[3].goal: the footprint at (12.00, 4.00) overlaps obstacles[7] by 0.21 m; move
/// the goal or the obstacle".
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& where, const std::string& what)
      : std::runtime_error(where + ": " + what) {}
};

}  // namespace mvtp
