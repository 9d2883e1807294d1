#include "planner/lot/temporal_plan_graph.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kOut = 0.01;  ///< [m] beyond a cell: there a car has left it

}  // namespace

PathCells::PathCells(const ArcPath& path, const Vehicle& body, double margin) {
  const double length = path.length();
  for (double s = 0.0; s < length - 1e-9; s += kLength) {
    const double end = std::min(s + kLength, length);
    std::vector<Pose> poses = {path.at((s + end) / 2), path.at(s), path.at(end)};
    // A change of direction or curvature inside the cell.
    for (const ArcPath::Piece& piece : path.pieces()) {
      if (piece.begin > s && piece.begin < end) poses.push_back(piece.start);
    }
    add(poses, body, margin);
  }
  add({path.at(length)}, body, margin);
  bound_blocks();
}

/// The box along the first pose that contains the bodies at all of them.
void PathCells::add(const std::vector<Pose>& poses, const Vehicle& body, double margin) {
  double ahead = body.front;
  double behind = body.rear;
  double aside = body.width / 2;
  for (const Pose& pose : poses) {
    for (const double x : {body.front, -body.rear}) {
      for (const double y : {body.width / 2, -body.width / 2}) {
        const Pose corner = relative(poses.front(), compose(pose, {x, y, 0.0}));
        ahead = std::max(ahead, corner.x);
        behind = std::max(behind, -corner.x);
        aside = std::max(aside, std::abs(corner.y));
      }
    }
  }
  const Frame frame(poses.front());
  boxes_.push_back(box_pose(frame, (ahead - behind) / 2));
  shapes_.push_back({float((ahead + behind) / 2 + margin), float(aside + margin), 0.0F});
}

void PathCells::bound_blocks() {
  for (std::size_t begin = 0; begin < boxes_.size(); begin += kBlock) {
    const std::size_t end = std::min(boxes_.size(), begin + kBlock);
    const BoxPose& middle = boxes_[(begin + end) / 2];
    Circle circle{middle.x, middle.y, 0.0F};
    for (std::size_t k = begin; k < end; ++k) {
      const float away = std::hypot(boxes_[k].x - middle.x, boxes_[k].y - middle.y);
      circle.radius = std::max(circle.radius, away + shapes_[k].half_diagonal());
    }
    circles_.push_back(circle);
  }
}

bool PathCells::touch(Range own, const PathCells& other, Range theirs) const {
  bool result = false;
  for_each_contact(own, other, theirs, [&](int, int) { result = true; });
  return result;
}

void PathCells::keep_clear(const KeepClear& ground) {
  kept_clear_.clear();
  for (int cell = 0; cell < size(); ++cell) {
    if (!ground.touches(box(cell), shape(cell))) continue;
    if (kept_clear_.empty() || kept_clear_.back().last < cell - 1)
      kept_clear_.push_back({cell, cell});
    kept_clear_.back().last = cell;
  }
  if (!kept_clear_.empty() && kept_clear_.back().last == size() - 1) kept_clear_.pop_back();
}

int PathCells::waits_before(int cell, int here) const {
  for (auto stretch = kept_clear_.rbegin(); stretch != kept_clear_.rend(); ++stretch) {
    const bool would_stand_there = cell > stretch->first && cell <= stretch->last + 1;
    if (would_stand_there && here <= stretch->last) cell = std::max(stretch->first, here);
  }
  return cell;
}

void Precedence::add(double limit, double need) { steps_.push_back({limit, need}); }

void Precedence::finish() {
  std::ranges::sort(steps_, [](const Step& a, const Step& b) {
    return a.limit != b.limit ? a.limit < b.limit : a.need > b.need;
  });
  std::vector<Step> kept;
  for (const Step& step : steps_) {
    if (kept.empty() || step.need > kept.back().need) kept.push_back(step);
  }
  steps_ = std::move(kept);
}

std::pair<Precedence, Precedence> precedence(const CellSchedule& first,
                                             const CellSchedule& second) {
  std::pair<Precedence, Precedence> result;
  std::vector<double> need_of_first(std::size_t(first.cells->size()), 0.0);
  std::vector<double> need_of_second(std::size_t(second.cells->size()), 0.0);
  // Where two cells meet a car is in both: who waits there has not left the one behind it.
  const auto beyond = [](int cell) { return (cell + 1) * PathCells::kLength + kOut; };
  const PathCells::Range own = first.cells->from(first.first);
  const PathCells::Range theirs = second.cells->from(second.first);
  first.cells->for_each_contact(own, *second.cells, theirs, [&](int a, int b) {
    const auto i = std::size_t(a);
    const auto j = std::size_t(b);
    if (first.times[i] <= second.times[j]) {
      need_of_second[j] = std::max(need_of_second[j], beyond(a));
    } else {
      need_of_first[i] = std::max(need_of_first[i], beyond(b));
    }
  });
  const auto collect = [](const CellSchedule& schedule, const std::vector<double>& needs,
                          Precedence& precedence) {
    for (std::size_t k = 0; k < needs.size(); ++k) {
      if (needs[k] == 0.0) continue;
      precedence.add(schedule.cells->waits_before(int(k), schedule.first) * PathCells::kLength,
                     needs[k]);
    }
    precedence.finish();
  };
  collect(first, need_of_first, result.first);
  collect(second, need_of_second, result.second);
  return result;
}

}  // namespace mvtp
