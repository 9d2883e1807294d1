#include "planner/search/soft_astar.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "planner/geometry/frame.hpp"

namespace mvtp {
namespace {

constexpr int kLookAtClock = 256;   ///< expansions between two looks at the clock
constexpr int kShotEvery = 6;       ///< expansions between two shots far from the goal
constexpr double kShotRange = 3.0;  ///< within so many turning radii every node shoots
/// The cost-to-go is no bound: so much of it may be wrong before the deadline cuts [radii].
constexpr double kSlack = 0.1;
constexpr double kNoPrice = 1e-3;   ///< [s]: prices are summed up in single precision
constexpr double kRounding = 1e-9;  ///< of a step: no step of its own for so little
constexpr int kRoomFor = 1 << 12;   ///< expansions, before the table of cells has to grow

/// Instants that a path takes.
int duration(std::span<const Arc> arcs, double step) {
  int instants = 0;
  for (const Arc& arc : arcs) instants += int(std::ceil(std::abs(arc.length) / step - kRounding));
  return instants;
}

/// A box given in the frame of a car, in the world.
BoxPose moved(const BoxPose& box, const Frame& car) {
  const Point middle = car.world(double(box.x), double(box.y));
  const float ux = float(car.ux);
  const float uy = float(car.uy);
  return {float(middle.x), float(middle.y), ux * box.ux - uy * box.uy, uy * box.ux + ux * box.uy};
}

SweptBox moved(const SweptBox& box, const Frame& car) {
  return {moved(box.pose, car), box.half_length, box.half_width};
}

}  // namespace

std::optional<SoftPath> SoftAstar::search(const SoftProblem& problem, const SoftOptions& options,
                                          const Deadline& deadline) {
  problem_ = &problem;
  options_ = options;
  prepare();
  const Pose& start = problem.start;
  Node root{Frame(start),         0.0F, 0.0F, -1,
            problem.start_bucket, 0,    -1,   std::int8_t(problem.direction)};
  root.f = estimate(0.0, root.bucket, to_go(start.x, start.y, start.theta));
  push(root);
  for (int n = 0; n < options.max_expansions && !open_.empty(); ++n) {
    std::pop_heap(open_.begin(), open_.end(), std::greater<>());
    const auto [f, minus_node] = open_.back();
    open_.pop_back();
    if (double(f) >= best_.cost) break;
    const int node = -minus_node;
    const Node& top = nodes_[std::size_t(node)];
    const Pose at = pose(top);
    if (!waits_in_its_cell(top) && cell_of(at.x, at.y, at.theta, top.bucket).f < top.f) continue;
    ++expansions_;
    if (shoots(n, top)) try_shot(node);
    if (n % kLookAtClock == kLookAtClock - 1 && deadline.expired()) break;
    expand(node);
  }
  if (best_.node < 0) return std::nullopt;
  return path();
}

bool SoftAstar::shoots(int expansion, const Node& node) const {
  const Vehicle& vehicle = problem_->car->vehicle();
  const double h = to_go(node.at.x, node.at.y, heading(node.turns));
  const bool close =
      (h - tail_duration_) * vehicle.max_speed < kShotRange * vehicle.min_turning_radius;
  if (!close && expansion % kShotEvery != 0) return false;
  return double(node.price) + node.bucket * bucket_duration_ + h < best_.cost;
}

void SoftAstar::prepare() {
  const MacroCar& car = *problem_->car;
  bucket_duration_ = car.time().bucket_duration();
  turn_ = car.turn();
  tail_duration_ = 0.0;
  for (const Arc& arc : problem_->tail) {
    tail_duration_ += std::abs(arc.length) / car.vehicle().max_speed;
  }
  nodes_.clear();
  open_.clear();
  best_ = Shot{};
  // Room for what the expansions of most searches can make; small searches stay in the cache.
  const std::size_t room = std::bit_ceil(
      std::size_t(std::min(options_.max_expansions, kRoomFor)) * (options_.slowly ? 20 : 10) + 64);
  clear_cells(room);
  boxes_.resize(std::size_t(car.time().bucket) + 1);
  price_of_resting();
}

void SoftAstar::price_of_resting() {
  const MacroCar& car = *problem_->car;
  Pose end = problem_->cost_to_go->goal();
  for (const Arc& arc : problem_->tail) end = drive(end, arc);
  const BoxPose goal = box_pose(car.vehicle(), end);
  boxes_.assign(boxes_.size(), goal);
  const OtherRobots& others = problem_->others;
  const int horizon = std::min(others.occupancy->horizon(), others.horizon);
  rest_price_.assign(std::size_t(horizon) + 2, 0.0F);
  rest_cost_.assign(std::size_t(horizon) + 2, 0.0F);
  for (int k = horizon; k >= 0 && !problem_->leaves; --k) {
    rest_price_[std::size_t(k)] = rest_price_[std::size_t(k) + 1] +
                                  price(k, boxes_.data(), 0.0F, car.shape().half_diagonal());
  }
  rest_cost_.back() = float((horizon + 1) * bucket_duration_);
  for (int k = horizon; k >= 0; --k) {
    const float now = float(k * bucket_duration_) + rest_price_[std::size_t(k)];
    rest_cost_[std::size_t(k)] = std::min(now, rest_cost_[std::size_t(k) + 1]);
  }
}

float SoftAstar::price(int bucket, const BoxPose* boxes, float travel, float radius) {
  if (bucket >= problem_->others.horizon) return 0.0F;
  const BoxPose& middle = boxes[problem_->car->time().bucket / 2];
  const Occupancy& occupancy = *problem_->others.occupancy;
  const int near = occupancy.near(bucket, middle.x, middle.y, radius, found_.data());
  if (near == 0) return 0.0F;
  BoxShape own = problem_->car->shape();
  own.travel = travel;
  const SweptBox swept = swept_box(boxes, own, problem_->car->time().bucket);
  nearby_ = 0;
  for (int k = 0; k < near; ++k) {
    const int j = found_[std::size_t(k)];
    if (!apart(swept, occupancy.motion(bucket, j).swept)) found_[std::size_t(nearby_++)] = j;
  }
  return price_of_nearby(bucket, boxes, travel);
}

void SoftAstar::look_around(int bucket, const BoxPose& middle, float radius) {
  const OtherRobots& others = problem_->others;
  around_ = 0;
  if (bucket >= others.horizon) return;
  around_ = others.occupancy->near(bucket, middle.x, middle.y, radius, around_list_.data());
}

bool SoftAstar::anyone_nearby(int bucket, const BoxPose& halfway, float radius,
                              const SweptBox& swept) {
  const Occupancy& occupancy = *problem_->others.occupancy;
  nearby_ = 0;
  for (int k = 0; k < around_; ++k) {
    const int j = around_list_[std::size_t(k)];
    if (!occupancy.overlaps(bucket, j, halfway.x, halfway.y, radius)) continue;
    if (!apart(swept, occupancy.motion(bucket, j).swept)) found_[std::size_t(nearby_++)] = j;
  }
  return nearby_ > 0;
}

float SoftAstar::price_of_nearby(int bucket, const BoxPose* boxes, float travel) {
  const OtherRobots& others = problem_->others;
  const int instants = problem_->car->time().bucket;
  BoxShape own = problem_->car->shape();
  own.travel = travel;
  const int t = bucket * instants;
  float sum = 0.0F;
  for (int k = 0; k < nearby_; ++k) {
    const std::size_t j = std::size_t(found_[std::size_t(k)]);
    BoxShape other = others.shapes[j];
    other.travel = others.occupancy->motion(bucket, int(j)).travel;
    if (meet(boxes, own, others.tracks[j].boxes(t), other, instants)) sum += others.prices[j];
  }
  return sum;
}

/// Of those around, for an action that begins at `from`.
float SoftAstar::price_of_action(int bucket, const Frame& from, const BoxPose& halfway,
                                 const MacroCar::Action& action) {
  if (around_ == 0) return 0.0F;
  if (!anyone_nearby(bucket, halfway, action.radius, moved(action.swept, from))) return 0.0F;
  for (std::size_t t = 0; t < boxes_.size(); ++t) boxes_[t] = moved(action.boxes[t], from);
  return price_of_nearby(bucket, boxes_.data(), action.travel);
}

double SoftAstar::to_go(double x, double y, double theta) const {
  return (*problem_->cost_to_go)({x, y, theta}) / problem_->car->vehicle().max_speed +
         tail_duration_;
}

float SoftAstar::estimate(double price, int bucket, double to_go) const {
  const double arrival = bucket * bucket_duration_ + to_go;
  const std::size_t k = std::min(std::size_t(arrival / bucket_duration_), rest_cost_.size() - 1);
  return float(price + std::max(arrival, double(rest_cost_[k])) + (options_.weight - 1.0) * to_go);
}

/// Makes the table empty, with room for so many cells. @param room  a power of two
void SoftAstar::clear_cells(std::size_t room) {
  if (cells_.size() < room) {
    cells_.assign(room, {0, 0.0F, 0});
    stamp_ = 0;
  }
  cell_mask_ = room - 1;
  used_cells_ = 0;
  ++stamp_;
}

void SoftAstar::grow_cells() {
  std::vector<Cell> kept;
  for (std::size_t i = 0; i <= cell_mask_; ++i) {
    if (cells_[i].stamp == stamp_) kept.push_back(cells_[i]);
  }
  clear_cells(2 * (cell_mask_ + 1));
  for (const Cell& cell : kept) cell_with(cell.key).f = cell.f;
}

/// The cell with this key, made if need be: linear probing in a table that is never full.
SoftAstar::Cell& SoftAstar::cell_with(std::uint64_t key) {
  std::size_t i = std::size_t(key * 0x9e3779b97f4a7c15U >> 24U) & cell_mask_;
  while (cells_[i].stamp == stamp_ && cells_[i].key != key) i = (i + 1) & cell_mask_;
  if (cells_[i].stamp == stamp_) return cells_[i];
  if (4 * used_cells_ > 3 * cell_mask_) {
    grow_cells();
    return cell_with(key);
  }
  ++used_cells_;
  return cells_[i] = {key, std::numeric_limits<float>::infinity(), stamp_};
}

SoftAstar::Cell& SoftAstar::cell_of(double x, double y, double theta, int bucket) {
  const double turns = theta / (2.0 * std::numbers::pi);
  const auto heading =
      std::uint64_t((turns - std::floor(turns)) * (2.0 * std::numbers::pi / options_.cell_heading));
  const auto column = std::uint64_t(std::int64_t(std::floor(x / options_.cell)) + (1 << 18));
  const auto row = std::uint64_t(std::int64_t(std::floor(y / options_.cell)) + (1 << 18));
  const std::uint64_t key = ((column << 20U | row) << 8U | heading) << 16U |
                            (std::uint64_t(bucket / options_.cell_buckets) & 0xffffU);
  return cell_with(key);
}

/// Has the robot got there by waiting in the cell of its parent? The parent was there earlier, but
/// that does not make it better.
bool SoftAstar::waits_in_its_cell(const Node& node) const {
  return options_.waits && node.action == MacroCar::kWait &&
         node.bucket % options_.cell_buckets != 0;
}

void SoftAstar::push(const Node& node) {
  nodes_.push_back(node);
  open_.emplace_back(node.f, -int(nodes_.size() - 1));
  std::push_heap(open_.begin(), open_.end(), std::greater<>());
}

void SoftAstar::expand(int node) {
  // Everyone whom any of the actions might touch, once for all of them.
  const MacroCar& car = *problem_->car;
  const Node& from = nodes_[std::size_t(node)];
  look_around(from.bucket, box_pose(from.at, car.ahead()), car.reach_of_all());
  const int actions = options_.slowly ? int(car.actions().size()) : MacroCar::kQuick;
  for (int a = 0; a < actions; ++a) try_action(node, a);
}

void SoftAstar::try_action(int parent, int a) {
  const MacroCar& car = *problem_->car;
  const MacroCar::Action& action = car.actions()[std::size_t(a)];
  const Node from = nodes_[std::size_t(parent)];
  Node child = from;
  child.parent = parent;
  child.action = std::int8_t(a);
  child.bucket = from.bucket + 1;
  child.turns = from.turns + action.turn;
  if (action.arc.length != 0.0) child.direction = action.arc.length > 0.0 ? 1 : -1;
  if (child.direction * from.direction < 0) child.price += float(options_.reversal);
  child.at = from.at.then(action.end);
  const double theta = heading(child.turns);
  const double h = to_go(child.at.x, child.at.y, theta);
  const double slack = kSlack * car.vehicle().min_turning_radius / car.vehicle().max_speed;
  if (child.bucket * bucket_duration_ + h - slack > problem_->deadline * car.time().dt) return;
  child.f = estimate(double(child.price), child.bucket, h);
  if (double(child.f) >= best_.cost) return;
  Cell& cell = cell_of(child.at.x, child.at.y, theta, child.bucket);
  const bool waits = waits_in_its_cell(child);
  if (cell.f <= child.f && !waits) return;

  const BoxPose halfway = moved(action.boxes[std::size_t(car.time().bucket / 2)], from.at);
  if (a != MacroCar::kWait && !car.is_free(pose(from), action.arc, halfway)) return;
  const float more = price_of_action(from.bucket, from.at, halfway, action);
  if (options_.hard && more > 0.0F) return;
  child.price += more;
  child.f += more;
  if ((cell.f <= child.f && !waits) || double(child.f) >= best_.cost) return;
  cell.f = std::min(cell.f, child.f);
  push(child);
}

void SoftAstar::try_shot(int node) {
  const MacroCar& car = *problem_->car;
  const Node& from = nodes_[std::size_t(node)];
  const Pose start = pose(from);
  const Pose& goal = problem_->cost_to_go->goal();
  const ReedsSheppPath shot = reeds_shepp_path(start, goal, car.vehicle().min_turning_radius);
  const std::span<const Arc> arcs = to_the_end(shot);
  const int instants = car.time().bucket;
  const int arrival = from.bucket * instants + duration(arcs, car.step_length());
  if (arrival > problem_->deadline) return;
  const std::size_t rest =
      std::min(std::size_t((arrival + instants - 1) / instants), rest_price_.size() - 1);
  const double reversals = price_of_reversals(from.direction, arcs);
  const double cost =
      double(from.price) + reversals + arrival * car.time().dt + double(rest_price_[rest]);
  if (cost >= best_.cost) return;
  const double price = follow(start, from.bucket, arcs, best_.cost - cost);
  if (cost + price >= best_.cost) return;
  if (options_.hard && double(rest_price_[rest]) + price > 0.0) return;
  best_.node = node;
  best_.arcs = shot;
  best_.cost = cost + price;
  best_.price = double(from.price) + reversals + double(rest_price_[rest]) + price;
}

std::span<const Arc> SoftAstar::to_the_end(const ReedsSheppPath& shot) {
  if (problem_->tail.empty()) return {shot.begin(), shot.end()};
  to_the_end_.assign(shot.begin(), shot.end());
  to_the_end_.insert(to_the_end_.end(), problem_->tail.begin(), problem_->tail.end());
  return to_the_end_;
}

double SoftAstar::price_of_reversals(int direction, std::span<const Arc> arcs) const {
  double sum = 0.0;
  for (const Arc& arc : arcs) {
    if (arc.length * direction < 0.0) sum += options_.reversal;
    if (arc.length != 0.0) direction = arc.length > 0.0 ? 1 : -1;
  }
  return sum;
}

/// The price of the arcs from the beginning of a bucket on, infinite if they are not free; stops
/// once it is `most`.
double SoftAstar::follow(const Pose& start, int bucket, std::span<const Arc> arcs, double most) {
  const MacroCar& car = *problem_->car;
  const int whole = car.time().bucket;
  const double step = car.step_length();
  Ride ride{Frame(start), start.theta, bucket};
  for (const Arc& arc : arcs) {
    const MacroCar::Action* action = car.beginning_of(arc);
    for (double left = std::abs(arc.length); left > kRounding * step;) {
      double driven = whole * step;
      bool free = false;
      if (action != nullptr && ride.instants == 0 && left >= driven) {
        free = ride_action(ride, *action);
      } else {
        const int instants =
            std::min(whole - ride.instants, int(std::ceil(left / step - kRounding)));
        driven = std::min(left, instants * step);
        free = ride_piece(ride, {std::copysign(driven, arc.length), arc.curvature}, instants);
      }
      if (!free) return std::numeric_limits<double>::infinity();
      if (ride.price >= most) return ride.price;
      left -= driven;
    }
  }
  if (ride.instants > 0) end_bucket(ride);
  return ride.price;
}

/// For a bucket, from its beginning on. @return false if the map is in the way
bool SoftAstar::ride_action(Ride& ride, const MacroCar::Action& action) {
  const MacroCar& car = *problem_->car;
  const BoxPose halfway = moved(action.boxes[std::size_t(car.time().bucket / 2)], ride.at);
  if (!car.is_free({ride.at.x, ride.at.y, ride.theta}, action.arc, halfway)) return false;
  look_around(ride.bucket, halfway, action.radius);
  ride.price += double(price_of_action(ride.bucket, ride.at, halfway, action));
  ride.at = ride.at.then(action.end);
  ride.theta += action.arc.length * action.arc.curvature;
  ++ride.bucket;
  return true;
}

/// For so many instants, all but the last at full speed, at most to the end of the bucket.
/// @return false if the map is in the way
bool SoftAstar::ride_piece(Ride& ride, const Arc& piece, int instants) {
  const MacroCar& car = *problem_->car;
  const double ahead = car.ahead();
  const Frame middle = ride.at.then(arc_end({piece.length / 2, piece.curvature}));
  if (!car.is_free({ride.at.x, ride.at.y, ride.theta}, piece, box_pose(middle, ahead))) {
    return false;
  }
  if (ride.instants == 0) boxes_[0] = box_pose(ride.at, ahead);
  const Frame end = ride.at.then(arc_end(piece));
  const Frame step = arc_end({std::copysign(car.step_length(), piece.length), piece.curvature});
  for (int k = 1; k <= instants; ++k) {
    ride.at = k < instants ? ride.at.then(step) : end;
    boxes_[std::size_t(++ride.instants)] = box_pose(ride.at, ahead);
  }
  ride.theta += piece.length * piece.curvature;
  if (ride.instants == car.time().bucket) end_bucket(ride);
  return true;
}

/// Adds the price of what was driven of a bucket and of resting for the remainder.
void SoftAstar::end_bucket(Ride& ride) {
  const auto driven = boxes_.begin() + ride.instants;
  std::fill(driven, boxes_.end(), *driven);
  const MacroCar& car = *problem_->car;
  ride.price += double(price(ride.bucket, boxes_.data(), car.shape().travel, car.reach()));
  ++ride.bucket;
  ride.instants = 0;
}

SoftPath SoftAstar::path() {
  const MacroCar& car = *problem_->car;
  const int instants = car.time().bucket;
  const Node& last = nodes_[std::size_t(best_.node)];
  const std::span<const Arc> arcs = to_the_end(best_.arcs);
  double reversals = price_of_reversals(last.direction, arcs);
  std::vector<int> actions;
  for (int n = best_.node; nodes_[std::size_t(n)].parent >= 0; n = nodes_[std::size_t(n)].parent) {
    const Node& node = nodes_[std::size_t(n)];
    actions.push_back(node.action);
    const bool reversed = node.direction * nodes_[std::size_t(node.parent)].direction < 0;
    reversals += reversed ? options_.reversal : 0.0;
  }
  SoftPath path;
  path.cost = best_.cost;
  path.price = reversals == 0.0 ? best_.price : std::max(0.0, best_.price - reversals);
  if (path.price < kNoPrice) path.price = 0.0;
  path.steps.reserve(actions.size() * std::size_t(instants) +
                     std::size_t(duration(arcs, car.step_length())));
  for (auto a = actions.rbegin(); a != actions.rend(); ++a) {
    const Arc& arc = car.actions()[std::size_t(*a)].arc;
    path.steps.insert(path.steps.end(), std::size_t(instants),
                      Arc{arc.length / instants, arc.curvature});
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
