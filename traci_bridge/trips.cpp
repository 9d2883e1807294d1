#include "traci_bridge/trips.hpp"

#include <optional>
#include <string>

#include "traci_bridge/declared_type.hpp"
#include "traci_bridge/xml.hpp"

namespace mvtp {
namespace {

/// SUMO writes -1 for "not yet".
std::optional<double> reached(double time) {
  return time < 0.0 ? std::nullopt : std::optional(time);
}

/// SUMO counts in milligrams; its fuel is taken for petrol.
std::optional<Emissions> read_emissions(const XmlFile& file, const tinyxml2::XMLElement& trip) {
  constexpr double kMilligram = 1e-3;  // [g]
  constexpr double kPetrol = 0.742;    // [g/ml]
  const tinyxml2::XMLElement* element = trip.FirstChildElement("emissions");
  if (element == nullptr) return std::nullopt;
  return Emissions{.fuel = file.number(*element, "fuel_abs") * kMilligram / kPetrol,
                   .co2 = file.number(*element, "CO2_abs") * kMilligram,
                   .nox = file.number(*element, "NOx_abs") * kMilligram};
}

Trip read_trip(const XmlFile& file, const tinyxml2::XMLElement& element) {
  const std::string id = file.text(element, "id");
  return {.id = id,
          .type = declared_type(file.text(element, "vType"), id),
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
          .emissions = read_emissions(file, element),
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
