#pragma once

#include <map>
#include <set>
#include <string>

#include "coordinator/traffic.hpp"

namespace mvtp {

/// Who keeps drivers in their lanes, so that nobody lets go whom another one still keeps.
class LaneKeeping {
 public:
  enum class Reason {
    kSignal,  ///< he is near his line, with a light of the coordinator
    kGuest,   ///< he passes a junction as a guest
    kBeside,  ///< somebody under control is beside him, or will be
    kExit,    ///< somebody under control leaves a junction onto a lane beside his
  };

  /// @param traffic  must outlive it.
  explicit LaneKeeping(Traffic& traffic) : traffic_(traffic) {}

  /// From now on there is this reason to keep him in his lane, or there is none.
  void keep(const std::string& id, Reason reason, bool keep);
  /// From now on there is this reason to keep these in their lanes, and nobody else.
  void keep_only(std::set<std::string> ids, Reason reason);

 private:
  void show(const std::string& id);

  Traffic& traffic_;
  std::map<Reason, std::set<std::string>> kept_;
};

}  // namespace mvtp
