#include "tools/view/replay.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ranges>
#include <stdexcept>
#include <utility>

#include "tools/view/replay_json.hpp"

// Layout of Replay::frames, each a ReplayColumn without any length in between (the header has
// them):
//   times [ms]; clearances [cm], if the header says so, kNoClearance for none;
//   for each track: x [cm], y [cm], heading [0.1 deg], speed [2 cm/s], states as ReplayRuns;
//     groups (0, or 1 + the first vehicle) and ranks as ReplayRuns, if the header says so;
//     CO2 [0.2 g/s], if the header says so;
//   if the header has tubes, over all tracks: how many runs of frames with the same tube code each
//   has;
//     how many frames each run has; the codes (ReplayTubes::code_of); and of the tubes that are
//     kept for each of the times `later` the least and the most reach in `units` of the header.
// A track is one vehicle in an unbroken row of frames.

namespace mvtp {
namespace {

using Json = ReplayJson;

constexpr int kFormat = 2;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr std::int64_t kHeadingsPerTurn = 3600;
constexpr double kSpeedUnit = 0.02;          // [m/s]
constexpr double kCo2Unit = 0.2;             // [g/s]
constexpr std::int64_t kNoClearance = 9999;  // [cm]
constexpr double kFarthest = 1e7;            // [m]; beyond it a position is an error
constexpr double kEpisodeGap = 1.0;          // [s]
constexpr double kTimeTolerance = 1e-6;      // [s]

std::int64_t quantise(double value, double unit) { return std::llround(value / unit); }

/// In (-half a turn, half a turn].
std::int64_t shortest_turn(std::int64_t difference) {
  const std::int64_t turn = ((difference % kHeadingsPerTurn) + kHeadingsPerTurn) % kHeadingsPerTurn;
  return turn > kHeadingsPerTurn / 2 ? turn - kHeadingsPerTurn : turn;
}

bool is_sound(const ReplayVehicleState& state) {
  return std::abs(state.pose.x) < kFarthest && std::abs(state.pose.y) < kFarthest &&
         std::abs(state.pose.theta) < kFarthest && std::abs(state.speed) < kFarthest;
}

/// Text from outside need not be UTF-8; what is not becomes U+FFFD.
std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

void ReplayColumn::push(std::int64_t value) {
  const std::int64_t difference = value - last_;
  const std::int64_t second = empty_ ? difference : difference - last_difference_;
  last_difference_ = empty_ ? 0 : difference;
  last_ = value;
  empty_ = false;

  auto rest = (static_cast<std::uint64_t>(second) << 1) ^ static_cast<std::uint64_t>(second >> 63);
  for (; rest >= 0x80; rest >>= 7) bytes_.push_back(static_cast<char>((rest & 0x7f) | 0x80));
  bytes_.push_back(static_cast<char>(rest));
}

void ReplayRuns::push(std::int64_t value) {
  if (length_ > 0 && value != value_) {
    pairs_.push(length_);
    pairs_.push(value_);
    length_ = 0;
  }
  value_ = value;
  ++length_;
}

std::string ReplayRuns::bytes() const {
  ReplayColumn all = pairs_;
  all.push(length_);
  all.push(value_);
  return all.bytes();
}

ReplayRecorder::ReplayRecorder(ReplayInfo info, ReplayScene scene, double interval)
    : info_(std::move(info)), scene_(std::move(scene)), interval_(interval) {}

std::size_t ReplayRecorder::add_vehicle(const ReplayVehicle& vehicle) {
  vehicles_.push_back(vehicle);
  track_of_.push_back(kNone);
  return vehicles_.size() - 1;
}

std::size_t ReplayRecorder::add_signal(const std::string& id) {
  signals_.push_back({id, {}});
  return signals_.size() - 1;
}

void ReplayRecorder::add_lights(double time, std::size_t signal, const std::string& lights) {
  auto& shown = signals_.at(signal).shown;
  if (shown.empty() || shown.back().second != lights) shown.emplace_back(time, lights);
}

bool ReplayRecorder::is_due(double time) const { return time >= next_due_ - kTimeTolerance; }

void ReplayRecorder::add_frame(double time, std::span<const ReplayVehicleState> states,
                               std::optional<double> clearance) {
  if (!(std::abs(time) < kFarthest) || (last_time_ && time <= *last_time_)) {
    throw std::invalid_argument("ReplayRecorder::add_frame: the time must increase");
  }
  for (const ReplayVehicleState& state : states) {
    if (state.vehicle >= vehicles_.size()) {
      throw std::invalid_argument("ReplayRecorder::add_frame: unknown vehicle");
    }
  }
  if (!last_time_) first_time_ = time;
  last_time_ = time;
  if (clearance) clearance_ = std::min(*clearance, clearance_.value_or(*clearance));

  pending_.assign(states.begin(), states.end());
  is_pending_ = true;
  if (!is_due(time)) return;
  const double intervals =
      interval_ > 0.0 ? std::floor((time - first_time_ + kTimeTolerance) / interval_) + 1.0 : 0.0;
  next_due_ = first_time_ + intervals * interval_;
  keep_pending();
}

void ReplayRecorder::keep_pending() {
  if (!is_pending_) return;
  is_pending_ = false;
  times_.push(quantise(*last_time_, 1e-3));
  const double most = static_cast<double>(kNoClearance) / 100.0;
  clearances_.push(clearance_ ? quantise(std::clamp(*clearance_, -most, most), 0.01)
                              : kNoClearance);
  has_clearance_ = has_clearance_ || clearance_.has_value();
  clearance_.reset();
  for (const ReplayVehicleState& state : pending_) {
    if (is_sound(state)) append(state);
  }
  ++frames_;
}

void ReplayRecorder::append(const ReplayVehicleState& state) {
  std::size_t& current = track_of_[state.vehicle];
  if (current != kNone) {
    const std::size_t next_frame = tracks_[current].first_frame + tracks_[current].count;
    if (next_frame > frames_) return;  // listed twice
    if (next_frame < frames_) current = kNone;
  }
  if (current == kNone) {
    current = tracks_.size();
    tracks_.push_back({.vehicle = state.vehicle, .first_frame = frames_});
  }
  Track& track = tracks_[current];
  track.x.push(quantise(state.pose.x, 0.01));
  track.y.push(quantise(state.pose.y, 0.01));
  const std::int64_t heading =
      quantise(state.pose.theta, 2.0 * std::numbers::pi / static_cast<double>(kHeadingsPerTurn));
  track.heading.push(track.heading.last() + shortest_turn(heading - track.heading.last()));
  track.speed.push(quantise(state.speed, kSpeedUnit));
  track.state.push(static_cast<std::int64_t>(state.state));
  track.group.push(state.group ? static_cast<std::int64_t>(*state.group) + 1 : 0);
  track.rank.push(state.rank);
  track.co2.push(quantise(state.co2.value_or(0.0), kCo2Unit));
  tubes_.push(current, times_.last(), state.tube);
  has_groups_ = has_groups_ || state.group.has_value();
  has_emissions_ = has_emissions_ || state.co2.has_value();
  ++track.count;
}

void ReplayRecorder::add_event(const ReplayEvent& event) {
  if (last_time_ && std::abs(event.time - *last_time_) < kTimeTolerance) keep_pending();
  // Recent ones are at the end, but for the few that go on while others begin.
  constexpr std::size_t kLookBack = 200;
  for (Episode& episode : episodes_ | std::views::reverse | std::views::take(kLookBack)) {
    const ReplayEvent& known = episode.event;
    if (known.kind == event.kind && known.vehicles == event.vehicles && known.text == event.text &&
        event.time >= known.time && event.time - episode.end < kEpisodeGap) {
      episode.end = std::max(episode.end, event.time);
      episode.event.value = std::min(known.value, event.value);
      return;
    }
  }
  episodes_.push_back({event, event.time});
}

std::string ReplayRecorder::columns() const {
  std::string bytes = times_.bytes();
  if (has_clearance_) bytes += clearances_.bytes();
  for (const Track& track : tracks_) {
    for (const ReplayColumn* column : {&track.x, &track.y, &track.heading, &track.speed}) {
      bytes += column->bytes();
    }
    bytes += track.state.bytes();
    if (has_groups_) bytes += track.group.bytes() + track.rank.bytes();
    if (has_emissions_) bytes += track.co2.bytes();
  }
  if (!tubes_.empty()) bytes += tubes_.bytes(tracks_.size());
  return bytes;
}

Replay ReplayRecorder::finish() {
  keep_pending();
  Json header = {{"format", kFormat},
                 {"title", info_.title},
                 {"label", info_.label},
                 {"command", info_.command},
                 {"version", info_.version},
                 {"seed", info_.seed},
                 {"steps", info_.motion == ReplayMotion::kSteps},
                 {"frames", frames_},
                 {"clearance", has_clearance_},
                 {"groups", has_groups_},
                 {"emissions", has_emissions_},
                 {"tubes", tubes_.empty() ? Json(nullptr) : to_json(tubes_)},
                 {"scene", to_json(scene_)}};
  for (const char* list : {"figures", "events", "signals", "vehicles", "tracks"}) {
    header[list] = Json::array();
  }
  for (const ReplayFigure& figure : figures_) {
    header["figures"].push_back({figure.label, figure.value, figure.unit});
  }
  std::ranges::stable_sort(episodes_, {}, [](const Episode& e) { return e.event.time; });
  for (const auto& [event, end] : episodes_) header["events"].push_back(to_json(event, end));
  for (const Signal& signal : signals_) {
    header["signals"].push_back({{"id", signal.id}, {"shown", signal.shown}});
  }
  for (const ReplayVehicle& vehicle : vehicles_) header["vehicles"].push_back(to_json(vehicle));
  for (const Track& track : tracks_) {
    header["tracks"].push_back({track.vehicle, track.first_frame, track.count});
  }
  return {info_.title, dump(header), columns()};
}

Replay with_label(Replay replay, const std::string& label) {
  Json header = Json::parse(replay.header);
  header["label"] = label;
  replay.header = dump(header);
  return replay;
}

}  // namespace mvtp
