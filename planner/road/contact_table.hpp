#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "planner/geometry/oriented_box.hpp"
#include "planner/motion/reference_path.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// Safety distances that the bodies of two vehicles keep, in all (not on each side) [m].
struct Margins {
  double along = 0.6;
  double across = 0.4;
};

/// Axis-parallel rectangle; empty as made.
struct PlaneBounds {
  double x_low = std::numeric_limits<double>::infinity();
  double x_high = -std::numeric_limits<double>::infinity();
  double y_low = std::numeric_limits<double>::infinity();
  double y_high = -std::numeric_limits<double>::infinity();

  void include(const PlaneBounds& other);
  [[nodiscard]] bool overlaps(const PlaneBounds& other) const {
    return x_low <= other.x_high && other.x_low <= x_high && y_low <= other.y_high &&
           other.y_low <= y_high;
  }
};

/// The ground that a body covers along a path: its rectangle at every sample, with half of the
/// margins around it, and what bounds them. Rectangles are made when they are asked for: there are
/// too many to keep.
class SweptPath {
 public:
  static constexpr std::size_t kChunk = 16;  ///< samples per entry of chunks()

  /// @param path  must outlive it.
  SweptPath(const ReferencePath& path, const Vehicle& body, const Margins& margins);
  SweptPath(ReferencePath&& path, const Vehicle& body, const Margins& margins) = delete;

  [[nodiscard]] std::size_t samples() const { return path_->samples(); }
  [[nodiscard]] OrientedBox box(std::size_t i) const { return footprint(grown_, path_->sample(i)); }
  [[nodiscard]] std::span<const PlaneBounds> chunks() const { return chunks_; }
  [[nodiscard]] const PlaneBounds& bounds() const { return bounds_; }
  /// From one sample to the next no point of the body moves further than this [m].
  [[nodiscard]] double stride() const { return stride_; }
  /// So much, at least, the margins of two such bodies push them apart [m].
  [[nodiscard]] double least_margin() const { return least_margin_; }

 private:
  const ReferencePath* path_;
  Vehicle grown_;
  std::vector<PlaneBounds> chunks_;
  PlaneBounds bounds_;
  double stride_ = ReferencePath::kSpacing;
  double least_margin_ = 0.0;
};

/// Where two bodies on two reference paths touch: for each position of A the positions of B.
///
/// One look-up replaces a test of two rectangles, which is what makes planning along known paths
/// fast. Rows and bounds are rounded to half a sample of the paths, and a motion between two looks
/// is taken as even. The margins contain both: where the grown rectangles are apart at a pair of
/// samples, there is a gap of at least the smaller margin between the true bodies; until half a
/// sample further none of their points has moved by more than half a stride; and what still lacks,
/// in tight bends, is added to the rectangles (kUneven, slack in the source). So wherever the table
/// has no contact, the true bodies do not touch, at the samples and between them.
class ContactTable {
 public:
  struct Interval {
    float low;  ///< [m] along B's path
    float high;
  };

  /// B's samples from the first to the second.
  using Run = std::pair<std::uint32_t, std::uint32_t>;

  /// No contact anywhere.
  ContactTable() = default;
  /// Contacts as given: for samples of A's path those of B's. Runs may overlap.
  explicit ContactTable(const std::map<std::uint32_t, std::vector<Run>>& rows);
  ContactTable(const SweptPath& a, const SweptPath& b);
  ContactTable(const ReferencePath& path_a, const Vehicle& body_a, const ReferencePath& path_b,
               const Vehicle& body_b, const Margins& margins);

  /// The same contacts with A and B exchanged.
  [[nodiscard]] ContactTable transposed() const;

  /// Do the bodies touch with A's rear axle at `s_a` and B's at `s_b`?
  [[nodiscard]] bool touches(double s_a, double s_b) const { return blocks(s_a, s_b, s_b); }

  /// Does B meet A, standing at `s_a`, while it drives forward from `s_b` to `s_b_end`?
  [[nodiscard]] bool blocks(double s_a, double s_b, double s_b_end) const {
    const double r = row_of(s_a);
    if (!(r >= 0.0 && r < double(rows()))) return false;
    return row_meets(std::size_t(r), s_b, s_b_end);
  }

  /// Do they meet while A drives evenly from `a` to `a_end` and B, in the same time, evenly from
  /// `b` to `b_end`? Between the samples of A too: each row is compared with all positions that B
  /// has while A is in it. @pre a <= a_end, b <= b_end
  [[nodiscard]] bool sweeps(double a, double a_end, double b, double b_end) const;

  /// Is there a contact with A anywhere within [a, a_end] and B anywhere within [b, b_end]?
  [[nodiscard]] bool meets(double a, double a_end, double b, double b_end) const;

  /// Do the paths, from `s_a` on along that of A and from `s_b` on along that of B, lie on common
  /// ground, then part, and meet again?
  [[nodiscard]] bool parts_and_meets_again(double s_a, double s_b) const;

  /// The first station of A, from `s_a` on, where it may meet a B that drives from `s_b` to
  /// `s_b_end` [m]; infinite if there is none.
  [[nodiscard]] double first_met(double s_a, double s_b, double s_b_end) const;

  /// Is there, as far as bounds of 16 rows each tell, a contact with A within [a, a_end] and B
  /// within [b, b_end]? Never false where sweeps(), meets() or blocks() is true.
  [[nodiscard]] bool reaches(double a, double a_end, double b, double b_end) const {
    return within_bounds(a, a_end, b, b_end) && blocks_reach(row_of(a), row_of(a_end), b, b_end);
  }

  /// Is there any contact with A within [a, a_end]?
  [[nodiscard]] bool concerns(double a, double a_end) const {
    return a <= last_ && a_end >= first_;
  }
  /// The stretch of A's path where there are contacts [m]; its first behind its last if there are
  /// none.
  [[nodiscard]] double first() const { return first_; }
  [[nodiscard]] double last() const { return last_; }
  /// The same of B's path.
  [[nodiscard]] double b_first() const { return double(bounds_.low); }
  [[nodiscard]] double b_last() const { return double(bounds_.high); }

  /// No contact at any position of the two.
  [[nodiscard]] bool empty() const { return intervals_.empty(); }

 private:
  static constexpr std::size_t kBlock = 16;  ///< rows

  /// In rows of this table, the first at 0; whole numbers are where rows begin.
  [[nodiscard]] double row_of(double s_a) const {
    return s_a / ReferencePath::kSpacing + 0.5 - double(first_row_);
  }
  [[nodiscard]] std::size_t rows() const { return begin_.size() - 1; }

  /// Can there be a contact, as far as the bounds of all rows tell?
  [[nodiscard]] bool within_bounds(double a, double a_end, double b, double b_end) const {
    return concerns(a, a_end) && b <= double(bounds_.high) && b_end >= double(bounds_.low);
  }
  /// @param from, to  as row_of() gives
  [[nodiscard]] bool blocks_reach(double from, double to, double b, double b_end) const;

  [[nodiscard]] bool row_meets(std::size_t row, double low, double high) const {
    for (std::uint32_t i = begin_[row]; i < begin_[row + 1]; ++i) {
      if (low <= double(intervals_[i].high) && high >= double(intervals_[i].low)) return true;
    }
    return false;
  }

  /// Adds the contacts of the next row.
  void append_row(std::uint32_t row, std::span<const Run> runs);
  void finish();

  std::uint32_t first_row_ = 0;             ///< the sample of A's path of the first row
  std::vector<std::uint32_t> begin_ = {0};  ///< of each row in intervals_, and one behind the last
  std::vector<Interval> intervals_;
  std::vector<Interval> blocks_;     ///< bounds of kBlock rows each
  Interval bounds_ = {1e9F, -1e9F};  ///< of all rows
  double first_ = 1e9;               ///< [m] along A's path, where the rows begin and
  double last_ = -1e9;               ///< where they end
};

}  // namespace mvtp
