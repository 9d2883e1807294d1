#include "traci_bridge/parking_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <ranges>
#include <utility>

#include "planner/geometry.hpp"
#include "planner/problem/input_error.hpp"
#include "traci_bridge/parking_geometry.hpp"
#include "traci_bridge/xml.hpp"

namespace mvtp {
namespace {

using Element = tinyxml2::XMLElement;

constexpr double kSmallestLength = 2.0;  // of a slot [m]
constexpr double kSmallestWidth = 1.0;   // of a slot [m]
constexpr double kAisle = 1.0;           // so deep is the ground at the open side of a slot [m]
constexpr double kShortestPiece = 1.0;   // of a lane on the ground [m]
constexpr double kFarthest = 1e7;        // coordinate [m]
constexpr std::size_t kMostPoints = 1000;

/// A polygon as drawn, with the line it stands in.
struct Drawn {
  std::string id;
  Polygon shape;
  std::string where;
};

struct Area {
  std::vector<ParkingSlot> slots;
  std::vector<std::string> where;  ///< of each slot
  std::string place;
};

class ParkingReader {
 public:
  explicit ParkingReader(const RoadNetwork& network) : network_(network) {}

  void read(const std::string& path) {
    const XmlFile file(path, "an additional file of SUMO");
    for (const Element* poly : children(file.root(), "poly")) read_polygon(file, *poly);
    for (const Element* area : children(file.root(), "parkingArea")) read_area(file, *area);
  }

  std::vector<ParkingLot> lots() const {
    check_apart();
    std::vector<ParkingLot> lots;
    for (const Drawn& ground : std::views::values(grounds_)) lots.push_back(lot_on(ground));
    return lots;
  }

 private:
  void read_polygon(const XmlFile& file, const Element& element) {
    const std::string type = attribute(element, "type");
    if (!type.starts_with("parking.")) return;
    const bool is_ground = type == "parking.ground";
    if (!is_ground && type != "parking.obstacle") {
      file.fail(element, fmt::format("<poly> type: \"{}\" is unknown; choose parking.ground or "
                                     "parking.obstacle",
                                     type));
    }
    Drawn drawn{.id = file.text(element, "id"), .shape = {}, .where = file.where(element)};
    drawn.shape = outline(file, element, drawn.id);
    if (!is_ground) {
      obstacles_.push_back(std::move(drawn));
    } else if (const std::string id = drawn.id; !grounds_.emplace(id, std::move(drawn)).second) {
      file.fail(element, fmt::format("the ground of lot \"{}\" is defined twice; delete one", id));
    }
  }

  /// A simple polygon without its closing point and repeated points.
  static Polygon outline(const XmlFile& file, const Element& element, const std::string& id) {
    const auto fail = [&](const std::string& problem) {
      file.fail(element, fmt::format("polygon \"{}\" {}", id, problem));
    };
    const std::string geo = attribute(element, "geo");
    if (geo == "1" || geo == "true") {
      fail("is given as longitudes and latitudes; save it in metres, without geo=\"1\"");
    }
    Polygon polygon = file.points(element, "shape");
    const auto repeated = std::ranges::unique(polygon);
    polygon.erase(repeated.begin(), repeated.end());
    if (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
    if (polygon.size() < 3) fail(fmt::format("has {} points; draw at least 3", polygon.size()));
    if (polygon.size() > kMostPoints) {
      fail(fmt::format("has {} points; draw at most {}", polygon.size(), kMostPoints));
    }
    for (const Point& p : polygon) {
      if (std::max(std::abs(p.x), std::abs(p.y)) > kFarthest) {
        fail(fmt::format("reaches to ({}, {}) m; draw it on the network", p.x, p.y));
      }
    }
    if (const auto contact = self_contact(polygon)) {
      fail(fmt::format("touches or crosses itself: sides {} and {}; draw a simple outline",
                       contact->first + 1, contact->second + 1));
    }
    return polygon;
  }

  void read_area(const XmlFile& file, const Element& element) {
    const std::string id = file.text(element, "id");
    Area area{.slots = {}, .where = {}, .place = file.where(element)};
    for (const Element* space : children(element, "space")) {
      area.slots.push_back(read_space(file, element, *space));
      area.slots.back().id = std::to_string(area.slots.size());
      area.where.push_back(file.where(*space));
    }
    if (!areas_.emplace(id, std::move(area)).second) {
      file.fail(element, fmt::format("the parkingArea \"{}\" is defined twice; delete one", id));
    }
  }

  static ParkingSlot read_space(const XmlFile& file, const Element& area, const Element& space) {
    const auto of = [&](const char* name) -> const Element& {  // what a space lacks its area says
      return space.Attribute(name) == nullptr && area.Attribute(name) != nullptr ? area : space;
    };
    ParkingSlot slot{.id = {},
                     .middle = {},
                     .length = file.positive(of("length"), "length"),
                     .width = file.positive(of("width"), "width")};
    const double angle = file.number(of("angle"), "angle", 0.0);
    const double theta = (std::fmod(angle, 360.0) - 90.0) * std::numbers::pi / 180.0;
    const Pose front{file.number(space, "x"), file.number(space, "y"), wrap_to_pi(theta)};
    const double largest =
        std::max({slot.length, slot.width, std::abs(front.x), std::abs(front.y)});
    if (largest > kFarthest) {
      file.fail(space, fmt::format("a length of {} m; draw the space on the network", largest));
    }
    slot.middle = compose(front, {-slot.length / 2, 0.0, 0.0});
    return slot;
  }

  void check_apart() const {
    for (auto lot = grounds_.begin(); lot != grounds_.end(); ++lot) {
      for (auto other = grounds_.begin(); other != lot; ++other) {
        if (!overlap(lot->second.shape, other->second.shape)) continue;
        throw InputError(lot->second.where,
                         fmt::format("the ground of lot \"{}\" overlaps that of lot \"{}\"; move "
                                     "one of them",
                                     lot->first, other->first));
      }
    }
  }

  ParkingLot lot_on(const Drawn& ground) const {
    const auto area = areas_.find(ground.id);
    if (area == areas_.end()) {
      throw InputError(ground.where,
                       fmt::format("lot \"{0}\" has no slots; add <parkingArea id=\"{0}\"> with "
                                   "its <space>s to the additional files",
                                   ground.id));
    }
    if (area->second.slots.empty()) {
      throw InputError(area->second.place,
                       fmt::format("lot \"{}\" has no slots; add a <space> for each", ground.id));
    }
    ParkingLot lot;
    lot.id = ground.id;
    lot.ground = ground.shape;
    for (const Drawn& obstacle : obstacles_) {
      if (overlap(obstacle.shape, ground.shape)) lot.obstacles.push_back(obstacle.shape);
    }
    lot.slots = area->second.slots;
    for (std::size_t i = 0; i < lot.slots.size(); ++i) check(lot, i, area->second.where[i]);
    for (std::size_t i = 0; i < lot.slots.size(); ++i) turn_inwards(lot, i, area->second.where[i]);
    add_lanes(lot, ground.where);
    return lot;
  }

  static void check(const ParkingLot& lot, std::size_t i, const std::string& where) {
    const ParkingSlot& slot = lot.slots[i];
    const auto fail = [&](const std::string& problem) {
      throw InputError(where, fmt::format("slot {} of lot \"{}\" {}", slot.id, lot.id, problem));
    };
    if (slot.length < kSmallestLength || slot.width < kSmallestWidth) {
      fail(fmt::format("is {:g} x {:g} m, smaller than any car; give at least {:g} x {:g} m",
                       slot.length, slot.width, kSmallestLength, kSmallestWidth));
    }
    const OrientedBox box = inner_box(slot);
    if (!inside(box, lot.ground)) {
      fail(
          fmt::format("around ({:.2f}, {:.2f}) m is not all on the ground; move it, or draw a "
                      "larger ground",
                      slot.middle.x, slot.middle.y));
    }
    for (const Polygon& obstacle : lot.obstacles) {
      if (covers(obstacle, box)) fail("lies on an obstacle; move one of them");
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (separation(box, inner_box(lot.slots[j])) >= 0.0) continue;
      fail(fmt::format("overlaps slot {}; move one of them", lot.slots[j].id));
    }
  }

  /// Turns the slot so that it points away from its open side.
  static void turn_inwards(ParkingLot& lot, std::size_t i, const std::string& where) {
    ParkingSlot& slot = lot.slots[i];
    if (is_open(lot, slot, -1.0)) return;
    if (!is_open(lot, slot, +1.0)) {
      throw InputError(where, fmt::format("slot {} of lot \"{}\" is closed at both short sides; "
                                          "leave ground free at one of them",
                                          slot.id, lot.id));
    }
    slot.middle.theta = wrap_to_pi(slot.middle.theta + std::numbers::pi);
  }

  /// Is there free ground behind (side -1) or ahead (+1) of the slot?
  static bool is_open(const ParkingLot& lot, const ParkingSlot& slot, double side) {
    ParkingSlot beyond = slot;
    beyond.middle = compose(slot.middle, {side * (slot.length + kAisle) / 2, 0.0, 0.0});
    beyond.length = kAisle;
    const OrientedBox box = inner_box(beyond);
    return inside(box, lot.ground) &&
           std::ranges::none_of(lot.obstacles,
                                [&](const Polygon& obstacle) { return covers(obstacle, box); }) &&
           std::ranges::none_of(lot.slots, [&](const ParkingSlot& other) {
             return separation(box, inner_box(other)) < 0.0;
           });
  }

  void add_lanes(ParkingLot& lot, const std::string& where) const {
    for (const Lane& lane : std::views::values(network_.lanes)) {
      if (lane.footpath && touches(lane.shape, lot.ground)) {
        lot.footpaths.push_back({lane.shape, lane.width});
      }
      if (lane.internal || !lane.drivable) continue;
      const std::vector<Point> backwards(lane.shape.rbegin(), lane.shape.rend());
      if (const auto entry = straight_piece(lane, backwards, lot, where)) {
        const auto& [end, begin] = *entry;
        lot.entries.push_back(lot_lane(lane, begin, end));
        lot.entries.back().offset = lane.length - lot.entries.back().length * stretch(lane);
      }
      if (const auto exit = straight_piece(lane, lane.shape, lot, where)) {
        lot.exits.push_back(lot_lane(lane, exit->first, exit->second));
      }
    }
    const auto require = [&](const std::vector<LotLane>& lanes, const char* what,
                             const char* remedy) {
      if (!lanes.empty()) return;
      throw InputError(where, fmt::format("no lane {} on the ground of lot \"{}\"; draw the ground "
                                          "over the {}",
                                          what, lot.id, remedy));
    };
    require(lot.entries, "ends", "last metres of a lane that leads there");
    require(lot.exits, "begins", "first metres of a lane that leads away");
  }

  static bool touches(const std::vector<Point>& line, const Polygon& ground) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      if (gap(segment(line[i - 1], line[i]), ground) < 0.0) return true;
    }
    return contains(ground, line.front());
  }

  /// Metres of the lane per metre of its centre line: SUMO lets them differ.
  static double stretch(const Lane& lane) { return lane.length / length_of(lane.shape); }

  static LotLane lot_lane(const Lane& lane, const Point& begin, const Point& end) {
    return {.lane = lane.id,
            .begin = {begin.x, begin.y, std::atan2(end.y - begin.y, end.x - begin.x)},
            .length = length_of({begin, end}),
            .offset = 0.0};
  }

  /// The ends of the piece on the ground of a lane whose `line` begins there, or none.
  static std::optional<std::pair<Point, Point>> straight_piece(const Lane& lane,
                                                               const std::vector<Point>& line,
                                                               const ParkingLot& lot,
                                                               const std::string& where) {
    const Piece piece = piece_on_ground(line, lot.ground);
    // A lane that never leaves the ground is one of SUMO's aisles: vehicles need none.
    if (!piece.leaves || length_of(piece.line) < kShortestPiece) return std::nullopt;
    if (const double aside = bend(piece.line); aside > kTolerance) {
      throw InputError(where, fmt::format("lane \"{}\" is not straight on the ground of lot "
                                          "\"{}\": it bends by {:.2f} m; straighten it, or end "
                                          "the ground before the bend",
                                          lane.id, lot.id, aside));
    }
    return std::pair(piece.line.front(), piece.line.back());
  }

  const RoadNetwork& network_;
  std::map<std::string, Drawn> grounds_;
  std::map<std::string, Area> areas_;
  std::vector<Drawn> obstacles_;
};

}  // namespace

std::vector<ParkingLot> read_parking_lots(const std::vector<std::string>& additional_files,
                                          const RoadNetwork& network) {
  ParkingReader reader(network);
  for (const std::string& path : additional_files) reader.read(path);
  return reader.lots();
}

}  // namespace mvtp
