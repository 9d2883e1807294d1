#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/bench/results.hpp"
#include "tools/runs/mean.hpp"

namespace mvtp {

/// What the name of an instance says about it, by the habits of our suites and of CSDO's:
/// "dense_map50x50_obst20_a025_ex07.yaml", "map_50by50_obst25_agents5_ex0.yaml", "circle8.yaml".
struct InstanceTraits {
  std::string suite;  ///< "dense"; "results" if the name has none of these
  std::string map;    ///< for people: "50 x 50 m, 20 obstacles"; else its folder, or "other"
  std::optional<int> robots;  ///< nullopt: the name does not say

  friend auto operator<=>(const InstanceTraits&, const InstanceTraits&) = default;
};
[[nodiscard]] InstanceTraits traits_of(const std::string& instance);

/// One algorithm on one map with one number of robots.
struct CellSummary {
  std::string algorithm;
  std::optional<int> robots;
  int runs = 0;
  int solved = 0;  ///< that the solver calls so
  int valid = 0;   ///< that the referee finds valid: these are the successes
  // Over the successes; nullopt if there are none.
  std::optional<MeanAndDeviation> makespan_steps;
  std::optional<MeanAndDeviation> ratio;           ///< makespan / lower bound
  std::optional<MeanAndDeviation> first_solution;  ///< [s]
  // Over all runs.
  MeanAndDeviation runtime;  ///< [s]; see summarise()
  double peak_rss = 0.0;     ///< the largest [MiB]
};

/// A column of the figures.
struct MapSummary {
  std::string map;
  std::vector<CellSummary> cells;  ///< ordered by robots, then by algorithm
};

/// Two algorithms on the runs in which both succeeded: the fair comparison of their makespans.
struct Comparison {
  std::string algorithm;
  std::string other;
  int runs = 0;
  double ratio = 0.0;  ///< geometric mean of makespan / the other's makespan
};

struct SuiteSummary {
  std::string suite;
  std::vector<MapSummary> maps;
  std::vector<std::string> algorithms;  ///< the order in which tables and legends list them
  std::vector<Comparison> comparisons;  ///< of all ordered pairs that have common successes
};

/// Groups the rows as the figures of the ESCoT paper do (Figs. 6 and 7).
/// @param time_limit  what a run without success counts as in `runtime`, as in the paper [s];
///                    nullopt: what it took.
[[nodiscard]] std::vector<SuiteSummary> summarise(std::span<const ResultRow> rows,
                                                  std::optional<double> time_limit);

/// The tables, and below them how their figures are to be read.
[[nodiscard]] std::string to_markdown(std::span<const SuiteSummary> suites,
                                      std::optional<double> time_limit);
/// What report.py draws.
[[nodiscard]] std::string to_json(std::span<const SuiteSummary> suites,
                                  std::optional<double> time_limit);

}  // namespace mvtp
