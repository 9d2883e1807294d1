#include "tools/view/load.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/plan_file.hpp"
#include "planner/problem/text_file.hpp"
#include "planner/problem/validate.hpp"
#include "tools/view/page.hpp"
#include "tools/view/plan_replay.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMaxTextBytes = 500'000'000;

std::string name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

bool is_page(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".html" || extension == ".htm";
}

Instance load_instance(const std::string& path, const InstanceReadOptions& options) {
  try {
    return read_instance(path, options);
  } catch (const InputError&) {
    // A plan without its instance is the likeliest slip.
    if (read_text_file(path, kMaxTextBytes).find("schedule") == std::string::npos) throw;
    throw InputError(path, "looks like a plan; name its instance with --instance");
  }
}

Replay load_plan(const std::string& path, const std::string& instance_path,
                 const ViewRequest& request, ReplayInfo info) {
  Instance instance = read_instance(instance_path, request.reading);
  Plan plan = read_plan(path, {.yaw = request.reading.yaw, .dt = instance.dt});
  if (!request.reading.vehicle_preset) take_vehicles(plan, instance);
  if (!plan.statistics.initial_overlaps.empty()) instance.initial_overlap = InitialOverlap::kAllow;
  if (request.reading.dt) plan.statistics.dt = *request.reading.dt;
  return replay_of(instance, plan, find_violations(instance, plan, CollisionRule::kContinuous),
                   std::move(info), path);
}

void check_counts(const ViewRequest& request) {
  const auto pages = static_cast<std::size_t>(std::ranges::count_if(request.files, is_page));
  const std::size_t plans = request.files.size() - pages;
  if (request.instances.size() > 1 && request.instances.size() != plans) {
    throw InputError("--instance", "names " + std::to_string(request.instances.size()) +
                                       " instances for " + std::to_string(plans) +
                                       " plans; name one for all, or one for each");
  }
}

}  // namespace

std::vector<Replay> load_replays(const ViewRequest& request) {
  check_counts(request);
  std::vector<Replay> replays;
  std::size_t plans = 0;
  for (const std::string& file : request.files) {
    if (is_page(file)) {
      std::vector<Replay> found = replays_of(read_text_file(file, kMaxTextBytes), file);
      std::ranges::move(found, std::back_inserter(replays));
      continue;
    }
    ReplayInfo info;
    info.title = request.title.empty() ? name_of(file) : request.title;
    info.label = name_of(file);
    if (request.instances.empty()) {
      replays.push_back(replay_of(load_instance(file, request.reading), std::move(info)));
    } else {
      const std::size_t which = std::min(plans++, request.instances.size() - 1);
      replays.push_back(load_plan(file, request.instances[which], request, std::move(info)));
    }
  }

  if (!request.labels.empty() && request.labels.size() != replays.size()) {
    throw InputError("--label", "names " + std::to_string(request.labels.size()) + " of " +
                                    std::to_string(replays.size()) + " replays; name all or none");
  }
  for (std::size_t i = 0; i < request.labels.size(); ++i) {
    replays[i] = with_label(std::move(replays[i]), request.labels[i]);
  }
  return replays;
}

}  // namespace mvtp
