#include <tinyxml2.h>

#include <filesystem>
#include <limits>
#include <map>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/export/recording.hpp"
#include "tools/view/page.hpp"
#include "tools/view/read_replay.hpp"
#include "traci_bridge/declared_type.hpp"
#include "traci_bridge/sumo_frame.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTextBytes = 2'000'000'000;

double number(const tinyxml2::XMLElement& element, const char* name, const std::string& where) {
  double value = 0.0;
  if (element.QueryDoubleAttribute(name, &value) != tinyxml2::XML_SUCCESS) {
    throw InputError(where, std::string("<") + element.Name() + "> has no number \"" + name +
                                "\"; run mvtp coordinate again");
  }
  return value;
}

/// Takes apart what SUMO writes: one element per time step, which may be more than fits into memory
/// as a tree.
class FcdReader {
 public:
  FcdReader(std::string path, const std::map<std::string, ReplayVehicle>& bodies)
      : path_(std::move(path)), text_(read_text_file(path_, kMaxTextBytes)), bodies_(bodies) {}

  void read(Recording& recording) {
    recording_ = &recording;
    constexpr std::string_view kOpening = "<timestep";
    for (std::size_t at = 0; (at = text_.find(kOpening, at)) != std::string::npos;) {
      const std::size_t end = end_of(at);
      tinyxml2::XMLDocument step;
      if (end == std::string::npos ||
          step.Parse(text_.data() + at, end - at) != tinyxml2::XML_SUCCESS) {
        throw InputError(path_, "is damaged behind time " + std::to_string(last_time_) +
                                    " s; run mvtp coordinate again");
      }
      read_step(*step.RootElement());
      at = end;
    }
    if (steps_ < 2) throw InputError(path_, "has less than two time steps; give a longer run");
  }

  /// The file that the run had as its network, as SUMO notes it at the top.
  [[nodiscard]] std::string network() const {
    constexpr std::string_view kKey = "<net-file value=\"";
    const std::size_t at = text_.find(kKey);
    if (at == std::string::npos || at > text_.find("<timestep")) return "";
    const std::size_t begin = at + kKey.size();
    return fs::path(text_.substr(begin, text_.find('"', begin) - begin)).lexically_normal();
  }

 private:
  /// Behind the end of the time step that begins at `at`.
  [[nodiscard]] std::size_t end_of(std::size_t at) const {
    const std::size_t tag_end = text_.find('>', at);
    if (tag_end == std::string::npos) return tag_end;
    if (text_[tag_end - 1] == '/') return tag_end + 1;
    constexpr std::string_view kClosing = "</timestep>";
    const std::size_t end = text_.find(kClosing, tag_end);
    return end == std::string::npos ? end : end + kClosing.size();
  }

  void read_step(const tinyxml2::XMLElement& step) {
    const double time = number(step, "time", path_);
    if (steps_ == 1) recording_->dt = time - last_time_;
    if (steps_ > 0 && time <= last_time_) throw InputError(path_, "its times do not increase");
    last_time_ = time;
    ++steps_;
    const tinyxml2::XMLElement* vehicle = step.FirstChildElement("vehicle");
    for (; vehicle != nullptr; vehicle = vehicle->NextSiblingElement("vehicle")) {
      read_vehicle(*vehicle, time);
    }
  }

  void read_vehicle(const tinyxml2::XMLElement& element, double time) {
    const char* id = element.Attribute("id");
    if (id == nullptr) throw InputError(path_, "a vehicle in it has no id");
    const auto [known, is_new] = index_of_.try_emplace(id, recording_->vehicles.size());
    if (is_new) recording_->vehicles.push_back({id, "", body_of(id), {}});
    RecordedVehicle& vehicle = recording_->vehicles[known->second];
    if (const char* type = element.Attribute("type")) vehicle.kind = declared_type(type, id);
    const SumoPosition place{number(element, "x", path_), number(element, "y", path_),
                             number(element, "angle", path_)};
    vehicle.states.push_back(
        {time, from_sumo(place, vehicle.body.front), number(element, "speed", path_), 0.0});
  }

  [[nodiscard]] Vehicle body_of(const std::string& id) const {
    const auto body = bodies_.find(id);
    if (body == bodies_.end()) {
      throw InputError(path_, "has vehicle \"" + id +
                                  "\", which the replay beside it lacks; are both of one run?");
    }
    Vehicle vehicle = mvtp::body_of(body->second.length, body->second.width);
    vehicle.front = body->second.front;
    vehicle.rear = body->second.length - body->second.front;
    vehicle.max_speed = std::numeric_limits<double>::infinity();  // not known here
    return vehicle;
  }

  std::string path_;
  std::string text_;
  const std::map<std::string, ReplayVehicle>& bodies_;
  Recording* recording_ = nullptr;
  std::map<std::string, std::size_t> index_of_;
  double last_time_ = 0.0;
  int steps_ = 0;
};

}  // namespace

Recording read_run_recording(const std::string& folder) {
  const std::string page = (fs::path(folder) / "view.html").string();
  const std::string fcd = (fs::path(folder) / "fcd.xml").string();
  for (const std::string& file : {page, fcd}) {
    if (fs::exists(file)) continue;
    throw InputError(file,
                     "is missing; give the folder of a run of mvtp coordinate without "
                     "--no-view and --no-fcd, or of mvtp compare with --keep-fcd");
  }
  const Replay replay = replays_of(read_text_file(page, kMaxTextBytes), page).front();
  std::map<std::string, ReplayVehicle> bodies;
  for (const ReplayVehicle& vehicle : vehicles_of(replay, page)) {
    if (!vehicle.person) bodies[vehicle.id] = vehicle;
  }

  Recording recording;
  recording.name = fs::canonical(folder).filename().string();
  recording.scene = scene_of(replay, page);
  FcdReader reader(fcd, bodies);
  reader.read(recording);
  recording.network = reader.network();
  for (RecordedVehicle& vehicle : recording.vehicles) fill_in_motion(vehicle);
  return recording;
}

}  // namespace mvtp
