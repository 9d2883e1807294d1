#include <fmt/format.h>

#include <algorithm>

#include "planner/problem/text_file.hpp"
#include "tools/export/formats.hpp"
#include "tools/export/in_time.hpp"

namespace mvtp {

std::string to_csv(const Recording& recording) {
  std::string text = "t,id,x,y,yaw,v,steer\n";
  for (const TimedState& entry : in_order_of_time(recording)) {
    const RecordedState& s = *entry.state;
    text +=
        fmt::format("{:.3f},{},{:.4f},{:.4f},{:.6f},{:.4f},{:.6f}\n", s.time,
                    csv_field(entry.vehicle->id), s.pose.x, s.pose.y, s.pose.theta, s.v, s.steer);
  }
  return text;
}

}  // namespace mvtp
