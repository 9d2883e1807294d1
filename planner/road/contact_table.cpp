#include "planner/road/contact_table.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kHalf = ReferencePath::kSpacing / 2.0;
/// [m]: a car that brakes or speeds up is never further than a h^2 / 8 from where it would be at an
/// even speed, h between two looks: for two cars at 4.5 m/s^2 and 0.25 s, the longest step.
constexpr double kUneven = 0.07;

PlaneBounds bounds_of(const OrientedBox& b) {
  const double x = std::abs(b.ux) * b.half_length + std::abs(b.uy) * b.half_width;
  const double y = std::abs(b.uy) * b.half_length + std::abs(b.ux) * b.half_width;
  return {b.x - x, b.x + x, b.y - y, b.y + y};
}

/// The samples of `b` in chunks that may reach into `near`: pairs of the first and one behind.
void find_near(const SweptPath& b, const PlaneBounds& near,
               std::vector<std::pair<std::size_t, std::size_t>>& ranges) {
  ranges.clear();
  for (std::size_t c = 0; c < b.chunks().size(); ++c) {
    if (!b.chunks()[c].overlaps(near)) continue;
    const std::size_t first = c * SweptPath::kChunk;
    const std::size_t behind = std::min(first + SweptPath::kChunk, b.samples());
    if (!ranges.empty() && ranges.back().second == first) {
      ranges.back().second = behind;
    } else {
      ranges.emplace_back(first, behind);
    }
  }
}

/// The rectangles of a stretch of a path.
class Boxes {
 public:
  /// From the first to the last chunk that reaches into `near`.
  Boxes(const SweptPath& path, const PlaneBounds& near) {
    std::vector<std::pair<std::size_t, std::size_t>> ranges;
    find_near(path, near, ranges);
    if (ranges.empty()) return;
    first_ = ranges.front().first;
    for (std::size_t i = first_; i < ranges.back().second; ++i) boxes_.push_back(path.box(i));
  }
  [[nodiscard]] std::size_t first() const { return first_; }
  [[nodiscard]] std::size_t behind() const { return first_ + boxes_.size(); }
  const OrientedBox& operator[](std::size_t i) const { return boxes_[i - first_]; }

 private:
  std::size_t first_ = 0;
  std::vector<OrientedBox> boxes_;
};

}  // namespace

void PlaneBounds::include(const PlaneBounds& other) {
  x_low = std::min(x_low, other.x_low);
  x_high = std::max(x_high, other.x_high);
  y_low = std::min(y_low, other.y_low);
  y_high = std::max(y_high, other.y_high);
}

SweptPath::SweptPath(const ReferencePath& path, const Vehicle& body, const Margins& margins)
    : path_(&path), grown_(body) {
  grown_.front += margins.along / 2.0;
  grown_.rear += margins.along / 2.0;
  grown_.width += margins.across;
  double most_turn = 0.0;
  for (std::size_t i = 0; i < path.samples(); ++i) {
    if (i % kChunk == 0) chunks_.emplace_back();
    chunks_.back().include(bounds_of(box(i)));
    if (i == 0) continue;
    const double turn = path.sample(i).theta - path.sample(i - 1).theta;
    most_turn = std::max(most_turn, std::abs(wrap_to_pi(turn)));
  }
  for (const PlaneBounds& chunk : chunks_) bounds_.include(chunk);
  least_margin_ = std::min(margins.along, margins.across);
  const double arm = std::hypot(std::max(grown_.front, grown_.rear), grown_.width / 2.0);
  stride_ = path.longest_step() + arm * most_turn + 1e-9;
}

ContactTable::ContactTable(const ReferencePath& path_a, const Vehicle& body_a,
                           const ReferencePath& path_b, const Vehicle& body_b,
                           const Margins& margins)
    : ContactTable(SweptPath(path_a, body_a, margins), SweptPath(path_b, body_b, margins)) {}

ContactTable::ContactTable(const SweptPath& a, const SweptPath& b) {
  std::vector<std::pair<std::size_t, std::size_t>> near;
  std::vector<Run> runs;
  const double apart = (a.least_margin() + b.least_margin()) / 2.0;
  const double slack = std::max(0.0, (a.stride() + b.stride()) / 2.0 + kUneven - apart);
  const Boxes on_a(a, b.bounds());
  const Boxes on_b(b, a.bounds());
  for (std::size_t i = on_a.first(); i < on_a.behind(); ++i) {
    if (i % SweptPath::kChunk == 0) find_near(b, a.chunks()[i / SweptPath::kChunk], near);
    runs.clear();
    for (const auto& [first, behind] : near) {
      bool inside = false;
      for (std::size_t j = first; j < behind;) {
        const double gap = separation(on_a[i], on_b[j]) - slack;
        // From sample to sample the gap, and likewise how deep the boxes overlap, changes by a
        // stride at most: nothing changes at the samples that are left out.
        const double sure = std::floor((std::abs(gap) - 1e-9) / b.stride());
        const std::size_t next = std::min(j + 1 + std::size_t(std::max(0.0, sure)), behind);
        if (gap <= 0.0) {
          if (!inside) runs.emplace_back(std::uint32_t(j), std::uint32_t(j));
          runs.back().second = std::uint32_t(next - 1);
        }
        inside = gap <= 0.0;
        j = next;
      }
    }
    append_row(std::uint32_t(i), runs);
  }
  finish();
}

ContactTable::ContactTable(const std::map<std::uint32_t, std::vector<Run>>& rows) {
  for (const auto& [row, runs] : rows) {
    // Rows without a contact in between.
    for (auto next = first_row_ + std::uint32_t(begin_.size()) - 1; !empty() && next < row;
         ++next) {
      append_row(next, {});
    }
    append_row(row, runs);
  }
  finish();
}

void ContactTable::append_row(std::uint32_t row, std::span<const Run> runs) {
  if (intervals_.empty()) {
    if (runs.empty()) return;
    first_row_ = row;
  }
  for (const auto& [first, last] : runs) {
    intervals_.push_back({float(double(first) * ReferencePath::kSpacing - kHalf),
                          float(double(last) * ReferencePath::kSpacing + kHalf)});
  }
  begin_.push_back(std::uint32_t(intervals_.size()));
}

void ContactTable::finish() {
  while (begin_.size() > 1 && begin_[begin_.size() - 2] == begin_.back()) begin_.pop_back();
  for (std::size_t row = 0; row < rows(); ++row) {
    if (row % kBlock == 0) blocks_.push_back({1e9F, -1e9F});
    for (std::uint32_t i = begin_[row]; i < begin_[row + 1]; ++i) {
      blocks_.back().low = std::min(blocks_.back().low, intervals_[i].low);
      blocks_.back().high = std::max(blocks_.back().high, intervals_[i].high);
    }
    bounds_.low = std::min(bounds_.low, blocks_.back().low);
    bounds_.high = std::max(bounds_.high, blocks_.back().high);
  }
  if (!empty()) {
    // A little inside, so that row_of() rounds into the rows.
    first_ = (double(first_row_) - 0.5) * ReferencePath::kSpacing + 1e-9;
    last_ = first_ + double(rows()) * ReferencePath::kSpacing - 2e-9;
  }
  begin_.shrink_to_fit();
  intervals_.shrink_to_fit();
}

ContactTable ContactTable::transposed() const {
  if (empty()) return {};
  const auto sample = [](float s, double half) {
    return std::uint32_t(std::lround((double(s) + half) / ReferencePath::kSpacing));
  };
  const std::uint32_t first = sample(bounds_.low, kHalf);
  std::vector<std::vector<Run>> columns(sample(bounds_.high, -kHalf) - first + 1);
  for (std::uint32_t row = 0; row < rows(); ++row) {
    const std::uint32_t s_a = first_row_ + row;
    for (std::uint32_t i = begin_[row]; i < begin_[row + 1]; ++i) {
      const std::uint32_t last = sample(intervals_[i].high, -kHalf);
      for (std::uint32_t s_b = sample(intervals_[i].low, kHalf); s_b <= last; ++s_b) {
        std::vector<Run>& column = columns[s_b - first];
        if (!column.empty() && column.back().second + 1 == s_a) {
          column.back().second = s_a;
        } else {
          column.emplace_back(s_a, s_a);
        }
      }
    }
  }
  ContactTable table;
  for (std::uint32_t c = 0; c < columns.size(); ++c) table.append_row(first + c, columns[c]);
  table.finish();
  return table;
}

bool ContactTable::sweeps(double a, double a_end, double b, double b_end) const {
  if (!within_bounds(a, a_end, b, b_end)) return false;
  const double from = row_of(a);
  const double to = row_of(a_end);
  const auto first = std::size_t(std::max(from, 0.0));
  const auto last = std::size_t(std::min(to, double(rows()) - 1.0));
  const double b_per_row = to > from ? (b_end - b) / (to - from) : 0.0;
  for (std::size_t row = first; row <= last; ++row) {
    const bool enters = double(row) > from;
    const bool leaves = double(row + 1) < to;
    const double low = enters ? b + (double(row) - from) * b_per_row : b;
    const double high = leaves ? b + (double(row + 1) - from) * b_per_row : b_end;
    if (row_meets(row, low, high)) return true;
  }
  return false;
}

bool ContactTable::meets(double a, double a_end, double b, double b_end) const {
  if (!within_bounds(a, a_end, b, b_end)) return false;
  const auto first = std::size_t(std::max(row_of(a), 0.0));
  const auto last = std::size_t(std::min(row_of(a_end), double(rows()) - 1.0));
  for (std::size_t row = first; row <= last; ++row) {
    if (row_meets(row, b, b_end)) return true;
  }
  return false;
}

bool ContactTable::parts_and_meets_again(double s_a, double s_b) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bool is_common = false, has_parted = false;
  for (auto row = std::size_t(std::max(row_of(s_a), 0.0)); row < rows(); ++row) {
    const bool meets = row_meets(row, s_b, kInfinity);
    if (meets && has_parted) return true;
    has_parted |= is_common && !meets;
    is_common |= meets;
  }
  return false;
}

double ContactTable::first_met(double s_a, double s_b, double s_b_end) const {
  for (auto row = std::size_t(std::max(row_of(s_a), 0.0)); row < rows(); ++row) {
    if (!row_meets(row, s_b, s_b_end)) continue;
    return (double(first_row_) + double(row) - 0.5) * ReferencePath::kSpacing;
  }
  return std::numeric_limits<double>::infinity();
}

bool ContactTable::blocks_reach(double from, double to, double b, double b_end) const {
  const std::size_t last = std::size_t(std::min(to, double(rows()) - 1.0)) / kBlock;
  for (std::size_t block = std::size_t(std::max(from, 0.0)) / kBlock; block <= last; ++block) {
    if (b <= double(blocks_[block].high) && b_end >= double(blocks_[block].low)) return true;
  }
  return false;
}

}  // namespace mvtp
