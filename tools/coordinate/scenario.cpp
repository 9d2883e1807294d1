#include "tools/coordinate/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <sstream>
#include <string_view>

#include "planner/problem/input_error.hpp"
#include "traci_bridge/packed_file.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

std::optional<double> number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole ? std::optional(value) : std::nullopt;
}

/// The value of an option of SUMO among those behind "--", as "--NAME V" or "--NAME=V".
std::optional<std::string> given(const CoordinateOptions& options, std::string_view name,
                                 std::string_view short_name) {
  std::optional<std::string> value;
  for (std::size_t i = 0; i < options.sumo.size(); ++i) {
    const std::string& word = options.sumo[i];
    const std::string_view head = std::string_view(word).substr(0, word.find('='));
    if (head != name && head != short_name) continue;
    if (head.size() < word.size()) {
      value = word.substr(head.size() + 1);
    } else if (i + 1 < options.sumo.size()) {
      value = options.sumo[i + 1];
    }
  }
  return value;
}

std::string setting(const SumoConfiguration& configuration, const char* name) {
  const auto found = configuration.others.find(name);
  return found == configuration.others.end() ? "" : found->second;
}

/// The value that SUMO has of an option: as it is given behind "--", else as the scenario says.
std::string chosen(const CoordinateOptions& options, const SumoConfiguration& configuration,
                   const std::string& name) {
  const std::string option = "--" + name;
  const auto value = given(options, option, option);
  return value ? *value : setting(configuration, name.c_str());
}

bool is_positive(const std::string& text) {
  const auto value = number(text);
  return value && *value > 0.0;
}

void choose_step_length(const CoordinateOptions& options, Scenario& scenario) {
  if (const auto text = given(options, "--step-length", "--step-length")) {
    const std::optional<double> step = number(*text);
    if (step && *step > kLongestStep) {
      throw InputError("SUMO option --step-length",
                       fmt::format("{} s is too long to drive vehicles by; give at most {} s",
                                   *text, kLongestStep));
    }
    return;
  }
  const double step = scenario.configuration.step_length;
  if (step <= kLongestStep) return;
  scenario.sumo.extra.insert(scenario.sumo.extra.end(),
                             {"--step-length", fmt::format("{}", kStepLength)});
  scenario.notes.push_back(
      fmt::format("SUMO runs at steps of {} s, not the scenario's {} s", kStepLength, step));
}

/// Every vehicle has the device, unless the user says otherwise.
void equip_with_emissions(const CoordinateOptions& options, Scenario& scenario) {
  const char* option = "--device.emissions.probability";
  const bool chosen = std::ranges::any_of(
      options.sumo, [](const auto& word) { return word.starts_with("--device.emissions"); });
  if (!chosen) scenario.sumo.extra.insert(scenario.sumo.extra.end(), {option, "1"});
}

void choose_end(const CoordinateOptions& options, Scenario& scenario) {
  scenario.end = scenario.configuration.end;
  if (const auto text = given(options, "--end", "-e")) {
    if (const auto end = number(*text)) {
      scenario.end = *end < 0.0 ? std::nullopt : end;
    }
  }
  if (options.end) scenario.end = options.end;
  const auto text = given(options, "--begin", "-b");
  const auto begin = number(text ? *text : setting(scenario.configuration, "begin"));
  if (scenario.end && begin && *scenario.end < *begin) {
    throw InputError(options.configuration,
                     fmt::format("ends at t = {:g} s, before it begins at t = {:g} s; give a later "
                                 "--end",
                                 *scenario.end, *begin));
  }
}

/// Do vehicles look for new routes on their way?
bool reroutes(const CoordinateOptions& options, const Scenario& scenario) {
  const auto value = [&](const char* name) {
    return chosen(options, scenario.configuration, std::string("device.rerouting.") + name);
  };
  const bool equipped = is_positive(value("probability")) || !value("explicit").empty() ||
                        scenario.demand.rerouting_devices;
  return equipped && (is_positive(value("period")) || scenario.demand.rerouting_periods);
}

void note_settings(const CoordinateOptions& options, Scenario& scenario) {
  const SumoConfiguration& c = scenario.configuration;
  const auto note = [&](const std::string& text) { scenario.notes.push_back(text); };
  if (const std::string after = setting(c, "time-to-teleport"); is_positive(after)) {
    note(fmt::format("time-to-teleport {}: nobody is teleported here; a jam shows in the delays",
                     after));
  }
  if (is_positive(chosen(options, c, "lateral-resolution"))) {
    note("lateral-resolution: SUMO's sublane model moves only vehicles that are not coordinated");
  }
  if (scenario.demand.rerouters) {
    note("rerouters: a coordinated vehicle takes its new route once it is handed back");
  }
  if (reroutes(options, scenario)) {
    note("device.rerouting: a coordinated vehicle takes its new route once it is handed back");
  }
  if (scenario.demand.people) {
    note(
        "people on foot: coordinated vehicles keep clear of them at crossings; nobody expects them "
        "on the road elsewhere");
  }
}

/// The attribute of a tag, without its quotes.
std::optional<std::string_view> attribute_of(std::string_view tag, std::string_view name) {
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    const std::size_t begin = at + name.size() + 2;  // behind ="
    const bool whole = at > 0 && tag[at - 1] == ' ' && begin < tag.size() && tag[begin - 2] == '=';
    if (whole) return tag.substr(begin, tag.find_first_of("\"'", begin) - begin);
  }
  return std::nullopt;
}

void scan_parameter(std::string_view tag, Demand& demand) {
  const auto key = attribute_of(tag, "key");
  const std::string value(attribute_of(tag, "value").value_or(""));
  if (key == "has.rerouting.device") {
    const bool has = value == "true" || value == "1" || value == "yes" || value == "on";
    demand.rerouting_devices = demand.rerouting_devices || has;
  } else if (key == "device.rerouting.probability") {
    demand.rerouting_devices = demand.rerouting_devices || is_positive(value);
  } else if (key == "device.rerouting.period") {
    demand.rerouting_periods = demand.rerouting_periods || is_positive(value);
  }
}

void scan_tag(std::string_view tag, Demand& demand) {
  tag.remove_prefix(std::min(tag.find('<'), tag.size()));
  const std::string_view name = tag.substr(0, tag.find_first_of(" \n\t/"));
  demand.people = demand.people || name == "<person" || name == "<personFlow";
  demand.rerouters = demand.rerouters || name == "<rerouter";
  if (name == "<param") scan_parameter(tag, demand);
  const bool single = name == "<vehicle" || name == "<trip";
  if (!single && name != "<flow") return;
  const auto text = attribute_of(tag, single ? "depart" : "end");
  const auto time = text ? number(*text) : std::nullopt;
  if (time) demand.last_departure = std::max(demand.last_departure.value_or(*time), *time);
}

/// The files of an option that are given behind "--" instead of those of the scenario.
std::vector<std::string> files_of(const CoordinateOptions& options, std::string_view name,
                                  std::string_view short_name,
                                  const std::vector<std::string>& files) {
  const auto list = given(options, name, short_name);
  if (!list) return files;
  std::vector<std::string> paths;
  std::stringstream words(*list);
  for (std::string path; std::getline(words, path, ',');) paths.push_back(path);
  return paths;
}

Demand scan_demand(const CoordinateOptions& options, const SumoConfiguration& configuration,
                   const InterruptionPoint& point) {
  Demand demand;
  for (const auto& files :
       {files_of(options, "--route-files", "-r", configuration.route_files),
        files_of(options, "--additional-files", "-a", configuration.additional_files)}) {
    for (const std::string& path : files) {
      std::error_code unreadable;
      if (!fs::is_regular_file(path, unreadable)) continue;  // SUMO says so, or it is read but once
      for_each_tag(path, [&](std::string_view tag) {
        point();
        scan_tag(tag, demand);
      });
    }
  }
  return demand;
}

fs::path their_path(const Scenario& scenario, const std::string& configuration,
                    const std::string& name) {
  const fs::path plain = fs::path(configuration).parent_path() / name;  // or `name`, if absolute
  return plain.parent_path() /
         (setting(scenario.configuration, "output-prefix") + plain.filename().string());
}

/// @throws InputError
SumoAddress address_of(const CoordinateOptions& options) {
  const std::string& text = options.remote;
  const std::size_t colon = text.rfind(':');
  const auto port = colon == std::string::npos || colon == 0
                        ? std::nullopt
                        : number(std::string_view(text).substr(colon + 1));
  if (!port || *port != double(int(*port)) || *port < 1 || *port > 65535) {
    throw InputError("--remote " + text, "is no HOST:PORT; give e.g. localhost:8813");
  }
  if (options.order > options.num_clients) {
    throw InputError(
        fmt::format("--order {}", options.order),
        fmt::format("is beyond --num-clients {}; give both as SUMO was told", options.num_clients));
  }
  return {.host = text.substr(0, colon),
          .port = int(*port),
          .order = options.order,
          .clients = options.num_clients};
}

}  // namespace

Scenario plan_run(const CoordinateOptions& options, RunFolder& folder,
                  const InterruptionPoint& point) {
  Scenario scenario{.configuration = read_configuration(options.configuration)};
  scenario.demand = scan_demand(options, scenario.configuration, point);
  SumoOptions& sumo = scenario.sumo;
  sumo.configuration = options.configuration;
  sumo.log = folder.part("sumo.log");
  sumo.extra = options.sumo;
  sumo.point = point;
  sumo.gui = options.gui;
  sumo.separate_process = options.separate_process;
  if (!options.remote.empty()) {
    sumo.remote = address_of(options);
    choose_end(options, scenario);
    note_settings(options, scenario);
    return scenario;
  }
  sumo.seed = options.seed;
  if (!options.no_fcd) sumo.fcd_output = folder.path("fcd.xml");
  sumo.tripinfo_output = folder.path("tripinfo.xml");
  choose_step_length(options, scenario);
  equip_with_emissions(options, scenario);
  choose_end(options, scenario);
  note_settings(options, scenario);
  return scenario;
}

std::vector<std::string> notes_on(const Traffic& traffic) {
  std::vector<std::string> notes;
  if (traffic.network().left_hand) {
    notes.emplace_back("left-hand traffic: tried little; look at the audit of the run");
  }
  if (traffic.network().opposite_lanes) {
    notes.emplace_back("overtaking in the opposite lane: such vehicles are not foreseen");
  }
  for (const std::string& id : traffic.types()) {
    const std::string kind = traffic.type(id).vehicle_class;
    if (kind == "bicycle" || kind == "ship" || kind == "tram" || kind.starts_with("rail")) {
      notes.push_back(fmt::format("vehicles of type {} ({}) are left to SUMO", id, kind));
    }
  }
  return notes;
}

std::vector<std::string> copy_outputs(const Scenario& scenario, const std::string& configuration) {
  std::vector<std::string> notes;
  for (const auto& [option, ours] : {std::pair{"fcd-output", scenario.sumo.fcd_output},
                                     {"tripinfo-output", scenario.sumo.tripinfo_output}}) {
    const std::string name = setting(scenario.configuration, option);
    if (name.empty() || ours.empty()) continue;
    std::error_code error;
    const fs::path theirs = their_path(scenario, configuration, name);
    fs::copy_file(ours, theirs, fs::copy_options::overwrite_existing, error);
    if (error) {
      notes.push_back(fmt::format("{} {}: not written ({}); the same is in {}", option,
                                  theirs.string(), error.message(), ours));
    }
  }
  return notes;
}

}  // namespace mvtp
