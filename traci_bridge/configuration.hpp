#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mvtp {

/// What a SUMO configuration (*.sumocfg) says about its inputs and its time; paths as found from
/// the working directory, environment variables replaced.
struct SumoConfiguration {
  std::string net_file;
  std::vector<std::string> route_files;
  std::vector<std::string> additional_files;
  double step_length = 1.0;                   ///< [s]
  double begin = 0.0;                         ///< [s]
  std::optional<double> end;                  ///< [s]; none: until the last vehicle has arrived
  std::map<std::string, std::string> others;  ///< every further option as it is written
};

/// Reads a configuration, and checks that every file it names is there.
///
/// Throws InputError otherwise: SUMO itself would only say so much later, and less clearly.
[[nodiscard]] SumoConfiguration read_configuration(const std::string& path);

/// Sets the environment variable SUMO_HOME to where SUMO is installed, unless it is set already:
/// SUMO finds its schemas by it, and a configuration may name files of SUMO by it.
void set_sumo_home();

}  // namespace mvtp
