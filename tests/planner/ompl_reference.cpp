#include "tests/planner/ompl_reference.hpp"

#include <ompl/base/ScopedState.h>
#include <ompl/base/spaces/ReedsSheppStateSpace.h>

#include <memory>

namespace mvtp {

double ompl_reeds_shepp_length(const Pose& from, const Pose& to, double radius) {
  using Space = ompl::base::ReedsSheppStateSpace;
  const auto space = std::make_shared<Space>(radius);
  ompl::base::ScopedState<Space> a(space);
  ompl::base::ScopedState<Space> b(space);
  a->setXY(from.x, from.y);
  a->setYaw(from.theta);
  b->setXY(to.x, to.y);
  b->setYaw(to.theta);
  return space->distance(a.get(), b.get());
}

}  // namespace mvtp
