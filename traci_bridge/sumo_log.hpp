#pragma once

#include <sys/types.h>

#include <cstdio>
#include <memory>
#include <string>

#include "traci_bridge/sumo_traffic.hpp"

namespace mvtp {

/// What SUMO writes on stderr instead of saying it in its exceptions.
class SumoLog {
 public:
  /// @param path  of the file that keeps it; empty: nobody does.
  explicit SumoLog(const std::string& path);

  /// Where to write; open as long as this object lives.
  [[nodiscard]] int descriptor() const;
  /// SUMO's error messages since the last call, in one line; empty if there are none.
  [[nodiscard]] std::string take_errors();
  /// Its warnings since the begin.
  [[nodiscard]] SumoWarnings warnings() const;

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
  [[nodiscard]] std::string text_from(off_t begin) const;

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  off_t taken_ = 0;  ///< up to where errors have been taken
};

}  // namespace mvtp
