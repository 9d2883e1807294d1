// Analytic expansions: Reeds-Shepp paths to the goal, and the whole path that the best of them
// ends.

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/geometry/frame.hpp"
#include "planner/geometry/moving_box.hpp"
#include "planner/search/soft_hybrid_astar.hpp"

namespace mvtp {
namespace {

constexpr int kExpansionEvery = 6;  ///< far from the goal one node in so many is tried analytically
constexpr double kExpansionRange = 3.0;  ///< within so many turning radii every node is tried
constexpr double kNoSoftCost = 1e-3;     ///< [s]: such costs are summed up in single precision
constexpr double kRounding = 1e-9;       ///< of a step: no step of its own for so little

/// Time steps that a path takes.
int duration(std::span<const Arc> arcs, double step) {
  int time_steps = 0;
  for (const Arc& arc : arcs) time_steps += int(std::ceil(std::abs(arc.length) / step - kRounding));
  return time_steps;
}

}  // namespace

bool SoftHybridAstar::tries_analytic_expansion(int expansion, const Node& node) const {
  const Vehicle& vehicle = problem_->car->vehicle();
  const double h = to_go(node.at.x, node.at.y, heading(node.turns));
  const bool close =
      (h - tail_duration_) * vehicle.max_speed < kExpansionRange * vehicle.min_turning_radius;
  if (!close && expansion % kExpansionEvery != 0) return false;
  return double(node.soft_cost) + node.macro_step * macro_step_duration_ + h < best_.cost;
}

void SoftHybridAstar::try_analytic_expansion(int node) {
  const MotionPrimitives& car = *problem_->car;
  const Node& from = nodes_[std::size_t(node)];
  const Pose start = pose(from);
  const Pose& goal = problem_->cost_to_go->goal();
  const ReedsSheppPath analytic_expansion =
      reeds_shepp_path(start, goal, car.vehicle().min_turning_radius);
  const std::span<const Arc> arcs = to_the_end(analytic_expansion);
  const int time_steps = car.time().macro_step;
  const int arrival = from.macro_step * time_steps + duration(arcs, car.step_length());
  if (arrival > problem_->deadline) return;
  const std::size_t rest =
      std::min(std::size_t((arrival + time_steps - 1) / time_steps), rest_soft_cost_.size() - 1);
  const double reversals = cost_of_reversals(from.direction, arcs);
  const double cost =
      double(from.soft_cost) + reversals + arrival * car.time().dt + double(rest_soft_cost_[rest]);
  if (cost >= best_.cost) return;
  const double soft_cost = follow(start, from.macro_step, arcs, best_.cost - cost);
  if (cost + soft_cost >= best_.cost) return;
  if (options_.hard && double(rest_soft_cost_[rest]) + soft_cost > 0.0) return;
  best_.node = node;
  best_.arcs = analytic_expansion;
  best_.cost = cost + soft_cost;
  best_.soft_cost = double(from.soft_cost) + reversals + double(rest_soft_cost_[rest]) + soft_cost;
}

std::span<const Arc> SoftHybridAstar::to_the_end(const ReedsSheppPath& analytic_expansion) {
  if (problem_->tail.empty()) return {analytic_expansion.begin(), analytic_expansion.end()};
  to_the_end_.assign(analytic_expansion.begin(), analytic_expansion.end());
  to_the_end_.insert(to_the_end_.end(), problem_->tail.begin(), problem_->tail.end());
  return to_the_end_;
}

double SoftHybridAstar::cost_of_reversals(int direction, std::span<const Arc> arcs) const {
  double sum = 0.0;
  for (const Arc& arc : arcs) {
    if (arc.length * direction < 0.0) sum += options_.reversal;
    if (arc.length != 0.0) direction = arc.length > 0.0 ? 1 : -1;
  }
  return sum;
}

/// The soft-collision cost of the arcs from the beginning of a macro step on, infinite if they are
/// not free; stops once it is `most`.
double SoftHybridAstar::follow(const Pose& start, int macro_step, std::span<const Arc> arcs,
                               double most) {
  const MotionPrimitives& car = *problem_->car;
  const int whole = car.time().macro_step;
  const double step = car.step_length();
  PropagatedState state{Frame(start), start.theta, macro_step};
  for (const Arc& arc : arcs) {
    const MotionPrimitives::Primitive* primitive = car.beginning_of(arc);
    for (double left = std::abs(arc.length); left > kRounding * step;) {
      double driven = whole * step;
      bool free = false;
      if (primitive != nullptr && state.time_steps == 0 && left >= driven) {
        free = propagate_primitive(state, *primitive);
      } else {
        const int time_steps =
            std::min(whole - state.time_steps, int(std::ceil(left / step - kRounding)));
        driven = std::min(left, time_steps * step);
        free = propagate_arc(state, {std::copysign(driven, arc.length), arc.curvature}, time_steps);
      }
      if (!free) return std::numeric_limits<double>::infinity();
      if (state.soft_cost >= most) return state.soft_cost;
      left -= driven;
    }
  }
  if (state.time_steps > 0) end_macro_step(state);
  return state.soft_cost;
}

/// For a macro step, from its beginning on. @return false if the map is blocking
bool SoftHybridAstar::propagate_primitive(PropagatedState& state,
                                          const MotionPrimitives::Primitive& primitive) {
  const MotionPrimitives& car = *problem_->car;
  const BoxPose halfway = moved(primitive.boxes[std::size_t(car.time().macro_step / 2)], state.at);
  if (!car.is_free({state.at.x, state.at.y, state.theta}, primitive.arc, halfway)) return false;
  update_neighbours(state.macro_step, halfway, primitive.radius);
  state.soft_cost += double(soft_cost_of_primitive(state.macro_step, state.at, halfway, primitive));
  state.at = state.at.then(primitive.end);
  state.theta += primitive.arc.length * primitive.arc.curvature;
  ++state.macro_step;
  return true;
}

/// For so many time steps, all but the last at full speed, at most to the end of the macro step.
/// @return false if the map is blocking
bool SoftHybridAstar::propagate_arc(PropagatedState& state, const Arc& arc, int time_steps) {
  const MotionPrimitives& car = *problem_->car;
  const double ahead = car.ahead();
  const Frame middle = state.at.then(arc_end({arc.length / 2, arc.curvature}));
  if (!car.is_free({state.at.x, state.at.y, state.theta}, arc, box_pose(middle, ahead))) {
    return false;
  }
  if (state.time_steps == 0) boxes_[0] = box_pose(state.at, ahead);
  const Frame end = state.at.then(arc_end(arc));
  const Frame step = arc_end({std::copysign(car.step_length(), arc.length), arc.curvature});
  for (int k = 1; k <= time_steps; ++k) {
    state.at = k < time_steps ? state.at.then(step) : end;
    boxes_[std::size_t(++state.time_steps)] = box_pose(state.at, ahead);
  }
  state.theta += arc.length * arc.curvature;
  if (state.time_steps == car.time().macro_step) end_macro_step(state);
  return true;
}

/// Adds the soft-collision cost of what was driven of a macro step and of resting for the
/// remainder.
void SoftHybridAstar::end_macro_step(PropagatedState& state) {
  const auto driven = boxes_.begin() + state.time_steps;
  std::fill(driven, boxes_.end(), *driven);
  const MotionPrimitives& car = *problem_->car;
  state.soft_cost +=
      double(soft_cost(state.macro_step, boxes_.data(), car.shape().travel, car.reach()));
  ++state.macro_step;
  state.time_steps = 0;
}

SoftResult SoftHybridAstar::path() {
  const MotionPrimitives& car = *problem_->car;
  const int time_steps = car.time().macro_step;
  const Node& last = nodes_[std::size_t(best_.node)];
  const std::span<const Arc> arcs = to_the_end(best_.arcs);
  double reversals = cost_of_reversals(last.direction, arcs);
  std::vector<int> primitives;
  for (int n = best_.node; nodes_[std::size_t(n)].parent >= 0; n = nodes_[std::size_t(n)].parent) {
    const Node& node = nodes_[std::size_t(n)];
    primitives.push_back(node.primitive);
    const bool reversed = node.direction * nodes_[std::size_t(node.parent)].direction < 0;
    reversals += reversed ? options_.reversal : 0.0;
  }
  SoftResult path;
  path.cost = best_.cost;
  path.soft_cost = reversals == 0.0 ? best_.soft_cost : std::max(0.0, best_.soft_cost - reversals);
  if (path.soft_cost < kNoSoftCost) path.soft_cost = 0.0;
  path.steps.reserve(primitives.size() * std::size_t(time_steps) +
                     std::size_t(duration(arcs, car.step_length())));
  for (auto a = primitives.rbegin(); a != primitives.rend(); ++a) {
    const Arc& arc = car.primitives()[std::size_t(*a)].arc;
    path.steps.insert(path.steps.end(), std::size_t(time_steps),
                      Arc{arc.length / time_steps, arc.curvature});
  }
  const double step = car.step_length();
  for (const Arc& arc : arcs) {
    const double sign = arc.length < 0.0 ? -1.0 : 1.0;
    for (double left = std::abs(arc.length); left > kRounding * step; left -= step) {
      path.steps.push_back({sign * std::min(left, step), arc.curvature});
    }
  }
  return path;
}

}  // namespace mvtp
