#include "tools/bench/results.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/runs/csv_reader.hpp"
#include "tools/runs/merge_rows.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMaxBytes = 1'000'000'000;

constexpr std::array<std::string_view, 14> kColumns = {
    "instance",       "algorithm",   "seed",        "status",        "valid",
    "makespan_steps", "makespan_s",  "flowtime_s",  "lower_bound_s", "first_solution_s",
    "runtime_s",      "peak_rss_mb", "solved_seed", "version"};

// ---- writing

std::string seconds(std::optional<double> value) {
  return value ? fmt::format("{:.4f}", *value) : std::string();
}

// ---- reading

/// The fields of one record, taken one after the other.
class Fields {
 public:
  Fields(const CsvRecord& record, std::string where) : record_(record), where_(std::move(where)) {
    if (record.size() == kColumns.size()) return;
    throw InputError(where_, fmt::format("has {} fields in place of {}; is it a results.csv?",
                                         record.size(), kColumns.size()));
  }

  std::string text() {
    if (record_[next_].empty()) refuse("text");
    return record_[next_++];
  }
  bool flag() {
    if (record_[next_] != "true" && record_[next_] != "false") refuse("true or false");
    return record_[next_++] == "true";
  }
  std::uint64_t count() {
    const std::optional<std::uint64_t> value = optional_count();
    if (!value) {
      --next_;
      refuse("a whole number");
    }
    return *value;
  }
  std::optional<std::uint64_t> optional_count() {
    return optional_value<std::uint64_t>("a whole number");
  }
  double number() {
    const std::optional<double> value = optional_number();
    if (!value) {
      --next_;
      refuse("a number");
    }
    return *value;
  }
  std::optional<double> optional_number() {
    const std::optional<double> value = optional_value<double>("a number");
    if (value && !(std::isfinite(*value) && *value >= 0.0)) {
      --next_;
      refuse("a finite number >= 0");
    }
    return value;
  }

 private:
  template <class Number>
  std::optional<Number> optional_value(const char* expected) {
    const std::string& text = record_[next_];
    if (text.empty()) {
      ++next_;
      return std::nullopt;
    }
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) refuse(expected);
    ++next_;
    return value;
  }

  [[noreturn]] void refuse(const char* expected) const {
    throw InputError(
        where_, fmt::format("{}: is \"{}\"; give {}", kColumns[next_], record_[next_], expected));
  }

  const CsvRecord& record_;
  std::string where_;
  std::size_t next_ = 0;
};

ResultRow to_row(const CsvRecord& record, const std::string& where) {
  Fields fields(record, where);
  ResultRow row;
  row.instance = fields.text();
  row.algorithm = fields.text();
  row.seed = fields.count();
  row.status = fields.text();
  row.valid = fields.flag();
  row.makespan_steps = fields.optional_count();
  row.makespan = fields.optional_number();
  row.flowtime = fields.optional_number();
  row.lower_bound = fields.optional_number();
  row.first_solution = fields.optional_number();
  row.runtime = fields.number();
  row.peak_rss = fields.number();
  row.solved_seed = fields.optional_count();
  row.version = fields.text();
  return row;
}

/// The rows, and how much of the content they are: an incomplete last line is left over.
std::pair<std::vector<ResultRow>, std::size_t> parse(std::string_view content,
                                                     const std::string& name) {
  CsvReader reader(content);
  const std::optional<CsvRecord> header = reader.next();
  if (header && !std::ranges::equal(*header, kColumns)) {
    throw InputError(name + ":1", fmt::format("has not the columns of a results.csv ({}); give "
                                              "another file",
                                              fmt::join(kColumns, ",")));
  }
  std::vector<ResultRow> rows;
  while (const std::optional<CsvRecord> record = reader.next()) {
    rows.push_back(to_row(*record, fmt::format("{}:{}", name, reader.line())));
  }
  return {std::move(rows), reader.position()};
}

}  // namespace

std::string results_header() { return fmt::format("{}\n", fmt::join(kColumns, ",")); }

std::string to_csv(const ResultRow& row) {
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{:.1f},{},{}\n", csv_field(row.instance),
                     csv_field(row.algorithm), row.seed, csv_field(row.status), row.valid,
                     row.makespan_steps ? fmt::to_string(*row.makespan_steps) : "",
                     seconds(row.makespan), seconds(row.flowtime), seconds(row.lower_bound),
                     seconds(row.first_solution), seconds(row.runtime), row.peak_rss,
                     row.solved_seed ? fmt::to_string(*row.solved_seed) : "",
                     csv_field(row.version));
}

std::vector<ResultRow> parse_results(std::string_view content, const std::string& name) {
  const auto [rows, length] = parse(content, name);
  if (length == 0) throw InputError(name, "is no results.csv; give what mvtp bench wrote");
  if (length < content.size()) {
    throw InputError(name, "has an incomplete last line; continue the run with --resume");
  }
  return rows;
}

std::vector<ResultRow> read_results(const std::string& path) {
  return parse_results(read_text_file(path, kMaxBytes), path);
}

std::vector<ResultRow> merge_results(const std::vector<std::vector<ResultRow>>& lists) {
  return merge_rows(lists, [](const ResultRow& row) { return key_of(row); });
}

ResultFile::ResultFile(const std::string& path, RowFile::Mode mode)
    : file_(path, mode, {"mvtp bench", results_header()}, [&](std::string_view content) {
        const auto [rows, length] = parse(content, path);
        for (const ResultRow& row : rows) done_.insert(key_of(row));
        return length;
      }) {}

void ResultFile::append(const ResultRow& row) {
  file_.append(to_csv(row));
  done_.insert(key_of(row));
}

}  // namespace mvtp
