#pragma once

#include <cstdio>
#include <memory>
#include <string>

namespace mvtp {

/// What SUMO writes on stderr instead of saying it in its exceptions.
class SumoLog {
 public:
  SumoLog();

  /// Where to write; open as long as this object lives.
  [[nodiscard]] int descriptor() const;
  /// SUMO's error messages since the last call, in one line; empty if there are none.
  [[nodiscard]] std::string take_errors();

  /// Sends this process's stderr into a log during its life.
  class Redirection {
   public:
    explicit Redirection(const SumoLog& log);
    Redirection(const Redirection&) = delete;
    Redirection& operator=(const Redirection&) = delete;
    ~Redirection();

   private:
    int stderr_;
  };

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace mvtp
