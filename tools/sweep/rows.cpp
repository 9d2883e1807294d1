#include "tools/sweep/rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/runs/csv_reader.hpp"

namespace mvtp {
namespace {

/// The columns before and behind the figures.
const std::vector<std::string> kBefore = {"scenario",    "controller", "scale",
                                          "penetration", "seed",       "status"};
const std::vector<std::string> kBehind = {"arrivals_per_minute", "runtime_s", "peak_rss_mb",
                                          "version"};

std::vector<std::string> columns() {
  std::vector<std::string> all = kBefore;
  for (const ComparedFigure& figure : compared_figures()) all.emplace_back(figure.name);
  all.insert(all.end(), kBehind.begin(), kBehind.end());
  return all;
}

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The fields of one record, taken one after the other.
class Fields {
 public:
  Fields(const CsvRecord& record, std::string where) : record_(record), where_(std::move(where)) {
    if (record.size() == columns().size()) return;
    throw InputError(where_, fmt::format("has {} fields in place of {}; is it of mvtp sweep?",
                                         record.size(), columns().size()));
  }

  const std::string& text() { return record_[next_++]; }
  template <class Number>
  Number number(const char* expected) {
    const auto value = number_in<Number>(record_[next_]);
    if (!value) refuse(expected);
    ++next_;
    return *value;
  }
  std::optional<double> optional_number() {
    if (!record_[next_].empty()) return number<double>("a number");
    ++next_;
    return std::nullopt;
  }
  std::vector<int> counts() {
    std::vector<int> all;
    std::string_view rest = record_[next_];
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(' '), rest.size());
      const auto value = number_in<int>(rest.substr(0, end));
      if (!value) refuse("whole numbers");
      all.push_back(*value);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    ++next_;
    return all;
  }

 private:
  [[noreturn]] void refuse(const char* expected) const {
    throw InputError(
        where_, fmt::format("{}: is \"{}\"; give {}", columns()[next_], record_[next_], expected));
  }

  const CsvRecord& record_;
  std::string where_;
  std::size_t next_ = 0;
};

SweepRow to_row(const CsvRecord& record, const std::string& where) {
  Fields fields(record, where);
  SweepRow row;
  row.scenario = fields.text();
  row.controller = fields.text();
  row.scale = fields.number<double>("a number");
  row.penetration = fields.number<double>("a number");
  row.seed = fields.number<std::uint64_t>("a whole number");
  row.status = fields.text();
  for (const ComparedFigure& figure : compared_figures()) {
    if (const auto value = fields.optional_number()) row.figures[figure.name] = *value;
  }
  row.arrivals = fields.counts();
  row.runtime = fields.number<double>("a number");
  row.peak_rss = fields.number<double>("a number");
  row.version = fields.text();
  return row;
}

/// The rows, and how much of the content they are: an incomplete last line is left over.
std::pair<std::vector<SweepRow>, std::size_t> parse(std::string_view content,
                                                    const std::string& name) {
  CsvReader reader(content);
  const std::optional<CsvRecord> header = reader.next();
  if (header && *header != columns()) {
    throw InputError(name + ":1", "has not the columns of mvtp sweep; give another file");
  }
  std::vector<SweepRow> rows;
  while (const std::optional<CsvRecord> record = reader.next()) {
    rows.push_back(to_row(*record, fmt::format("{}:{}", name, reader.line())));
  }
  return {std::move(rows), reader.position()};
}

}  // namespace

std::string sweep_header() { return fmt::format("{}\n", fmt::join(columns(), ",")); }

std::string to_csv(const SweepRow& row) {
  std::string text =
      fmt::format("{},{},{},{},{},{}", csv_field(row.scenario), csv_field(row.controller),
                  row.scale, row.penetration, row.seed, csv_field(row.status));
  for (const ComparedFigure& figure : compared_figures()) {
    const auto value = row.figures.find(figure.name);
    text += value == row.figures.end() ? "," : fmt::format(",{}", value->second);
  }
  return text + fmt::format(",{},{:.3f},{:.1f},{}\n", fmt::join(row.arrivals, " "), row.runtime,
                            row.peak_rss, csv_field(row.version));
}

std::vector<SweepRow> read_sweep(const std::string& path) {
  const std::string content = read_text_file(path, kMostRowBytes);
  auto [rows, length] = parse(content, path);
  if (length == 0) throw InputError(path, "is no table of mvtp sweep; give what that wrote");
  if (length < content.size()) {
    throw InputError(path, "has an incomplete last line; continue the sweep with --resume");
  }
  return std::move(rows);
}

void read_sweep_figures(const std::string& summary, const std::string& where, SweepRow& row) {
  ComparedRun run;
  read_summary(summary, where, run);
  row.status = run.status;
  for (const ComparedFigure& figure : compared_figures()) {
    const auto value = run.figures.find(figure.name);
    if (value != run.figures.end()) row.figures[figure.name] = value->second;
  }
  const auto json = nlohmann::json::parse(summary);
  row.arrivals = json.value("arrivals_per_minute", std::vector<int>());
}

SweepFile::SweepFile(const std::string& path, RowFile::Mode mode)
    : file_(path, mode, {"mvtp sweep", sweep_header()}, [&](std::string_view content) {
        const auto [rows, length] = parse(content, path);
        for (const SweepRow& row : rows) done_.insert(key_of(row));
        return length;
      }) {}

void SweepFile::append(const SweepRow& row) {
  file_.append(to_csv(row));
  done_.insert(key_of(row));
}

}  // namespace mvtp
