#include "planner/algorithms/road_contact.hpp"

#include "planner/motion/oriented_box.hpp"

namespace mvtp {
namespace {

/// Is `a`, standing where it is, in the way of the rest of the path of `b`? Not if only its margins
/// are, of two that stand too close.
bool stands_in_the_way(const ContactTable& seen_from_a, const RoadVehicle& a,
                       const RoadVehicle& b) {
  constexpr double kClose = 1.0;  // [m]: longer than any margin, shorter than any vehicle
  return seen_from_a.blocks(a.now.s, b.now.s + kClose, std::max(b.now.s + kClose, b.s_end));
}

}  // namespace

RoadContact::RoadContact(const RoadScene& scene, const RoadVehicle& a, const RoadVehicle& b,
                         double reaction)
    : library_(scene.library),
      ab_(&scene.library->contacts(a.path, b.path)),
      ba_(ab_->empty() ? ab_ : &scene.library->contacts(b.path, a.path)),
      a_(&a),
      b_(&b),
      reaction_(reaction) {
  if (ab_->empty() || !touch_braking(a.now, b.now, false)) return;
  const BrakingMotion stop_a{a.now, library_->body(a.path).max_decel, reaction};
  const BrakingMotion stop_b{b.now, library_->body(b.path).max_decel};
  least_gap_ = gap(a.now.s, b.now.s);
  for (int i = 1; i <= std::max(stop_a.looks(), stop_b.looks()); ++i) {
    least_gap_ = std::min(least_gap_, gap(stop_a.position(i), stop_b.position(i)));
  }
  close_ = true;
}

bool RoadContact::touch_braking(const InertialState& a, const InertialState& b,
                                bool lenient) const {
  const BrakingMotion stop_a{a, library_->body(a_->path).max_decel, reaction_};
  const BrakingMotion stop_b{b, library_->body(b_->path).max_decel};
  if (!ab_->reaches(a.s, stop_a.rest(), b.s, stop_b.rest())) return false;
  // Mostly it is where they come to rest that they touch, if at all.
  if (!lenient && ab_->touches(stop_a.rest(), stop_b.rest())) return true;
  // At least one look, for two that stand.
  const int looks = std::max({1, stop_a.looks(), stop_b.looks()});
  return touch([&](int i) { return stop_a.position(i); }, [&](int i) { return stop_b.position(i); },
               looks, lenient);
}

double RoadContact::gap(double s_a, double s_b) const {
  return separation(footprint(library_->body(a_->path), library_->path(a_->path).at(s_a)),
                    footprint(library_->body(b_->path), library_->path(b_->path).at(s_b)));
}

namespace {

/// Is vehicle `a` ahead of `b` on the path of `b`, along it?
bool drives_ahead(const RoadScene& scene, const RoadVehicle& a, const RoadVehicle& b) {
  constexpr double kAhead = 100.0;  // [m]
  constexpr double kAside = 1.2;    // [m]
  constexpr double kTurned = 0.5;   // [rad]
  const Pose pose = scene.library->path(a.path).at(a.now.s);
  const GuidePath& path = scene.library->path(b.path);
  const Pose near = path.at(path.project({pose.x, pose.y}, b.now.s, b.now.s + kAhead));
  return distance(near, pose) < kAside && std::abs(wrap_to_pi(near.theta - pose.theta)) < kTurned;
}

}  // namespace

RoadPairs::RoadPairs(const RoadScene& scene)
    : scene_(&scene),
      leads_(scene.vehicles.size() * scene.vehicles.size(), false),
      follows_(scene.vehicles.size() * scene.forecasts.size(), false) {
  const std::size_t n = scene.vehicles.size();
  vehicles_.reserve(n * (n > 0 ? n - 1 : 0) / 2);
  forecasts_.reserve(n * scene.forecasts.size());
  for (std::size_t j = 0; j < n; ++j) {
    const RoadVehicle& b = scene.vehicles[j];
    for (std::size_t i = 0; i < j; ++i) {
      const RoadVehicle& a = scene.vehicles[i];
      const RoadContact& contact = vehicles_.emplace_back(scene, a, b, 0.0);
      if (contact.never()) continue;
      const bool a_in_the_way = stands_in_the_way(contact.seen_from_a(), a, b);
      const bool b_in_the_way = stands_in_the_way(contact.seen_from_b(), b, a);
      leads_[i * n + j] = a_in_the_way && !b_in_the_way;
      leads_[j * n + i] = b_in_the_way && !a_in_the_way;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t f = 0; f < scene.forecasts.size(); ++f) {
      const RoadVehicle& a = scene.vehicles[i];
      const RoadVehicle& b = scene.forecasts[f].vehicle;
      const RoadContact& contact = forecasts_.emplace_back(scene, a, b, kReaction);
      if (contact.never()) continue;
      follows_[i * scene.forecasts.size() + f] =
          stands_in_the_way(contact.seen_from_a(), a, b) &&
          !stands_in_the_way(contact.seen_from_b(), b, a) &&
          (scene.forecasts[f].yields || drives_ahead(scene, a, b));
    }
  }
}

}  // namespace mvtp
