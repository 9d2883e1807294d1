#include "tools/view/read_replay.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string_view>

#include "planner/problem/input_error.hpp"
#include "tools/view/replay_json.hpp"

namespace mvtp {
namespace {

using Json = nlohmann::json;

/// x, y, x, y, ...
std::vector<Point> points_of(const Json& numbers) {
  std::vector<Point> points;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
    points.push_back({numbers.at(i).get<double>(), numbers.at(i + 1).get<double>()});
  }
  return points;
}

std::optional<Pose> pose_of(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return Pose{json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

ReplayVehicle vehicle_of(const Json& json) {
  return {.id = json.at("id").get<std::string>(),
          .kind = json.at("kind").get<std::string>(),
          .length = json.at("length").get<double>(),
          .width = json.at("width").get<double>(),
          .front = json.at("front").get<double>(),
          .max_speed = json.at("maxSpeed").get<double>(),
          .start = pose_of(json.at("start")),
          .goal = pose_of(json.at("goal")),
          .person = json.at("person").get<bool>(),
          .automated = json.at("automated").get<bool>(),
          .movement = json.at("movement").get<std::string>()};
}

ReplayLaneKind lane_kind_of(const std::string& name) {
  for (const auto kind : {ReplayLaneKind::kBuses, ReplayLaneKind::kBicycles, ReplayLaneKind::kRail,
                          ReplayLaneKind::kFoot}) {
    if (name == name_of(kind)) return kind;
  }
  return ReplayLaneKind::kCars;
}

void read_paths(const Json& json, ReplayScene& scene) {
  for (const Json& lane : json.at("lanes")) {
    scene.lanes.push_back({.shape = points_of(lane.at("shape")),
                           .width = lane.at("width").get<double>(),
                           .internal = lane.at("internal").get<bool>(),
                           .stop_line = lane.at("stop").get<bool>(),
                           .kind = lane_kind_of(lane.at("kind").get<std::string>())});
  }
  for (const Json& crossing : json.at("crossings")) {
    scene.crossings.push_back(
        {points_of(crossing.at("shape")), crossing.at("width").get<double>()});
  }
  for (const Json& light : json.at("lights")) {
    const std::vector<Point> line = points_of(light.at("line"));
    scene.lights.push_back({.signal = light.at("signal").get<std::size_t>(),
                            .index = light.at("index").get<int>(),
                            .from = line.at(0),
                            .to = line.at(1)});
    if (const Json& target = light.at("target"); !target.is_null()) {
      scene.lights.back().target = points_of(target).at(0);
    }
  }
  for (const Json& corridor : json.at("corridors")) {
    scene.corridors.push_back({corridor.at("zone").get<int>(), points_of(corridor.at("shape"))});
  }
}

ReplayScene scene_of(const Json& json) {
  ReplayScene scene;
  read_paths(json, scene);
  const auto read = [&](const char* name, std::vector<Polygon>& polygons) {
    for (const Json& polygon : json.at(name)) polygons.push_back(points_of(polygon));
  };
  read("polygons", scene.polygons);
  read("junctions", scene.junctions);
  read("zones", scene.zones);
  read("slots", scene.slots);
  if (const Json& border = json.at("border"); !border.is_null()) {
    scene.border = Point{border.at(0).get<double>(), border.at(1).get<double>()};
  }
  for (const Json& circle : json.at("circles")) {
    scene.circles.push_back(
        {circle.at(0).get<double>(), circle.at(1).get<double>(), circle.at(2).get<double>()});
  }
  return scene;
}

/// Takes ReplayColumns apart.
class ColumnReader {
 public:
  explicit ColumnReader(std::string_view bytes) : bytes_(bytes) {}

  /// One whole column of so many values.
  std::vector<std::int64_t> column(std::size_t count) {
    std::vector<std::int64_t> values;
    begin_column();
    while (values.size() < count) values.push_back(next());
    return values;
  }

  /// ReplayRuns: pairs of how often and which, in a column that ends with the track.
  std::vector<std::int64_t> runs(std::size_t count) {
    std::vector<std::int64_t> values;
    begin_column();
    while (values.size() < count) {
      const std::int64_t length = next();
      const std::int64_t value = next();
      if (length <= 0 || static_cast<std::size_t>(length) > count - values.size()) throw Damaged();
      values.insert(values.end(), static_cast<std::size_t>(length), value);
    }
    return values;
  }

  struct Damaged {};

 private:
  void begin_column() { index_ = value_ = difference_ = 0; }

  std::int64_t next() {
    const std::int64_t second = varint();
    difference_ = index_ == 1 ? second : difference_ + second;
    ++index_;
    return value_ += difference_;
  }

  std::int64_t varint() {
    std::uint64_t rest = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      if (at_ >= bytes_.size()) throw Damaged();
      const auto byte = static_cast<unsigned char>(bytes_[at_++]);
      rest |= std::uint64_t(byte & 0x7f) << shift;
      if (byte < 0x80) {
        return static_cast<std::int64_t>(rest >> 1) ^ -static_cast<std::int64_t>(rest & 1);
      }
    }
    throw Damaged();
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::int64_t index_ = 0;
  std::int64_t value_ = 0;
  std::int64_t difference_ = 0;
};

/// Which columns there are beside those that all replays have.
struct Extras {
  bool groups = false;
  bool emissions = false;
};

void read_track(const Json& track, const Extras& extras, ColumnReader& reader,
                ReplayFrames& frames) {
  const auto vehicle = track.at(0).get<std::size_t>();
  const auto first = track.at(1).get<std::size_t>();
  const auto count = track.at(2).get<std::size_t>();
  const std::size_t frame_count = frames.times.size();
  if (first > frame_count || count > frame_count - first) throw ColumnReader::Damaged();
  const auto x = reader.column(count);
  const auto y = reader.column(count);
  const auto heading = reader.column(count);
  const auto speed = reader.column(count);
  const auto state = reader.runs(count);
  const auto groups = extras.groups ? reader.runs(count) : std::vector<std::int64_t>(count);
  const auto ranks = extras.groups ? reader.runs(count) : std::vector<std::int64_t>(count);
  const auto co2 = extras.emissions ? reader.column(count) : std::vector<std::int64_t>();
  for (std::size_t k = 0; k < count; ++k) {
    const Pose pose{double(x[k]) * 0.01, double(y[k]) * 0.01,
                    wrap_to_pi(double(heading[k]) * std::numbers::pi / 1800.0)};
    ReplayVehicleState& now = frames.states[first + k].emplace_back();
    now = {vehicle, pose, double(speed[k]) * 0.02, static_cast<ReplayState>(state[k])};
    if (groups[k] > 0) now.group = static_cast<std::size_t>(groups[k] - 1);
    now.rank = static_cast<int>(ranks[k]);
    if (extras.emissions) now.co2 = double(co2[k]) * 0.2;
  }
}

/// At a fraction u of the distance from a to b, with a constant twist: along an arc, if a car drove
/// one.
Pose between(const Pose& a, const Pose& b, double u) {
  const Pose step = relative(a, b);
  if (std::abs(step.theta) < 1e-4) return compose(a, {u * step.x, u * step.y, u * step.theta});
  const double half = step.theta / 2.0;
  const double cot = half / std::tan(half);
  const double vx = (cot * step.x + half * step.y) / step.theta;
  const double vy = (cot * step.y - half * step.x) / step.theta;
  const double phi = u * step.theta;
  const double sin = std::sin(phi);
  const double cos = 1.0 - std::cos(phi);
  return compose(a, {sin * vx - cos * vy, cos * vx + sin * vy, phi});
}

template <class Value>
Value read(const Replay& replay, const std::string& where,
           const std::function<Value(const Json&)>& value_of) {
  try {
    return value_of(Json::parse(replay.header));
  } catch (const Json::exception&) {
    throw InputError(where, "the replay in it is damaged; write the page again");
  } catch (const ColumnReader::Damaged&) {
    throw InputError(where, "the replay in it is damaged; write the page again");
  }
}

}  // namespace

std::vector<ReplayVehicle> vehicles_of(const Replay& replay, const std::string& where) {
  return read<std::vector<ReplayVehicle>>(replay, where, [](const Json& header) {
    std::vector<ReplayVehicle> vehicles;
    for (const Json& vehicle : header.at("vehicles")) vehicles.push_back(vehicle_of(vehicle));
    return vehicles;
  });
}

ReplayScene scene_of(const Replay& replay, const std::string& where) {
  return read<ReplayScene>(replay, where,
                           [](const Json& header) { return scene_of(header.at("scene")); });
}

ReplayFrames frames_of(const Replay& replay, const std::string& where) {
  return read<ReplayFrames>(replay, where, [&](const Json& header) {
    ReplayFrames frames;
    if (header.at("steps").get<bool>()) frames.motion = ReplayMotion::kSteps;
    ColumnReader reader(replay.frames);
    const auto count = header.at("frames").get<std::size_t>();
    for (const std::int64_t ms : reader.column(count)) frames.times.push_back(double(ms) / 1000.0);
    if (header.at("clearance").get<bool>()) (void)reader.column(count);
    frames.states.resize(count);
    const Extras extras{header.at("groups").get<bool>(), header.at("emissions").get<bool>()};
    for (const Json& track : header.at("tracks")) read_track(track, extras, reader, frames);
    return frames;
  });
}

std::vector<ReplaySignal> signals_of(const Replay& replay, const std::string& where) {
  return read<std::vector<ReplaySignal>>(replay, where, [](const Json& header) {
    std::vector<ReplaySignal> signals;
    for (const Json& json : header.at("signals")) {
      ReplaySignal& signal = signals.emplace_back();
      signal.id = json.at("id").get<std::string>();
      for (const Json& shown : json.at("shown")) {
        signal.shown.emplace_back(shown.at(0).get<double>(), shown.at(1).get<std::string>());
      }
    }
    return signals;
  });
}

std::vector<std::string> lights_at(const Replay& replay, double time, const std::string& where) {
  std::vector<std::string> lights;
  for (const ReplaySignal& signal : signals_of(replay, where)) {
    lights.emplace_back();
    for (const auto& [since, letters] : signal.shown) {
      if (since <= time + 1e-9) lights.back() = letters;
    }
  }
  return lights;
}

std::vector<ReplayVehicleState> states_at(const ReplayFrames& frames, double time) {
  const auto next = std::ranges::upper_bound(frames.times, time);
  if (next == frames.times.begin()) return {};
  const auto k = static_cast<std::size_t>(next - frames.times.begin()) - 1;
  std::vector<ReplayVehicleState> now = frames.states[k];
  if (next == frames.times.end()) return now;
  const double u = (time - frames.times[k]) / (*next - frames.times[k]);
  for (ReplayVehicleState& state : now) {
    const auto& later = frames.states[k + 1];
    const auto same = std::ranges::find(later, state.vehicle, &ReplayVehicleState::vehicle);
    if (same == later.end()) continue;
    state.pose = between(state.pose, same->pose, u);
    if (u > 0.0 && frames.motion == ReplayMotion::kSteps) state.speed = same->speed;
  }
  return now;
}

}  // namespace mvtp
