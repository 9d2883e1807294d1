#include "coordinator/report/people_log.hpp"

#include "coordinator/measures/statistics.hpp"

namespace mvtp {

void PeopleLog::observe(const Snapshot& now) {
  const double step = last_ < 0.0 ? 0.0 : now.time - last_;
  last_ = now.time;
  for (const Pedestrian& person : now.people) {
    double& wait = waits_.try_emplace(person.id, 0.0).first->second;
    if (person.speed < kStands) wait += step;
  }
}

PeopleFigures PeopleLog::figures() const {
  std::vector<double> waits;
  for (const auto& [id, wait] : waits_) waits.push_back(wait);
  return {.walked = std::int64_t(waits.size()),
          .wait_mean = mean(waits),
          .wait_p95 = quantile(waits, 0.95),
          .wait_max = largest(waits)};
}

}  // namespace mvtp
