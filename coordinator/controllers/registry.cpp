#include "coordinator/controllers/registry.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

// One line per controller: the function of its name says what it is, in a file of its own.
#define MVTP_CONTROLLERS(ENTRY) \
  ENTRY(escot)                  \
  ENTRY(pbcr)                   \
  ENTRY(prioritized)            \
  ENTRY(aim)                    \
  ENTRY(fcfs_light)             \
  ENTRY(h_aim)                  \
  ENTRY(conflict_zone)          \
  ENTRY(fcfs)                   \
  ENTRY(one_at_a_time)          \
  ENTRY(sumo)                   \
  ENTRY(fixed_time)             \
  ENTRY(actuated)               \
  ENTRY(priority)               \
  ENTRY(max_pressure)           \
  ENTRY(max_wave)

namespace mvtp {

#define MVTP_DECLARE(name) ControllerKind name##_controller();
MVTP_CONTROLLERS(MVTP_DECLARE)
#undef MVTP_DECLARE

std::span<const ControllerKind> controller_kinds() {
#define MVTP_LIST(name) name##_controller(),
  static const std::vector<ControllerKind> kinds = {MVTP_CONTROLLERS(MVTP_LIST)};
#undef MVTP_LIST
  return kinds;
}

const ControllerKind* find_controller(const std::string& name) {
  const std::span<const ControllerKind> kinds = controller_kinds();
  const auto found = std::ranges::find(kinds, name, &ControllerKind::name);
  return found == kinds.end() ? nullptr : &*found;
}

const ControllerKind& controller_of_lots(LotController controller) {
  const std::span<const ControllerKind> kinds = controller_kinds();
  const auto found = std::ranges::find(kinds, controller, &ControllerKind::on_lots);
  if (found == kinds.end()) throw std::logic_error("a controller of parking lots has no name");
  return *found;
}

}  // namespace mvtp
