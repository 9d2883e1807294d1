#pragma once

#include <string>

namespace mvtp {

/// A file that another writes: PATH.part until commit(), removed if there is none.
class OutputFile {
 public:
  /// Throws InputError unless the file can be written.
  /// @param prefix  what the writer puts before the last part of every path.
  explicit OutputFile(std::string path, const std::string& prefix = "");
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  /// What to tell the writer: without the prefix.
  [[nodiscard]] std::string part() const { return path_ + ".part"; }
  /// Gives the file (XML) its name. Throws InputError, also if its end is missing.
  void commit();
  /// It stays as it is, whatever happens.
  void keep() { pending_ = false; }

 private:
  std::string path_;
  std::string written_;  ///< where the writer puts it
  bool pending_ = true;
};

}  // namespace mvtp
