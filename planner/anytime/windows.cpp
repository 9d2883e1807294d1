#include "planner/anytime/windows.hpp"

namespace mvtp {
namespace {

constexpr double kConflictsPerRobot = 1.0;
constexpr int kWindow = 12;     ///< [macro steps]
constexpr int kLookahead = 20;  ///< searches see so much further than the window [macro steps]

}  // namespace

bool needs_windows(const JointMotion& motion) {
  return double(motion.conflicts().size()) > kConflictsPerRobot * motion.size();
}

bool resolve_by_windows(JointMotion& motion, const std::function<bool()>& resolve) {
  motion.restore({motion.trajectories(), kWindow, kWindow + kLookahead});
  for (int end = kWindow; resolve(); end += kWindow) {
    if (!motion.has_horizon()) return true;
    if (end * motion.time().macro_step > motion.makespan()) {
      motion.set_horizon(JointMotion::kNoHorizon, JointMotion::kNoHorizon);
      return true;
    }
    motion.set_horizon(end + kWindow, end + kWindow + kLookahead);
  }
  return false;
}

}  // namespace mvtp
