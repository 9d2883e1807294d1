#include "tools/cli/instance_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "planner/problem/vehicle_file.hpp"
#include "tools/cli/option_types.hpp"

namespace mvtp {

void add_instance_options(CLI::App& app, InstanceReadOptions& options) {
  const char* group = kInstanceGroup;
  app.add_option("--vehicle", options.vehicle_preset,
                 "Vehicle preset, in place of the file's own [escot]")
      ->type_name("escot|cl-cbs")
      ->group(group);
  app.add_option("--dt", options.dt, "Duration of one step [s], in place of the file's or preset's")
      ->type_name("S")
      ->check(number_between(kLeastOfVehicle, kLongestStep))
      ->group(group);
  add_choice<YawSense>(app, "--yaw", options.yaw,
                       {{"ccw", YawSense::kCounterClockwise}, {"cw", YawSense::kClockwise}},
                       "How the files mean yaw: ccw as CSDO, cw as CL-CBS's solver [ccw]")
      ->group(group);
  add_choice<Bounds>(app, "--bounds", options.bounds,
                     {{"axle", Bounds::kAxle}, {"footprint", Bounds::kFootprint}},
                     "What must stay inside the map [axle for plain CL-CBS files, else footprint]")
      ->group(group);
}

void add_instance_rules(CLI::App& app, InstanceReadOptions& options) {
  add_choice<InitialOverlap>(
      app, "--initial-overlap", options.initial_overlap,
      {{"refuse", InitialOverlap::kRefuse}, {"allow", InitialOverlap::kAllow}},
      "What of a start or goal that overlaps an obstacle or another one: bad input, or exempt from "
      "the collision rule until the two are apart, or from the arrival on [refuse]")
      ->group(kRulesGroup);
}

std::string exemptions_text(const std::vector<std::string>& exemptions) {
  if (exemptions.empty()) return {};
  return fmt::format("; allowed: {}", fmt::join(exemptions, ", "));
}

void add_collision_option(CLI::App& app, CollisionRule& rule) {
  add_choice<CollisionRule>(
      app, "--collision", rule,
      {{"continuous", CollisionRule::kContinuous}, {"steps", CollisionRule::kSteps}},
      "Footprints may not touch along the motion, or only at whole steps [continuous]")
      ->group(kRulesGroup);
}

}  // namespace mvtp
