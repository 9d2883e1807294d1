#include "tools/view/replay.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ranges>
#include <stdexcept>
#include <utility>

// Layout of Replay::frames, each a ReplayColumn without any length in between (the header has
// them):
//   times [ms]; clearances [cm], if the header says so, kNoClearance for none;
//   for each track: x [cm], y [cm], heading [0.1 deg], speed [2 cm/s],
//                   states as pairs (length of the run, state).
// A track is one vehicle in an unbroken row of frames.

namespace mvtp {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr std::int64_t kHeadingsPerTurn = 3600;
constexpr double kSpeedUnit = 0.02;          // [m/s]
constexpr std::int64_t kNoClearance = 9999;  // [cm]
constexpr double kFarthest = 1e7;            // [m]; beyond it a position is an error
constexpr double kEpisodeGap = 1.0;          // [s]
constexpr double kTimeTolerance = 1e-6;      // [s]

std::int64_t quantise(double value, double unit) { return std::llround(value / unit); }

double centimetres(double metres) { return std::round(metres * 100.0) / 100.0; }

/// In (-half a turn, half a turn].
std::int64_t shortest_turn(std::int64_t difference) {
  const std::int64_t turn = ((difference % kHeadingsPerTurn) + kHeadingsPerTurn) % kHeadingsPerTurn;
  return turn > kHeadingsPerTurn / 2 ? turn - kHeadingsPerTurn : turn;
}

bool is_sound(const ReplayVehicleState& state) {
  return std::abs(state.pose.x) < kFarthest && std::abs(state.pose.y) < kFarthest &&
         std::abs(state.pose.theta) < kFarthest && std::abs(state.speed) < kFarthest;
}

/// x, y, x, y, ... [m]
Json flat(const std::vector<Point>& points) {
  Json numbers = Json::array();
  for (const Point& point : points) {
    numbers.push_back(centimetres(point.x));
    numbers.push_back(centimetres(point.y));
  }
  return numbers;
}

Json flat(const std::vector<Polygon>& polygons) {
  Json all = Json::array();
  for (const Polygon& polygon : polygons) all.push_back(flat(polygon));
  return all;
}

Json to_json(const std::optional<Pose>& pose) {
  if (!pose) return nullptr;
  return {centimetres(pose->x), centimetres(pose->y), std::round(pose->theta * 1e4) / 1e4};
}

Json to_json(const ReplayScene& scene) {
  Json lanes = Json::array();
  for (const ReplayLane& lane : scene.lanes) {
    lanes.push_back({{"width", lane.width},
                     {"internal", lane.internal},
                     {"stop", lane.stop_line},
                     {"shape", flat(lane.shape)}});
  }
  Json circles = Json::array();
  for (const Circle& circle : scene.circles) {
    circles.push_back({centimetres(circle.x), centimetres(circle.y), circle.radius});
  }
  return {{"border", scene.border ? Json{scene.border->x, scene.border->y} : Json(nullptr)},
          {"lanes", std::move(lanes)},
          {"junctions", flat(scene.junctions)},
          {"zones", flat(scene.zones)},
          {"circles", std::move(circles)},
          {"polygons", flat(scene.polygons)}};
}

Json to_json(const ReplayVehicle& vehicle) {
  return {{"id", vehicle.id},
          {"kind", vehicle.kind},
          {"length", vehicle.length},
          {"width", vehicle.width},
          {"front", vehicle.front},
          {"maxSpeed", vehicle.max_speed},
          {"start", to_json(vehicle.start)},
          {"goal", to_json(vehicle.goal)}};
}

const char* name_of(ReplayEventKind kind) {
  switch (kind) {
    case ReplayEventKind::kOverlap:
      return "overlap";
    case ReplayEventKind::kNearMiss:
      return "near";
    case ReplayEventKind::kSlowReplan:
      return "slow";
    case ReplayEventKind::kNote:
      return "note";
  }
  return "";
}

/// A slow replan is worse the longer it is; of clearances the smaller is worse.
double worse(ReplayEventKind kind, double a, double b) {
  return kind == ReplayEventKind::kSlowReplan ? std::max(a, b) : std::min(a, b);
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

ReplayRecorder::ReplayRecorder(ReplayInfo info, ReplayScene scene, double interval)
    : info_(std::move(info)), scene_(std::move(scene)), interval_(interval) {}

std::size_t ReplayRecorder::add_vehicle(const ReplayVehicle& vehicle) {
  vehicles_.push_back(vehicle);
  track_of_.push_back(kNone);
  return vehicles_.size() - 1;
}

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
  if (time < next_due_ - kTimeTolerance) return;
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
    tracks_.push_back({.vehicle = state.vehicle, .first_frame = frames_, .run = state.state});
  }
  Track& track = tracks_[current];
  track.x.push(quantise(state.pose.x, 0.01));
  track.y.push(quantise(state.pose.y, 0.01));
  const std::int64_t heading =
      quantise(state.pose.theta, 2.0 * std::numbers::pi / static_cast<double>(kHeadingsPerTurn));
  track.heading.push(track.heading.last() + shortest_turn(heading - track.heading.last()));
  track.speed.push(quantise(state.speed, kSpeedUnit));
  if (state.state != track.run) end_run(track);
  track.run = state.state;
  ++track.states_in_run;
  ++track.count;
}

void ReplayRecorder::end_run(Track& track) {
  track.state.push(track.states_in_run);
  track.state.push(static_cast<std::int64_t>(track.run));
  track.states_in_run = 0;
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
      episode.event.value = worse(event.kind, known.value, event.value);
      return;
    }
  }
  episodes_.push_back({event, event.time});
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
                 {"scene", to_json(scene_)}};
  for (const char* list : {"figures", "events", "vehicles", "tracks"}) header[list] = Json::array();
  for (const ReplayFigure& figure : figures_) {
    header["figures"].push_back({figure.label, figure.value, figure.unit});
  }
  std::ranges::stable_sort(episodes_, {}, [](const Episode& e) { return e.event.time; });
  for (const auto& [event, end] : episodes_) {
    header["events"].push_back({{"kind", name_of(event.kind)},
                                {"time", event.time},
                                {"end", end},
                                {"x", event.place.x},
                                {"y", event.place.y},
                                {"vehicles", event.vehicles},
                                {"value", event.value},
                                {"text", event.text}});
  }
  for (const ReplayVehicle& vehicle : vehicles_) header["vehicles"].push_back(to_json(vehicle));

  std::string columns = times_.bytes();
  if (has_clearance_) columns += clearances_.bytes();
  for (Track track : tracks_) {
    end_run(track);
    header["tracks"].push_back({track.vehicle, track.first_frame, track.count});
    for (const ReplayColumn* column :
         {&track.x, &track.y, &track.heading, &track.speed, &track.state}) {
      columns += column->bytes();
    }
  }
  return {info_.title, dump(header), std::move(columns)};
}

Replay with_label(Replay replay, const std::string& label) {
  Json header = Json::parse(replay.header);
  header["label"] = label;
  replay.header = dump(header);
  return replay;
}

}  // namespace mvtp
