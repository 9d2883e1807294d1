#include "tools/cli/run_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/cli/output_folder.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSummary = "summary.json";

/// Every file that a run may write, but the pictures of further parking lots.
constexpr std::array kFiles = {"summary.json", "vehicles.csv", "replans.csv",   "events.csv",
                               "view.html",    "visits.csv",   "occupancy.csv", "lot.svg",
                               "fcd.xml",      "tripinfo.xml", "sumo.log"};

constexpr const char* kPart = ".part";

std::string part_of(const std::string& name) { return name + kPart; }

bool is_picture_of_a_lot(const std::string& name) {
  return name.starts_with("lot") && name.ends_with(".svg");
}

/// @param suffix  of the names: that of unfinished files, or none
void remove_files(const fs::path& folder, const std::string& suffix) {
  std::error_code ignored;
  for (const std::string name : kFiles) fs::remove(folder / (name + suffix), ignored);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    std::string name = entry.path().filename();
    if (!name.ends_with(suffix)) continue;
    name.erase(name.size() - suffix.size());
    if (is_picture_of_a_lot(name)) fs::remove(entry.path(), ignored);
  }
}

/// Cuts one of SUMO's files after its last whole element, and closes the root element.
void close_xml(const fs::path& path) {
  std::ifstream in(path);
  std::string line;
  std::string root;
  std::streamoff end = 0;
  bool comment = false;  // SUMO begins with one that holds its configuration
  while (std::getline(in, line) && !in.eof()) {
    comment = comment || line.starts_with("<!--");
    const bool is_root = root.empty() && !comment && line.starts_with('<') && line[1] != '?';
    if (comment && line.find("-->") != std::string::npos) comment = false;
    if (is_root) root = line.substr(1, line.find_first_of(" >") - 1);
    // SUMO indents each level by four blanks.
    const bool child = !root.empty() && line.starts_with("    <") && line.size() > 5;
    if (is_root || (child && (line[5] == '/' || line.ends_with("/>")))) end = in.tellg();
  }
  in.close();
  if (root.empty()) return;
  fs::resize_file(path, std::uintmax_t(end));
  std::ofstream(path, std::ios::app) << "</" << root << ">\n";
}

/// What SUMO's last words say about why it aborted; empty if nothing.
std::string failed_assertion(const fs::path& log) {
  std::ifstream file(log);
  std::string found;
  for (std::string line; std::getline(file, line);) {
    if (line.find("Assertion") != std::string::npos) found = line;
  }
  return found;
}

}  // namespace

RunFolder::RunFolder(const std::string& folder, const std::string& option)
    : folder_(folder), option_(option) {
  make_output_folder(folder, option);
  for (const char* name : kFiles) check_writable(path(name));
  require_room(folder, option);
  lock_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    const bool taken = lock_ >= 0 && errno == EWOULDBLOCK;
    const std::string why = taken ? "another run writes into it" : std::strerror(errno);
    if (lock_ >= 0) ::close(lock_);
    throw InputError(folder, fmt::format("{}; choose another {}", why, option));
  }
  remove_files(folder_, kPart);
}

RunFolder::~RunFolder() {
  std::error_code ignored;
  for (const std::string& name : parts_) fs::remove(path(part_of(name)), ignored);
  ::close(lock_);
}

std::string RunFolder::part(const std::string& name) {
  parts_.insert(name);
  return path(part_of(name));
}

void RunFolder::drop(const std::string& name) {
  std::error_code ignored;
  fs::remove(path(part_of(name)), ignored);
  parts_.erase(name);
}

void RunFolder::write(const std::string& name, std::string_view content) {
  try {
    write_text_file(part(name), content);
  } catch (const InputError&) {
    if (!is_full(folder_)) throw;
    throw InputError(path(name), fmt::format("cannot be written: the disk is full; make room or "
                                             "choose another {}",
                                             option_));
  }
}

void RunFolder::remove_old_results() { remove_files(folder_, ""); }

void RunFolder::discard() {
  remove_old_results();
  remove_files(folder_, kPart);
  parts_.clear();
}

void RunFolder::commit() {
  for (const std::string& name : parts_) {
    std::error_code error;
    fs::rename(path(part_of(name)), path(name), error);
    if (error) throw InputError(path(name), fmt::format("cannot be written ({})", error.message()));
  }
  parts_.clear();
}

void finish_parts(const fs::path& folder) {
  std::error_code error;
  for (const char* name : {"fcd.xml", "tripinfo.xml"}) {
    const fs::path part = folder / part_of(name);
    if (fs::exists(part, error)) close_xml(part);
  }
  for (const std::string name : kFiles) {
    if (fs::exists(folder / part_of(name), error)) {
      fs::rename(folder / part_of(name), folder / name, error);
    }
  }
}

bool complete_crashed_run(const fs::path& folder, const std::string& message) {
  const std::string reason = failed_assertion(folder / part_of("sumo.log"));
  const fs::path summary = folder / part_of(kSummary);
  Json figures = Json::parse(std::ifstream(summary), nullptr, /*allow_exceptions=*/false);
  const bool found = figures.is_object();
  if (found) {
    const std::string why = message + (reason.empty() ? "" : ": " + reason);
    Json patched = {{"status", "failed"}, {"message", why}};
    for (const auto& [key, value] : figures.items()) {
      if (!patched.contains(key)) patched[key] = value;
    }
    write_text_file(summary, patched.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  }
  std::error_code error;
  const bool unfinished = std::ranges::any_of(
      kFiles, [&](const std::string& name) { return fs::exists(folder / part_of(name), error); });
  if (unfinished) remove_files(folder, "");  // what has its name already is of an earlier run
  finish_parts(folder);
  return found;
}

void announce_run_folder(const std::string& folder) {
  const char* const note = std::getenv(kRunFolderNote);
  if (note == nullptr) return;
  const int descriptor = std::atoi(note);
  const std::string line = fs::absolute(folder).string();
  if (::write(descriptor, line.data(), line.size()) != ssize_t(line.size())) return;
  ::close(descriptor);
  ::unsetenv(kRunFolderNote);
}

}  // namespace mvtp
