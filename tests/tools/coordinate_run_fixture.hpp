#pragma once

#include <tinyxml2.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/tools/program_fixture.hpp"

namespace mvtp {

inline const std::string kNet = std::string(MVTP_NETWORKS) + "/crossroads.net.xml";
inline const std::string kBusy = std::string(MVTP_SCENARIOS) + "/crossroads/crossroads-400.sumocfg";

[[nodiscard]] inline std::string vehicle(const std::string& id, double depart,
                                         const std::string& edges, const std::string& more = "") {
  return "<vehicle id=\"" + id + "\" type=\"car\" depart=\"" + std::to_string(depart) +
         "\"><route edges=\"" + edges + "\"/>" + more + "</vehicle>";
}

class CoordinateRun : public Program {
 protected:
  /// Writes a scenario on the crossroads; `more` goes into its configuration.
  void write(const std::string& demand, const std::string& more = "",
             const std::string& net = kNet) const {
    (void)directory_.file("x.rou.xml",
                          "<routes><vType id=\"car\" length=\"4.5\"/>" + demand + "</routes>");
    (void)directory_.file("x.sumocfg", "<configuration><net-file value=\"" + net +
                                           "\"/><route-files value=\"x.rou.xml\"/>" + more +
                                           "</configuration>");
  }

  [[nodiscard]] Outcome coordinate(const std::string& more = "") const {
    return run("coordinate -c x.sumocfg --no-view " + more);
  }

  [[nodiscard]] nlohmann::json summary() const {
    const nlohmann::json result =
        nlohmann::json::parse(content_of(directory_.path("out/summary.json")), nullptr,
                              /*allow_exceptions=*/false);
    EXPECT_TRUE(result.is_object());
    return result;
  }

  [[nodiscard]] bool is_xml(const std::string& file) const {
    tinyxml2::XMLDocument document;
    return document.LoadFile(directory_.path(file).c_str()) == tinyxml2::XML_SUCCESS;
  }
};

inline const std::string kStep = "<step-length value=\"0.1\"/>";

}  // namespace mvtp
