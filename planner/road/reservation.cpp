#include "planner/road/reservation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace mvtp {
namespace {

/// Samples of a path, the last one included.
struct Samples {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

Samples samples_of(const JunctionStretch& stretch, const SweptPath& swept) {
  const auto most = std::int64_t(swept.samples()) - 1;
  const auto at = [&](double s) {
    return std::uint32_t(
        std::clamp<std::int64_t>(std::lround(s / ReferencePath::kSpacing), 0, most));
  };
  return {at(stretch.from), at(stretch.to)};
}

using Tile = std::int64_t;

/// The tiles that a body touches, ascending.
std::vector<Tile> tiles_under(const OrientedBox& box) {
  const double x = std::abs(box.ux) * box.half_length + std::abs(box.uy) * box.half_width;
  const double y = std::abs(box.uy) * box.half_length + std::abs(box.ux) * box.half_width;
  const auto cell = [](double v) { return std::int64_t(std::floor(v / kTile)); };
  std::vector<Tile> tiles;
  for (std::int64_t i = cell(box.x - x); i <= cell(box.x + x); ++i) {
    for (std::int64_t j = cell(box.y - y); j <= cell(box.y + y); ++j) {
      const OrientedBox tile{.x = (double(i) + 0.5) * kTile,
                             .y = (double(j) + 0.5) * kTile,
                             .ux = 1.0,
                             .uy = 0.0,
                             .half_length = kTile / 2.0,
                             .half_width = kTile / 2.0};
      if (separation(box, tile) <= 0.0) tiles.push_back((i << 32) + j);
    }
  }
  std::ranges::sort(tiles);
  return tiles;
}

/// For each tile the samples of `b` whose bodies touch it, as one run: a body is on a tile once.
std::map<Tile, Samples> occupied_tiles(const SweptPath& b, const Samples& range) {
  std::map<Tile, Samples> occupied_tiles;
  for (std::uint32_t j = range.first; j <= range.last; ++j) {
    for (const Tile tile : tiles_under(b.box(j))) {
      occupied_tiles.try_emplace(tile, Samples{j, j}).first->second.last = j;
    }
  }
  return occupied_tiles;
}

using Run = ContactTable::Run;
using Rows = std::map<std::uint32_t, std::vector<Run>>;

void add_rectangle(const Samples& a, const Samples& b, Rows& rows) {
  for (std::uint32_t i = a.first; i <= a.last; ++i) rows[i].emplace_back(b.first, b.last);
}

void add_tiles(const SweptPath& swept_a, const Samples& a, const SweptPath& swept_b,
               const Samples& b, Rows& rows) {
  const std::map<Tile, Samples> there = occupied_tiles(swept_b, b);
  for (std::uint32_t i = a.first; i <= a.last; ++i) {
    for (const Tile tile : tiles_under(swept_a.box(i))) {
      const auto occupied = there.find(tile);
      if (occupied != there.end())
        rows[i].emplace_back(occupied->second.first, occupied->second.last);
    }
  }
}

/// The rectangle around all contacts of two stretches.
void add_conflict_area(const Samples& a, const Samples& b, const ContactTable& bodies, Rows& rows) {
  Samples area_a{a.last, a.first};
  Samples area_b{b.last, b.first};
  for (std::uint32_t i = a.first; i <= a.last; ++i) {
    for (std::uint32_t j = b.first; j <= b.last; ++j) {
      if (!bodies.touches(i * ReferencePath::kSpacing, j * ReferencePath::kSpacing)) continue;
      area_a = {std::min(area_a.first, i), std::max(area_a.last, i)};
      area_b = {std::min(area_b.first, j), std::max(area_b.last, j)};
    }
  }
  if (area_a.first <= area_a.last) add_rectangle(area_a, area_b, rows);
}

}  // namespace

ContactTable reserved_ground(Reservation reservation, const ReservingPath& a,
                             const ReservingPath& b, const ContactTable& bodies) {
  Rows rows;
  for (const JunctionStretch& on_a : a.stretches) {
    for (const JunctionStretch& on_b : b.stretches) {
      if (on_a.junction != on_b.junction) continue;
      const bool follow = on_a.approach == on_b.approach;
      const Samples range_a = samples_of(on_a, *a.swept);
      const Samples range_b = samples_of(on_b, *b.swept);
      switch (reservation) {
        case Reservation::kNone:
          break;
        case Reservation::kTiles:
          add_tiles(*a.swept, range_a, *b.swept, range_b, rows);
          break;
        case Reservation::kConflictArea:
          if (!follow) add_conflict_area(range_a, range_b, bodies, rows);
          break;
        case Reservation::kJunction:
          if (!follow) add_rectangle(range_a, range_b, rows);
          break;
      }
    }
  }
  return ContactTable(rows);
}

}  // namespace mvtp
