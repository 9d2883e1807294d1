#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tools/runs/temporary_folder.hpp"

namespace mvtp {

/// A page in a headless Chromium, driven over a socket by the DevTools protocol. It ends with this
/// process, however that ends.
///
/// Every function throws InputError if the browser ends, does not answer for a minute, or refuses.
class Browser {
 public:
  struct Size {
    int width = 1280;  ///< [CSS pixels]
    int height = 720;
    double ratio = 1.0;  ///< device pixels per CSS pixel
  };

  /// The browser that is installed: chromium-headless-shell or chromium.
  [[nodiscard]] static std::optional<std::filesystem::path> find();

  Browser(const std::filesystem::path& program, const Size& size);
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;
  ~Browser();

  void resize(const Size& size);
  /// Opens a file and waits until it has been read and its scripts have run once.
  /// @param fragment  of the address, without #
  void open(const std::filesystem::path& page, const std::string& fragment = "");
  /// The value of an expression of JavaScript; of a promise, what it resolves to.
  [[nodiscard]] nlohmann::json evaluate(const std::string& expression);

 private:
  explicit Browser(const std::filesystem::path& program);
  nlohmann::json call(const std::string& method, const nlohmann::json& parameters);
  void send(const std::string& message) const;
  /// The next message from the browser.
  [[nodiscard]] nlohmann::json receive();

  TemporaryFolder profile_;
  pid_t process_ = -1;
  int socket_ = -1;
  int calls_ = 0;
  std::string session_;
  std::string unread_;
  std::string last_event_;
};

}  // namespace mvtp
