#include "planner/search/occupancy.hpp"

#include <bit>
#include <cmath>

// The scan is compiled for wider vectors too where the compiler can choose between them at run
// time; every version gives the same result.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define MVTP_WIDEST_VECTORS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define MVTP_WIDEST_VECTORS
#endif

namespace mvtp {
namespace {

constexpr float kAway = 1e9F;
constexpr int kBlock = int(Occupancy::kPadding);

/// Writes the numbers of the circles that overlap the given one to `found`.
MVTP_WIDEST_VECTORS
int scan(const float* xs, const float* ys, const float* radii, int count, float x, float y,
         float radius, int* found) {
  int n = 0;
  for (int base = 0; base < count; base += kBlock) {
    unsigned hits = 0;
    for (int l = 0; l < kBlock; ++l) {
      const float dx = xs[base + l] - x;
      const float dy = ys[base + l] - y;
      const float reach = radii[base + l] + radius;
      hits |= (dx * dx + dy * dy < reach * reach ? 1U : 0U) << unsigned(l);
    }
    for (; hits != 0; hits &= hits - 1) found[n++] = base + std::countr_zero(hits);
  }
  return n;
}

struct MotionBounds {
  float excursion;  ///< of the middle of the body from where it is half way
  float travel;     ///< of any point of the body between two time steps
};

MotionBounds bounds_of(const BoxPose* boxes, int macro_step, float half_diagonal) {
  const BoxPose& middle = boxes[macro_step / 2];
  float excursion = 0.0F;
  float travel = 0.0F;
  for (int t = 0; t <= macro_step; ++t) {
    const float dx = boxes[t].x - middle.x;
    const float dy = boxes[t].y - middle.y;
    excursion = std::max(excursion, dx * dx + dy * dy);
    if (t == macro_step) break;
    const float driven = std::hypot(boxes[t + 1].x - boxes[t].x, boxes[t + 1].y - boxes[t].y);
    const float turn = std::abs(boxes[t].ux * boxes[t + 1].uy - boxes[t].uy * boxes[t + 1].ux);
    travel = std::max(travel, driven + turn * half_diagonal);
  }
  // Chords are shorter than arcs, and sines than angles, by less than this.
  constexpr float kArcs = 1.002F;
  return {std::sqrt(excursion) * kArcs, travel * kArcs};
}

}  // namespace

Occupancy::Occupancy(int robots, TimeGrid time)
    : time_(time), stride_((robots + kBlock - 1) / kBlock * kBlock) {
  extend(1);
}

void Occupancy::extend(int rows) {
  const std::size_t size = std::size_t(rows) * std::size_t(stride_);
  const std::size_t old = x_.size();
  const auto grow = [&](auto& values, const auto& absent) {
    values.resize(size, absent);
    if (old == 0) return;
    for (std::size_t k = old; k < size; ++k) values[k] = values[k - std::size_t(stride_)];
  };
  grow(x_, kAway);
  grow(y_, kAway);
  grow(radius_, 0.0F);
  grow(sweeps_, MacroStepSweep{});
  rows_ = rows;
}

void Occupancy::place(int i, const ArcTrajectory& trajectory, const BoxShape& shape) {
  const int moving = (trajectory.arrival() + time_.macro_step - 1) / time_.macro_step;
  const bool leaves = trajectory.departure() != ArcTrajectory::kNever;
  const int present = leaves ? trajectory.departure() / time_.macro_step : ArcTrajectory::kNever;
  const int settled = leaves ? present : moving;
  if (settled >= rows_) extend(settled + 1);
  const float half = shape.half_diagonal();
  const int middle = time_.macro_step / 2;
  for (int k = 0; k < rows_; ++k) {
    if (k >= present) {
      remove(i, k);
      continue;
    }
    const std::size_t here = at(k, i);
    const BoxPose* boxes = trajectory.boxes(k * time_.macro_step);
    x_[here] = boxes[k < moving ? middle : 0].x;
    y_[here] = boxes[k < moving ? middle : 0].y;
    radius_[here] = half;
    sweeps_[here] = {{*boxes, shape.half_length, shape.half_width}, 0.0F};
    if (k >= moving) continue;
    const MotionBounds bounds = bounds_of(boxes, time_.macro_step, half);
    radius_[here] += bounds.excursion;
    sweeps_[here] = {swept_box(boxes, shape, time_.macro_step), bounds.travel};
  }
}

void Occupancy::remove(int i) {
  for (int k = 0; k < rows_; ++k) remove(i, k);
}

void Occupancy::remove(int i, int macro_step) {
  const std::size_t here = at(macro_step, i);
  x_[here] = kAway;
  y_[here] = kAway;
  radius_[here] = 0.0F;
}

int Occupancy::near(int macro_step, float x, float y, float radius, int* found) const {
  const std::size_t row = at(std::min(macro_step, rows_ - 1), 0);
  return scan(x_.data() + row, y_.data() + row, radius_.data() + row, stride_, x, y, radius, found);
}

}  // namespace mvtp
