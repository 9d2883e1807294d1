"""What there is to see after a step, as arrays; Traffic.vehicles() and people() fill them."""

from typing import NamedTuple

import numpy as np


class Vehicles(NamedTuple):
    """All vehicles on the road after a step, ordered by id: row i of each array is ids[i]'s."""

    ids: list  #: of str
    types: list  #: ids of their types
    poses: np.ndarray  #: (n, 3): x [m], y [m], yaw [rad] of the rear axles
    speeds: np.ndarray  #: (n,) [m/s]
    lanes: list  #: ids of the lanes that they are on; empty while off every lane
    lane_positions: np.ndarray  #: (n,) of the front bumpers from the start of the lane [m]
    taken_over: np.ndarray  #: (n,) bool: driven by a controller


class People(NamedTuple):
    """Everyone on foot after a step, ordered by id."""

    ids: list  #: of str
    poses: np.ndarray  #: (n, 3): x [m], y [m], direction [rad]
    speeds: np.ndarray  #: (n,) [m/s]
    edges: list  #: sidewalks, crossings or other edges that they are on
