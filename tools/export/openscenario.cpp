#include <algorithm>
#include <cmath>

#include "planner/problem/document_builder.hpp"
#include "tools/cli/version.hpp"
#include "tools/export/formats.hpp"
#include "tools/export/xml_writer.hpp"

namespace mvtp {
namespace {

/// Writes one scenario. A vehicle's place is that of its rear axle, as with us. Trajectories are
/// followed by position and heading, so reversing needs nothing more.
class Scenario {
 public:
  explicit Scenario(const Recording& recording) : recording_(recording) {
    begin_ = recording.vehicles.front().states.front().time;
    end_ = begin_;
    for (const RecordedVehicle& vehicle : recording.vehicles) {
      begin_ = std::min(begin_, vehicle.states.front().time);
      end_ = std::max(end_, vehicle.states.back().time);
    }
  }

  std::string write(const std::string& road_file) {
    xml_.element("OpenSCENARIO", [&] {
      write_head(road_file);
      xml_.element("Entities", [&] {
        for (const RecordedVehicle& vehicle : recording_.vehicles) write_entity(vehicle);
      });
      xml_.element("Storyboard", [&] {
        write_start();
        write_story();
        xml_.element("StopTrigger", [&] { write_time_condition("end", end_ - begin_); });
      });
    });
    return xml_.str();
  }

 private:
  using Inside = std::function<void()>;

  void named(const char* element, const std::string& name, const Inside& inside) {
    if (name.starts_with('$')) {
      throw InputError(excerpt(name),
                       "begins with $, as parameters of OpenSCENARIO do; choose another name");
    }
    xml_.element(element, [&] {
      xml_.attribute("name", name);
      inside();
    });
  }

  void write_head(const std::string& road_file) {
    xml_.element("FileHeader", [&] {
      xml_.attribute("revMajor", std::string("1"));
      xml_.attribute("revMinor", std::string("2"));
      xml_.attribute("date", recording_.date + "T00:00:00");
      xml_.attribute("description", recording_.name);
      xml_.attribute("author", fmt::format("mvtp {}", version()));
    });
    xml_.element("CatalogLocations", [] {});
    xml_.element("RoadNetwork", [&] {
      if (road_file.empty()) return;
      xml_.element("LogicFile", [&] { xml_.attribute("filepath", road_file); });
    });
  }

  // ---- bodies

  void write_entity(const RecordedVehicle& vehicle) {
    named("ScenarioObject", vehicle.id, [&] {
      named("Vehicle", vehicle.kind.empty() ? "vehicle" : vehicle.kind, [&] {
        xml_.attribute("vehicleCategory", std::string(vehicle.body.length() > 7.0 ? "bus" : "car"));
        write_box(vehicle.body);
        write_performance(vehicle.body);
        xml_.element("Axles", [&] {
          write_axle("FrontAxle", vehicle.body, vehicle.body.wheelbase);
          write_axle("RearAxle", vehicle.body, 0.0);
        });
        xml_.element("Properties", [] {});
      });
    });
  }

  void write_box(const Vehicle& body) {
    const double height = 1.5;  // [m]; not known
    xml_.element("BoundingBox", [&] {
      xml_.element("Center", [&] {
        xml_.attribute("x", (body.front - body.rear) / 2.0);
        xml_.attribute("y", 0.0);
        xml_.attribute("z", height / 2.0);
      });
      xml_.element("Dimensions", [&] {
        xml_.attribute("width", body.width);
        xml_.attribute("length", body.length());
        xml_.attribute("height", height);
      });
    });
  }

  void write_performance(const Vehicle& body) {
    const double unlimited = 200.0;  // [m/s^2], [m/s]
    xml_.element("Performance", [&] {
      xml_.attribute("maxSpeed", std::min(body.max_speed, unlimited));
      xml_.attribute("maxAcceleration", std::min(body.max_accel, unlimited));
      xml_.attribute("maxDeceleration", std::min(body.max_decel, unlimited));
    });
  }

  void write_axle(const char* name, const Vehicle& body, double x) {
    const double wheel = 0.6;  // [m]; not known
    xml_.element(name, [&] {
      xml_.attribute("maxSteering",
                     x > 0.0 ? std::atan(body.wheelbase * body.max_curvature()) : 0.0);
      xml_.attribute("wheelDiameter", wheel);
      xml_.attribute("trackWidth", 0.8 * body.width);
      xml_.attribute("positionX", x);
      xml_.attribute("positionZ", wheel / 2.0);
    });
  }

  // ---- motions

  [[nodiscard]] double since_begin(const RecordedState& state) const { return state.time - begin_; }

  [[nodiscard]] bool is_there_at_the_start(const RecordedVehicle& vehicle) const {
    return since_begin(vehicle.states.front()) < recording_.dt / 2.0;
  }

  void write_position(const Pose& pose) {
    xml_.element("Position", [&] {
      xml_.element("WorldPosition", [&] {
        xml_.attribute("x", pose.x);
        xml_.attribute("y", pose.y);
        xml_.attribute("h", pose.theta, 6);
      });
    });
  }

  void write_start() {
    xml_.element("Init", [&] {
      xml_.element("Actions", [&] {
        for (const RecordedVehicle& vehicle : recording_.vehicles) {
          if (is_there_at_the_start(vehicle)) write_placing(vehicle);
        }
      });
    });
  }

  void write_placing(const RecordedVehicle& vehicle) {
    xml_.element("Private", [&] {
      xml_.attribute("entityRef", vehicle.id);
      xml_.element("PrivateAction", [&] {
        xml_.element("TeleportAction", [&] { write_position(vehicle.states.front().pose); });
      });
    });
  }

  /// One act for all; in it a group for each vehicle, whose events follow the clock.
  void write_story() {
    named("Story", "motions", [&] {
      named("Act", "all", [&] {
        for (const RecordedVehicle& vehicle : recording_.vehicles) write_group(vehicle);
        xml_.element("StartTrigger", [&] { write_time_condition("begin", 0.0); });
      });
    });
  }

  void write_group(const RecordedVehicle& vehicle) {
    xml_.element("ManeuverGroup", [&] {
      xml_.attribute("maximumExecutionCount", std::string("1"));
      xml_.attribute("name", "group of " + vehicle.id);
      xml_.element("Actors", [&] {
        xml_.attribute("selectTriggeringEntities", std::string("false"));
        xml_.element("EntityRef", [&] { xml_.attribute("entityRef", vehicle.id); });
      });
      named("Maneuver", "motion of " + vehicle.id, [&] { write_events(vehicle); });
    });
  }

  void write_events(const RecordedVehicle& vehicle) {
    const double first = since_begin(vehicle.states.front());
    const double last = since_begin(vehicle.states.back());
    if (!is_there_at_the_start(vehicle)) {
      write_event("entry of " + vehicle.id, first, [&] {
        write_entity_action(vehicle, "AddEntityAction",
                            [&] { write_position(vehicle.states.front().pose); });
      });
    }
    write_event("drive of " + vehicle.id, first, [&] { write_following(vehicle); });
    if (last < end_ - begin_ - recording_.dt / 2.0) {
      write_event("exit of " + vehicle.id, last + recording_.dt,
                  [&] { write_entity_action(vehicle, "DeleteEntityAction", [] {}); });
    }
  }

  void write_event(const std::string& name, double time, const Inside& action) {
    named("Event", name, [&] {
      xml_.attribute("priority", std::string("parallel"));
      named("Action", name, action);
      xml_.element("StartTrigger", [&] { write_time_condition("time of " + name, time); });
    });
  }

  void write_entity_action(const RecordedVehicle& vehicle, const char* action,
                           const Inside& inside) {
    xml_.element("GlobalAction", [&] {
      xml_.element("EntityAction", [&] {
        xml_.attribute("entityRef", vehicle.id);
        xml_.element(action, inside);
      });
    });
  }

  void write_following(const RecordedVehicle& vehicle) {
    xml_.element("PrivateAction", [&] {
      xml_.element("RoutingAction", [&] {
        xml_.element("FollowTrajectoryAction", [&] {
          xml_.element("TrajectoryRef", [&] { write_trajectory(vehicle); });
          xml_.element("TimeReference", [&] {
            xml_.element("Timing", [&] {
              xml_.attribute("domainAbsoluteRelative", std::string("absolute"));
              xml_.attribute("scale", 1.0);
              xml_.attribute("offset", 0.0);
            });
          });
          xml_.element("TrajectoryFollowingMode",
                       [&] { xml_.attribute("followingMode", std::string("position")); });
        });
      });
    });
  }

  void write_trajectory(const RecordedVehicle& vehicle) {
    named("Trajectory", "trajectory of " + vehicle.id, [&] {
      xml_.attribute("closed", std::string("false"));
      xml_.element("Shape", [&] {
        xml_.element("Polyline", [&] {
          for (const RecordedState& state : vehicle.states) {
            write_vertex(since_begin(state), state.pose);
          }
          // There must be two: who was there for a moment only stands for a step.
          if (vehicle.states.size() == 1) {
            const RecordedState& only = vehicle.states.front();
            write_vertex(since_begin(only) + recording_.dt, only.pose);
          }
        });
      });
    });
  }

  void write_vertex(double time, const Pose& pose) {
    xml_.element("Vertex", [&] {
      xml_.attribute("time", time);
      write_position(pose);
    });
  }

  void write_time_condition(const std::string& name, double time) {
    xml_.element("ConditionGroup", [&] {
      named("Condition", name, [&] {
        xml_.attribute("delay", 0.0);
        xml_.attribute("conditionEdge", std::string("none"));
        xml_.element("ByValueCondition", [&] {
          xml_.element("SimulationTimeCondition", [&] {
            xml_.attribute("value", time);
            xml_.attribute("rule", std::string("greaterOrEqual"));
          });
        });
      });
    });
  }

  const Recording& recording_;
  double begin_ = 0.0;  ///< [s] of the recording; that of the scenario is 0
  double end_ = 0.0;    ///< [s]
  XmlWriter xml_;
};

}  // namespace

std::string to_openscenario(Recording recording, const std::string& road_file) {
  split_stays(recording);
  return Scenario(recording).write(road_file);
}

}  // namespace mvtp
