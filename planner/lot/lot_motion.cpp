#include "planner/lot/lot_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/motion/inertial_car.hpp"

namespace mvtp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNearly = 0.005;     ///< [m]: so close to where it stops a slow car is there
constexpr double kSlow = 0.05;        ///< [m/s]
constexpr double kStandstill = 1e-6;  ///< [m] in one step: nobody moves
constexpr int kStagnation = 20;       ///< steps in which nobody moves, before a forecast is over

/// The speed after `dt` from which a car that has `v` now can still slow down to `end` within
/// `distance`.
double braked_speed(double v, double distance, double end, double braking, double dt) {
  const double rest = distance - v * dt / 2 + end * end / (2 * braking);
  if (rest <= 0.0) return 0.0;
  return braking * (std::sqrt(dt * dt / 4 + 2 * rest / braking) - dt / 2);
}

}  // namespace

double LotForecast::driven_at(std::size_t i, double time) const {
  const std::vector<float>& s = driven[i];
  const double cell = std::clamp(time / dt, 0.0, double(s.size() - 1));
  const auto k = std::size_t(cell);
  const std::size_t next = std::min(k + 1, s.size() - 1);
  return double(s[k]) + (cell - double(k)) * double(s[next] - s[k]);
}

double LotForecast::cost() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < driven.size(); ++i) sum += arrives[i] != 0 ? arrival(i) : 0.0;
  return sum;
}

int LotMotion::find(std::int64_t key) const {
  const auto car = std::ranges::lower_bound(cars_, key, {}, &LotCar::key);
  return car != cars_.end() && car->key == key ? int(car - cars_.begin()) : -1;
}

void LotMotion::put(LotCar car) {
  remove(car.key);
  const auto place = std::ranges::lower_bound(cars_, car.key, {}, &LotCar::key);
  cars_.insert(place, std::move(car));
}

void LotMotion::remove(std::int64_t key) {
  std::erase_if(cars_, [key](const LotCar& car) { return car.key == key; });
  std::erase_if(orders_, [key](const auto& order) {
    return order.first.first == key || order.first.second == key;
  });
}

void LotMotion::grant(std::int64_t key, double stop) {
  cars_[std::size_t(find(key))].granted = stop;
}

void LotMotion::set_order(std::int64_t first, std::int64_t second, Precedence order) {
  if (order.empty()) {
    orders_.erase({first, second});
  } else {
    orders_.insert_or_assign({first, second}, std::move(order));
  }
}

void LotMotion::stop_permanently(std::int64_t key) {
  LotCar& car = cars_[std::size_t(find(key))];
  if (car.stopped_permanently) return;
  car.stopped_permanently = true;
  car.path.truncate(car.s + stopping_distance(car.v, limits_.braking));
}

std::vector<std::int64_t> LotMotion::stop_the_blocked_permanently() {
  std::vector<std::int64_t> stopped_permanently;
  for (bool more = true; more;) {
    const LotForecast now = forecast();
    more = false;
    for (std::size_t i = 0; i < cars_.size(); ++i) {
      if (now.arrives[i] != 0 || cars_[i].stopped_permanently || !cars_[i].planned) continue;
      stopped_permanently.push_back(cars_[i].key);
      more = true;
    }
    for (const std::int64_t key : stopped_permanently) stop_permanently(key);
  }
  return stopped_permanently;
}

std::vector<LotMotion::Link> LotMotion::links() const {
  std::vector<Link> result;
  for (const auto& [pair, order] : orders_) {
    const int waiting = find(pair.first);
    const int first = find(pair.second);
    if (waiting >= 0 && first >= 0) {
      result.push_back({std::size_t(waiting), std::size_t(first), &order});
    }
  }
  return result;
}

std::vector<double> LotMotion::turns() const {
  std::vector<double> ends;
  for (const LotCar& car : cars_) ends.push_back(car.granted);
  for (Link& link : links()) {
    double& end = ends[link.waiting];
    end = std::min(end, link.order->limit(cars_[link.first].s, link.hint));
  }
  return ends;
}

double LotMotion::time_until(const LotCar& car, double s, double stop) const {
  constexpr double kTimeStep = 0.1;  // [s]
  constexpr double kLongest = 60.0;  // [s]
  double time = 0.0;
  for (State now{car.s, car.v}; now.s < s; time += kTimeStep) {
    const State next = advance(car, now, stop, kTimeStep);
    const bool stands = next.s <= now.s + kStandstill && next.v <= now.v;
    if (stands || time > kLongest) return kInfinity;
    now = next;
  }
  return time;
}

double LotMotion::rest_after(const LotCar& car, double time) const {
  constexpr double kTimeStep = 0.1;  // [s]
  State now{car.s, car.v};
  for (double t = 0.0; t < time - kTimeStep / 2; t += kTimeStep) {
    now = advance(car, now, kInfinity, kTimeStep);
  }
  return std::min(now.s + stopping_distance(now.v, limits_.braking), car.path.stop_after(now.s));
}

double LotMotion::speed_limit(const ArcPath::Piece& piece) const {
  const double curvature = std::abs(piece.arc.curvature);
  return curvature > 0.0 ? std::min(limits_.speed, std::sqrt(limits_.lateral / curvature))
                         : limits_.speed;
}

double LotMotion::next_speed(const LotCar& car, double s, double v, double stop, double dt) const {
  const std::vector<ArcPath::Piece>& pieces = car.path.pieces();
  double next = v + limits_.accel * dt;
  if (!pieces.empty()) {
    const std::size_t here = car.path.piece_from(s);
    next = std::min(next, std::max(speed_limit(pieces[here]), v - limits_.braking * dt));
    const double lookahead =
        s + v * dt + (v + limits_.speed) * (v + limits_.speed) / limits_.braking;
    for (std::size_t k = here + 1; k < pieces.size() && pieces[k].begin < lookahead; ++k) {
      next = std::min(
          next, braked_speed(v, pieces[k].begin - s, speed_limit(pieces[k]), limits_.braking, dt));
    }
  }
  next = std::min(next, braked_speed(v, stop - s, 0.0, limits_.braking, dt));
  return std::max({next, v - limits_.hardest * dt, 0.0});
}

LotMotion::State LotMotion::advance(const LotCar& car, State now, double stop, double dt) const {
  const double turn = car.path.stop_after(now.s);  // or the end
  const bool stops = turn < car.path.length() || car.stops();
  if (stops) stop = std::min(stop, turn);
  const double v = next_speed(car, now.s, now.v, stop, dt);
  State next{now.s + (now.v + v) / 2 * dt, v};
  // The last step before a stop is shorter than it takes time for: it ends at the stop. A stop that
  // came too suddenly is overrun; a change of direction is not.
  const bool there = v < kSlow && std::abs(next.s - stop) < kNearly && stop >= now.s;
  if (there) next = {stop, 0.0};
  if (next.s > turn && stops) next = {turn, 0.0};
  return next;
}

void LotMotion::step(double dt, std::span<const double> stopping_points) {
  const std::vector<double> turns = this->turns();
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    LotCar& car = cars_[i];
    const State next = advance(car, {car.s, car.v}, std::min(stopping_points[i], turns[i]), dt);
    car.s = next.s;
    car.v = next.v;
  }
}

LotForecast LotMotion::forecast(double dt) const {
  LotForecast result;
  result.dt = dt;
  std::vector<Link> links = this->links();
  std::vector<State> states;
  std::vector<double> stops(cars_.size());
  for (const LotCar& car : cars_) {
    states.push_back({car.s, car.v});
    result.driven.push_back({float(car.s)});
  }
  result.arrives.assign(cars_.size(), 0);
  int still = 0;
  while (still < kStagnation) {
    std::ranges::transform(cars_, stops.begin(), [](const LotCar& car) {
      return car.planned ? kInfinity : car.granted;  // what delays a plan is not known
    });
    for (Link& link : links) {
      const LotCar& first = cars_[link.first];
      const double driven = states[link.first].s;
      if (!first.stops() && driven >= first.path.length()) continue;  // it has left
      const double limit = link.order->limit(driven, link.hint);
      stops[link.waiting] = std::min(stops[link.waiting], limit);
    }
    bool moved = false;
    result.complete = true;
    for (std::size_t i = 0; i < cars_.size(); ++i) {
      const LotCar& car = cars_[i];
      State& state = states[i];
      result.arrives[i] = state.s >= car.path.length() ? 1 : 0;
      if (result.arrives[i] != 0) continue;
      const double reach = state.v * state.v / (2 * limits_.hardest);
      if (state.s + reach > stops[i] + kNearly) result.gentle = false;
      const State next = advance(car, state, stops[i], dt);
      moved = moved || next.s > state.s + kStandstill;
      state = next;
      result.driven[i].push_back(float(next.s));
      result.complete = result.complete && car.stopped_permanently;
    }
    if (result.complete) break;
    still = moved ? 0 : still + 1;
  }
  return result;
}

}  // namespace mvtp
