#include "coordinator/signals/queue_model.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

namespace mvtp {
namespace {

constexpr double kStep = 0.5;       ///< [s]
constexpr double kHorizon = 120.0;  ///< [s]
constexpr double kHeadway = 2.0;    ///< [s] of saturated flow
constexpr double kStart = 1.0;      ///< [s] until the first of a queue is over the line
constexpr double kGap = 3.0;        ///< [s] between those who come closely
constexpr double kYield = 4.0;      ///< [s] that who yields needs before the next one comes

/// Queues that discharge.
class Discharge {
 public:
  Discharge(const Queues& queues, const QueuePhases& phases) : queues_(queues), phases_(phases) {
    heads_.assign(queues.size(), 0);
    last_.assign(queues.size(), -kHeadway);
    for (const auto& queue : queues) left_ += queue.size();
  }

  /// @param next  the second phase; none: as the others are chosen.
  double run(double end, std::optional<int> next) {
    int phase = phases_.present;
    double green = phases_.ready;
    bool first = next.has_value();
    for (double t = 0.0; left_ > 0 && t < kHorizon; t += kStep) {
      const bool over = first ? t >= end : t >= green + phases_.least_green && !goes_on(phase, t);
      if (over && (first || wants_other(phase))) {
        clear(phase, t);
        phase = first ? *next : busiest(phase, t);
        green = t + (first ? phases_.first_change : phases_.change);
        first = false;
      }
      if (t >= green) serve(phase, green, t);
    }
    for (std::size_t lane = 0; lane < queues_.size(); ++lane) {
      for (std::size_t i = heads_[lane]; i < queues_[lane].size(); ++i) {
        lost_ += queues_[lane][i].weight * (kHorizon - queues_[lane][i].arrival);
      }
    }
    return lost_;
  }

 private:
  [[nodiscard]] const QueuedVehicle* head(std::size_t lane) const {
    return heads_[lane] < queues_[lane].size() ? &queues_[lane][heads_[lane]] : nullptr;
  }

  /// Does somebody to whom it would have to yield come soon, or stand at its green?
  [[nodiscard]] bool must_yield(std::size_t lane, int phase, double t) const {
    for (std::size_t other = 0; other < queues_.size(); ++other) {
      const QueuedVehicle* foe = other == lane ? nullptr : head(other);
      if (foe == nullptr || !phases_.has_green(phase, foe->link)) continue;
      if (phases_.yields_to(foe->link, head(lane)->link)) continue;
      if (phases_.yields_to(head(lane)->link, foe->link) && foe->arrival < t + kYield) return true;
    }
    return false;
  }

  void pass(std::size_t lane, double t) {
    lost_ += head(lane)->weight * std::max(0.0, t - head(lane)->arrival);
    last_[lane] = t;
    ++heads_[lane];
    --left_;
  }

  void serve(int phase, double green, double t) {
    for (std::size_t lane = 0; lane < queues_.size(); ++lane) {
      const QueuedVehicle* v = head(lane);
      if (v == nullptr || v->arrival > t || t < last_[lane] + kHeadway) continue;
      if ((v->stands || v->arrival < green) && t < green + kStart) continue;
      if (phases_.has_green(phase, v->link) && t >= phases_.free_in(v->link) &&
          !must_yield(lane, phase, t))
        pass(lane, t);
    }
  }

  /// Who has waited inside to yield leaves at the end of a green.
  void clear(int phase, double t) {
    for (std::size_t lane = 0; lane < queues_.size(); ++lane) {
      const QueuedVehicle* v = head(lane);
      const bool inside = v != nullptr && v->arrival <= t && phases_.has_green(phase, v->link) &&
                          must_yield(lane, phase, t);
      if (inside) pass(lane, t + kHeadway);
    }
  }

  [[nodiscard]] bool goes_on(int phase, double t) const {
    for (std::size_t lane = 0; lane < queues_.size(); ++lane) {
      const QueuedVehicle* v = head(lane);
      if (v != nullptr && phases_.has_green(phase, v->link) && v->arrival < t + kGap) return true;
    }
    return false;
  }

  [[nodiscard]] bool wants_other(int phase) const {
    for (std::size_t lane = 0; lane < queues_.size(); ++lane) {
      if (head(lane) != nullptr && !phases_.has_green(phase, head(lane)->link)) return true;
    }
    return false;
  }

  /// The phase for which most vehicles wait or come first.
  [[nodiscard]] int busiest(int present, double t) const {
    int best = present;
    double most = -1e300;
    for (int p = 0; p < phases_.phases; ++p) {
      if (p == present) continue;
      double weight = 0.0;
      for (std::size_t lane = 0; lane < queues_.size(); ++lane) {
        for (std::size_t i = heads_[lane]; i < queues_[lane].size(); ++i) {
          const QueuedVehicle& v = queues_[lane][i];
          if (!phases_.has_green(p, v.link)) break;
          weight += v.weight * (v.arrival <= t ? 1.0 : 1.0 / (1.0 + v.arrival - t));
        }
      }
      if (weight > most) std::tie(best, most) = std::pair(p, weight);
    }
    return best;
  }

  const Queues& queues_;
  const QueuePhases& phases_;
  std::vector<std::size_t> heads_;  ///< the first who is still there, by lane
  std::vector<double> last_;        ///< when the last one went, by lane
  std::size_t left_ = 0;
  double lost_ = 0.0;
};

}  // namespace

double queue_delay(const Queues& queues, const QueuePhases& phases, double end, int next) {
  return Discharge(queues, phases).run(end, next);
}

double queue_delay(const Queues& queues, const QueuePhases& phases) {
  return Discharge(queues, phases).run(0.0, std::nullopt);
}

}  // namespace mvtp
