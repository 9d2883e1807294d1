#include "traci_bridge/sumo_signals.hpp"

#include <memory>
#include <stdexcept>

namespace mvtp::MVTP_SUMO_NAMESPACE {

namespace {

// The kinds of programs, by their numbers in TraCI.
constexpr int kStatic = 0;
constexpr int kActuated = 3;
// netconvert's --tls.min-dur and --tls.max-dur, for phases that say nothing themselves [s].
constexpr double kLeastGreen = 5.0;
constexpr double kMostGreen = 50.0;

bool is_change(const std::string& lights) { return lights.find_first_of("yu") != lights.npos; }

}  // namespace

SumoSignals::Signal& SumoSignals::shown(const std::string& signal) {
  const auto [found, is_new] = signals_.try_emplace(signal);
  Signal& shown = found->second;
  if (is_new) {
    shown.program = api::TrafficLight::getProgram(signal);
    shown.lights = api::TrafficLight::getRedYellowGreenState(signal);
    shown.lights.assign(shown.lights.size(), char(Light::kRed));
    shown.changed = true;
  }
  return shown;
}

void SumoSignals::show(const std::string& signal, int index, Light light) {
  Signal& shown = this->shown(signal);
  if (index < 0 || std::size_t(index) >= shown.lights.size()) {
    throw std::runtime_error("traffic signal \"" + signal + "\" has no light " +
                             std::to_string(index));
  }
  shown.changed |= shown.lights[std::size_t(index)] != char(light);
  shown.lights[std::size_t(index)] = char(light);
}

void SumoSignals::show_all(const std::string& signal, const std::string& lights) {
  Signal& shown = this->shown(signal);
  if (lights.size() != shown.lights.size()) {
    throw std::runtime_error("traffic signal \"" + signal + "\" has " +
                             std::to_string(shown.lights.size()) + " lights, not " +
                             std::to_string(lights.size()));
  }
  shown.changed |= shown.lights != lights;
  shown.lights = lights;
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

/// Its own: what we show is a program for SUMO, too.
std::string SumoSignals::program_of(const std::string& signal) const {
  const auto ours = signals_.find(signal);
  return ours == signals_.end() ? api::TrafficLight::getProgram(signal) : ours->second.program;
}

std::vector<SignalPhase> SumoSignals::phases(const std::string& signal) const {
  const std::string program = program_of(signal);
  std::vector<SignalPhase> phases;
  for (const libsumo::TraCILogic& logic : api::TrafficLight::getAllProgramLogics(signal)) {
    if (logic.programID != program) continue;
    for (const auto& phase : logic.phases) {
      const bool timed = is_change(phase->state);  // it lasts what it lasts
      const bool has_range = phase->minDur > 0.0 && phase->maxDur > phase->minDur;
      const double least = has_range ? phase->minDur : kLeastGreen;
      const double most = has_range ? phase->maxDur : kMostGreen;
      phases.push_back({.duration = phase->duration,
                        .least = timed ? phase->duration : least,
                        .most = timed ? phase->duration : most,
                        .lights = phase->state});
    }
  }
  return phases;
}

SignalControl SumoSignals::control_of(const std::string& signal) const {
  const std::string program = program_of(signal);
  if (program == "off") return SignalControl::kOff;
  for (const libsumo::TraCILogic& logic : api::TrafficLight::getAllProgramLogics(signal)) {
    if (logic.programID == program && logic.type == kStatic) return SignalControl::kFixed;
  }
  return SignalControl::kActuated;
}

void SumoSignals::control(const std::string& signal, SignalControl control) const {
  if (control == SignalControl::kOff) return api::TrafficLight::setProgram(signal, "off");
  const bool fixed = control == SignalControl::kFixed;
  libsumo::TraCILogic logic(fixed ? "mvtp-fixed" : "mvtp-actuated", fixed ? kStatic : kActuated, 0);
  for (const SignalPhase& phase : phases(signal)) {
    logic.phases.push_back(std::make_shared<libsumo::TraCIPhase>(
        phase.duration, phase.lights, fixed ? phase.duration : phase.least,
        fixed ? phase.duration : phase.most));
  }
  api::TrafficLight::setProgramLogic(signal, logic);
  api::TrafficLight::setProgram(signal, logic.programID);
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
