#include "coordinator/people/people.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mvtp {
namespace {

// How people walk: SUMO's lie between these, measured on its crossings.
constexpr double kFast = 1.8;      ///< [m/s]
constexpr double kSlow = 0.8;      ///< [m/s]
constexpr double kHesitate = 1.0;  ///< [s] until one who stands walks at his green
constexpr double kStands = 0.2;    ///< [m/s] below which somebody stands

/// [m] from a crossing where its people are expected: so far even fast ones need longer than a
/// vehicle needs for its turn.
constexpr double kNearby = 12.0;
constexpr double kStuck = 2.0;   ///< [s] after which one who stands on a crossing goes on standing
constexpr double kAtKerb = 1.5;  ///< [m] before the kerb at which people wait
constexpr double kSlack = 0.5;   ///< [s] that new plans keep before and behind people
/// [s] that new plans keep before those who have not come to the kerb yet: as long as a turn takes,
/// since who is in it can neither wait for them nor be waited for.
constexpr double kSlackToCome = 5.0;
constexpr double kPromiseAfter = 3.0;  ///< [s] after which a green is promised ahead of time,
constexpr double kAhead = 3.0;    ///< so much [s]: longer than any vehicle in town needs to stop
constexpr double kLongest = 6.0;  ///< [s] after which a green is worth any delay of others
constexpr double kDriversFirst = 8.0;  ///< [s] in which drivers go first who have waited longer
constexpr double kCourtesy = 1.0;      ///< [s] by which drivers who came later may still go first
/// [s] after which people walk around vehicles that stand on the edge of their crossing: such a
/// vehicle may wait for them to leave the kerb beside which it has to pass.
constexpr double kSqueezeAfter = 20.0;
constexpr double kMostGreen = 12.0;  ///< [s]

}  // namespace

People::People(Traffic& traffic, const LaneGraph& graph, PathLibrary& library, SignalHeads& heads,
               const DecisionGrid& grid)
    : traffic_(traffic), graph_(graph), heads_(heads), grid_(grid), paths_(graph, library) {
  for (int c = 0; c < graph.crossings(); ++c) {
    numbers_.emplace(graph.crossing(c).crossing->id, c);
    for (const std::string& end : graph.crossing(c).crossing->ends) meeting_[end].push_back(c);
  }
}

std::int64_t People::steps(double seconds) const {
  return std::int64_t(std::ceil(seconds / grid_.dt - 1e-6));
}

bool People::is_ours(int crossing) const {
  return heads_.owns(heads_.light_of_crossing(crossing)) && !heads_.is_free();
}

bool People::knows(const std::string& crossing) const {
  const auto found = numbers_.find(crossing);
  return found != numbers_.end() && is_ours(found->second);
}

void People::begin(std::int64_t step, const std::function<bool(const std::string&)>& is_clear) {
  step_ = step;
  remember_crossings();
  Persons now;
  for (const Pedestrian& person : traffic_.pedestrians()) see(person, now);
  people_ = std::move(now);
  for (int c = 0; c < graph_.crossings(); ++c) heads_.occupy(c, false);
  for (const auto& [id, person] : people_) {
    if (person.where == Where::kOnIt) heads_.occupy(person.crossing, true);
  }
  show_greens(is_clear);
  call_for_greens();
  for (int c = 0; c < graph_.crossings(); ++c) heads_.expect_people(c, over_at(c));
}

/// When nobody is expected on it any more, as far as greens are promised [s]; in the past: nobody
/// is.
double People::over_at(int crossing) {
  std::int64_t over = -1;
  const auto granted = granted_.find(crossing);
  if (granted != granted_.end()) {
    over = granted->second.end + steps(0.5 * heads_.crossing_time(crossing));
  }
  for (const auto& [id, person] : people_) {
    if (person.crossing != crossing || person.where != Where::kOnIt) continue;
    const double left = paths_.end(crossing, person.forward) - person.s;
    over = std::max(over, step_ + steps(std::max(0.0, left) / SignalHeads::kWalking));
  }
  return over < 0 ? -1e300 : traffic_.time() + double(over - step_) * grid_.dt;
}

/// Who is on a crossing, or has come from it.
void People::remember_crossings() {
  std::map<std::string, int> last;
  for (const Pedestrian& p : traffic_.pedestrians()) {
    const auto on = numbers_.find(p.edge);
    const auto before = last_crossing_.find(p.id);
    if (on != numbers_.end()) {
      last.emplace(p.id, on->second);
    } else if (before != last_crossing_.end()) {
      last.insert(*before);
    }
  }
  last_crossing_ = std::move(last);
}

void People::see(const Pedestrian& p, Persons& now) {
  const auto on = numbers_.find(p.edge);
  if (on != numbers_.end()) see_at(p, on->second, Where::kOnIt, now);
  if (const auto before = numbers_.find(p.next); before != numbers_.end()) {
    return see_at(p, before->second, Where::kBefore, now);
  }
  // Who walks along the kerb from one sidewalk to the next is in the path of those who turn, too;
  // but nobody goes back over the crossing that he comes from.
  const auto to = meeting_.find(p.next);
  const auto at = to == meeting_.end() ? meeting_.find(p.edge) : to;
  if (at == meeting_.end()) return;
  const bool leaves = to == meeting_.end() && !p.next.empty();
  const auto last = last_crossing_.find(p.id);
  for (const int c : at->second) {
    if (last != last_crossing_.end() && c == last->second) continue;
    see_at(p, c, leaves ? Where::kPasses : Where::kNear, now);
  }
}

void People::see_at(const Pedestrian& p, int crossing, Where where, Persons& now) {
  Person person{
      .crossing = crossing, .where = where, .speed = p.speed, .came = step_, .stands_since = step_};
  const auto known = people_.find({p.id, crossing});
  if (where == Where::kOnIt) {
    person.forward =
        known != people_.end() ? known->second.forward : paths_.heads_forward(crossing, p.theta);
  } else {
    person.forward = paths_.starts_forward(crossing, p.position);
  }
  if (known != people_.end()) {
    if (known->second.where == where) person.came = known->second.came;
    if (p.speed < kStands) person.stands_since = known->second.stands_since;
  }
  const bool is_on_it = where == Where::kOnIt;
  const CrossingPaths::Place place = paths_.place(crossing, person.forward, is_on_it, p.position);
  if (place.s < CrossingPaths::kKerb - kNearby) return;
  person.s = place.s;
  person.aside = place.aside;
  now.insert_or_assign({p.id, crossing}, person);
}

/// Does he want to go over this crossing, and has not begun to?
bool People::waits(const Person& person, int crossing) const {
  return person.crossing == crossing && person.where == Where::kBefore;
}

void People::show_greens(const std::function<bool(const std::string&)>& is_clear) {
  std::erase_if(granted_, [&](const auto& entry) {
    const auto& [crossing, green] = entry;
    const int light = heads_.light_of_crossing(crossing);
    const bool is_over = step_ >= green.end;
    if (is_over) heads_.end_green(light);
    if (is_over || step_ < green.begin || heads_.light(light) != Light::kRed) return is_over;
    heads_.reserve(crossing, false);
    if (!is_clear(id_of(crossing))) return true;
    heads_.turn_green(light);
    return false;
  });
}

/// Since when the first of those has waited who want to go over it.
std::optional<std::int64_t> People::waits_since(int crossing) const {
  std::optional<std::int64_t> since;
  for (const auto& [id, person] : people_) {
    if (!waits(person, crossing)) continue;
    since = std::min(since.value_or(person.came), person.came);
  }
  return since;
}

void People::call_for_greens() {
  for (int c = 0; c < graph_.crossings(); ++c) {
    const std::optional<std::int64_t> since = is_ours(c) ? waits_since(c) : std::nullopt;
    const bool calls = since && !granted_.contains(c);
    heads_.call(c, calls ? *since + steps(kCourtesy) : std::numeric_limits<std::int64_t>::max());
  }
}

bool People::has_waited(int crossing, double seconds) const {
  const std::optional<std::int64_t> since = waits_since(crossing);
  return since && step_ - *since >= steps(seconds);
}

/// Long enough for those who wait, and at real timing for one who steps onto it at its end to be
/// half over. Who has waited for long is promised one ahead where one at once was not possible
/// before.
People::Green People::next_green(int crossing) const {
  const auto offered = offered_.find(crossing);
  const bool ahead = has_waited(crossing, kPromiseAfter) && offered != offered_.end() &&
                     offered->second == step_ - grid_.steps_per_decision;
  const Green now{.begin = step_ + (ahead ? steps(kAhead) : 0)};
  double needed = std::max(heads_.timing().least_green,
                           heads_.timing().has_yellow ? 0.5 * heads_.crossing_time(crossing) : 0.0);
  for (const auto& [id, person] : people_) {
    if (!waits(person, crossing)) continue;
    const double to_kerb = std::max(0.0, CrossingPaths::kKerb - person.s);
    needed = std::max(needed, kHesitate + to_kerb / kSlow);
  }
  return {.begin = now.begin, .end = now.begin + steps(std::min(needed, kMostGreen))};
}

std::vector<People::Expected> People::expect(const std::vector<std::string>& guests) {
  std::map<int, Green> greens = granted_;
  for (const std::string& guest : guests) {
    const auto crossing = numbers_.find(guest);
    if (crossing == numbers_.end()) continue;
    greens.try_emplace(crossing->second, next_green(crossing->second));
  }
  std::vector<Expected> all;
  for (const auto& [id, person] : people_) {
    const auto green = greens.find(person.crossing);
    all.push_back(
        {person.crossing,
         expect_one(person, green == greens.end() ? std::nullopt : std::optional(green->second))});
  }
  return all;
}

/// On the crossing he walks on, unless something stops him there; before it he walks in its green,
/// or where nothing stops him.
Forecast People::expect_one(const Person& person, const std::optional<Green>& green) {
  const Green always{.begin = step_, .end = std::numeric_limits<std::int64_t>::max() / 2};
  const bool stands = person.speed < kStands;
  if (person.where == Where::kOnIt) {
    const bool is_stuck = stands && step_ - person.stands_since >= steps(kStuck);
    return is_stuck ? stays(person, person.s) : crosses(person, always);
  }
  if (is_ours(person.crossing)) {
    if (!green) return stays(person, CrossingPaths::kKerb);
    const double to_kerb = std::max(0.0, CrossingPaths::kKerb - person.s);
    const std::int64_t there = std::max(green->begin, step_ + steps(to_kerb / kFast));
    return there < green->end ? crosses(person, *green) : stays(person, CrossingPaths::kKerb);
  }
  const bool yields = !graph_.crossing(person.crossing).crossing->has_priority;
  const bool waits = yields && (stands || person.where == Where::kNear);
  return waits || person.where == Where::kPasses ? stays(person, CrossingPaths::kKerb)
                                                 : crosses(person, always);
}

/// He is at the kerb as fast as he can, and steps onto the crossing at the end of the green at
/// last.
Forecast People::crosses(const Person& person, const Green& green) {
  const double end = paths_.end(person.crossing, person.forward);
  const double to_kerb = std::max(0.0, CrossingPaths::kKerb - person.s);
  const double slow = person.speed < kStands ? kSlow : std::min(kSlow, person.speed);
  const double fast = std::max(kFast, person.speed);
  const std::int64_t wait =
      std::max<std::int64_t>(0, green.begin - step_ - std::int64_t(to_kerb / fast / grid_.dt));
  std::int64_t late = std::max<std::int64_t>(0, green.begin - step_);
  if (person.speed < kStands) late += steps(kHesitate);
  const std::int64_t last = green.end - step_ - std::int64_t(to_kerb / slow / grid_.dt);
  late = std::clamp<std::int64_t>(late, 0, std::max<std::int64_t>(0, last));
  const bool squeezes = person.where != Where::kOnIt && has_waited(person.crossing, kSqueezeAfter);
  const int path = paths_.path(
      person.crossing, person.forward,
      squeezes ? CrossingPaths::Room::kSqueezes : CrossingPaths::Room::kWalks, person.aside);
  return forecast_on(path, person, walk(person.s, wait, fast, end, true),
                     walk(person.s, late, slow, end, true));
}

/// He goes no further than to this station.
Forecast People::stays(const Person& person, double to) {
  // People stand a hand before the kerb. Contact tables take half a sample before and behind as
  // one, and keep as much room again: at the last sample before the kerb he has enough of it.
  constexpr double kLastSample = CrossingPaths::kKerb - ReferencePath::kSpacing / 2.0 - 0.01;
  const bool stands = person.speed < kStands && person.s > CrossingPaths::kKerb - kAtKerb;
  if (stands && person.where != Where::kOnIt) to = std::min(to, kLastSample);
  const int path = paths_.path(person.crossing, person.forward,
                               stands ? CrossingPaths::Room::kStands : CrossingPaths::Room::kComes,
                               person.aside);
  const double s = std::min(person.s, to);
  Forecast forecast = forecast_on(path, person, walk(s, 0, kFast, stands ? s : to, false),
                                  walk(s, 0, kFast, s, false));
  if (!stands) forecast.slack_before = int(steps(kSlackToCome));
  return forecast;
}

/// @param from  negative: he is not on the path yet, where nobody can meet him.
/// @param wait  steps before he walks.
/// @param leaves  and has left at the end; else he stands there.
SpeedProfile People::walk(double from, std::int64_t wait, double speed, double to,
                          bool leaves) const {
  SpeedProfile t{.begin = step_, .states = {{from, 0.0}}, .complete = leaves};
  for (std::int64_t k = 0; k < wait; ++k) t.states.push_back({from, 0.0});
  for (double s = from + speed * grid_.dt; s < to; s += speed * grid_.dt) {
    t.states.push_back({s, speed});
  }
  if (from < to) t.states.push_back({to, leaves ? speed : 0.0});
  return t;
}

Forecast People::forecast_on(int path, const Person& person, SpeedProfile earliest,
                             SpeedProfile latest) const {
  Forecast forecast{.vehicle = {},
                    .earliest = std::move(earliest),
                    .latest = std::move(latest),
                    .yields = false,
                    .relies = true,
                    .slack_before = int(steps(kSlack)),
                    .slack_behind = int(steps(kSlack))};
  forecast.vehicle.path = path;
  forecast.vehicle.now = {forecast.earliest.states.front().s, person.speed};
  forecast.vehicle.s_end = forecast.earliest.states.back().s;
  return forecast;
}

double People::waited(const std::string& crossing) const {
  const std::optional<std::int64_t> since = waits_since(numbers_.at(crossing));
  return since ? double(step_ - *since) * grid_.dt : 0.0;
}

std::vector<std::string> People::propose(const std::function<double(int)>& drivers_waited) {
  std::vector<std::string> ids;
  for (int c = 0; c < graph_.crossings(); ++c) {
    if (!is_ours(c) || granted_.contains(c) || !waits_since(c)) continue;
    const int light = heads_.light_of_crossing(c);
    if (!heads_.may_turn_green(light)) continue;
    const double here = waited(id_of(c));
    if (here < kDriversFirst && drivers_waited(light) > here) continue;
    ids.push_back(id_of(c));
    if (next_green(c).begin == step_) offered_[c] = step_;
  }
  return ids;
}

double People::worth(const std::vector<std::string>& crossings) const {
  double worth = 0.0;
  for (const std::string& id : crossings) {
    const auto crossing = numbers_.find(id);
    if (crossing == numbers_.end()) continue;
    for (const auto& [name, person] : people_) {
      if (!waits(person, crossing->second)) continue;
      const double waited = double(step_ - person.came) * grid_.dt;
      if (waited >= kLongest) return std::numeric_limits<double>::infinity();
      worth += waited;
    }
  }
  return worth;
}

void People::grant(const std::string& id) {
  const int crossing = numbers_.at(id);
  const Green green = next_green(crossing);
  granted_.emplace(crossing, green);
  ++greens_;
  heads_.call(crossing, std::numeric_limits<std::int64_t>::max());
  if (green.begin > step_) {
    heads_.reserve(crossing, true);
  } else {
    heads_.turn_green(heads_.light_of_crossing(crossing));
  }
}

void People::release_all() {
  for (const auto& [crossing, green] : granted_) heads_.reserve(crossing, false);
  granted_.clear();
  people_.clear();
}

}  // namespace mvtp
