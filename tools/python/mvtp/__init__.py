"""Many car-like vehicles, coordinated: instances and plans, the referee, SUMO in the closed loop.

Lengths are in metres, times in seconds, angles in radians, counter-clockwise from +x; a pose is that
of the middle of the rear axle. Bad input raises InputError with the line that the command prints.
"""

from importlib import import_module as _import_module

from ._errors import Interrupted, RunError
from ._observed import People, Vehicles
from ._planner import InputError, Instance, Plan, Vehicle, Violation, validate
from ._planner import algorithms as ALGORITHMS
from ._planner import version as __version__
from ._program import Comparison, Run, compare, coordinate
from ._solve import solve

# SUMO's libraries take a while to load: only for those who use them.
_WITH_SUMO = {
    "Connection": "_sumo",
    "Controller": "_sumo",
    "Junction": "_sumo",
    "Lane": "_sumo",
    "RoadNetwork": "_sumo",
    "SignalPhase": "_sumo",
    "Simulation": "_simulation",
    "Traffic": "_sumo",
    "VehicleType": "_sumo",
}

__all__ = sorted(
    [
        "ALGORITHMS",
        "Comparison",
        "InputError",
        "Instance",
        "Interrupted",
        "People",
        "Plan",
        "Run",
        "RunError",
        "Vehicle",
        "Vehicles",
        "Violation",
        "__version__",
        "compare",
        "coordinate",
        "solve",
        "validate",
        *_WITH_SUMO,
    ]
)

for _name in (Instance, Plan, Vehicle, Violation, InputError, validate):
    _name.__module__ = __name__
del _name


def __getattr__(name):
    if name not in _WITH_SUMO:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        value = getattr(_import_module(f".{_WITH_SUMO[name]}", __name__), name)
    except ModuleNotFoundError as error:
        raise InputError(
            f"mvtp.{name}: needs SUMO, which this build lacks; build with -DMVTP_WITH_SUMO=ON"
        ) from error
    globals()[name] = value
    return value


def __dir__():
    return sorted({*globals(), *__all__})
