#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/motion/guide_path.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// Safety distances that the bodies of two vehicles keep, in all (not on each side) [m].
struct Margins {
  double along = 0.6;
  double across = 0.4;
};

/// Where two bodies on two guide paths touch: for each position of A the positions of B.
///
/// One look-up replaces a test of two rectangles, which is what makes planning along known paths
/// fast. Rows and bounds are rounded to half a sample of the paths; the margins contain that.
class ContactTable {
 public:
  struct Interval {
    float low;  ///< [m] along B's path
    float high;
  };

  ContactTable(const GuidePath& path_a, const Vehicle& body_a, const GuidePath& path_b,
               const Vehicle& body_b, const Margins& margins);

  /// Do the bodies touch with A's rear axle at `s_a` and B's at `s_b`?
  [[nodiscard]] bool touches(double s_a, double s_b) const { return blocks(s_a, s_b, s_b); }

  /// Does B meet A, standing at `s_a`, while it drives forward from `s_b` to `s_b_end`?
  [[nodiscard]] bool blocks(double s_a, double s_b, double s_b_end) const {
    for (const Interval& i : row(s_a)) {
      if (s_b <= double(i.high) && s_b_end >= double(i.low)) return true;
    }
    return false;
  }

  /// Can A, while it drives from `s_a` to `s_a_end`, meet a B that is at `s_b` and never reverses?
  [[nodiscard]] bool relevant(double s_a, double s_a_end, double s_b) const {
    return s_a <= last_ && s_a_end >= first_ && s_b <= highest_;
  }

  /// No contact at any position of the two.
  [[nodiscard]] bool empty() const { return intervals_.empty(); }

 private:
  [[nodiscard]] std::span<const Interval> row(double s_a) const {
    const double cell = s_a / GuidePath::kSpacing + 0.5;
    if (!(cell >= 0.0 && cell < double(begin_.size() - 1))) return {};
    const auto r = std::size_t(cell);
    return {intervals_.data() + begin_[r], intervals_.data() + begin_[r + 1]};
  }

  std::vector<std::uint32_t> begin_;  ///< of each row in intervals_, and one behind the last
  std::vector<Interval> intervals_;
  double first_ = 1e9;  ///< s_a of the first and of the last row with a contact
  double last_ = -1e9;
  double highest_ = -1e9;  ///< largest s_b of all contacts
};

}  // namespace mvtp
