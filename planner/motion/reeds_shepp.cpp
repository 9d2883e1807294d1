#include "planner/motion/reeds_shepp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-10;  ///< lengths of the wrong sign by so little are 0

/// The paper's M: an angle in (-pi, pi]. The argument is within a few turns.
double wrap(double angle) {
  while (angle > kPi) angle -= 2.0 * kPi;
  while (angle <= -kPi) angle += 2.0 * kPi;
  return angle;
}

/// The shortest path found so far: segment lengths (radius 1, negative in reverse) and their
/// curvatures.
struct Word {
  std::array<double, 5> lengths{};
  std::array<int, 5> turns{};  ///< 1 left, -1 right, 0 straight
  double total = std::numeric_limits<double>::infinity();
};

/// One of the paper's symmetries, applied to a word that starts with a left turn forwards.
struct Symmetry {
  bool flipped = false;    ///< in time: forwards becomes reverse
  bool mirrored = false;   ///< left becomes right
  bool backwards = false;  ///< driven from its end
};

/// The goal, seen so that a base word leads to it, with what all words share.
///
/// (xi, eta) is the vector between the centres of the first and last turning circle, less one
/// radius sideways: both left ("same"), or left and right ("other").
struct Target {
  Target(double x, double y, double angle, double sine, double cosine)
      : phi(angle),
        same_xi(x - sine),
        same_eta(y - 1.0 + cosine),
        other_xi(x + sine),
        other_eta(y - 1.0 - cosine),
        same_square(same_xi * same_xi + same_eta * same_eta),
        other_square(other_xi * other_xi + other_eta * other_eta) {}

  double phi;
  double same_xi;
  double same_eta;
  double other_xi;
  double other_eta;
  double same_square;
  double other_square;
};

class Shortest {
 public:
  Shortest(double x, double y, double phi) {
    const double sine = std::sin(phi);
    const double cosine = std::cos(phi);
    for (const bool flipped : {false, true}) {
      for (const bool mirrored : {false, true}) {
        const double sx = flipped ? -x : x;
        const double sy = mirrored ? -y : y;
        const double sign = flipped == mirrored ? 1.0 : -1.0;
        const double s = sign * sine;
        const Target forth(sx, sy, sign * phi, s, cosine);
        const Symmetry symmetry{flipped, mirrored, false};
        left_straight_left(forth, symmetry);
        left_straight_right(forth, symmetry);
        four_turns(forth, symmetry);
        turn_straight_turn_between_cusps(forth, symmetry);
        for (const bool backwards : {false, true}) {
          const Target target =
              backwards ? Target(sx * cosine + sy * s, sx * s - sy * cosine, sign * phi, s, cosine)
                        : forth;
          const Symmetry both{flipped, mirrored, backwards};
          three_turns(target, both);
          cusp_then_straight(target, both);
        }
      }
    }
  }

  [[nodiscard]] const Word& word() const { return best_; }

 private:
  static bool positive(double length) { return length >= -kRounding; }
  static bool negative(double length) { return length <= kRounding; }
  /// Is a word that is at least so long no better than the best so far, whatever the rounding?
  [[nodiscard]] bool too_long(double at_least) const { return at_least >= best_.total + 1e-9; }

  template <std::size_t N>
  void offer(const Symmetry& symmetry, const std::array<double, N>& lengths,
             const std::array<int, N>& turns) {
    double total = 0.0;
    for (const double length : lengths) total += std::abs(length);
    if (total >= best_.total) return;
    best_ = Word{};
    best_.total = total;
    for (std::size_t k = 0; k < N; ++k) {
      const std::size_t from = symmetry.backwards ? N - 1 - k : k;
      best_.lengths[k] = symmetry.flipped ? -lengths[from] : lengths[from];
      best_.turns[k] = symmetry.mirrored ? -turns[from] : turns[from];
    }
  }

  /// C S C, turning the same way: eq. (8.1).
  void left_straight_left(const Target& g, const Symmetry& symmetry) {
    const double u = std::sqrt(g.same_square);
    // The turns add up to phi; and t < 0 if the goal is to the right.
    if (u >= best_.total || too_long(u + std::abs(g.phi)) || g.same_eta < -1e-9 * u) return;
    const double t = std::atan2(g.same_eta, g.same_xi);
    const double v = wrap(g.phi - t);
    if (positive(t) && positive(v)) offer<3>(symmetry, {t, u, v}, {1, 0, 1});
  }

  /// C S C, turning both ways: eq. (8.2).
  void left_straight_right(const Target& g, const Symmetry& symmetry) {
    if (g.other_square < 4.0) return;
    const double u = std::sqrt(g.other_square - 4.0);
    if (u >= best_.total || too_long(u + std::abs(g.phi))) return;
    const double t = wrap(std::atan2(g.other_eta, g.other_xi) + std::atan2(2.0, u));
    const double v = wrap(t - g.phi);
    if (positive(t) && positive(v)) offer<3>(symmetry, {t, u, v}, {1, 0, -1});
  }

  /// C|C|C and C|CC: eqs. (8.3), (8.4).
  void three_turns(const Target& g, const Symmetry& symmetry) {
    if (g.same_square > 16.0) return;
    const double u = -2.0 * std::asin(std::min(std::sqrt(g.same_square) / 4.0, 1.0));
    if (too_long(std::abs(u) + std::abs(wrap(g.phi + u)))) return;
    const double t = wrap(std::atan2(g.same_eta, g.same_xi) + u / 2.0 + kPi);
    const double v = wrap(g.phi - t + u);
    if (positive(t) && negative(u)) offer<3>(symmetry, {t, u, v}, {1, -1, 1});
  }

  /// CCu|CuC and C|CuCu|C: eqs. (8.7), (8.8).
  void four_turns(const Target& g, const Symmetry& symmetry) {
    if (g.other_square <= 4.0) {
      const double u = std::acos(0.25 * (2.0 + std::sqrt(g.other_square)));
      if (!too_long(2.0 * u)) {
        const auto [t, v] = outer_turns(u, -u, g);
        if (positive(t) && negative(v)) offer<4>(symmetry, {t, u, -u, v}, {1, -1, 1, -1});
      }
    }
    if (g.other_square >= 4.0 && g.other_square <= 20.0) {
      const double u = -std::acos((20.0 - g.other_square) / 16.0);
      if (too_long(-2.0 * u)) return;
      const auto [t, v] = outer_turns(u, u, g);
      if (positive(t) && positive(v)) offer<4>(symmetry, {t, u, u, v}, {1, -1, 1, -1});
    }
  }

  /// The paper's tau and omega: the first and last of four turns, given those between.
  static std::pair<double, double> outer_turns(double u, double v, const Target& g) {
    const double delta = wrap(u - v);
    const double a = std::sin(u) - std::sin(delta);
    const double b = std::cos(u) - std::cos(delta) - 1.0;
    const double first =
        std::atan2(g.other_eta * a - g.other_xi * b, g.other_xi * a + g.other_eta * b);
    const double side = 2.0 * (std::cos(delta) - std::cos(v) - std::cos(u)) + 3.0;
    const double tau = side < 0.0 ? wrap(first + kPi) : first;
    return {tau, wrap(tau - u + v - g.phi)};
  }

  /// C|C(pi/2) S C: eqs. (8.9), (8.10).
  void cusp_then_straight(const Target& g, const Symmetry& symmetry) {
    if (g.same_square >= 4.0) {
      const double side = std::sqrt(g.same_square - 4.0);
      const double u = 2.0 - side;
      if (u <= kRounding && kPi / 2 - u < best_.total) {
        const double t = wrap(std::atan2(g.same_eta, g.same_xi) + std::atan2(side, -2.0));
        const double v = wrap(g.phi - kPi / 2 - t);
        if (positive(t) && negative(v)) {
          offer<4>(symmetry, {t, -kPi / 2, u, v}, {1, -1, 0, 1});
        }
      }
    }
    if (g.other_square >= 4.0) {
      const double u = 2.0 - std::sqrt(g.other_square);
      if (kPi / 2 - u >= best_.total) return;
      const double t = std::atan2(g.other_xi, -g.other_eta);
      const double v = wrap(t + kPi / 2 - g.phi);
      if (positive(t) && negative(v)) {
        offer<4>(symmetry, {t, -kPi / 2, u, v}, {1, -1, 0, -1});
      }
    }
  }

  /// C|C(pi/2) S C(pi/2)|C: eq. (8.11).
  void turn_straight_turn_between_cusps(const Target& g, const Symmetry& symmetry) {
    if (g.other_square < 4.0) return;
    const double u = 4.0 - std::sqrt(g.other_square - 4.0);
    if (u > kRounding || kPi - u >= best_.total) return;
    const double t = std::atan2((4.0 - u) * g.other_xi - 2.0 * g.other_eta,
                                -2.0 * g.other_xi + (u - 4.0) * g.other_eta);
    const double v = wrap(t - g.phi);
    if (positive(t) && positive(v)) {
      offer<5>(symmetry, {t, -kPi / 2, u, -kPi / 2, v}, {1, -1, 0, 1, -1});
    }
  }

  Word best_;
};

Word shortest_word(const Pose& from, const Pose& to, double radius) {
  const Pose goal = relative(from, to);
  return Shortest(goal.x / radius, goal.y / radius, goal.theta).word();
}

// The table covers x, y in [0, kRange] and all headings; mirror images give the other quadrants.
constexpr float kRange = 8.0F;  // [radii]
constexpr int kCells = 28;      // per axis
constexpr int kHeadings = 48;
constexpr float kCell = kRange / float(kCells);
constexpr float kHeading = 2.0F * std::numbers::pi_v<float> / float(kHeadings);
constexpr int kRow = kHeadings + 1;  // the first heading again at the end

}  // namespace

double ReedsSheppPath::length() const {
  double sum = 0.0;
  for (const Arc& arc : *this) sum += std::abs(arc.length);
  return sum;
}

ReedsSheppPath reeds_shepp_path(const Pose& from, const Pose& to, double radius) {
  const Word word = shortest_word(from, to, radius);
  ReedsSheppPath path;
  for (std::size_t k = 0; k < word.lengths.size(); ++k) {
    const double length = word.lengths[k] * radius;
    if (std::abs(length) < 1e-9) continue;
    path.arcs[std::size_t(path.count++)] = {length, word.turns[k] / radius};
  }
  return path;
}

double reeds_shepp_length(const Pose& from, const Pose& to, double radius) {
  return radius * shortest_word(from, to, radius).total;
}

ReedsSheppTable::ReedsSheppTable() : lengths_(std::size_t((kCells + 1) * (kCells + 1) * kRow)) {
  for (std::atomic<float>& length : lengths_) length.store(-1.0F, std::memory_order_relaxed);
}

inline float ReedsSheppTable::entry(std::size_t index) const {
  const float known = lengths_[index].load(std::memory_order_relaxed);
  return known >= 0.0F ? known : compute(index);
}

float ReedsSheppTable::compute(std::size_t index) const {
  const auto cell = [&](std::size_t stride, std::size_t count) {
    return float(index / stride % count);
  };
  const float heading = cell(1, kRow);
  const Pose to{double(cell(kRow * (kCells + 1), kCells + 1) * kCell),
                double(cell(kRow, kCells + 1) * kCell), wrap_to_pi(double(heading * kHeading))};
  const float computed = float(reeds_shepp_length({}, to, 1.0));
  lengths_[index].store(computed, std::memory_order_relaxed);  // any thread would find the same
  return computed;
}

const ReedsSheppTable& ReedsSheppTable::shared() {
  static const ReedsSheppTable kTable;
  return kTable;
}

double ReedsSheppTable::length(double x, double y, double theta) const {
  // A path mirrored at either axis is a path; each mirror turns the heading round.
  if ((x < 0.0) != (y < 0.0)) theta = -theta;
  const float px = float(std::abs(x));
  const float py = float(std::abs(y));
  const float far = std::max(px, py);
  if (far <= kRange) return double(inside(px, py, float(theta)));
  // Far away the path is a long straight line between two turns that depend on directions only.
  const float scale = kRange / far;
  return double(inside(px * scale, py * scale, float(theta)) +
                (1.0F - scale) * std::sqrt(px * px + py * py));
}

float ReedsSheppTable::inside(float x, float y, float theta) const {
  float turns = theta * (1.0F / (2.0F * std::numbers::pi_v<float>));
  turns -= std::floor(turns);
  const float heading = turns * float(kHeadings);
  const float gx = x * (1.0F / kCell);
  const float gy = y * (1.0F / kCell);
  const int ix = std::min(int(gx), kCells - 1);
  const int iy = std::min(int(gy), kCells - 1);
  const int ih = std::min(int(heading), kHeadings - 1);
  const float fx = gx - float(ix);
  const float fy = gy - float(iy);
  const float fh = heading - float(ih);
  const int corner = (ix * (kCells + 1) + iy) * kRow + ih;
  const auto along_heading = [&](int offset) {
    const std::size_t index = std::size_t(corner + offset * kRow);
    const float from = entry(index);
    return from + fh * (entry(index + 1) - from);
  };
  const float low = along_heading(0) * (1.0F - fx) + along_heading(kCells + 1) * fx;
  const float high = along_heading(1) * (1.0F - fx) + along_heading(kCells + 2) * fx;
  return low * (1.0F - fy) + high * fy;
}

}  // namespace mvtp
