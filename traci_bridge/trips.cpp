#include "traci_bridge/trips.hpp"

#include <optional>

#include "traci_bridge/xml.hpp"

namespace mvtp {
namespace {

/// SUMO writes -1 for "not yet".
std::optional<double> reached(double time) {
  return time < 0.0 ? std::nullopt : std::optional(time);
}

Trip read_trip(const XmlFile& file, const tinyxml2::XMLElement& element) {
  return {.id = file.text(element, "id"),
          .type = file.text(element, "vType"),
          .depart = reached(file.number(element, "depart")),
          .depart_delay = file.number(element, "departDelay"),
          .depart_lane = attribute(element, "departLane"),
          .depart_position = file.number(element, "departPos", 0.0),
          .depart_speed = file.number(element, "departSpeed", 0.0),
          .arrival = reached(file.number(element, "arrival")),
          .arrival_lane = attribute(element, "arrivalLane"),
          .arrival_position = file.number(element, "arrivalPos", 0.0),
          .duration = file.number(element, "duration"),
          .route_length = file.number(element, "routeLength"),
          .time_loss = file.number(element, "timeLoss"),
          .waiting_time = file.number(element, "waitingTime"),
          .speed_factor = file.number(element, "speedFactor"),
          .vaporized = attribute(element, "vaporized")};
}

}  // namespace

std::vector<Trip> read_trips(const std::string& path) {
  const XmlFile file(path, "SUMO's tripinfo-output");
  if (std::string(file.root().Name()) != "tripinfos") {
    file.fail(file.root(), std::string("the root element is <") + file.root().Name() +
                               ">, not <tripinfos>; give the path of SUMO's tripinfo-output");
  }
  std::vector<Trip> trips;
  for (const tinyxml2::XMLElement* element : children(file.root(), "tripinfo")) {
    trips.push_back(read_trip(file, *element));
  }
  return trips;
}

}  // namespace mvtp
