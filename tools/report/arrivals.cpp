#include "tools/report/arrivals.hpp"

#include <algorithm>
#include <vector>

#include "tools/runs/mean.hpp"

namespace mvtp {
namespace {

using Json = ReportJson;

}  // namespace

Json arrivals_line(const std::string& label, std::span<const SweepRow> rows) {
  Json line = {{"label", label}, {"x", Json::array()}, {"y", Json::array()}, {"sd", Json::array()}};
  std::size_t minutes = 0;
  for (const SweepRow& row : rows) minutes = std::max(minutes, row.arrivals.size());
  for (std::size_t m = 0; m < minutes; ++m) {
    std::vector<double> there;
    for (const SweepRow& row : rows) {
      if (m < row.arrivals.size()) there.push_back(row.arrivals[m]);
    }
    const MeanAndDeviation arrivals = mean_and_deviation(there);
    line["x"].push_back(double(m) + 0.5);
    line["y"].push_back(arrivals.mean);
    line["sd"].push_back(arrivals.deviation.value_or(0.0));
  }
  return line;
}

Json arrivals_figure(Json panels) {
  return {{"name", "arrivals-by-minute"},
          {"x", "Time [min]"},
          {"y", "Arrivals [1/min]"},
          {"panels", std::move(panels)}};
}

}  // namespace mvtp
