#include "tools/bench/results.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMaxBytes = 1'000'000'000;

constexpr std::array<std::string_view, 13> kColumns = {
    "instance",       "algorithm",   "seed",       "status",        "valid",
    "makespan_steps", "makespan_s",  "flowtime_s", "lower_bound_s", "first_solution_s",
    "runtime_s",      "peak_rss_mb", "version"};

// ---- writing

std::string seconds(std::optional<double> value) {
  return value ? fmt::format("{:.4f}", *value) : std::string();
}

// ---- reading

using Record = std::vector<std::string>;

/// Takes records off a CSV text [RFC 4180]; both ends of line will do.
class CsvReader {
 public:
  explicit CsvReader(std::string_view text) : text_(text) {}

  /// The next record; nullopt at the end, or if the rest does not end with an end of line.
  std::optional<Record> next() {
    Record record(1);
    bool in_quotes = false;
    std::size_t lines = 0;
    for (std::size_t i = position_; i < text_.size(); ++i) {
      const char c = text_[i];
      if (c == '\n') ++lines;
      if (c == '"') {
        const bool is_pair = in_quotes && i + 1 < text_.size() && text_[i + 1] == '"';
        if (is_pair)
          record.back() += text_[i++];
        else
          in_quotes = !in_quotes;
      } else if (in_quotes) {
        record.back() += c;
      } else if (c == ',') {
        record.emplace_back();
      } else if (c == '\n') {
        if (record.back().ends_with('\r')) record.back().pop_back();
        position_ = i + 1;
        line_ = next_line_;
        next_line_ += lines;
        return record;
      } else {
        record.back() += c;
      }
    }
    return std::nullopt;
  }

  /// Behind the last record taken.
  [[nodiscard]] std::size_t position() const { return position_; }
  /// On which line the last record taken began, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
  std::size_t next_line_ = 1;
};

/// The fields of one record, taken one after the other.
class Fields {
 public:
  Fields(const Record& record, std::string where) : record_(record), where_(std::move(where)) {
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

  const Record& record_;
  std::string where_;
  std::size_t next_ = 0;
};

ResultRow to_row(const Record& record, const std::string& where) {
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
  row.version = fields.text();
  return row;
}

/// The rows, and how much of the content they are: an incomplete last line is left over.
std::pair<std::vector<ResultRow>, std::size_t> parse(std::string_view content,
                                                     const std::string& name) {
  CsvReader reader(content);
  const std::optional<Record> header = reader.next();
  if (header && !std::ranges::equal(*header, kColumns)) {
    throw InputError(name + ":1", fmt::format("has not the columns of a results.csv ({}); give "
                                              "another file",
                                              fmt::join(kColumns, ",")));
  }
  std::vector<ResultRow> rows;
  while (const std::optional<Record> record = reader.next()) {
    rows.push_back(to_row(*record, fmt::format("{}:{}", name, reader.line())));
  }
  return {std::move(rows), reader.position()};
}

[[noreturn]] void report_unwritable(const std::string& path) {
  throw InputError(
      path, fmt::format("cannot be written: {}; choose another --output", std::strerror(errno)));
}

/// Only its end may be missing: what stands there must begin like one of ours.
void reject_foreign_text(const std::string& path, std::string_view content) {
  const std::string header = results_header();
  if (header.starts_with(content.substr(0, header.size()))) return;
  throw InputError(path, "is no results.csv; choose another --output");
}

}  // namespace

std::string results_header() { return fmt::format("{}\n", fmt::join(kColumns, ",")); }

std::string to_csv(const ResultRow& row) {
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{:.1f},{}\n", csv_field(row.instance),
                     csv_field(row.algorithm), row.seed, csv_field(row.status), row.valid,
                     row.makespan_steps ? fmt::to_string(*row.makespan_steps) : "",
                     seconds(row.makespan), seconds(row.flowtime), seconds(row.lower_bound),
                     seconds(row.first_solution), seconds(row.runtime), row.peak_rss,
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
  std::map<RunKey, const ResultRow*> runs;
  for (const std::vector<ResultRow>& rows : lists) {
    for (const ResultRow& row : rows) runs.emplace(key_of(row), &row);
  }
  std::vector<ResultRow> merged;
  for (const auto& [key, row] : runs) merged.push_back(*row);
  return merged;
}

ResultFile::ResultFile(std::string path, Mode mode)
    : path_(std::move(path)),
      file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
  if (file_ < 0) report_unwritable(path_);
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    throw InputError(path_, "is written by another mvtp bench; choose another --output");
  }
  const off_t size = ::lseek(file_, 0, SEEK_END);
  if (size < 0) throw InputError(path_, "is no regular file; choose another --output");
  if (size > 0 && mode == Mode::kCreate) {
    throw InputError(path_, "exists; continue it with --resume, or choose another --output");
  }
  std::size_t kept = 0;
  if (size > 0) {
    const std::string content = read_text_file(path_, kMaxBytes);
    reject_foreign_text(path_, content);
    const auto [rows, length] = parse(content, path_);
    for (const ResultRow& row : rows) done_.insert(key_of(row));
    kept = length;
  }
  if (::ftruncate(file_, off_t(kept)) != 0) report_unwritable(path_);
  if (kept == 0) write_line(results_header());
}

ResultFile::~ResultFile() { ::close(file_); }

void ResultFile::append(const ResultRow& row) {
  write_line(to_csv(row));
  done_.insert(key_of(row));
}

void ResultFile::write_line(std::string_view line) {
  ssize_t written = -1;
  while ((written = ::write(file_, line.data(), line.size())) < 0 && errno == EINTR) {
  }
  if (written != ssize_t(line.size())) {
    throw InputError(path_, "cannot be written: is the disk full? Make room and use --resume");
  }
}

}  // namespace mvtp
