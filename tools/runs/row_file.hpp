#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace mvtp {

/// A CSV file to which the rows of runs are appended one by one, each with one write(): a process
/// that is killed leaves whole lines. It is locked, so that no two write to it.
class RowFile {
 public:
  enum class Mode {
    kCreate,  ///< there may be no such file, or an empty one
    kResume,  ///< keeps what is there, but for an incomplete last line
  };
  struct Format {
    std::string command;  ///< that writes such files, for messages
    std::string header;   ///< the first line, with its end
  };

  /// @param read  takes in what is in the file, and returns how much of it are whole rows.
  /// @throws InputError if the file cannot be written, is in use, exists against `mode`, or is not
  /// of this format.
  RowFile(std::string path, Mode mode, const Format& format,
          const std::function<std::size_t(std::string_view)>& read);
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;
  ~RowFile();

  /// @param line  with its end. @throws InputError if the disk is full.
  void append(std::string_view line);

 private:
  std::string path_;
  int file_;
};

/// The largest such file that is read [bytes].
inline constexpr std::size_t kMostRowBytes = 1'000'000'000;

}  // namespace mvtp
