#include "coordinator/junctions/referee.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "coordinator/audit/audit.hpp"
#include "coordinator/audit/footprint_motion.hpp"

namespace mvtp {
namespace {

constexpr int kSlice = 5;       ///< steps that are looked at together
constexpr double kBulge = 0.3;  ///< [m] beyond its places at the steps a body reaches between them
/// A point on an arc of less than a right angle moves at most so much further than its chord.
constexpr double kArc = 1.12;

/// A body at one moment.
struct Place {
  Pose rear_axle;
  double c = 1.0;  ///< cosine and
  double s = 0.0;  ///< sine of its heading
  std::array<Point, 4> corners;
};

Place place_of(const Pose& p, const Vehicle& body) {
  Place place{.rear_axle = p, .c = std::cos(p.theta), .s = std::sin(p.theta), .corners = {}};
  const double half = body.width / 2.0;
  const std::array<Point, 4> local = {
      {{body.front, half}, {-body.rear, half}, {-body.rear, -half}, {body.front, -half}}};
  for (std::size_t i = 0; i < 4; ++i) {
    place.corners[i] = {p.x + place.c * local[i].x - place.s * local[i].y,
                        p.y + place.s * local[i].x + place.c * local[i].y};
  }
  return place;
}

/// How far all corners of `b` lie beyond one side of `a`, the best of the four [m].
double beyond_a_side(const Place& a, const Vehicle& body, const Place& b) {
  double ahead = 1e300, behind = 1e300, left = 1e300, right = 1e300;
  for (const Point& p : b.corners) {
    const double dx = p.x - a.rear_axle.x;
    const double dy = p.y - a.rear_axle.y;
    const double along = a.c * dx + a.s * dy;
    const double aside = a.c * dy - a.s * dx;
    ahead = std::min(ahead, along - body.front);
    behind = std::min(behind, -along - body.rear);
    left = std::min(left, aside - body.width / 2.0);
    right = std::min(right, -aside - body.width / 2.0);
  }
  return std::max({ahead, behind, left, right});
}

/// No point of the body moves further than this between two places [m].
double travel(const Place& from, const Place& to) {
  double squared = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double dx = to.corners[i].x - from.corners[i].x;
    const double dy = to.corners[i].y - from.corners[i].y;
    squared = std::max(squared, dx * dx + dy * dy);
  }
  return kArc * std::sqrt(squared);
}

/// A vehicle during some steps: its poses at their ends, and the ground it needs.
struct Drive {
  std::size_t entry = 0;  ///< in the plan
  const RoadVehicle* vehicle = nullptr;
  const Vehicle* body = nullptr;
  std::vector<Place> places;  ///< at the begin, and at the end of each step until it leaves
  double x_low = 1e300, x_high = -1e300, y_low = 1e300, y_high = -1e300;
};

Drive drive_of(const RoadScene& scene, const JointPlan& plan, std::size_t entry,
               std::int64_t from) {
  const RoadVehicle& v = scene.vehicle(plan.entries[entry].key);
  Drive drive{.entry = entry, .vehicle = &v, .body = &scene.body(v)};
  const ReferencePath& path = scene.library->path(v.path);
  const Vehicle& body = *drive.body;
  for (std::int64_t k = from; k <= from + kSlice; ++k) {
    const InertialState state = plan.entries[entry].profile->at(k);
    if (state.s >= SpeedProfile::kDeparted) break;
    drive.places.push_back(place_of(path.at(state.s), body));
    for (const Point& p : drive.places.back().corners) {
      drive.x_low = std::min(drive.x_low, p.x - kBulge);
      drive.x_high = std::max(drive.x_high, p.x + kBulge);
      drive.y_low = std::min(drive.y_low, p.y - kBulge);
      drive.y_high = std::max(drive.y_high, p.y + kBulge);
    }
  }
  return drive;
}

class Referee {
 public:
  Referee(const RoadScene& scene, const JointPlan& plan, const JointPlan& judged)
      : scene_(scene), plan_(plan) {
    for (const JointPlan::Entry& e : plan.entries) {
      end_ = std::max(end_, e.profile->end());
      kept_.push_back(judged.find(e.key) == e.profile.get());
    }
  }

  std::vector<PlannedContact> judge() {
    if (std::ranges::all_of(kept_, [](bool kept) { return kept; })) return {};
    for (std::int64_t k = scene_.step; k < end_; k += kSlice) judge_slice(k);
    std::vector<PlannedContact> contacts;
    for (const auto& [pair, contact] : found_) {
      if (contact) contacts.push_back({pair.first, pair.second, *contact});
    }
    return contacts;
  }

 private:
  void judge_slice(std::int64_t from) {
    std::vector<Drive> drives;
    for (std::size_t e = 0; e < plan_.entries.size(); ++e) {
      Drive drive = drive_of(scene_, plan_, e, from);
      if (!drive.places.empty()) drives.push_back(std::move(drive));
    }
    std::ranges::sort(drives, {}, &Drive::x_low);
    for (std::size_t i = 0; i < drives.size(); ++i) {
      const Drive& a = drives[i];
      for (std::size_t j = i + 1; j < drives.size() && drives[j].x_low <= a.x_high; ++j) {
        const Drive& b = drives[j];
        if (b.y_low > a.y_high || a.y_low > b.y_high) continue;
        if (kept_[a.entry] && kept_[b.entry]) continue;
        judge_pair(a, b, from);
      }
    }
  }

  void judge_pair(const Drive& a, const Drive& b, std::int64_t from) {
    const std::pair<std::int64_t, std::int64_t> pair = std::minmax(a.vehicle->key, b.vehicle->key);
    const auto known = found_.find(pair);
    if (known != found_.end() && known->second) return;
    // Those who overlap when the plan begins are listed until they are apart.
    bool overlap = known != found_.end();
    if (from == scene_.step) overlap = touch(a, b, 0);
    const std::size_t steps = std::min(a.places.size(), b.places.size()) - 1;
    double apart = 0.0;  // at least so far they are, at the begin of the step
    for (std::size_t i = 0; i < steps; ++i) {
      if (overlap) {
        overlap = touch(a, b, i + 1);
        continue;
      }
      const double closing =
          travel(a.places[i], a.places[i + 1]) + travel(b.places[i], b.places[i + 1]);
      if (closing >= apart) {
        apart = std::max(beyond_a_side(a.places[i], *a.body, b.places[i]),
                         beyond_a_side(b.places[i], *b.body, a.places[i]));
      }
      if (closing >= apart && meet(a, b, i)) {
        found_[pair] = from + std::int64_t(i) + 1;
        return;
      }
      apart -= closing;
    }
    if (overlap) {
      found_[pair] = std::nullopt;
    } else {
      found_.erase(pair);
    }
  }

  static bool touch(const Drive& a, const Drive& b, std::size_t i) {
    return clearance(a.places[i].rear_axle, *a.body, b.places[i].rear_axle, *b.body) <
           -Audit::kTolerance;
  }

  /// In step i, at its end or before it?
  static bool meet(const Drive& a, const Drive& b, std::size_t i) {
    const StepMotion motion_a(a.places[i].rear_axle, a.places[i + 1].rear_axle);
    const StepMotion motion_b(b.places[i].rear_axle, b.places[i + 1].rear_axle);
    return nearest_moment(motion_a, *a.body, motion_b, *b.body, 0.0, -Audit::kTolerance).gap <
           -Audit::kTolerance;
  }

  const RoadScene& scene_;
  const JointPlan& plan_;
  std::int64_t end_ = 0;
  std::vector<bool> kept_;  ///< of each entry: as in the plan that was judged before
  /// The step of the first contact of a pair; none as long as they overlap since the begin.
  std::map<std::pair<std::int64_t, std::int64_t>, std::optional<std::int64_t>> found_;
};

}  // namespace

std::vector<PlannedContact> find_planned_contacts(const RoadScene& scene, const JointPlan& plan,
                                                  const JointPlan& judged) {
  return Referee(scene, plan, judged).judge();
}

bool touches_passage(const PathLibrary& library, int path, const SpeedProfile& plan,
                     const Forecast& passage, std::int64_t step) {
  constexpr double kApart = 0.5;  // [m] between two places of the driver that are looked at
  const ContactTable& contacts = library.contacts(path, passage.vehicle.path);
  const SpeedProfile& latest = passage.latest ? *passage.latest : passage.earliest;
  for (std::int64_t k = step; k < latest.end(); ++k) {
    const double s = plan.at(k).s;
    if (s >= SpeedProfile::kDeparted) return false;
    const double last = std::min(passage.earliest.at(k).s, passage.vehicle.s_end);
    const double first = std::min(latest.at(k).s, last);
    if (!contacts.meets(s, s, first, last)) continue;
    const Pose own = library.path(path).at(s);
    for (double other = first; other < last + kApart; other += kApart) {
      const Pose pose = library.path(passage.vehicle.path).at(std::min(other, last));
      if (clearance(own, library.body(path), pose, library.body(passage.vehicle.path)) < 0.0) {
        return true;
      }
    }
  }
  return false;
}

namespace {

/// When a pair touches first of which one is in the group, and how many pairs do; more is worse.
std::pair<std::int64_t, std::size_t> harm_to(std::span<const std::int64_t> group,
                                             std::span<const PlannedContact> contacts) {
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  std::size_t pairs = 0;
  for (const PlannedContact& c : contacts) {
    if (std::ranges::count(group, c.first) + std::ranges::count(group, c.second) == 0) continue;
    ++pairs;
    first = std::min(first, c.step);
  }
  return {-first, pairs};
}

}  // namespace

std::vector<std::size_t> better_as_before(std::span<const std::vector<std::int64_t>> groups,
                                          std::span<const PlannedContact> contacts,
                                          std::span<const PlannedContact> before) {
  std::vector<std::size_t> better;
  std::ranges::copy_if(
      groups_in_contact(groups, contacts), std::back_inserter(better),
      [&](std::size_t g) { return harm_to(groups[g], before) < harm_to(groups[g], contacts); });
  return better;
}

std::vector<std::size_t> groups_in_contact(std::span<const std::vector<std::int64_t>> groups,
                                           std::span<const PlannedContact> contacts) {
  std::vector<std::size_t> touched;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto is_member = [&](std::int64_t key) {
      return std::ranges::find(groups[g], key) != groups[g].end();
    };
    const bool in_contact = std::ranges::any_of(contacts, [&](const PlannedContact& c) {
      return is_member(c.first) || is_member(c.second);
    });
    if (in_contact) touched.push_back(g);
  }
  return touched;
}

}  // namespace mvtp
