#include "tools/cli/command_line.hpp"

#include <fstream>

namespace mvtp {

std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string line;
  for (std::string argument; std::getline(file, argument, '\0');) {
    line += line.empty() ? "mvtp" : " " + argument;
  }
  return line;
}

}  // namespace mvtp
