#include "tools/generate/open_lot.hpp"

#include <cmath>
#include <numbers>
#include <string>

namespace mvtp {
namespace {

constexpr double kEast = 0.0;
constexpr double kWest = std::numbers::pi;

/// A column of equal slots from `west` on, and the direction into them.
struct Column {
  double west = 0.0;
  double theta = kEast;
  double length = 5.0;
  double width = 2.5;
  int half = 5;  ///< slots on each side of the footpath
};

void add_column(ParkingLot& lot, const Column& column) {
  const auto millis = [](double value) { return std::round(1e3 * value) / 1e3; };
  for (const double south : {6.5, 21.0}) {
    for (int i = 0; i < column.half; ++i) {
      const Pose middle{millis(column.west + column.length / 2),
                        millis(south + (i + 0.5) * column.width), column.theta};
      lot.slots.push_back(
          {std::to_string(lot.slots.size() + 1), middle, column.length, column.width});
    }
  }
}

Polygon rectangle(double west, double south, double east, double north) {
  return {{west, south}, {east, south}, {east, north}, {west, north}};
}

}  // namespace

ParkingLot open_lot() {
  ParkingLot lot;
  lot.id = "lot";
  lot.ground = rectangle(0.0, 0.0, 51.0, 40.0);
  for (const double west : {13.0, 29.4}) {  // at the ends of the two double columns
    lot.obstacles.push_back(rectangle(west, 6.0, west + 8.0, 6.4));
    lot.obstacles.push_back(rectangle(west, 33.6, west + 8.0, 34.0));
  }
  add_column(lot, {.west = 0.3, .theta = kWest, .length = 5.5});
  add_column(lot, {.west = 11.8, .theta = kEast});
  add_column(lot, {.west = 17.2, .theta = kWest});
  add_column(lot, {.west = 28.2, .theta = kEast});
  add_column(lot, {.west = 33.6, .theta = kWest});
  add_column(lot, {.west = 44.6, .theta = kEast, .length = 6.0, .width = 2.8, .half = 4});
  lot.footpaths.push_back({.line = {{0.0, 20.0}, {51.0, 20.0}}, .width = 2.0});
  return lot;
}

}  // namespace mvtp
