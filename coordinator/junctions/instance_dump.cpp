#include "coordinator/junctions/instance_dump.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "coordinator/audit/footprint_motion.hpp"
#include "planner/problem/instance_file.hpp"

namespace mvtp {
namespace {

constexpr double kCell = 0.5;    ///< [m] side of the squares that the ground is divided into
constexpr double kBorder = 4.0;  ///< [m] of map around the paths
constexpr double kApart = 0.5;   ///< [m] between two goals
constexpr double kCut = 0.5;     ///< [m] by which a goal is moved back at a time
constexpr double kHalfDiagonal = kCell / std::numbers::sqrt2;

/// The piece of its path that a vehicle still has to drive.
class RemainingPath {
 public:
  RemainingPath(const std::string& id, const Driven& driven, const CorridorMap& corridors)
      : id_(id),
        driven_(driven),
        path_(corridors.library().path(driven.road.path)),
        body_(corridors.library().body(driven.road.path)),
        from_(driven.road.now.s),
        to_(std::max(from_, driven.road.s_end)),
        left_(to_ - from_) {}

  [[nodiscard]] Pose at(double s) const { return driven_.approach.pose(path_, s); }
  [[nodiscard]] double from() const { return from_; }
  [[nodiscard]] double to() const { return to_; }
  [[nodiscard]] const Vehicle& body() const { return body_; }
  /// Distance to the end of the corridor [m]: the more, the further behind.
  [[nodiscard]] double left() const { return left_; }
  [[nodiscard]] bool stays() const { return to_ == from_; }
  void cut_back() { to_ = std::max(from_, to_ - kCut); }

  [[nodiscard]] Agent agent(const Point& origin) const {
    const auto shifted = [&](double s) {
      const Pose pose = at(s);
      return Pose{pose.x - origin.x, pose.y - origin.y, pose.theta};
    };
    Vehicle vehicle = body_;
    vehicle.max_speed = driven_.road.cruise_speed;
    return {id_, vehicle, shifted(from_), shifted(to_)};
  }

 private:
  std::string id_;
  const Driven& driven_;
  const ReferencePath& path_;
  const Vehicle& body_;
  double from_;
  double to_;
  double left_;
};

/// Moves goals back along their paths until all are apart, that of the vehicle further behind
/// first. At worst everybody stays at its start, where nobody overlaps.
void part_goals(std::vector<RemainingPath>& paths) {
  for (bool moved = true; moved;) {
    moved = false;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        RemainingPath* behind = &paths[i];
        RemainingPath* ahead = &paths[j];
        if (behind->left() < ahead->left()) std::swap(behind, ahead);
        if (behind->stays()) std::swap(behind, ahead);
        if (behind->stays()) continue;
        if (clearance(behind->at(behind->to()), behind->body(), ahead->at(ahead->to()),
                      ahead->body()) >= kApart) {
          continue;
        }
        behind->cut_back();
        moved = true;
      }
    }
  }
}

/// Calls `visitor` with the rear-axle poses of a path, close to each other, both ends included.
template <class Visitor>
void for_each_pose(const RemainingPath& path, Visitor visitor) {
  const int steps = int(std::ceil((path.to() - path.from()) / ReferencePath::kSpacing));
  for (int i = 0; i <= steps; ++i) {
    visitor(path.at(std::min(path.to(), path.from() + i * ReferencePath::kSpacing)));
  }
}

/// A box of whole squares of ground, each solid or free.
class Ground {
 public:
  Ground(const std::vector<RemainingPath>& paths, const DrivableArea& area) {
    set_box(paths);
    free_.assign(std::size_t(columns_) * std::size_t(rows_), 0);
    for (const RemainingPath& path : paths) {
      for_each_pose(path, [&](const Pose& pose) { set_free(pose, path.body()); });
    }
    for (int r = 0; r < rows_; ++r) {
      for (int c = 0; c < columns_; ++c) {
        if (free(c, r) == 0 && area.contains(middle(c, r), kHalfDiagonal)) free(c, r) = 1;
      }
    }
  }

  [[nodiscard]] const Point& origin() const { return low_; }
  [[nodiscard]] double width() const { return columns_ * kCell; }
  [[nodiscard]] double height() const { return rows_ * kCell; }

  /// The solid squares merged to rectangles, seen from origin(): rows as long as they go, then as
  /// many like it as follow.
  [[nodiscard]] std::vector<Polygon> solids() const {
    std::vector<Polygon> solids;
    std::vector<char> done = free_;
    const auto is_open = [&](int c, int r) { return done[index(c, r)] == 0; };
    for (int r = 0; r < rows_; ++r) {
      for (int c = 0; c < columns_; ++c) {
        if (!is_open(c, r)) continue;
        int right = c;
        while (right < columns_ && is_open(right, r)) ++right;
        int top = r;
        const auto goes_on = [&] {
          for (int i = c; i < right; ++i) {
            if (!is_open(i, top)) return false;
          }
          return true;
        };
        for (; top < rows_ && goes_on(); ++top) {
          std::fill_n(done.begin() + std::ptrdiff_t(index(c, top)), right - c, char{1});
        }
        solids.push_back({{c * kCell, r * kCell},
                          {right * kCell, r * kCell},
                          {right * kCell, top * kCell},
                          {c * kCell, top * kCell}});
      }
    }
    return solids;
  }

 private:
  [[nodiscard]] std::size_t index(int c, int r) const {
    return std::size_t(r) * std::size_t(columns_) + std::size_t(c);
  }
  [[nodiscard]] char& free(int c, int r) { return free_[index(c, r)]; }
  [[nodiscard]] Point middle(int c, int r) const {
    return {low_.x + (c + 0.5) * kCell, low_.y + (r + 0.5) * kCell};
  }

  void set_box(const std::vector<RemainingPath>& paths) {
    Point low{1e300, 1e300};
    Point high{-1e300, -1e300};
    for (const RemainingPath& path : paths) {
      const double reach = kBorder + std::hypot(std::max(path.body().front, path.body().rear),
                                                path.body().width / 2.0);
      for_each_pose(path, [&](const Pose& p) {
        low = {std::min(low.x, p.x - reach), std::min(low.y, p.y - reach)};
        high = {std::max(high.x, p.x + reach), std::max(high.y, p.y + reach)};
      });
    }
    low_ = {kCell * std::floor(low.x / kCell), kCell * std::floor(low.y / kCell)};
    columns_ = int(std::ceil((high.x - low_.x) / kCell));
    rows_ = int(std::ceil((high.y - low_.y) / kCell));
  }

  /// Frees all squares that a body touches.
  void set_free(const Pose& pose, const Vehicle& body) {
    const double half_length = body.length() / 2.0 + kHalfDiagonal;
    const double half_width = body.width / 2.0 + kHalfDiagonal;
    const Pose centre = compose(pose, {(body.front - body.rear) / 2.0, 0.0, 0.0});
    const double reach = std::hypot(half_length, half_width);
    const auto first = [](double x) { return int(std::floor(x / kCell)); };
    for (int r = first(centre.y - reach - low_.y); r <= first(centre.y + reach - low_.y); ++r) {
      for (int c = first(centre.x - reach - low_.x); c <= first(centre.x + reach - low_.x); ++c) {
        const Point m = middle(c, r);
        const Pose at = relative(centre, {m.x, m.y, 0.0});
        if (std::abs(at.x) <= half_length && std::abs(at.y) <= half_width) free(c, r) = 1;
      }
    }
  }

  Point low_;  ///< the lower left corner
  int columns_ = 0;
  int rows_ = 0;
  std::vector<char> free_;
};

}  // namespace

Instance instance_of(const Coordinator& coordinator, const DrivableArea& area, double dt) {
  std::vector<RemainingPath> paths;
  for (const auto& [id, driven] : coordinator.driven()) {
    paths.emplace_back(id, driven, coordinator.corridors());
  }
  part_goals(paths);
  const Ground ground(paths, area);
  Instance instance{.dt = dt};
  for (const RemainingPath& path : paths) instance.agents.push_back(path.agent(ground.origin()));
  instance.map.width = ground.width();
  instance.map.height = ground.height();
  instance.map.polygons = ground.solids();
  return instance;
}

void InstanceDump::observe() {
  const std::vector<Replan>& replans = coordinator_.replans();
  if (replans.size() == replans_) return;
  replans_ = replans.size();
  if (coordinator_.driven().size() < 2 || ++counted_ < options_.every) return;
  counted_ = 0;
  const double time = replans.back().time;
  write_instance(instance_of(coordinator_, area_, options_.dt),
                 fmt::format("{}/t{:09.2f}.yaml", options_.folder, time),
                 {.description = fmt::format("{}, t = {:.2f} s", options_.origin, time)});
}

}  // namespace mvtp
