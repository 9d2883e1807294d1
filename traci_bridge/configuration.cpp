#include "traci_bridge/configuration.hpp"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "planner/problem/input_error.hpp"
#include "traci_bridge/xml.hpp"

namespace mvtp {
namespace {

using Element = tinyxml2::XMLElement;

std::string trim(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\n\r");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t\n\r") - begin + 1);
}

/// Reads the options of a configuration: elements at any depth, each with its value as the
/// attribute `value` or `v`, or as text.
class ConfigurationReader {
 public:
  explicit ConfigurationReader(const std::string& path)
      : path_(path), file_(path, "a SUMO configuration, *.sumocfg") {}

  SumoConfiguration read() {
    read_options(file_.root());
    if (configuration_.net_file.empty()) {
      file_.fail(file_.root(),
                 "no net-file in it; give the path of a SUMO configuration, *.sumocfg");
    }
    return configuration_;
  }

 private:
  void read_options(const Element& parent) {
    for (const Element* option = parent.FirstChildElement(); option != nullptr;
         option = option->NextSiblingElement()) {
      if (option->FirstChildElement() != nullptr) {
        read_options(*option);
      } else {
        read_option(*option);
      }
    }
  }

  void read_option(const Element& option) {
    const std::string_view name = option.Name();
    if (name == "net-file" || name == "net" || name == "n") {
      const std::vector<std::string> paths = files(option);
      if (paths.size() != 1) file_.fail(option, "give one net-file");
      configuration_.net_file = paths.front();
    } else if (name == "route-files" || name == "r") {
      configuration_.route_files = files(option);
    } else if (name == "additional-files" || name == "additional" || name == "a") {
      configuration_.additional_files = files(option);
    } else if (name == "step-length") {
      configuration_.step_length = time(option);
    } else if (name == "begin" || name == "b") {
      configuration_.begin = time(option);
    } else if (name == "end" || name == "e") {
      const double end = time(option);
      if (end >= 0.0) configuration_.end = end;  // SUMO's -1: no end
    } else {
      configuration_.others[std::string(name)] = trim(value(option));
    }
  }

  static std::string value(const Element& option) {
    for (const char* name : {"value", "v"}) {
      if (const char* value = option.Attribute(name)) return value;
    }
    const char* text = option.GetText();
    return text == nullptr ? "" : text;
  }

  std::vector<std::string> files(const Element& option) const {
    std::vector<std::string> paths;
    for (const std::string& word : split(value(option), ",")) {
      const std::string name = trim(with_environment(option, word));
      if (name.empty()) continue;
      const std::filesystem::path from = std::filesystem::path(path_).parent_path();
      paths.push_back((from / name).string());  // an absolute name replaces `from`
      try {
        check_readable(paths.back(), std::string("the ") + option.Name());
      } catch (const InputError& error) {
        file_.fail(option, std::string(option.Name()) + ": " + error.what());
      }
    }
    return paths;
  }

  /// Replaces each ${NAME}.
  std::string with_environment(const Element& option, std::string text) const {
    std::size_t begin = text.find("${");
    while (begin != std::string::npos) {
      const std::size_t end = text.find('}', begin);
      if (end == std::string::npos) file_.fail(option, "\"" + text + "\": a } is missing");
      const std::string name = text.substr(begin + 2, end - begin - 2);
      const char* variable = std::getenv(name.c_str());
      if (variable == nullptr) {
        file_.fail(option, "the environment variable " + name + " is not set; export " + name);
      }
      text.replace(begin, end + 1 - begin, variable);
      begin = text.find("${", begin + std::string_view(variable).size());
    }
    return text;
  }

  /// A time as seconds or as [days:]hours:minutes:seconds.
  double time(const Element& option) const {
    const std::vector<std::string> parts = split(trim(value(option)), ":");
    static constexpr std::array kSeconds = {1.0, 60.0, 3600.0, 86400.0};
    if (parts.empty() || parts.size() == 2 || parts.size() > kSeconds.size()) fail_time(option);
    double seconds = 0.0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::optional<double> number = parse_number(parts[parts.size() - 1 - i]);
      if (!number) fail_time(option);
      seconds += *number * kSeconds[i];
    }
    return seconds;
  }

  [[noreturn]] void fail_time(const Element& option) const {
    file_.fail(option, std::string(option.Name()) + ": \"" + value(option) +
                           "\" is not a time; give seconds or hours:minutes:seconds");
  }

  std::string path_;
  XmlFile file_;
  SumoConfiguration configuration_;
};

}  // namespace

SumoConfiguration read_configuration(const std::string& path) {
  set_sumo_home();
  const SumoConfiguration configuration = ConfigurationReader(path).read();
  if (!(configuration.step_length >= 0.001)) {  // SUMO's clock counts milliseconds
    throw InputError(path, "step-length: " + std::to_string(configuration.step_length) +
                               " s is below 0.001 s; give e.g. 0.1");
  }
  return configuration;
}

void set_sumo_home() {
  if (const char* home = std::getenv("SUMO_HOME"); home != nullptr && *home != '\0') return;
  for (const char* home : {"/usr/share/sumo", "/usr/local/share/sumo", "/opt/sumo/share/sumo",
                           "/usr/local/sumo", "/opt/sumo"}) {
    if (std::filesystem::is_directory(std::filesystem::path(home) / "tools")) {
      setenv("SUMO_HOME", home, 1);
      return;
    }
  }
}

}  // namespace mvtp
