#include "planner/road/road_contact.hpp"

#include "planner/geometry/oriented_box.hpp"

namespace mvtp {
namespace {

constexpr double kBareGap = 0.05;  ///< [m] between two that are stuck
constexpr double kClose = 1.0;     ///< [m]: longer than any margin, shorter than any vehicle
constexpr double kGraze = 0.5;     ///< [m] by which two in one lane may overlap at their sides
constexpr double kNotice = 2.0;    ///< [s] until a driver answers to who has come into his lane
constexpr double kAside = 1.2;     ///< [m]: no further from a path is who is on it
constexpr double kNextLane = 6.0;  ///< [m]: no further aside is who comes over from the next lane
constexpr double kTurned = 0.5;    ///< [rad] and drive the same way

/// Half of what `b` covers along the axis of `a` [m].
double half_depth(const OrientedBox& a, const OrientedBox& b) {
  return b.half_length * std::abs(a.ux * b.ux + a.uy * b.uy) +
         b.half_width * std::abs(a.ux * b.uy - a.uy * b.ux);
}

/// From `a` to `b` along the axis of `a` [m].
double distance_along(const OrientedBox& a, const OrientedBox& b) {
  return (b.x - a.x) * a.ux + (b.y - a.y) * a.uy;
}

/// How far `b` is beyond the sides of `a` [m].
double gap_across(const OrientedBox& a, const OrientedBox& b) {
  return std::abs((b.y - a.y) * a.ux - (b.x - a.x) * a.uy) - a.half_width -
         b.half_length * std::abs(a.ux * b.uy - a.uy * b.ux) -
         b.half_width * std::abs(a.ux * b.ux + a.uy * b.uy);
}

/// Is one of them behind the other, rather than beside it or across its path?
bool follow_each_other(const OrientedBox& a, const OrientedBox& b) {
  constexpr double kAligned = 0.7;  // cosine
  const double along = std::abs(distance_along(a, b)) - a.half_length - half_depth(a, b);
  return a.ux * b.ux + a.uy * b.uy > kAligned && along >= gap_across(a, b);
}

/// How far from a vehicle others are looked for along its path [m].
struct LookAlong {
  double behind;
  double ahead;
};
constexpr LookAlong kAhead{30.0, 100.0};
constexpr LookAlong kBehind{100.0, 30.0};

/// Where a vehicle is beside the path of another one that drives the same way.
struct BesidePath {
  double along;   ///< [m] ahead of that one
  double aside;   ///< [m] from the path
  double turned;  ///< [rad] away from its direction
  double off;     ///< [m] ahead of or behind the part of the path that was looked at
};

/// Where `a` is, seen from `b`.
BesidePath beside_path(const PathLibrary& library, const PlaceOnPath& a, const PlaceOnPath& b,
                       const LookAlong& look) {
  const Pose pose = library.path(a.path).at(a.s);
  const ReferencePath& path = library.path(b.path);
  const double foot = path.project({pose.x, pose.y}, b.s - look.behind, b.s + look.ahead);
  const Pose local = relative(path.at(foot), pose);
  return {foot - b.s, std::abs(local.y), std::abs(local.theta), std::abs(local.x)};
}

bool is_on_path(const BesidePath& at) {
  return at.off < kAside && at.aside < kAside && at.turned < kTurned;
}

bool is_in_next_lane(const BesidePath& at) {
  return at.off < kAside && at.aside >= kAside && at.aside < kNextLane && at.turned < kTurned;
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
  stuck_ = a.stuck && b.stuck;
  if (ab_->empty() || (!stuck_ && !touch_braking(a.now, b.now, false))) return;
  const OrientedBox box_a = footprint(library_->body(a.path), library_->path(a.path).at(a.now.s));
  const OrientedBox box_b = footprint(library_->body(b.path), library_->path(b.path).at(b.now.s));
  b_ahead_ = distance_along(box_a, box_b) > 0.0;
  in_one_lane_ = follow_each_other(box_a, box_b);
  const BrakingProfile stop_a{a.now, library_->body(a.path).max_decel, reaction};
  const BrakingProfile stop_b{b.now, library_->body(b.path).max_decel};
  const double gap_now = gap(a.now.s, b.now.s);
  least_gap_ = gap_now;
  for (int i = 1; i <= std::max(stop_a.looks(), stop_b.looks()); ++i) {
    least_gap_ = std::min(least_gap_, gap(stop_a.position(i), stop_b.position(i)));
  }
  too_late_ = gap_now >= 0.0 && least_gap_ < 0.0;
  if (stuck_) least_gap_ = std::min(least_gap_, kBareGap);
  close_ = true;
}

bool RoadContact::touch_braking(const InertialState& a, const InertialState& b,
                                bool lenient) const {
  const BrakingProfile stop_a{a, library_->body(a_->path).max_decel, reaction_};
  const BrakingProfile stop_b{b, library_->body(b_->path).max_decel};
  if (!ab_->reaches(a.s, stop_a.rest(), b.s, stop_b.rest())) return false;
  // Mostly it is where they come to rest that they touch, if at all.
  if (!lenient && ab_->touches(stop_a.rest(), stop_b.rest())) return true;
  // At least one look, for two that stand.
  const int looks = std::max({1, stop_a.looks(), stop_b.looks()});
  return touch_though_they_brake([&](int i) { return stop_a.position(i); },
                                 [&](int i) { return stop_b.position(i); }, looks, lenient);
}

bool RoadContact::a_blocks(const InertialState& a, const InertialState& b) const {
  return ab_->blocks(a.s, b.s + kClose, std::max(b.s + kClose, b_->s_end));
}

bool RoadContact::b_blocks(const InertialState& a, const InertialState& b) const {
  return ba_->blocks(b.s, a.s + kClose, std::max(a.s + kClose, a_->s_end));
}

bool RoadContact::a_is_beside(const InertialState& a, const InertialState& b) const {
  return is_in_next_lane(beside_path(*library_, {a_->path, a.s}, {b_->path, b.s}, kAhead));
}

bool RoadContact::a_is_alongside(const InertialState& a, const InertialState& b,
                                 double closing) const {
  const Vehicle& body_a = library_->body(a_->path);
  const Vehicle& body_b = library_->body(b_->path);
  const double behind = -(body_a.front + body_b.rear);
  const double ahead = body_b.front + body_a.rear + closing;
  // As seen from `b`, which is nearly what its path says, and much quicker to say.
  constexpr double kNearly = 3.0;  // [m], and half a radian
  const Pose local = relative(library_->path(b_->path).at(b.s), library_->path(a_->path).at(a.s));
  const bool may_be = local.x > behind - kNearly && local.x < ahead + kNearly &&
                      std::abs(local.y) > kAside / 2 && std::abs(local.y) < kNextLane + kNearly &&
                      std::abs(local.theta) < kTurned + 0.5;
  if (!may_be) return false;
  const BesidePath at = beside_path(*library_, {a_->path, a.s}, {b_->path, b.s}, kAhead);
  return is_in_next_lane(at) && at.along > behind && at.along < ahead;
}

bool RoadContact::cuts_off(const InertialState& a, const InertialState& b) const {
  const BrakingProfile stop_a{a, library_->body(a_->path).max_decel, 0.0};
  const BrakingProfile stop_b{b, library_->body(b_->path).max_decel, kNotice};
  if (!ab_->reaches(a.s, stop_a.rest(), b.s, stop_b.rest())) return false;
  const int looks = std::max({1, stop_a.looks(), stop_b.looks()});
  return meet([&](int i) { return stop_a.position(i); }, [&](int i) { return stop_b.position(i); },
              0, looks);
}

/// Of two in one lane along it: where one drives on into the other, and through it, that goes on to
/// shrink, unlike their separation.
double RoadContact::gap(double s_a, double s_b) const {
  const OrientedBox a = footprint(library_->body(a_->path), library_->path(a_->path).at(s_a));
  const OrientedBox b = footprint(library_->body(b_->path), library_->path(b_->path).at(s_b));
  const double across = std::max(gap_across(a, b), gap_across(b, a));
  if (!in_one_lane_ || across > -kGraze) return separation(a, b);
  return (b_ahead_ ? 1.0 : -1.0) * distance_along(a, b) - a.half_length - half_depth(a, b);
}

/// Is the gap anywhere between these positions too small, to the length of a finger? Halves them
/// until no point of a body can have moved by as much as they are apart.
bool RoadContact::dips(double a, double a_end, double b, double b_end) const {
  constexpr double kFinger = 0.05;  // [m] of both, along their paths
  constexpr double kSwing = 2.0;    // by which the nose of a car that turns moves further than that
  const double moved = (a_end - a) + (b_end - b);
  if (moved <= kFinger) return false;
  const double middle_a = 0.5 * (a + a_end);
  const double middle_b = 0.5 * (b + b_end);
  const double there = gap(middle_a, middle_b);
  if (there < std::min(least_gap_, 0.5 * least_gap_) - kNoWorse) return true;
  if (there > least_gap_ + 0.5 * kSwing * moved) return false;
  return dips(a, middle_a, b, middle_b) || dips(middle_a, a_end, middle_b, b_end);
}

bool drives_ahead(const PathLibrary& library, const PlaceOnPath& a, const PlaceOnPath& b) {
  const BesidePath ahead = beside_path(library, a, b, kAhead);
  if (ahead.along > 0.0 && is_on_path(ahead)) return true;
  const BesidePath behind = beside_path(library, b, a, kBehind);
  return behind.along < 0.0 && is_on_path(behind);
}

namespace {

bool drives_ahead(const RoadScene& scene, const RoadVehicle& a, const RoadVehicle& b) {
  return drives_ahead(*scene.library, {a.path, a.now.s}, {b.path, b.now.s});
}

/// Does a driver keep behind `a`, which is ahead of him?
bool keeps_behind(const RoadScene& scene, const Forecast& driver, const RoadVehicle& a,
                  const RoadContact& contact) {
  const RoadVehicle& b = driver.vehicle;
  // Who has been told to pass looks at nobody who leaves his path on the junction.
  if (driver.told == Told::kToPass && a.is_on_junction() &&
      !contact.a_blocks({a.s_exit_lane, 0.0}, b.now)) {
    return false;
  }
  // Who has only a part of it in his path follows it if he can still stop behind it; if he
  // stands, and it comes over into his lane, he stands because of it.
  const bool stands_behind = b.now.v == 0.0 && contact.a_is_beside(a.now, b.now);
  return drives_ahead(scene, a, b) || stands_behind ||
         (driver.yields && !contact.touch_braking(a.now, b.now, false));
}

}  // namespace

bool RoadPairs::matters(std::size_t j, std::size_t i) const {
  const RoadVehicle& a = scene_->vehicles[i];
  const RoadVehicle& b = scene_->vehicles[j];
  return a.exits_with(b) || !between(i, j).contact->never() ||
         !scene_->library->reserved(a.path, b.path).empty();
}

bool RoadPairs::is_behind(std::size_t i, std::size_t f) const {
  return drives_ahead(*scene_, scene_->forecasts[f].vehicle, scene_->vehicles[i]);
}

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
      const bool a_blocks = contact.a_blocks(a.now, b.now);
      const bool b_blocks = contact.b_blocks(a.now, b.now);
      leads_[i * n + j] = a_blocks && !b_blocks;
      leads_[j * n + i] = b_blocks && !a_blocks;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t f = 0; f < scene.forecasts.size(); ++f) {
      const RoadVehicle& a = scene.vehicles[i];
      const RoadVehicle& b = scene.forecasts[f].vehicle;
      const RoadContact& contact = forecasts_.emplace_back(scene, a, b, scene.reaction);
      if (contact.never()) continue;
      if (!contact.is_ahead(a.now, b.now)) continue;
      follows_[i * scene.forecasts.size() + f] =
          keeps_behind(scene, scene.forecasts[f], a, contact);
    }
  }
}

}  // namespace mvtp
