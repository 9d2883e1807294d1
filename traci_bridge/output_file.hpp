#pragma once

#include <string>

namespace mvtp {

/// A file that another writes: PATH.part until commit(), gone if there is none.
class OutputFile {
 public:
  /// Throws InputError unless the file can be written.
  explicit OutputFile(std::string path);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  [[nodiscard]] std::string part() const { return path_ + ".part"; }
  /// Gives the file its name. Throws InputError.
  void commit();

 private:
  std::string path_;
  bool pending_ = true;
};

}  // namespace mvtp
