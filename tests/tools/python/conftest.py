"""What the tests share: the program, the scenarios, a small run."""

import os
import subprocess
from pathlib import Path

import pytest


@pytest.fixture
def program():
    """Path of the program of the same build."""
    return os.environ["MVTP_PROGRAM"]


@pytest.fixture
def scenarios():
    return Path(os.environ["MVTP_SCENARIOS"])


@pytest.fixture
def circle8(scenarios):
    """Eight robots that change places on a circle."""
    return scenarios / "circle" / "circle8.yaml"


@pytest.fixture
def crossroads(scenarios):
    return scenarios / "crossroads" / "crossroads-600.sumocfg"


@pytest.fixture
def with_light(scenarios):
    return scenarios / "crossroads" / "crossroads-600.static.sumocfg"


@pytest.fixture
def command(program):
    """Runs the program; the result has returncode, stdout and stderr."""

    def run(*arguments):
        words = [program, *map(str, arguments)]
        return subprocess.run(words, capture_output=True, text=True, timeout=120)

    return run
