"""Options of the commands as keywords of Python."""

import os

from ._planner import InputError

_MAY_BE_NONE = ("end", "run_time_limit")


def words(options):
    """zone_radius=60 becomes "--zone-radius=60", True a flag, and a list a word for each entry.

    False is left out, and None where it is allowed; `sumo`, options for SUMO itself, goes behind "--".
    """
    options = dict(options)
    sumo = [str(word) for word in options.pop("sumo", None) or ()]
    result = []
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        if value is True:
            result.append(option)
        elif isinstance(value, (list, tuple)):
            result += [f"{option}={_text(entry)}" for entry in value]
        elif value is None:
            require(name in _MAY_BE_NONE, name, "is None; leave it out, or give a value")
        elif value is not False:
            result.append(f"{option}={_text(value)}")
    return result + (["--", *sumo] if sumo else [])


def _text(value):
    """One value as the command line has it: a path, or what Python prints."""
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)


def require(condition, where, what):
    """Raises InputError, "where: what", unless the condition holds."""
    if not condition:
        raise InputError(f"{where}: {what}")
