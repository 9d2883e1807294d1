# What other projects include as <mvtp/NAME>, and where it lies here. Everything else is installed
# only as far as these need it, and may change without notice.
set(public_headers
  # one instance: problem, plan, solver, referee
  pose.hpp             planner/problem/pose.hpp
  vehicle.hpp          planner/problem/vehicle.hpp
  instance.hpp         planner/problem/instance.hpp
  instance_file.hpp    planner/problem/instance_file.hpp
  plan.hpp             planner/problem/plan.hpp
  plan_array.hpp       planner/problem/plan_array.hpp
  plan_file.hpp        planner/problem/plan_file.hpp
  metrics.hpp          planner/problem/metrics.hpp
  deadline.hpp         planner/problem/deadline.hpp
  input_error.hpp      planner/problem/input_error.hpp
  solve.hpp            planner/solve.hpp
  validate.hpp         planner/problem/validate.hpp
  # roads and parking lots
  road.hpp             planner/road/road_escot.hpp
  lot.hpp              planner/lot/lot_planner.hpp
  # the closed loop (mvtp::coordinator)
  traffic.hpp          coordinator/traffic.hpp
  controller.hpp       coordinator/controller.hpp
  simulation.hpp       coordinator/simulation.hpp
  coordinator.hpp      coordinator/coordinator.hpp
  lot_coordinator.hpp  coordinator/lot_coordinator.hpp
)
