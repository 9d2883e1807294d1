#include "tools/view/browser.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tools/cli/child_process.hpp"

namespace mvtp {
namespace {

using Json = nlohmann::json;

constexpr int kAnswerTimeout = 60'000;  // [ms] for one answer

[[noreturn]] void fail(const std::string& why) {
  throw InputError("Chromium", why + "; install chromium-headless-shell anew, or do without");
}

std::vector<std::string> arguments_of(const std::filesystem::path& program,
                                      const std::filesystem::path& profile) {
  std::vector<std::string> arguments = {program.string(),
                                        "--headless",
                                        "--remote-debugging-pipe",
                                        "--user-data-dir=" + profile.string(),
                                        "--disable-gpu",
                                        "--disable-dev-shm-usage",
                                        "--disable-quic",
                                        "--disable-sync",
                                        "--disable-extensions",
                                        "--disable-background-networking",
                                        "--disable-component-update",
                                        "--disable-default-apps",
                                        "--no-first-run",
                                        "--hide-scrollbars",
                                        "--force-color-profile=srgb"};
  if (geteuid() == 0) arguments.emplace_back("--no-sandbox");  // for root there is none
  arguments.emplace_back("about:blank");
  return arguments;
}

/// Starts a program with a socket as its files 3 and 4, in a process group of its own.
pid_t start(const std::vector<std::string>& arguments, int socket) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int file : {1, 2}) {
    posix_spawn_file_actions_addopen(&files, file, "/dev/null", O_WRONLY, 0);
  }
  for (const int file : {3, 4}) posix_spawn_file_actions_adddup2(&files, socket, file);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t process = -1;
  const int error = posix_spawn(&process, argv.front(), &files, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) fail(arguments.front() + " does not start (" + std::strerror(error) + ")");
  return process;
}

}  // namespace

std::optional<std::filesystem::path> Browser::find() {
  for (const char* name : {"chromium-headless-shell", "chromium"}) {
    if (const auto program = find_program(name)) return program;
  }
  return std::nullopt;
}

Browser::Browser(const std::filesystem::path& program) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    fail(std::string("no socket for it (") + std::strerror(errno) + ")");
  }
  // The child gets its end under numbers that this process does not use.
  const int theirs = fcntl(ends[1], F_DUPFD_CLOEXEC, 10);
  close(ends[1]);
  socket_ = ends[0];
  process_ = start(arguments_of(program, profile_.path()), theirs);
  close(theirs);
}

// From here on the browser is ended whatever is thrown.
Browser::Browser(const std::filesystem::path& program, const Size& size) : Browser(program) {
  const Json target = call("Target.createTarget", {{"url", "about:blank"}});
  session_ = call("Target.attachToTarget", {{"targetId", target.at("targetId")}, {"flatten", true}})
                 .at("sessionId");
  call("Page.enable", Json::object());
  resize(size);
}

Browser::~Browser() {
  close(socket_);
  if (process_ <= 0) return;
  kill(-process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

void Browser::resize(const Size& size) {
  call("Emulation.setDeviceMetricsOverride", {{"width", size.width},
                                              {"height", size.height},
                                              {"deviceScaleFactor", size.ratio},
                                              {"mobile", false}});
}

void Browser::open(const std::filesystem::path& page, const std::string& fragment) {
  std::string address = "file://";
  for (const char c : std::filesystem::absolute(page).string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                       std::string_view("/-_.~").find(c) != std::string_view::npos;
    if (plain) {
      address.push_back(c);
    } else {
      constexpr std::string_view kDigits = "0123456789ABCDEF";
      const auto byte = static_cast<unsigned char>(c);
      address += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  if (!fragment.empty()) address += "#" + fragment;
  // Through an empty page: another fragment of the same one would not read it anew.
  for (const std::string& next : {std::string("about:blank"), address}) {
    last_event_.clear();
    call("Page.navigate", {{"url", next}});
    while (last_event_ != "Page.loadEventFired") (void)receive();
  }
}

Json Browser::evaluate(const std::string& expression) {
  const Json answer =
      call("Runtime.evaluate",
           {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}});
  if (answer.contains("exceptionDetails")) {
    const Json& what = answer["exceptionDetails"];
    fail("the page says: " + what.value("/exception/description"_json_pointer, what.dump()));
  }
  return answer.at("result").value("value", Json());
}

Json Browser::call(const std::string& method, const Json& parameters) {
  const int id = ++calls_;
  Json request = {{"id", id}, {"method", method}, {"params", parameters}};
  if (!session_.empty()) request["sessionId"] = session_;
  send(request.dump());
  while (true) {
    Json answer = receive();
    if (answer.value("id", -1) != id) continue;
    if (answer.contains("error")) fail(method + ": " + answer["error"].dump());
    return answer.at("result");
  }
}

void Browser::send(const std::string& message) const {
  const std::string_view bytes(message.c_str(), message.size() + 1);  // ends with a zero
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("it has ended");
    sent += static_cast<std::size_t>(count);
  }
}

Json Browser::receive() {
  std::size_t end = 0;
  while ((end = unread_.find('\0')) == std::string::npos) {
    pollfd file{socket_, POLLIN, 0};
    const int ready = poll(&file, 1, kAnswerTimeout);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) fail("it does not answer");
    std::array<char, 65536> buffer{};
    const ssize_t count = recv(socket_, buffer.data(), buffer.size(), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("it has ended");
    unread_.append(buffer.data(), static_cast<std::size_t>(count));
  }
  Json message = Json::parse(unread_.substr(0, end), nullptr, false);
  unread_.erase(0, end + 1);
  if (!message.is_object()) fail("its answer is no JSON");
  if (message.contains("method")) last_event_ = message["method"];
  return message;
}

}  // namespace mvtp
