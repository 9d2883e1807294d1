# What other projects include as <mvtp/NAME>, and where it lies here. Everything else is installed
# only as far as these need it, and may change without notice. The comments go into the docs.
# Those of the planner, with all of planner/problem/, are also what the other floors include of it.
set(public_headers
  # one instance: problem, plan, solver, referee
  pose.hpp             planner/problem/pose.hpp               # points, poses, angles
  vehicle.hpp          planner/problem/vehicle.hpp            # body and limits of a car-like vehicle, the presets
  instance.hpp         planner/problem/instance.hpp           # agents, obstacles and bounds of one problem
  instance_file.hpp    planner/problem/instance_file.hpp      # reading and writing instances
  plan.hpp             planner/problem/plan.hpp               # trajectories of all agents, and statistics
  plan_array.hpp       planner/problem/plan_array.hpp         # trajectories as Eigen arrays, without a copy
  plan_file.hpp        planner/problem/plan_file.hpp          # reading and writing plans
  metrics.hpp          planner/problem/metrics.hpp            # makespan, flowtime, arrival steps
  deadline.hpp         planner/problem/deadline.hpp           # when a search stops
  input_error.hpp      planner/problem/input_error.hpp        # what bad input throws
  solve.hpp            planner/solve.hpp                      # all algorithms by name
  validate.hpp         planner/problem/validate.hpp           # the referee
  # roads and parking lots
  geometry.hpp         planner/geometry.hpp                   # arcs, bodies, polygons, paths in the plane
  road.hpp             planner/road.hpp                       # ESCoT for vehicles on paths of a road
  lot.hpp              planner/lot.hpp                        # ESCoT for vehicles on open ground
  # the closed loop (mvtp::coordinator)
  traffic.hpp          coordinator/traffic.hpp                # the port to the traffic, to be implemented for one of your own
  controller.hpp       coordinator/controller.hpp             # who decides in each step; derive your own
  simulation.hpp       coordinator/simulation/simulation.hpp  # the loop of controllers and traffic
  coordinator.hpp      coordinator/junctions/coordinator.hpp  # the coordinator of junctions
  lot_coordinator.hpp  coordinator/lot/lot_coordinator.hpp    # the coordinator of a parking lot
)
