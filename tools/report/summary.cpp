#include "tools/report/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <regex>
#include <tuple>
#include <utility>

namespace mvtp {
namespace {

// ---- names of instances

/// The last match of the pattern's first group; names say more than the folders they lie in.
std::optional<std::string> last_match(const std::string& text, const char* pattern) {
  const std::regex regex(pattern, std::regex::icase);
  std::optional<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), regex), end; i != end; ++i) {
    found = (*i)[1].str();
  }
  return found;
}

/// Numbers so long that they mean nothing are left alone.
std::optional<int> to_number(const std::optional<std::string>& digits) {
  if (!digits || digits->size() > 8) return std::nullopt;
  return std::stoi(*digits);
}

std::string plain_digits(const std::string& digits) {
  const std::size_t zeros = std::min(digits.find_first_not_of('0'), digits.size() - 1);
  return digits.substr(zeros);
}

/// "50 x 50 m, 20 obstacles" as far as the name says it.
std::string map_of(const std::string& instance) {
  std::string map;
  const auto width = last_match(instance, R"((\d+)(?:x|by)\d+)");
  const auto height = last_match(instance, R"(\d+(?:x|by)(\d+))");
  if (width) map = plain_digits(*width) + " x " + plain_digits(*height) + " m";
  const auto obstacles = last_match(instance, R"(obst(\d+))");
  auto kind = last_match(
      instance,
      R"((?:^|[/_.-])(empty|obstacles?|random|rooms?|maze|circle|pairs)(?=\d*(?:[/_.-]|$)))");
  if (obstacles)
    kind = plain_digits(*obstacles) == "0" ? "empty" : plain_digits(*obstacles) + " obstacles";
  if (kind) map += (map.empty() ? "" : ", ") + *kind;
  return map;
}

// ---- figures

std::optional<MeanAndDeviation> mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return mean_and_deviation(values);
}

CellSummary summarise_cell(const std::vector<const ResultRow*>& rows,
                           std::optional<double> time_limit) {
  CellSummary cell;
  std::vector<double> steps;
  std::vector<double> ratios;
  std::vector<double> first;
  std::vector<double> runtime;
  for (const ResultRow* row : rows) {
    ++cell.runs;
    if (row->status == "solved") ++cell.solved;
    cell.peak_rss = std::max(cell.peak_rss, row->peak_rss);
    runtime.push_back(row->valid ? row->runtime : time_limit.value_or(row->runtime));
    if (!row->valid) continue;
    ++cell.valid;
    if (row->makespan_steps) steps.push_back(double(*row->makespan_steps));
    if (row->makespan && row->lower_bound.value_or(0.0) > 0.0) {
      ratios.push_back(*row->makespan / *row->lower_bound);
    }
    if (row->first_solution) first.push_back(*row->first_solution);
  }
  cell.makespan_steps = mean_of(steps);
  cell.ratio = mean_of(ratios);
  cell.first_solution = mean_of(first);
  cell.runtime = mean_of(runtime).value_or(MeanAndDeviation{});
  return cell;
}

/// Where the algorithms of the program stand in tables and legends; others follow by name.
std::size_t rank(const std::string& algorithm) {
  constexpr std::array<std::string_view, 6> kOrder = {"escot-star", "escot",  "pbcr",
                                                      "eccr",       "cl-cbs", "sha"};
  return std::size_t(std::ranges::find(kOrder, algorithm) - kOrder.begin());
}

std::vector<std::string> algorithms_of(const std::vector<const ResultRow*>& rows) {
  std::vector<std::string> names;
  for (const ResultRow* row : rows) names.push_back(row->algorithm);
  std::ranges::sort(names, {}, [](const std::string& name) { return std::pair(rank(name), name); });
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::vector<Comparison> compare(const std::vector<const ResultRow*>& rows,
                                const std::vector<std::string>& algorithms) {
  std::map<std::pair<std::string, std::uint64_t>, std::map<std::string, double>> makespans;
  for (const ResultRow* row : rows) {
    if (!row->valid || row->makespan.value_or(0.0) <= 0.0) continue;
    makespans[{row->instance, row->seed}][row->algorithm] = *row->makespan;
  }
  std::vector<Comparison> comparisons;
  for (const std::string& a : algorithms) {
    for (const std::string& b : algorithms) {
      if (a == b) continue;
      Comparison comparison{a, b, 0, 0.0};
      double logarithms = 0.0;
      for (const auto& [run, by_algorithm] : makespans) {
        const auto of_a = by_algorithm.find(a);
        const auto of_b = by_algorithm.find(b);
        if (of_a == by_algorithm.end() || of_b == by_algorithm.end()) continue;
        ++comparison.runs;
        logarithms += std::log(of_a->second / of_b->second);
      }
      if (comparison.runs == 0) continue;
      comparison.ratio = std::exp(logarithms / comparison.runs);
      comparisons.push_back(comparison);
    }
  }
  return comparisons;
}

/// Maps by size, then the empty one, those with discs by their number, and others by name.
auto map_order(const std::string& map) {
  const int width = to_number(last_match(map, R"(^(\d+) x)")).value_or(1'000'000'000);
  const int obstacles =
      map.ends_with("empty")
          ? 0
          : to_number(last_match(map, R"((\d+) obstacles)")).value_or(1'000'000'000);
  return std::tuple(width, obstacles, map);
}

}  // namespace

InstanceTraits traits_of(const std::string& instance) {
  InstanceTraits traits;
  traits.suite = last_match(instance, R"((?:^|[/_.-])(typical|sparse|dense|crowd)(?=[/_.-]|$))")
                     .value_or("results");
  traits.map = map_of(instance);
  traits.robots =
      to_number(last_match(instance, R"((?:^|[/_.-])(?:a|agents|robots)(\d+)(?=[/_.-]|$))"));
  if (!traits.robots) {  // circle8.yaml
    traits.robots = to_number(last_match(instance, R"((?:^|/)[a-z]+(\d+)\.[a-z]+$)"));
  }
  if (traits.map.empty()) {
    const std::size_t slash = instance.rfind('/');
    traits.map = slash == std::string::npos ? "other" : instance.substr(0, slash);
  }
  return traits;
}

std::vector<SuiteSummary> summarise(std::span<const ResultRow> rows,
                                    std::optional<double> time_limit) {
  using ByAlgorithm = std::map<std::string, std::vector<const ResultRow*>>;
  using ByRobots = std::map<std::optional<int>, ByAlgorithm>;
  std::map<std::string, std::map<std::string, ByRobots>> groups;
  std::map<std::string, std::vector<const ResultRow*>> of_suite;
  for (const ResultRow& row : rows) {
    const InstanceTraits traits = traits_of(row.instance);
    groups[traits.suite][traits.map][traits.robots][row.algorithm].push_back(&row);
    of_suite[traits.suite].push_back(&row);
  }
  std::vector<SuiteSummary> suites;
  for (const auto& [suite, maps] : groups) {
    SuiteSummary summary{suite, {}, algorithms_of(of_suite[suite]), {}};
    summary.comparisons = compare(of_suite[suite], summary.algorithms);
    for (const auto& [map, by_robots] : maps) {
      MapSummary column{map, {}};
      for (const auto& [robots, by_algorithm] : by_robots) {
        for (const std::string& algorithm : summary.algorithms) {
          const auto found = by_algorithm.find(algorithm);
          if (found == by_algorithm.end()) continue;
          CellSummary cell = summarise_cell(found->second, time_limit);
          cell.algorithm = algorithm;
          cell.robots = robots;
          column.cells.push_back(std::move(cell));
        }
      }
      summary.maps.push_back(std::move(column));
    }
    std::ranges::sort(summary.maps, {}, [](const MapSummary& m) { return map_order(m.map); });
    suites.push_back(std::move(summary));
  }
  return suites;
}

}  // namespace mvtp
