#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/prediction/prediction.hpp"
#include "tests/coordinator/fake_traffic.hpp"
#include "tests/coordinator/walk.hpp"

namespace mvtp {

/// Forecasts on a shape, of vehicles with drivers of their own.
class Prediction {
 public:
  explicit Prediction(NetworkShape s) : shape(std::move(s)) {}

  std::vector<Forecast> predict(const std::string& lane, double position, double speed,
                                std::vector<std::string> edges, Intent intent,
                                const Stand& stand = {}, const std::string& next_lane = {}) {
    const Lane& l = shape.network.lanes.at(lane);
    const Point a = l.shape[l.shape.size() - 2];
    const Point b = l.shape.back();
    const double theta = std::atan2(b.y - a.y, b.x - a.x);
    const double back = l.length - position + car.front;
    const VehicleState v{.id = "v",
                         .type = "car",
                         .pose = compose({b.x, b.y, theta}, {-back, 0.0, 0.0}),
                         .speed = speed,
                         .top_speed = top_speed,
                         .lane = lane,
                         .lane_position = position};
    CourseQuery query = walk.at(lane, position, std::move(edges));
    query.next_lane = walk.graph.find_lane(next_lane);
    return predictor.predict(v, query, car, intent, stand, grid, 7);
  }

  /// Of the front bumper.
  [[nodiscard]] Pose place(const Forecast& f, std::int64_t k) {
    return compose(map.library().path(f.vehicle.path).at(f.earliest.at(k).s),
                   {car.front, 0.0, 0.0});
  }

  NetworkShape shape;
  Walk walk{shape.network};
  DrivableArea area{shape.network};
  CorridorMap map{walk.graph, area, {}};
  Predictor predictor{walk.graph, walk.finder, map};
  Vehicle car = fake_type("car").body;
  double top_speed = std::numeric_limits<double>::infinity();  ///< [m/s] of the vehicle
  DecisionGrid grid;
};

}  // namespace mvtp
