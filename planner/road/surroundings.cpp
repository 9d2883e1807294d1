#include "planner/road/surroundings.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace mvtp {

Surroundings::Surroundings(const RoadPairs& pairs, const RoadVehicle& vehicle,
                           std::span<const JointPlan::Entry> before, const ProfileOptions& options,
                           Forecasts forecasts, const std::vector<bool>& waived)
    : grid_(pairs.scene().grid),
      now_(pairs.scene().step),
      reaction_(pairs.scene().reaction),
      vehicle_(vehicle),
      body_(pairs.scene().body(vehicle)),
      options_(options),
      is_new_(forecasts == Forecasts::kWithSlack) {
  const RoadScene& scene = pairs.scene();
  const std::size_t self = pairs.index(vehicle.key);
  const double rest = vehicle.now.s + stopping_distance(vehicle.now.v, 0.5 * body_.max_decel);
  run_ups_ = {
      std::ranges::lower_bound(vehicle.run_ups, rest, {}, [](const auto& r) { return r.first; }),
      vehicle.run_ups.end()};
  const bool count = forecasts != Forecasts::kIgnore;
  if (count) closed_ = vehicle.closed;
  for (std::size_t f = 0; count && f < scene.forecasts.size(); ++f) {
    if (pairs.follows(f, self) || (!waived.empty() && waived[f])) continue;
    const Forecast& forecast = scene.forecasts[f];
    const ContactView contact = pairs.towards_forecast(self, f);
    const bool stays = forecast.held && !contact.contact->never() && !pairs.is_behind(self, f);
    add({contact, stays ? &*forecast.held : &forecast.earliest,
         forecast.latest ? &*forecast.latest : nullptr, &forecast.vehicle,
         &scene.body(forecast.vehicle), true, forecast.told, forecast.yields, forecast.relies});
    add_slack(forecast);
  }
  for (const JointPlan::Entry& e : before) {
    if (e.key == vehicle.key) continue;
    const std::size_t other = pairs.index(e.key);
    add({pairs.between(self, other), e.profile.get(), nullptr, &scene.vehicles[other],
         &scene.body(scene.vehicles[other]), false, Told::kNothing, false, false,
         &scene.library->reserved(vehicle.path, scene.vehicles[other].path)});
  }
  for (const Other& other : others_) stretches_.push_back(stretch_of(other));
}

bool Surroundings::step_is_clear(std::int64_t k, const InertialState& from, double a,
                                 const InertialState& to) const {
  count_work();
  if (enters_closed(k, from, a)) return false;
  const double reach = to.s + stopping_distance(to.v, body_.max_decel) + to.v * reaction_;
  // A leader of another driver may always be answered with full braking, and whoever crosses now;
  // one that stands can do no more.
  const bool brakes_fully = a <= -body_.max_decel + 1e-9 || (from.v == 0.0 && to.v == 0.0);
  const bool stays = to.s == vehicle_.now.s;
  const auto is_clear_of = [&](const Other& other) {
    const bool yields_in_time = other.latest == nullptr || k == now_ || stays;
    const bool helps =
        !other.relies || other.contact.contact->is_behind(from, other.hindmost_state(k));
    const bool may_brake = other.forecast && brakes_fully && yields_in_time && helps;
    if (may_brake && (k == now_ || stays)) return true;
    return !meets(other, k, from, a, to, reach) || (may_brake && !cuts_in(other, k, from, to));
  };
  // Whoever blocked it the last time will mostly do so again.
  if (last_blocker_ < others_.size() && !is_clear_of(others_[last_blocker_])) return false;
  for (std::size_t i = 0; i < others_.size(); ++i) {
    const Stretch& stretch = stretches_[i];
    if (k < stretch.begin || !stretch.overlaps(from.s, reach, k) || i == last_blocker_) continue;
    if (is_clear_of(others_[i])) continue;
    last_blocker_ = i;
    return false;
  }
  return true;
}

bool Surroundings::may_stand_at(double s) const {
  const auto holds_s = [s](const auto& stretch) { return s > stretch.first && s < stretch.second; };
  return vehicle_.may_wait_at(s) && std::ranges::none_of(run_ups_, holds_s);
}

bool Surroundings::can_wait(std::int64_t k, const InertialState& state) const {
  count_work();
  const double rest = state.s + stopping_distance(state.v, body_.max_decel);
  if (!may_stand_at(rest)) return false;
  const bool will_be_closed = std::ranges::any_of(closed_, [&](const ClosedStretch& c) {
    return c.end > k && rest >= c.from && state.s <= c.to;
  });
  return !will_be_closed && stands_clear(k, state);
}

bool Surroundings::stands_clear(std::int64_t k, const InertialState& state) const {
  const double rest = state.s + stopping_distance(state.v, body_.max_decel);
  for (std::size_t o = 0; o < others_.size(); ++o) {
    if (!stretches_[o].overlaps(state.s, rest, k)) continue;
    const Other& other = others_[o];
    if (other.reserved && stands_blocking(other, *other.reserved, k, state)) return false;
    // Two that are too close now cannot be asked to stand clear of each other.
    if (other.contact.contact->is_close_now()) continue;
    if (stands_blocking(other, other.contact.table(), k, state)) return false;
  }
  return true;
}

bool Surroundings::stands_blocking(const Other& other, const ContactTable& contacts, std::int64_t k,
                                   const InertialState& state) const {
  const double b = body_.max_decel;
  const double rest = state.s + stopping_distance(state.v, b);
  const double now = other.hindmost(k);
  const double end = other.profile->states.back().s;
  if (now > end || !contacts.reaches(state.s, rest, now, end)) return false;
  if (is_followed_by(other, state, other.profile->at(k))) return false;
  const int steps = braking_steps(state.v, b, grid_.dt);
  for (int i = 1; i < steps; ++i) {
    const double s = braked_position(state, b, i * grid_.dt);
    if (contacts.meets(s, s, other.hindmost(k + i), other.profile->at(k + i).s)) return true;
  }
  const double from = other.hindmost(k + steps);
  return from <= end && contacts.blocks(rest, from, end);
}

bool Surroundings::leaves_passages_free(std::int64_t k, const InertialState& state) const {
  count_work();
  return std::ranges::none_of(others_, [&](const Other& other) {
    return other.forecast && !other.yields && is_met_by_braking(other, k, state);
  });
}

bool Surroundings::is_met_by_braking(const Other& other, std::int64_t k,
                                     const InertialState& state) const {
  if (brakes_into(other, k, state)) return true;
  if (other.yields) return false;
  const double rest = state.s + stopping_distance(state.v, body_.max_decel);
  const double from = other.hindmost(k);
  const double end = other.profile->states.back().s;
  return from <= end && other.contact.table().blocks(rest, from, end);
}

bool Surroundings::is_barred(double s) const {
  constexpr double kAcross = 2.0;  // [m]: nobody is ahead of who stands so far across its path
  count_work();
  const double now = vehicle_.now.s;
  const double rest = now + stopping_distance(vehicle_.now.v, body_.max_decel);
  return std::ranges::any_of(others_, [&](const Other& other) {
    const SpeedProfile& last = other.latest != nullptr ? *other.latest : *other.profile;
    const double place = last.at(now_).s;
    const bool stands = !last.complete && last.states.back().s == place;
    if (!stands || other.contact.contact->is_close_now()) return false;
    const ContactTable& contacts = other.contact.table();
    if (contacts.touches(now, place) || contacts.touches(rest, place)) return false;
    for (double from = std::max(rest, contacts.first()); from + kAcross <= s; from += kAcross) {
      if (from > contacts.last()) break;
      if (contacts.touches(from, place) && contacts.touches(from + kAcross, place)) return true;
    }
    return false;
  });
}

void Surroundings::add(Other other) {
  const bool same_exit = vehicle_.exits_with(*other.vehicle);
  if (other.reserved) {
    const InertialState then = other.profile->at(now_);
    const bool idle =
        other.reserved->empty() || other.reserved->blocks(vehicle_.now.s, then.s, then.s);
    if (idle) other.reserved = nullptr;
  }
  if (other.contact.contact->never() && !same_exit && !other.reserved) return;
  other.braking_is_no_help =
      other.latest != nullptr && is_met_by_braking(other, now_, vehicle_.now);
  if (same_exit) on_exit_.push_back(others_.size());
  others_.push_back(other);
}

Surroundings::Stretch Surroundings::stretch_of(const Other& other) const {
  constexpr auto kNever = std::numeric_limits<std::int64_t>::max();
  const ContactTable& contacts = other.contact.table();
  const ContactTable& reserved = other.reserved ? *other.reserved : contacts;
  const double ours = std::min(contacts.first(), reserved.first());
  const double ours_end = std::max(contacts.last(), reserved.last());
  const double theirs = std::min(contacts.b_first(), reserved.b_first());
  const double theirs_end = std::max(contacts.b_last(), reserved.b_last());

  const SpeedProfile& hindmost = other.latest != nullptr ? *other.latest : *other.profile;
  const auto passed = std::ranges::upper_bound(hindmost.states, theirs_end, {}, &InertialState::s);
  std::int64_t end = hindmost.begin + (passed - hindmost.states.begin()) + other.behind;
  const bool is_known = passed != hindmost.states.end() || (other.forecast && hindmost.complete);
  if (!is_known) end = kNever;
  if (other.forecast) return {ours, ours_end, now_, end};

  const SpeedProfile& plan = *other.profile;
  const auto comes = std::ranges::find_if(plan.states, [&](const InertialState& x) {
    return x.s + stopping_distance(x.v, other.body->max_decel) >= theirs;
  });
  const bool never_comes = comes == plan.states.end() && !plan.complete;
  const std::int64_t begin = plan.begin + (comes - plan.states.begin());
  return {ours, ours_end, never_comes ? kNever : begin - grid_.steps_per_decision, end};
}

/// To the last of the others, if it is this forecast and either it or the plan is new: none where
/// the vehicle is within it already.
void Surroundings::add_slack(const Forecast& forecast) {
  if (others_.empty() || others_.back().vehicle != &forecast.vehicle) return;
  Other& other = others_.back();
  other.is_new = is_new_ || forecast.is_new;
  if (!other.is_new) return;
  const double s = vehicle_.now.s;
  const bool within =
      other.contact.table().meets(s, s, other.hindmost(now_ - forecast.slack_behind),
                                  other.profile->at(now_ + forecast.slack_before).s);
  if (within) return;
  other.before = forecast.slack_before;
  other.behind = forecast.slack_behind;
}

InertialState Surroundings::goes_on_at(const Other& other, std::int64_t k) const {
  return other.forecast ? other.profile->at(k) : other.profile->goes_on_at(k, grid_.dt);
}

bool Surroundings::meets(const Other& other, std::int64_t k, const InertialState& from, double a,
                         const InertialState& to, double reach) const {
  if (other.reserved && enters_reserved(other, k, from, a)) return true;
  const ContactTable& contacts = other.contact.table();
  if (other.latest != nullptr) return meets_anywhere(other, k, from, a, to);
  const auto there = [&](int i) { return goes_on_at(other, k + i); };
  const InertialState other_from = there(0);
  if (other_from.s >= SpeedProfile::kDeparted) return false;
  // The last step of the decision in which the other one is still there.
  int last = grid_.steps_per_decision;
  while (there(last).s >= SpeedProfile::kDeparted) --last;
  const InertialState other_to = there(last);
  // A driver who is expected to slow down may do so only once he has been told to.
  const bool may_be_late =
      other.forecast && other.told != Told::kToWait && other_to.v < other_from.v;
  const InertialState latest = may_be_late ? advance(other_from, 0.0, last * grid_.dt) : other_to;
  const double other_reach = latest.s + stopping_distance(latest.v, other.body->max_decel);
  const InertialState then =
      last == grid_.steps_per_decision ? to : advance(from, a, last * grid_.dt);
  if (!contacts.reaches(from.s, reach, other_from.s, other_reach)) {
    return brakes_onto_lane(other, k + last, then);
  }
  if (is_followed_by(other, from, other_from)) return false;

  // Too close to a driver ahead, or beside one who need not brake, there is no choice but full
  // braking: "no worse than braking now" would begin anew at every decision, nearer each time. Not
  // where both are stuck and he stays at his line: past him a bare gap is enough.
  const auto must_brake = [&] {
    const bool stays_stuck = other.contact.contact->are_stuck() && other.told == Told::kToWait;
    return other.forecast && !stays_stuck &&
           (other.contact.contact->is_behind(from, other_from) ||
            comes_over(other, from, other_from));
  };
  const bool lenient = other.contact.is_close(from, other_from) && !must_brake();
  const auto position = [&](int i) { return advance(from, a, i * grid_.dt).s; };
  const auto other_position = [&](int i) { return there(i).s; };
  if (other.contact.touch(position, other_position, last, lenient)) return true;
  const auto early_position = [&](int i) { return there(i + other.before).s; };
  if (other.before > 0 && !lenient &&
      other.contact.touch(position, early_position, last, /*lenient=*/false)) {
    return true;
  }
  // Who leaves within the decision drives on where this vehicle does not see it.
  if (other.contact.touch_braking(then, other_to, lenient)) return true;
  if (may_be_late && other.contact.touch_braking(then, latest, lenient)) return true;
  if (is_followed_by(other, then, other_to)) {
    return other.contact.contact->cuts_off(then, other_to);
  }
  return brakes_onto_lane(other, k + last, then);
}

bool Surroundings::enters_closed(std::int64_t k, const InertialState& from, double a) const {
  return std::ranges::any_of(closed_, [&](const ClosedStretch& c) {
    const std::int64_t first = std::max(c.begin, k) - k;
    const std::int64_t last = std::min(c.end, k + grid_.steps_per_decision) - k;
    if (first >= last) return false;
    return advance(from, a, double(first) * grid_.dt).s <= c.to &&
           advance(from, a, double(last) * grid_.dt).s >= c.from;
  });
}

bool Surroundings::enters_reserved(const Other& other, std::int64_t k, const InertialState& from,
                                   double a) const {
  for (int i = 0; i < grid_.steps_per_decision; ++i) {
    const InertialState there = other.profile->at(k + i + 1);
    if (there.s >= SpeedProfile::kDeparted) return false;
    const double s = advance(from, a, i * grid_.dt).s;
    const double s_end = advance(from, a, (i + 1) * grid_.dt).s;
    if (other.reserved->sweeps(s, s_end, other.profile->at(k + i).s, there.s)) return true;
  }
  return false;
}

bool Surroundings::meets_anywhere(const Other& other, std::int64_t k, const InertialState& from,
                                  double a, const InertialState& to) const {
  const ContactTable& contacts = other.contact.table();
  const auto is_there = [&](double s, double s_end, std::int64_t k_from, std::int64_t k_to) {
    return contacts.meets(s, s_end, other.hindmost(k_from - other.behind),
                          other.profile->at(k_to + other.before).s);
  };
  const int n = grid_.steps_per_decision;
  if (k == now_ && is_there(from.s, from.s, k, k)) {
    // As in meets(): behind a leader there is no choice but full braking.
    if (other.contact.contact->is_behind(from, {other.hindmost(k), 0.0})) return true;
    // Who is within the margins may go wherever that is no nearer to the other one, should it
    // hardly move.
    const auto position = [&](int i) { return advance(from, a, i * grid_.dt).s; };
    const auto hindmost = [&](int i) { return other.hindmost(k + i); };
    return other.contact.touch(position, hindmost, n, /*lenient=*/true);
  }
  for (int i = 0; i < n; ++i) {
    const double s = advance(from, a, i * grid_.dt).s;
    const double s_end = advance(from, a, (i + 1) * grid_.dt).s;
    if (is_there(s, s_end, k + i, k + i + 1)) return true;
  }
  const bool goes_on = other.braking_is_no_help && a >= 0.0;
  if (!goes_on && brakes_into(other, k + n, to)) return true;
  // Behind him on his lane it must be able to stop if he brakes: a plan that is kept in its first
  // decision only; a new one behind somebody told to pass, or one behind somebody who is told so
  // now, at every decision, or it would be lost when that moment comes.
  const InertialState hindmost = other.hindmost_state(k + n);
  return (k == now_ || (other.is_new && other.told == Told::kToPass)) &&
         hindmost.s < SpeedProfile::kDeparted && other.contact.contact->is_behind(to, hindmost) &&
         other.contact.touch_braking(to, hindmost, /*lenient=*/false);
}

bool Surroundings::brakes_into(const Other& other, std::int64_t k,
                               const InertialState& state) const {
  const ContactTable& contacts = other.contact.table();
  const int steps = braking_steps(state.v, body_.max_decel, grid_.dt);
  for (int i = 0; i < steps; ++i) {
    const double s = braked_position(state, body_.max_decel, i * grid_.dt);
    const double s_end = braked_position(state, body_.max_decel, (i + 1) * grid_.dt);
    const double last = other.profile->at(k + i + 1 + other.before).s;
    if (contacts.meets(s, s_end, other.hindmost(k + i - other.behind), last)) return true;
  }
  return false;
}

bool Surroundings::comes_over(const Other& other, const InertialState& state,
                              const InertialState& other_state) const {
  return is_new_ && other.contact.contact->a_is_beside(state, other_state);
}

bool Surroundings::brakes_onto_lane(const Other& other, std::int64_t k,
                                    const InertialState& state) const {
  if (!is_new_ || !other.forecast || !other.yields) return false;
  const ContactTable& contacts = other.contact.table();
  const InertialState there = other.profile->at(k);
  const double end = other.profile->states.back().s;
  const InertialState rest{state.s + stopping_distance(state.v, body_.max_decel), 0.0};
  if (!contacts.reaches(state.s, rest.s, there.s, end)) return false;
  const double meanwhile = there.v * state.v / body_.max_decel - (rest.s - state.s);
  if (!other.contact.contact->a_is_alongside(state, there, std::max(0.0, meanwhile))) return false;
  return brakes_into(other, k, state) ||
         (comes_over(other, rest, there) && contacts.blocks(rest.s, there.s, end));
}

bool Surroundings::is_followed_by(const Other& other, const InertialState& state,
                                  const InertialState& other_state) const {
  return other.yields && other.contact.contact->is_ahead(state, other_state) &&
         !comes_over(other, state, other_state);
}

bool Surroundings::cuts_in(const Other& other, std::int64_t k, const InertialState& from,
                           const InertialState& to) const {
  const InertialState other_to = other.profile->at(k + grid_.steps_per_decision);
  if (other_to.s >= SpeedProfile::kDeparted) return false;
  if (comes_over(other, to, other_to)) return true;
  return is_followed_by(other, to, other_to) &&
         !is_followed_by(other, from, other.profile->at(k)) &&
         other.contact.contact->cuts_off(to, other_to);
}

}  // namespace mvtp
