#include "traci_bridge/sumo_signals.hpp"

#include <stdexcept>

namespace mvtp::MVTP_SUMO_NAMESPACE {

void SumoSignals::show(const std::string& signal, int index, Light light) {
  const auto [found, is_new] = signals_.try_emplace(signal);
  Signal& shown = found->second;
  if (is_new) {
    shown.program = api::TrafficLight::getProgram(signal);
    shown.lights = api::TrafficLight::getRedYellowGreenState(signal);
    shown.lights.assign(shown.lights.size(), char(Light::kRed));
  }
  if (index < 0 || std::size_t(index) >= shown.lights.size()) {
    throw std::runtime_error("traffic signal \"" + signal + "\" has no light " +
                             std::to_string(index));
  }
  shown.changed |= is_new || shown.lights[std::size_t(index)] != char(light);
  shown.lights[std::size_t(index)] = char(light);
}

void SumoSignals::send() {
  for (auto& [id, signal] : signals_) {
    if (signal.changed) api::TrafficLight::setRedYellowGreenState(id, signal.lights);
    signal.changed = false;
  }
}

void SumoSignals::free(const std::string& signal) {
  const auto found = signals_.find(signal);
  if (found == signals_.end()) return;
  api::TrafficLight::setProgram(signal, found->second.program);
  signals_.erase(found);
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
