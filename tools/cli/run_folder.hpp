#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>

namespace mvtp {

/// The folder that one run writes its results into: NAME.part while it runs, NAME at its end.
///
/// While it is open, no other run can open it; a process that dies leaves it open to others.
class RunFolder {
 public:
  /// Makes the folder, and removes what an earlier run has not finished.
  /// @param option  the option that names it, for messages.
  /// @throws InputError if that is impossible, or another run has it open.
  RunFolder(const std::string& folder, const std::string& option);
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  /// Leaves nothing unfinished behind.
  ~RunFolder();

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  /// Removes the results of an earlier run: this one's input is good.
  void remove_old_results();
  /// NAME.part, for somebody else to write before commit().
  [[nodiscard]] std::string part(const std::string& name);
  /// Leaves a file out.
  void drop(const std::string& name);
  /// Writes NAME.part, over what it held before. @throws InputError
  void write(const std::string& name, std::string_view content);
  /// Gives every file its name. @throws InputError
  void commit();
  /// Removes all results, also those that others wrote.
  void discard();

 private:
  std::filesystem::path folder_;
  std::string option_;
  int lock_ = -1;
  std::set<std::string> parts_;
};

/// Gives the files their names that a run left unfinished; SUMO's end after their last whole
/// element.
void finish_parts(const std::filesystem::path& folder);

/// Completes what a run left in its folder that has died: finish_parts(), and the last checkpoint
/// has the status "failed" and this message. Results of an earlier run are removed.
/// @return whether there was a checkpoint.
bool complete_crashed_run(const std::filesystem::path& folder, const std::string& message);

/// Tells the process that started this one which folder it writes into, if it wants to know.
void announce_run_folder(const std::string& folder);

/// The environment variable with the file descriptor that announce_run_folder() writes to.
constexpr const char* kRunFolderNote = "MVTP_RUN_FOLDER_NOTE";

}  // namespace mvtp
