#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace mvtp {

/// A CSV file to which the rows of runs are appended one by one, each with one write(): a process
/// that is killed leaves whole lines. It is locked, so that no two write to it. Who gives up before
/// the first row, with an exception, leaves no file.
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

  /// @param line  with its end. @throws InputError if the disk is full; the file is as before.
  void append(std::string_view line);

 private:
  void begin(Mode mode, const Format& format,
             const std::function<std::size_t(std::string_view)>& read);
  void write(std::string_view line);
  void discard() const;

  std::string path_;
  int file_;
  std::size_t size_ = 0;          ///< of the whole lines [bytes]
  bool is_without_rows_ = false;  ///< this process has begun it, and added none
};

/// The largest such file that is read [bytes].
inline constexpr std::size_t kMostRowBytes = 1'000'000'000;

}  // namespace mvtp
