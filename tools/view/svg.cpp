#include "tools/view/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "planner/problem/input_error.hpp"
#include "tools/view/read_replay.hpp"

namespace mvtp {
namespace {

constexpr double kPixels = 1200.0;       // of the longer side
constexpr double kSurroundings = 150.0;  // [m] at least, around control zones
constexpr double kReverse = -0.02;       // [m/s]

/// The colours of the page, by ReplayState.
constexpr const char* kColours[] = {"#ffffff", "#0072b2", "#f0a500",
                                    "#5fb89b", "#8f979f", "#b3446c"};

const char* lane_colour(ReplayLaneKind kind) {
  switch (kind) {
    case ReplayLaneKind::kBuses:
      return "#c2a68c";
    case ReplayLaneKind::kBicycles:
      return "#b7c9a3";
    case ReplayLaneKind::kRail:
      return "#a9a3b5";
    case ReplayLaneKind::kFoot:
      return "#dcdcd4";
    case ReplayLaneKind::kCars:
      break;
  }
  return "#c3c8cf";
}

const char* light_colour(char light) {
  switch (light) {
    case 'G':
    case 'g':
      return "#009e73";
    case 'y':
    case 'Y':
      return "#f0c000";
    case 'r':
    case 'u':
    case 's':
      return "#d5201f";
    default:
      return "#59616c";
  }
}

/// Everything is in metres with y up; the drawing turns it over.
struct Box {
  double left = std::numeric_limits<double>::infinity();
  double low = left;
  double right = -left;
  double high = -left;

  void add(const Point& p) {
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  void add(const std::vector<Point>& points) {
    for (const Point& point : points) add(point);
  }
  [[nodiscard]] bool empty() const { return left > right; }
  void widen(double by) {
    left -= by;
    low -= by;
    right += by;
    high += by;
  }
};

Box box_of(const ReplayScene& scene, const std::vector<ReplayVehicleState>& states) {
  Box zones;
  for (const Polygon& zone : scene.zones) zones.add(zone);
  for (const Polygon& slot : scene.slots) zones.add(slot);
  if (!zones.empty()) {
    const double size = std::max(zones.right - zones.left, zones.high - zones.low);
    zones.widen(std::max(5.0, (kSurroundings - size) / 2.0));
    return zones;
  }
  Box all;
  if (scene.border) all.add({Point{0.0, 0.0}, *scene.border});
  for (const ReplayLane& lane : scene.lanes) all.add(lane.shape);
  for (const Polygon& junction : scene.junctions) all.add(junction);
  for (const ReplayVehicleState& state : states) all.add({state.pose.x, state.pose.y});
  all.widen(2.0);
  return all;
}

std::string points_of(const std::vector<Point>& points) {
  std::string text;
  for (const Point& p : points) text += fmt::format("{:.2f},{:.2f} ", p.x, p.y);
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return out;
}

std::string line_svg(const std::vector<Point>& line, const char* colour, double width,
                     const char* more = "") {
  return fmt::format("<polyline points=\"{}\" stroke=\"{}\" stroke-width=\"{:.2f}\" {}/>\n",
                     points_of(line), colour, width, more);
}

/// @param colour  nullptr: that of the kind of the lane
std::string lanes_of(const ReplayScene& scene, bool internal, const char* colour, double wider) {
  std::string svg;
  for (const ReplayLane& lane : scene.lanes) {
    if (lane.internal != internal) continue;
    svg += line_svg(lane.shape, colour != nullptr ? colour : lane_colour(lane.kind),
                    lane.width + wider);
  }
  return svg;
}

std::string lights_svg(const ReplayScene& scene, const std::vector<std::string>& shown) {
  std::string svg;
  for (const ReplayLight& light : scene.lights) {
    const std::string& letters = shown.at(light.signal);
    const auto index = static_cast<std::size_t>(light.index);
    svg += line_svg({light.from, light.to},
                    light_colour(index < letters.size() ? letters[index] : 'o'), 0.9);
  }
  return svg;
}

std::string polygons_of(const std::vector<Polygon>& polygons, const char* style) {
  std::string svg;
  for (const Polygon& polygon : polygons) {
    svg += fmt::format("<polygon points=\"{}\" {}/>\n", points_of(polygon), style);
  }
  return svg;
}

std::string scene_svg(const ReplayScene& scene) {
  std::string svg;
  if (scene.border) {
    svg += fmt::format(
        "<rect width=\"{:.2f}\" height=\"{:.2f}\" fill=\"#eceee8\" stroke=\"#6a7078\" "
        "stroke-width=\".2\"/>\n",
        scene.border->x, scene.border->y);
  }
  svg += "<g fill=\"none\" stroke-linejoin=\"round\">\n";
  svg += lanes_of(scene, false, "#ffffff", 0.15) + lanes_of(scene, false, nullptr, -0.15);
  svg += polygons_of(scene.junctions, "fill=\"#c3c8cf\"") + lanes_of(scene, true, "#c3c8cf", 0.0);
  for (const ReplayCrossing& crossing : scene.crossings) {
    svg += line_svg(crossing.shape, "#ffffff", crossing.width, "stroke-dasharray=\".5 .5\"");
  }
  svg += polygons_of(scene.slots, "stroke=\"#ffffff\" stroke-width=\".12\"");
  svg +=
      polygons_of(scene.zones, "stroke=\"#0063a0\" stroke-width=\".4\" stroke-dasharray=\"2 2\"");
  svg += "</g>\n" + polygons_of(scene.polygons, "fill=\"#6a7078\"");
  for (const Circle& circle : scene.circles) {
    svg += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"#6a7078\"/>\n",
                       circle.x, circle.y, circle.radius);
  }
  return svg;
}

/// A group in the frame of the rear axle.
std::string at(const Pose& pose, const std::string& inside) {
  return fmt::format("<g transform=\"translate({:.2f} {:.2f}) rotate({:.1f})\">{}</g>\n", pose.x,
                     pose.y, pose.theta * 180.0 / std::numbers::pi, inside);
}

std::string body_svg(const ReplayVehicle& vehicle, const char* style) {
  return fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" {}/>",
                     vehicle.front - vehicle.length, -vehicle.width / 2.0, vehicle.length,
                     vehicle.width, style);
}

std::string vehicle_svg(const ReplayVehicle& vehicle, const ReplayVehicleState& state) {
  if (vehicle.person) {
    return fmt::format(
        "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"{}\" stroke=\"#23272d\" "
        "stroke-width=\".1\"><title>{}</title></circle>\n",
        state.pose.x, state.pose.y, vehicle.front, kColours[std::size_t(ReplayState::kWalking)],
        escaped(vehicle.id));
  }
  const char* colour = state.speed < kReverse
                           ? "#cc3d93"
                           : kColours[static_cast<std::size_t>(state.state) % std::size(kColours)];
  const std::string style =
      fmt::format("fill=\"{}\" stroke=\"#23272d\" stroke-width=\".1\"", colour);
  // The windshield; its narrow end looks forward.
  const double at_x = vehicle.front - std::min(vehicle.length * 0.2, 1.4);
  const double back = at_x - 0.45 * std::min(vehicle.length * 0.26, 1.6);
  const double half = vehicle.width / 2.0;
  const std::string glass = fmt::format(
      "<polygon points=\"{:.2f},{:.2f} {:.2f},{:.2f} {:.2f},{:.2f} {:.2f},{:.2f}\" "
      "fill=\"#14181e\" fill-opacity=\".62\"/>",
      back, 0.82 * half, at_x, 0.62 * half, at_x, -0.62 * half, back, -0.82 * half);
  return at(state.pose, fmt::format("<title>{}</title>{}{}", escaped(vehicle.id),
                                    body_svg(vehicle, style.c_str()), glass));
}

std::string goals_svg(const std::vector<ReplayVehicle>& vehicles) {
  std::string svg;
  for (const ReplayVehicle& vehicle : vehicles) {
    if (!vehicle.goal) continue;
    svg += at(*vehicle.goal,
              body_svg(vehicle, "fill=\"none\" stroke=\"#59616c\" stroke-width=\".1\""));
  }
  return svg;
}

}  // namespace

std::string to_svg(const Replay& replay, double time, const std::string& where) {
  const ReplayFrames frames = frames_of(replay, where);
  if (frames.times.empty() || time < frames.times.front() || time > frames.times.back()) {
    throw InputError("--at", frames.times.empty()
                                 ? where + " has no moment to show"
                                 : fmt::format("is {} s; {} goes from {} to {} s", time, where,
                                               frames.times.front(), frames.times.back()));
  }
  const std::vector<ReplayVehicle> vehicles = vehicles_of(replay, where);
  const std::vector<ReplayVehicleState> states = states_at(frames, time);
  const ReplayScene scene = scene_of(replay, where);
  const Box box = box_of(scene, states);
  const double width = box.right - box.left;
  const double height = box.high - box.low;
  const double scale = kPixels / std::max(width, height);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" "
      "viewBox=\"{:.2f} {:.2f} {:.2f} {:.2f}\">\n<title>{}, {:g} s</title>\n"
      "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n"
      "<g transform=\"scale(1 -1)\">\n",
      scale * width, scale * height, box.left, -box.high, width, height, escaped(replay.title),
      time, box.left - 1.0, -box.high - 1.0, width + 2.0, height + 2.0,
      scene.border ? "#dcdfe3" : "#eceee8");
  svg += scene_svg(scene) + goals_svg(vehicles);
  svg += lights_svg(scene, lights_at(replay, time, where));
  for (const ReplayVehicleState& state : states) {
    svg += vehicle_svg(vehicles.at(state.vehicle), state);
  }
  return svg + "</g>\n</svg>\n";
}

}  // namespace mvtp
