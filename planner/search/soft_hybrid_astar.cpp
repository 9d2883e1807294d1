#include "planner/search/soft_hybrid_astar.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "planner/geometry/frame.hpp"
#include "planner/geometry/moving_box.hpp"

namespace mvtp {
namespace {

constexpr int kLookAtClock = 256;  ///< expansions between two looks at the clock
/// The cost-to-go is no bound: so much of it may be wrong before the deadline cuts [radii].
constexpr double kSlack = 0.1;

}  // namespace

std::optional<SoftResult> SoftHybridAstar::search(const SoftProblem& problem,
                                                  const SoftOptions& options,
                                                  const Deadline& deadline) {
  problem_ = &problem;
  options_ = options;
  start_search();
  const Pose& start = problem.start;
  Node root{Frame(start),
            0.0F,
            0.0F,
            -1,
            problem.start_macro_step,
            0,
            -1,
            std::int8_t(problem.direction)};
  root.f = estimate(0.0, root.macro_step, to_go(start.x, start.y, start.theta));
  push(root);
  for (int n = 0; n < options.max_expansions && !open_.empty(); ++n) {
    std::pop_heap(open_.begin(), open_.end(), std::greater<>());
    const auto [f, minus_node] = open_.back();
    open_.pop_back();
    if (double(f) >= best_.cost) break;
    const int node = -minus_node;
    const Node& top = nodes_[std::size_t(node)];
    const Pose at = pose(top);
    if (!waits_in_its_cell(top) && least_f_at(at.x, at.y, at.theta, top.macro_step) < top.f)
      continue;
    ++expansions_;
    if (tries_analytic_expansion(n, top)) try_analytic_expansion(node);
    if (n % kLookAtClock == kLookAtClock - 1 && deadline.expired()) break;
    expand(node);
  }
  if (best_.node < 0) return std::nullopt;
  return path();
}

void SoftHybridAstar::start_search() {
  const MotionPrimitives& car = *problem_->car;
  macro_step_duration_ = car.time().macro_step_duration();
  turn_ = car.turn();
  tail_duration_ = 0.0;
  for (const Arc& arc : problem_->tail) {
    tail_duration_ += std::abs(arc.length) / car.vehicle().max_speed;
  }
  nodes_.clear();
  open_.clear();
  best_ = AnalyticExpansion{};
  cells_.clear();
  boxes_.resize(std::size_t(car.time().macro_step) + 1);
  soft_cost_of_resting();
}

void SoftHybridAstar::soft_cost_of_resting() {
  const MotionPrimitives& car = *problem_->car;
  Pose end = problem_->cost_to_go->goal();
  for (const Arc& arc : problem_->tail) end = drive(end, arc);
  const BoxPose goal = box_pose(car.vehicle(), end);
  boxes_.assign(boxes_.size(), goal);
  const OtherRobots& others = problem_->others;
  const int horizon = std::min(others.occupancy->horizon(), others.horizon);
  rest_soft_cost_.assign(std::size_t(horizon) + 2, 0.0F);
  rest_cost_.assign(std::size_t(horizon) + 2, 0.0F);
  for (int k = horizon; k >= 0 && !problem_->leaves; --k) {
    rest_soft_cost_[std::size_t(k)] =
        rest_soft_cost_[std::size_t(k) + 1] +
        soft_cost(k, boxes_.data(), 0.0F, car.shape().half_diagonal());
  }
  rest_cost_.back() = float((horizon + 1) * macro_step_duration_);
  for (int k = horizon; k >= 0; --k) {
    const float now = float(k * macro_step_duration_) + rest_soft_cost_[std::size_t(k)];
    rest_cost_[std::size_t(k)] = std::min(now, rest_cost_[std::size_t(k) + 1]);
  }
}

float SoftHybridAstar::soft_cost(int macro_step, const BoxPose* boxes, float travel, float radius) {
  if (macro_step >= problem_->others.horizon) return 0.0F;
  const BoxPose& middle = boxes[problem_->car->time().macro_step / 2];
  const Occupancy& occupancy = *problem_->others.occupancy;
  const int near = occupancy.near(macro_step, middle.x, middle.y, radius, found_.data());
  if (near == 0) return 0.0F;
  BoxShape own = problem_->car->shape();
  own.travel = travel;
  const SweptBox swept = swept_box(boxes, own, problem_->car->time().macro_step);
  nearby_ = 0;
  for (int k = 0; k < near; ++k) {
    const int j = found_[std::size_t(k)];
    if (!apart(swept, occupancy.sweep(macro_step, j).swept)) found_[std::size_t(nearby_++)] = j;
  }
  return soft_cost_of_nearby(macro_step, boxes, travel);
}

void SoftHybridAstar::update_neighbours(int macro_step, const BoxPose& middle, float radius) {
  const OtherRobots& others = problem_->others;
  around_ = 0;
  if (macro_step >= others.horizon) return;
  around_ = others.occupancy->near(macro_step, middle.x, middle.y, radius, around_list_.data());
}

bool SoftHybridAstar::anyone_nearby(int macro_step, const BoxPose& halfway, float radius,
                                    const SweptBox& swept) {
  const Occupancy& occupancy = *problem_->others.occupancy;
  nearby_ = 0;
  for (int k = 0; k < around_; ++k) {
    const int j = around_list_[std::size_t(k)];
    if (!occupancy.overlaps(macro_step, j, halfway.x, halfway.y, radius)) continue;
    if (!apart(swept, occupancy.sweep(macro_step, j).swept)) found_[std::size_t(nearby_++)] = j;
  }
  return nearby_ > 0;
}

float SoftHybridAstar::soft_cost_of_nearby(int macro_step, const BoxPose* boxes, float travel) {
  const OtherRobots& others = problem_->others;
  const int time_steps = problem_->car->time().macro_step;
  BoxShape own = problem_->car->shape();
  own.travel = travel;
  const int t = macro_step * time_steps;
  float sum = 0.0F;
  for (int k = 0; k < nearby_; ++k) {
    const std::size_t j = std::size_t(found_[std::size_t(k)]);
    BoxShape other = others.shapes[j];
    other.travel = others.occupancy->sweep(macro_step, int(j)).travel;
    if (meet(boxes, own, others.trajectories[j].boxes(t), other, time_steps))
      sum += others.soft_costs[j];
  }
  return sum;
}

/// Of those around, for a motion primitive that begins at `from`.
float SoftHybridAstar::soft_cost_of_primitive(int macro_step, const Frame& from,
                                              const BoxPose& halfway,
                                              const MotionPrimitives::Primitive& primitive) {
  if (around_ == 0) return 0.0F;
  if (!anyone_nearby(macro_step, halfway, primitive.radius, moved(primitive.swept, from)))
    return 0.0F;
  for (std::size_t t = 0; t < boxes_.size(); ++t) boxes_[t] = moved(primitive.boxes[t], from);
  return soft_cost_of_nearby(macro_step, boxes_.data(), primitive.travel);
}

double SoftHybridAstar::to_go(double x, double y, double theta) const {
  return (*problem_->cost_to_go)({x, y, theta}) / problem_->car->vehicle().max_speed +
         tail_duration_;
}

float SoftHybridAstar::estimate(double soft_cost, int macro_step, double to_go) const {
  const double arrival = macro_step * macro_step_duration_ + to_go;
  const std::size_t k =
      std::min(std::size_t(arrival / macro_step_duration_), rest_cost_.size() - 1);
  return float(soft_cost + std::max(arrival, double(rest_cost_[k])) +
               (options_.weight - 1.0) * to_go);
}

float& SoftHybridAstar::least_f_at(double x, double y, double theta, int macro_step) {
  const double turns = theta / (2.0 * std::numbers::pi);
  const auto heading =
      std::uint64_t((turns - std::floor(turns)) * (2.0 * std::numbers::pi / options_.cell_heading));
  const auto column = std::uint64_t(std::int64_t(std::floor(x / options_.cell)) + (1 << 18));
  const auto row = std::uint64_t(std::int64_t(std::floor(y / options_.cell)) + (1 << 18));
  const std::uint64_t key = ((column << 20U | row) << 8U | heading) << 16U |
                            (std::uint64_t(macro_step / options_.cell_macro_steps) & 0xffffU);
  return cells_.try_emplace(key, std::numeric_limits<float>::infinity()).first->second;
}

/// Has the robot got there by waiting in the cell of its parent? The parent was there earlier, but
/// that does not make it better.
bool SoftHybridAstar::waits_in_its_cell(const Node& node) const {
  return options_.waits && node.primitive == MotionPrimitives::kWait &&
         node.macro_step % options_.cell_macro_steps != 0;
}

void SoftHybridAstar::push(const Node& node) {
  nodes_.push_back(node);
  open_.emplace_back(node.f, -int(nodes_.size() - 1));
  std::push_heap(open_.begin(), open_.end(), std::greater<>());
}

void SoftHybridAstar::expand(int node) {
  // Everyone whom any of the motion primitives might touch, once for all of them.
  const MotionPrimitives& car = *problem_->car;
  const Node& from = nodes_[std::size_t(node)];
  update_neighbours(from.macro_step, box_pose(from.at, car.ahead()), car.reach_of_all());
  const int primitives = options_.slowly ? int(car.primitives().size()) : MotionPrimitives::kQuick;
  for (int a = 0; a < primitives; ++a) try_primitive(node, a);
}

void SoftHybridAstar::try_primitive(int parent, int a) {
  const MotionPrimitives& car = *problem_->car;
  const MotionPrimitives::Primitive& primitive = car.primitives()[std::size_t(a)];
  const Node from = nodes_[std::size_t(parent)];
  Node child = from;
  child.parent = parent;
  child.primitive = std::int8_t(a);
  child.macro_step = from.macro_step + 1;
  child.turns = from.turns + primitive.turn;
  if (primitive.arc.length != 0.0) child.direction = primitive.arc.length > 0.0 ? 1 : -1;
  if (child.direction * from.direction < 0) child.soft_cost += float(options_.reversal);
  child.at = from.at.then(primitive.end);
  const double theta = heading(child.turns);
  const double h = to_go(child.at.x, child.at.y, theta);
  const double slack = kSlack * car.vehicle().min_turning_radius / car.vehicle().max_speed;
  if (child.macro_step * macro_step_duration_ + h - slack > problem_->deadline * car.time().dt)
    return;
  child.f = estimate(double(child.soft_cost), child.macro_step, h);
  if (double(child.f) >= best_.cost) return;
  float& least_f = least_f_at(child.at.x, child.at.y, theta, child.macro_step);
  const bool waits = waits_in_its_cell(child);
  if (least_f <= child.f && !waits) return;

  const BoxPose halfway = moved(primitive.boxes[std::size_t(car.time().macro_step / 2)], from.at);
  if (a != MotionPrimitives::kWait && !car.is_free(pose(from), primitive.arc, halfway)) return;
  const float more = soft_cost_of_primitive(from.macro_step, from.at, halfway, primitive);
  if (options_.hard && more > 0.0F) return;
  child.soft_cost += more;
  child.f += more;
  if ((least_f <= child.f && !waits) || double(child.f) >= best_.cost) return;
  least_f = std::min(least_f, child.f);
  push(child);
}

}  // namespace mvtp
