#include "coordinator/signals/signal_program.hpp"

#include <algorithm>

namespace mvtp {

SignalProgram::SignalProgram(const Traffic& traffic, std::string signal)
    : traffic_(traffic),
      signal_(std::move(signal)),
      phases_(traffic.signal_phases(signal_)),
      by_clock_(traffic.signal_control(signal_) == SignalControl::kFixed) {
  observe();
  since_.reset();
}

/// The phase with the lights that are shown; of several the one that comes next.
void SignalProgram::observe() {
  const std::string lights = traffic_.shown(signal_);
  if (phases_[phase_].lights == lights) return;
  for (std::size_t n = 1; n < phases_.size(); ++n) {
    const std::size_t next = (phase_ + n) % phases_.size();
    if (phases_[next].lights != lights) continue;
    phase_ = next;
    since_ = traffic_.time();
    return;
  }
}

char SignalProgram::right(std::size_t phase, int index) const {
  for (std::size_t n = 0; n < phases_.size(); ++n) {
    const char shown = light((phase + phases_.size() - n) % phases_.size(), index);
    if (shown != 'y') return shown;
  }
  return 'y';
}

SignalProgram::Course SignalProgram::course(double left, double horizon) const {
  Course course;
  std::size_t phase = phase_;
  for (double t = 0.0; t < horizon;
       left = by_clock_ ? phases_[phase].duration : phases_[phase].most) {
    course.push_back({t, t + left, phase});
    t += std::max(left, traffic_.step_length());
    phase = (phase + 1) % phases_.size();
  }
  return course;
}

std::vector<SignalProgram::Course> SignalProgram::courses(double horizon) const {
  const SignalPhase& now = phases_[phase_];
  const double elapsed = since_ ? traffic_.time() - *since_ : 0.0;
  const double most = by_clock_ ? now.duration : now.most;
  double least = by_clock_ ? now.duration : now.least;
  if (!since_) least = 0.0;  // nobody knows when it began
  std::vector<Course> courses = {course(std::max(0.0, most - elapsed), horizon)};
  if (least < most) courses.push_back(course(std::max(0.0, least - elapsed), horizon));
  return courses;
}

}  // namespace mvtp
