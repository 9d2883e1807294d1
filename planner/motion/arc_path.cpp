#include "planner/motion/arc_path.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kShortest = 1e-6;       ///< [m]: no piece of its own for so little
constexpr double kSameCurvature = 1e-9;  ///< [1/m]

}  // namespace

void ArcPath::append(const std::vector<Arc>& arcs) {
  for (const Arc& arc : arcs) {
    if (std::abs(arc.length) < kShortest) continue;
    if (!pieces_.empty()) {
      Piece& last = pieces_.back();
      if (last.arc.length * arc.length > 0.0 &&
          std::abs(last.arc.curvature - arc.curvature) < kSameCurvature) {
        last.arc.length += arc.length;
        continue;
      }
      pieces_.push_back({arc, last.end(), drive(last.start, last.arc)});
    } else {
      pieces_.push_back({arc, 0.0, start_});
    }
  }
}

void ArcPath::truncate(double s) {
  while (!pieces_.empty() && pieces_.back().begin >= s - kShortest) pieces_.pop_back();
  if (pieces_.empty() || pieces_.back().end() <= s) return;
  Piece& last = pieces_.back();
  last.arc.length = last.direction() * (s - last.begin);
}

std::size_t ArcPath::piece_from(double s) const {
  const auto next = std::ranges::upper_bound(pieces_, s, {}, &Piece::begin);
  return next == pieces_.begin() ? 0 : std::size_t(next - pieces_.begin()) - 1;
}

Pose ArcPath::at(double s) const {
  if (pieces_.empty()) return start_;
  const Piece& piece = pieces_[piece_from(s)];
  const double driven = std::clamp(s - piece.begin, 0.0, std::abs(piece.arc.length));
  const Pose pose = drive(piece.start, {piece.direction() * driven, piece.arc.curvature});
  return s <= length() ? pose : drive(pose, Arc{piece.direction() * (s - length()), 0.0});
}

double ArcPath::stop_after(double s) const {
  for (std::size_t k = pieces_.empty() ? 1 : piece_from(s); k + 1 < pieces_.size(); ++k) {
    if (pieces_[k].direction() != pieces_[k + 1].direction()) return pieces_[k].end();
  }
  return length();
}

int ArcPath::direction_from(double s) const {
  return pieces_.empty() ? 0 : pieces_[piece_from(s)].direction();
}

int ArcPath::reversals() const {
  int count = 0;
  for (std::size_t k = 1; k < pieces_.size(); ++k) {
    count += pieces_[k].direction() != pieces_[k - 1].direction() ? 1 : 0;
  }
  return count;
}

}  // namespace mvtp
