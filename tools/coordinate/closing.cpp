#include "tools/coordinate/closing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "tools/runs/comparison.hpp"

namespace mvtp {

std::string closing_table(const RunReport& report, const std::string& folder) {
  ComparedRun run{
      .control = report.controller, .seed = std::uint32_t(report.seed), .folder = folder};
  read_summary(summary_json(report), "summary.json", run);
  return comparison_table({&run, 1});
}

std::vector<std::string> complaints(const RunReport& report, const std::string& configuration,
                                    const std::string& events) {
  std::vector<std::string> lines;
  const auto missing = std::ranges::count_if(
      report.vehicles, [](const VehicleRecord& v) { return !v.arrival.has_value(); });
  if (!report.message.empty()) {
    lines.push_back(report.message);
  } else if (report.vehicles.empty()) {
    lines.push_back(
        fmt::format("no vehicle departed until t = {:.2f} s; is the demand of {} empty, or later?",
                    report.end, configuration));
  }
  if (report.audit.overlap_pairs_coordinated > 0) {
    lines.push_back(fmt::format("{} pairs with a coordinated vehicle overlapped; see {}",
                                report.audit.overlap_pairs_coordinated, events));
  }
  if (report.audit.people_touched > 0) {
    lines.push_back(fmt::format("coordinated vehicles touched people {} times; see {}",
                                report.audit.people_touched, events));
  }
  if (missing > 0 && report.message.empty()) {
    lines.push_back(fmt::format("{} of {} vehicles had not arrived at t = {:.2f} s ({})", missing,
                                report.vehicles.size(), report.end, report.status));
  }
  return lines;
}

}  // namespace mvtp
