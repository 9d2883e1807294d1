#include <cmath>

#include "tools/export/formats.hpp"
#include "tools/export/in_time.hpp"
#include "tools/export/xml_writer.hpp"
#include "traci_bridge/sumo_frame.hpp"

namespace mvtp {
namespace {

void write_vehicle(XmlWriter& xml, const TimedState& entry) {
  const SumoPosition place = to_sumo(entry.state->pose, entry.vehicle->body.front);
  xml.element("vehicle", [&] {
    xml.attribute("id", entry.vehicle->id);
    xml.attribute("x", place.x_m);
    xml.attribute("y", place.y_m);
    xml.attribute("angle", place.angle_deg);
    xml.attribute("type", entry.vehicle->kind.empty() ? "vehicle" : entry.vehicle->kind);
    xml.attribute("speed", std::abs(entry.state->v));
    xml.attribute("pos", 0.0);  // along a lane that is not known here
    xml.attribute("slope", 0.0);
  });
}

}  // namespace

std::string to_fcd(const Recording& recording) {
  const std::vector<TimedState> all = in_order_of_time(recording);
  XmlWriter xml;
  xml.element("fcd-export", [&] {
    for (std::size_t i = 0; i < all.size();) {
      const double time = all[i].state->time;
      xml.element("timestep", [&] {
        xml.attribute("time", time, 3);
        for (; i < all.size() && all[i].state->time == time; ++i) write_vehicle(xml, all[i]);
      });
    }
  });
  return xml.str();
}

}  // namespace mvtp
