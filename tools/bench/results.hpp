#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "tools/runs/row_file.hpp"

namespace mvtp {

/// One row of results.csv: how one run of one algorithm on one instance went.
struct ResultRow {
  std::string instance;  ///< path, relative to what all paths of the command have in common
  std::string algorithm;
  std::uint64_t seed = 0;
  /// What the solver says: "solved", "timeout", ... (see Status), or "invalid" if its own referee
  /// objects; without its word "refused", "crashed" or "killed".
  std::string status;
  bool valid = false;                           ///< what the referee says of the plan file
  std::optional<std::uint64_t> makespan_steps;  ///< in steps of the instance's duration
  std::optional<double> makespan;               ///< [s]
  std::optional<double> flowtime;               ///< [s]
  std::optional<double> lower_bound;            ///< [s]
  std::optional<double> first_solution;         ///< [s]
  double runtime = 0.0;                         ///< [s]
  double peak_rss = 0.0;                        ///< of the solver's process [MiB]
  std::optional<std::uint64_t> solved_seed;     ///< of the run that solved, of several
  std::string version;

  friend bool operator==(const ResultRow&, const ResultRow&) = default;
};

/// What identifies a run.
using RunKey = std::tuple<std::string, std::string, std::uint64_t>;
[[nodiscard]] inline RunKey key_of(const ResultRow& row) {
  return {row.instance, row.algorithm, row.seed};
}

/// The first line of every results.csv.
[[nodiscard]] std::string results_header();
/// One line with its end. Seconds have four digits behind the point.
[[nodiscard]] std::string to_csv(const ResultRow& row);

/// The rows of the file `name` with this content.
/// @throws InputError "results.csv:17: makespan_s: ..." where a line is not one of mvtp's.
[[nodiscard]] std::vector<ResultRow> parse_results(std::string_view content,
                                                   const std::string& name);
[[nodiscard]] std::vector<ResultRow> read_results(const std::string& path);

/// The rows of all lists, each run once (the first found counts), ordered by instance, algorithm
/// and seed.
[[nodiscard]] std::vector<ResultRow> merge_results(
    const std::vector<std::vector<ResultRow>>& lists);

/// A results.csv to which rows are appended one by one; see RowFile.
class ResultFile {
 public:
  using Mode = RowFile::Mode;

  /// @throws InputError if the file cannot be written, is in use, exists against `mode`, or is not
  /// one of mvtp's.
  ResultFile(const std::string& path, RowFile::Mode mode);

  /// The runs that are in the file.
  [[nodiscard]] const std::set<RunKey>& done() const { return done_; }
  /// @throws InputError if the disk is full.
  void append(const ResultRow& row);

 private:
  std::set<RunKey> done_;
  RowFile file_;
};

}  // namespace mvtp
