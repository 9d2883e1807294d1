#include "coordinator/corridor/no_waiting.hpp"

#include <algorithm>

namespace mvtp {

std::vector<std::pair<double, double>> inside_junctions(const Corridor& corridor, double length,
                                                        double before) {
  constexpr double kRounding = 0.05;  // [m] of where it waits before the line
  constexpr double kLong = 25.0;      // [m] of junction, where another one follows
  std::vector<std::pair<double, double>> inside;
  for (std::size_t i = 0; i < corridor.stops.size(); ++i) {
    const double line = corridor.stops[i];
    const bool is_last = i + 1 == corridor.stops.size();
    const double out = is_last ? corridor.s_exit + length
                               : std::min(line + kLong + length, corridor.stops[i + 1] - 1.0);
    inside.emplace_back(line - before + kRounding, out);
  }
  return inside;
}

std::vector<std::pair<double, double>> lanes_between(const LaneGraph& graph,
                                                     const Corridor& corridor) {
  std::vector<std::pair<double, double>> lanes;
  const auto exit = std::size_t(corridor.course.exit_piece);
  for (auto i = std::size_t(corridor.course.lines.front()) + 1; i < exit; ++i) {
    const bool is_normal = graph.edge_of(corridor.course.pieces[i].lane) != LaneGraph::kNone;
    if (is_normal) lanes.emplace_back(corridor.stations[i], corridor.stations[i + 1]);
  }
  return lanes;
}

std::vector<std::pair<double, double>> run_ups(const Corridor& corridor, double length) {
  constexpr double kLongest = 20.0;   // [m]: a car that starts there is 10 m/s fast at its line
  constexpr double kShare = 0.3;      // at most, of the road from one junction to the next
  constexpr double kJunction = 15.0;  // [m]
  std::vector<std::pair<double, double>> stretches;
  double begin = 0.0;
  for (const double line : corridor.stops) {
    const double room = line - begin;
    if (room > 0.0) stretches.emplace_back(line - std::min(kLongest, kShare * room), line);
    begin = line + kJunction + length;
  }
  return stretches;
}

}  // namespace mvtp
