#include "coordinator/corridor/least_curvature.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "coordinator/corridor/reference_path.hpp"

namespace mvtp {
namespace {

constexpr double kKnots = 1.0;  ///< [m] between the knots of the offset
using Matrix = Eigen::SparseMatrix<double>;

/// Minimise |M c + k|^2 over the offsets c within `room` of 0, knot by knot.
struct Program {
  Matrix change;              ///< M: what the offsets change of the curvature at each knot
  Eigen::VectorXd curvature;  ///< k [1/m]
  Eigen::VectorXd room;       ///< [m]
};

/// The mean curvature around each knot.
Eigen::VectorXd curvature_at_knots(const ReferencePath& path) {
  constexpr int kHalf = int(0.5 * kKnots / ReferencePath::kSpacing);
  Eigen::VectorXd curvature(Eigen::Index(path.length() / kKnots) + 1);
  for (Eigen::Index i = 0; i < curvature.size(); ++i) {
    double sum = 0.0;
    for (int k = -kHalf; k <= kHalf; ++k) {
      sum += path.curvature(double(i) * kKnots + k * ReferencePath::kSpacing);
    }
    curvature[i] = sum / (2 * kHalf + 1);
  }
  return curvature;
}

constexpr double kReach = 15.0;  ///< [m] in which the room comes and goes

/// The share of the room that there is at s.
double free_share(const FreeCourse& free, double s) {
  constexpr double kBefore = 20.0;  // [m] a line bodies wait
  double share = std::min({(s - free.within.from) / kReach, (free.within.to - s) / kReach, 1.0});
  for (const double line : free.lines) {
    if (s > line - kBefore) share = std::min(share, 0.5 + std::max(0.0, s - line) / kReach);
  }
  return std::max(share, 0.0);
}

/// Full room in bends, ever less beside them, and none outside the stretch.
Eigen::VectorXd room_at_knots(const Eigen::VectorXd& curvature, const FreeCourse& free,
                              double most) {
  constexpr double kBend = 1.0 / 200.0;  // [1/m]
  const auto reach = Eigen::Index(kReach / kKnots);
  const Eigen::Index n = curvature.size();
  Eigen::VectorXd room = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::abs(curvature[i]) < kBend) continue;
    for (Eigen::Index k = std::max<Eigen::Index>(0, i - reach); k < std::min(n, i + reach); ++k) {
      const double near = 1.0 - double(std::abs(k - i)) * kKnots / kReach;
      const double s = double(k) * kKnots;
      room[k] = std::max(room[k], most * std::min(near, free_share(free, s)));
    }
  }
  return room;
}

/// A cubic B-spline c has the offset (c[i-1] + 4 c[i] + c[i+1]) / 6 at its knot i, and the second
/// derivative (c[i-1] - 2 c[i] + c[i+1]) / h^2; in a circle an offset alone changes the curvature
/// by its square times the offset.
Program program_for(const ReferencePath& path, const FreeCourse& free, double room) {
  Program p;
  p.curvature = curvature_at_knots(path);
  p.room = room_at_knots(p.curvature, free, room);
  const Eigen::Index n = p.curvature.size();
  p.change = Matrix(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double square = p.curvature[i] * p.curvature[i];
    for (const Eigen::Index k : {i - 1, i, i + 1}) {
      if (k < 0 || k >= n || p.room[k] == 0.0) continue;
      const double weight = k == i ? 4.0 : 1.0;
      const double second = k == i ? -2.0 : 1.0;
      entries.emplace_back(i, k, second / (kKnots * kKnots) + square * weight / 6.0);
    }
  }
  p.change.setFromTriplets(entries.begin(), entries.end());
  return p;
}

/// A point strictly within the bounds, with the multipliers of both of them.
struct Iterate {
  Eigen::ArrayXd offsets;
  Eigen::ArrayXd above;  ///< multipliers of offset <= room
  Eigen::ArrayXd below;  ///< of -room <= offset
};

/// How far along `change` a positive quantity stays positive, in parts of it.
double longest_step(const Eigen::ArrayXd& value, const Eigen::ArrayXd& change) {
  constexpr double kKept = 0.99;  // of the distance to zero at most
  double length = 1.0;
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    if (change[i] < 0.0) length = std::min(length, -kKept * value[i] / change[i]);
  }
  return length;
}

/// One Newton step towards multiplier x slack = `barrier` at each bound.
void step_towards(const Program& p, const Matrix& hessian, double barrier, Iterate& at) {
  const Eigen::ArrayXd to_upper = p.room.array() - at.offsets;
  const Eigen::ArrayXd to_lower = p.room.array() + at.offsets;
  const Eigen::VectorXd gradient =
      p.change.transpose() * (p.change * at.offsets.matrix() + p.curvature);
  Matrix system = hessian;
  system.diagonal() += (at.above / to_upper + at.below / to_lower).matrix();
  const Eigen::VectorXd wanted = -gradient + (barrier / to_lower - barrier / to_upper).matrix();
  const Eigen::ArrayXd move = Eigen::SimplicialLDLT<Matrix>(system).solve(wanted).array();
  const Eigen::ArrayXd above = barrier / to_upper - at.above + at.above / to_upper * move;
  const Eigen::ArrayXd below = barrier / to_lower - at.below - at.below / to_lower * move;
  const double primal = std::min(longest_step(to_upper, -move), longest_step(to_lower, move));
  const double dual = std::min(longest_step(at.above, above), longest_step(at.below, below));
  at.offsets += primal * move;
  at.above += dual * above;
  at.below += dual * below;
}

/// The primal-dual interior-point method: Nocedal and Wright, Numerical Optimization (2006),
/// section 16.6. Offsets without room keep a hair of it, so that the method has an interior.
Eigen::VectorXd solve(Program p) {
  constexpr double kHair = 1e-9;     // [m]
  constexpr double kCentring = 0.1;  // of the gap that a step aims at
  constexpr double kEnough = 1e-9;   // the gap, for each bound
  constexpr int kMostSteps = 60;
  const Eigen::Index n = p.room.size();
  p.room = p.room.cwiseMax(kHair);
  Matrix identity(n, n);
  identity.setIdentity();
  const Matrix hessian = Matrix(p.change.transpose() * p.change) + 0.0 * identity;
  Iterate at{Eigen::ArrayXd::Zero(n), Eigen::ArrayXd::Constant(n, 1e-2),
             Eigen::ArrayXd::Constant(n, 1e-2)};
  for (int step = 0; step < kMostSteps; ++step) {
    const double gap =
        ((p.room.array() - at.offsets) * at.above + (p.room.array() + at.offsets) * at.below)
            .sum() /
        double(2 * n);
    if (gap < kEnough) break;
    step_towards(p, hessian, kCentring * gap, at);
  }
  return at.offsets;
}

/// The offset at a place u between the knots, in knots.
double spline(const Eigen::VectorXd& c, double u) {
  const auto i = Eigen::Index(u);
  const double t = u - double(i);
  const auto at = [&](Eigen::Index k) { return k < 0 || k >= c.size() ? 0.0 : c[k]; };
  const double s = 1.0 - t;
  return (s * s * s * at(i - 1) + (3 * t * t * t - 6 * t * t + 4) * at(i) +
          (3 * s * s * s - 6 * s * s + 4) * at(i + 1) + t * t * t * at(i + 2)) /
         6.0;
}

/// How much of the body is off its own road, summed along a path; nullopt if it cannot be driven.
std::optional<double> off_own_road(const ReferencePath& path, const Stretch& driven,
                                   const Vehicle& body, const DrivableArea& own) {
  double sum = 0.0;
  for (double s = driven.from; s <= std::min(driven.to, path.length()); s += kJudgedEvery) {
    if (std::abs(path.curvature(s)) > body.max_curvature()) return std::nullopt;
    sum += own.share_outside(path.at(s), body, 0.0);
  }
  return sum;
}

bool leaves_road_on(const ReferencePath& path, const Stretch& driven, const Vehicle& body,
                    const DrivableArea& area) {
  for (double s = driven.from; s <= std::min(driven.to, path.length()); s += kJudgedEvery) {
    if (leaves_road(path, s, body, area)) return true;
  }
  return false;
}

}  // namespace

ReferencePath least_curved(const ReferencePath& path, const FreeCourse& free, double room) {
  const Program program = program_for(path, free, room);
  if (program.room.isZero()) return path;
  const Eigen::VectorXd offsets = solve(program);
  std::vector<Point> points;
  points.reserve(path.samples());
  for (std::size_t i = 0; i < path.samples(); ++i) {
    const Pose& pose = path.sample(i);
    const double left = spline(offsets, double(i) * ReferencePath::kSpacing / kKnots);
    points.push_back({pose.x - left * std::sin(pose.theta), pose.y + left * std::cos(pose.theta)});
  }
  return ReferencePath(points);
}

ReferencePath straightened(ReferencePath path, const Stretch& driven, const FreeCourse& free,
                           double lane_width, const Vehicle& body, const DrivableArea& own,
                           const DrivableArea& area) {
  constexpr double kKept = 0.2;    // [m] to the border of the lane: half of what two keep apart
  constexpr double kLeast = 0.05;  // [m]
  const double most = 0.5 * (lane_width - body.width) - kKept;
  const auto before = off_own_road(path, driven, body, own);
  if (!before) return path;
  for (double room = most; room > kLeast; room *= 0.5) {
    ReferencePath straighter = least_curved(path, free, room);
    // In sharp bends half a metre is no longer small: what the offsets change is not as expected.
    if (straighter.max_abs_curvature() > path.max_abs_curvature()) continue;
    const auto now = off_own_road(straighter, driven, body, own);
    if (now && *now <= *before && !leaves_road_on(straighter, driven, body, area)) {
      return straighter;
    }
  }
  return path;
}

}  // namespace mvtp
