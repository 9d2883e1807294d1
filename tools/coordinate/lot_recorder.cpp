#include "tools/coordinate/lot_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace mvtp {
namespace {

constexpr double kSampleEvery = 10.0;  ///< [s]
constexpr double kPointEvery = 0.5;    ///< [s]
constexpr double kPixels = 16.0;       ///< per metre
constexpr double kMargin = 2.0;        ///< [m] around the ground

constexpr const char* kStyle = R"(<style>
.page{fill:#fff}.ground{fill:#eceff1;stroke:#607d8b;stroke-width:.12}
.obstacle{fill:#607d8b}.slot{fill:none;stroke:#90a4ae;stroke-width:.08}
.car{fill:#37474f;fill-opacity:.35}.path{fill:#fff59d;fill-opacity:.5}
.in{fill:none;stroke:#1565c0;stroke-opacity:.28;stroke-width:.14}
.out{fill:none;stroke:#e65100;stroke-opacity:.28;stroke-width:.14}
text{font:1.1px sans-serif;fill:#263238}
</style>
)";

std::string points_of(const std::vector<Point>& points) {
  std::string text;
  for (const Point& p : points) text += fmt::format("{:.2f},{:.2f} ", p.x, -p.y);
  return text;
}

std::string rectangle(const Pose& middle, double length, double width, const char* kind) {
  return fmt::format(
      "<rect class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" "
      "transform=\"translate({:.2f} {:.2f}) rotate({:.2f})\"/>\n",
      kind, -length / 2, -width / 2, length, width, middle.x, -middle.y,
      -middle.theta * 180.0 / std::numbers::pi);
}

}  // namespace

void LotRecorder::observe(double time) {
  if (time >= next_sample_) {
    occupancy_.push_back(lot_.occupied(time));
    next_sample_ = time + kSampleEvery;
  }
  if (time < next_point_) return;
  next_point_ = time + kPointEvery;
  for (const LotObservation& s : lot_.under_way()) {
    std::vector<Trail>& trails = trails_[s.id];
    if (trails.empty() || trails.back().leaving != s.leaving) trails.push_back({s.leaving, {}});
    const Pose middle = compose(s.pose, {(s.body.front - s.body.rear) / 2, 0.0, 0.0});
    trails.back().points.push_back({middle.x, middle.y});
  }
}

LotReport LotRecorder::report(const std::map<std::string, double>& at_gate) const {
  LotReport report{.lot = lot_.lot().id, .slots = int(lot_.lot().slots.size())};
  for (const auto& [id, event] : lot_.events()) {
    ParkingRecord record{event, std::nullopt};
    const auto gate = at_gate.find(id);
    if (gate != at_gate.end() && !event.there_at_start) record.at_gate = gate->second;
    report.events.push_back(record);
  }
  report.occupancy = occupancy_;
  return report;
}

std::string LotRecorder::picture() const {
  const ParkingLot& lot = lot_.lot();
  const auto [left, right] = std::ranges::minmax(lot.ground, {}, &Point::x);
  const auto [low, high] = std::ranges::minmax(lot.ground, {}, &Point::y);
  const double width = right.x - left.x + 2 * kMargin;
  const double height = high.y - low.y + 2 * kMargin;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" "
      "viewBox=\"{:.2f} {:.2f} {:.2f} {:.2f}\">\n{}",
      width * kPixels, height * kPixels, left.x - kMargin, -high.y - kMargin, width, height,
      kStyle);
  svg += fmt::format(
      "<rect class=\"page\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" "
      "height=\"{:.2f}\"/>\n",
      left.x - kMargin, -high.y - kMargin, width, height);
  svg += fmt::format("<polygon class=\"ground\" points=\"{}\"/>\n", points_of(lot.ground));
  for (const ParkingSlot& slot : lot.slots) {
    svg += rectangle(slot.middle, slot.length, slot.width, "slot");
  }
  for (const Polygon& polygon : lot.obstacles) {
    svg += fmt::format("<polygon class=\"obstacle\" points=\"{}\"/>\n", points_of(polygon));
  }
  for (const LotObservation& s : lot_.parked()) {
    const Pose middle = compose(s.pose, {(s.body.front - s.body.rear) / 2, 0.0, 0.0});
    svg += rectangle(middle, s.body.length(), s.body.width, "car");
  }
  for (const auto& [id, trails] : trails_) {
    for (const Trail& trail : trails) {
      svg += fmt::format("<polyline class=\"{}\" points=\"{}\"/>\n", trail.leaving ? "out" : "in",
                         points_of(trail.points));
    }
  }
  svg +=
      fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\">{}: in blue, out orange, {} vehicles</text>\n",
                  left.x - kMargin + 0.5, -low.y + kMargin - 0.6, lot.id, trails_.size());
  return svg + "</svg>\n";
}

}  // namespace mvtp
