#include "tools/toio/plan/release_graph.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kStep = 0.01;  // between two places of a sweep [s]
/// Grows the bodies, for what they do between two places: half of what a corner moves in kStep at
/// 75 mm/s, most of it covered by the places of the other body.
constexpr double kBetween = 0.0004;

void add_circle(SegmentSweep& sweep) {
  double min_x = sweep.boxes.front().x;
  double max_x = min_x;
  double min_y = sweep.boxes.front().y;
  double max_y = min_y;
  for (const OrientedBox& box : sweep.boxes) {
    min_x = std::min(min_x, box.x);
    max_x = std::max(max_x, box.x);
    min_y = std::min(min_y, box.y);
    max_y = std::max(max_y, box.y);
  }
  const OrientedBox& any = sweep.boxes.front();
  sweep.centre = {(min_x + max_x) / 2, (min_y + max_y) / 2};
  sweep.radius =
      std::hypot(max_x - min_x, max_y - min_y) / 2 + std::hypot(any.half_length, any.half_width);
}

bool meet(const SegmentSweep& a, const SegmentSweep& b) {
  const double reach = a.radius + b.radius;
  if (std::hypot(a.centre.x - b.centre.x, a.centre.y - b.centre.y) > reach) return false;
  return std::ranges::any_of(a.boxes, [&](const OrientedBox& p) {
    return std::ranges::any_of(b.boxes,
                               [&](const OrientedBox& q) { return separation(p, q) < 0.0; });
  });
}

/// Segment `k` of a robot; the rest at its goal if it has arrived.
const SegmentSweep& segment_at(const std::vector<SegmentSweep>& sweeps, std::size_t k) {
  return sweeps[std::min(k, sweeps.size() - 1)];
}

/// The first time of the plan at which two robots are blocking each other.
std::optional<std::size_t> same_time(const std::vector<SegmentSweep>& a,
                                     const std::vector<SegmentSweep>& b) {
  for (std::size_t k = 0; k < std::max(a.size(), b.size()); ++k) {
    if (meet(segment_at(a, k), segment_at(b, k))) return k;
  }
  return std::nullopt;
}

/// What j has to wait for of robot i, added to its requirements.
void add_requirements(const std::vector<SegmentSweep>& of_i, std::size_t i,
                      const std::vector<SegmentSweep>& of_j, std::vector<Requirement>& result) {
  std::size_t left = 0;  // segments of i below this one are required to be left already
  for (std::size_t b = 1; b < of_j.size(); ++b) {
    // The rest at the goal is never left; same_time() has looked at it.
    for (std::size_t a = std::min(b, of_i.size() - 1); a-- > left;) {
      if (!meet(of_i[a], of_j[b])) continue;
      result.push_back({b, i, a});
      left = a + 1;
      break;
    }
  }
}

}  // namespace

std::vector<SegmentSweep> sweeps_of(const Reference& reference, const Vehicle& body) {
  Vehicle grown = body;
  grown.front += kBetween;
  grown.rear += kBetween;
  grown.width += 2 * kBetween;
  const std::vector<double>& starts = reference.segment_starts();
  std::vector<SegmentSweep> sweeps;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    SegmentSweep sweep;
    const double end = k + 1 < starts.size() ? starts[k + 1] : starts[k];
    const int count = int(std::ceil((end - starts[k]) / kStep));
    for (int n = 0; n <= count; ++n) {
      const double time = n == count ? end : starts[k] + n * kStep;
      sweep.boxes.push_back(footprint(grown, reference.at(time).pose));
    }
    add_circle(sweep);
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

std::variant<ReleaseGraph, SweepConflict> build_release_graph(
    const std::vector<std::vector<SegmentSweep>>& sweeps) {
  ReleaseGraph graph(sweeps.size());
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    for (std::size_t j = i + 1; j < sweeps.size(); ++j) {
      if (const auto segment = same_time(sweeps[i], sweeps[j])) {
        return SweepConflict{i, j, *segment};
      }
      add_requirements(sweeps[i], i, sweeps[j], graph[j]);
      add_requirements(sweeps[j], j, sweeps[i], graph[i]);
    }
  }
  for (std::vector<Requirement>& requirements : graph) {
    std::ranges::stable_sort(requirements, {}, &Requirement::segment);
  }
  return graph;
}

double released_until(std::span<const Requirement> requirements,
                      const std::vector<Reference>& references, std::size_t robot,
                      std::span<const double> reached) {
  for (const Requirement& requirement : requirements) {
    const double left = references[requirement.robot].segment_starts()[requirement.left + 1];
    if (reached[requirement.robot] < left) {
      return references[robot].segment_starts()[requirement.segment];
    }
  }
  return references[robot].end();
}

}  // namespace mvtp
