#include "tests/planner/fcl_reference.hpp"

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <memory>

namespace mvtp {
namespace {

fcl::CollisionObjectd object(const OrientedBox& box) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  transform.linear() << box.ux, -box.uy, 0, box.uy, box.ux, 0, 0, 0, 1;
  transform.translation() << box.x, box.y, 0;
  return {std::make_shared<fcl::Boxd>(2 * box.half_length, 2 * box.half_width, 1.0), transform};
}

bool overlap(const fcl::CollisionObjectd& a, const fcl::CollisionObjectd& b) {
  fcl::CollisionResultd result;
  return fcl::collide(&a, &b, fcl::CollisionRequestd(), result) > 0;
}

}  // namespace

double fcl_distance(const OrientedBox& a, const OrientedBox& b) {
  if (fcl_overlap(a, b)) return 0.0;
  const fcl::CollisionObjectd first = object(a);
  const fcl::CollisionObjectd second = object(b);
  fcl::DistanceResultd result;
  return fcl::distance(&first, &second, fcl::DistanceRequestd(), result);
}

bool fcl_overlap(const OrientedBox& a, const OrientedBox& b) {
  return overlap(object(a), object(b));
}

bool fcl_overlap(const OrientedBox& box, const Point& centre, double radius) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  transform.translation() << centre.x, centre.y, 0;
  const fcl::CollisionObjectd disc(std::make_shared<fcl::Cylinderd>(radius, 1.0), transform);
  return overlap(object(box), disc);
}

}  // namespace mvtp
