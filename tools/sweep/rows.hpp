#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "tools/runs/comparison.hpp"
#include "tools/runs/row_file.hpp"

namespace mvtp {

/// One row of a sweep: how one run went.
struct SweepRow {
  std::string scenario;
  std::string controller;
  double scale = 1.0;        ///< of the demand
  double penetration = 1.0;  ///< 0 where nobody is taken over
  std::uint64_t seed = 0;
  /// As in summary.json, or "refused", "crashed".
  std::string status;
  std::map<std::string, double> figures;  ///< by the names of compared_figures()
  std::vector<int> arrivals;              ///< in each minute
  double runtime = 0.0;                   ///< [s]
  double peak_rss = 0.0;                  ///< [MiB]
  std::string version;

  friend bool operator==(const SweepRow&, const SweepRow&) = default;
};

/// What identifies a run.
using SweepKey = std::tuple<std::string, std::string, double, double, std::uint64_t>;
[[nodiscard]] inline SweepKey key_of(const SweepRow& row) {
  return {row.scenario, row.controller, row.scale, row.penetration, row.seed};
}

/// The first line of the file.
[[nodiscard]] std::string sweep_header();
/// One line with its end.
[[nodiscard]] std::string to_csv(const SweepRow& row);

/// @throws InputError "results.csv:17: seed: ..." where a line is not one of mvtp's.
[[nodiscard]] std::vector<SweepRow> read_sweep(const std::string& path);

/// Takes the figures and the arrivals from the text of a summary.json. @throws InputError
void read_sweep_figures(const std::string& summary, const std::string& where, SweepRow& row);

/// The results of a sweep, to which rows are appended; see RowFile.
class SweepFile {
 public:
  /// @throws InputError as RowFile
  SweepFile(const std::string& path, RowFile::Mode mode);

  [[nodiscard]] const std::set<SweepKey>& done() const { return done_; }
  void append(const SweepRow& row);

 private:
  std::set<SweepKey> done_;
  RowFile file_;
};

}  // namespace mvtp
