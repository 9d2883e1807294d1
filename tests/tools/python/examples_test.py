"""The examples of docs/python.md run, and show what they promise."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(os.environ["MVTP_EXAMPLES"])


@pytest.mark.parametrize(
    ("script", "arguments", "output"),
    [
        ("solve.py", (), r"solved: 6 robots, \d+ steps.*\nthe referee finds 0 violations\n"),
        ("controller.py", ("--end", "30"), r"Fcfs: \d+ vehicles, 0 pairs in contact"),
        (
            "reinforcement.py",
            ("--episodes", "2", "--seconds", "60"),
            r"episode 1: .*\nepisode 2: ",
        ),
    ],
)
def test_example(script, arguments, output, tmp_path):
    words = [sys.executable, str(EXAMPLES / script), *arguments]
    done = subprocess.run(words, capture_output=True, text=True, cwd=tmp_path, timeout=120)
    assert done.returncode == 0, done.stderr
    assert re.search(output, done.stdout), done.stdout
    if command := re.search(r"# mvtp (.*)", (EXAMPLES / script).read_text(encoding="utf-8")):
        subprocess.run([os.environ["MVTP_PROGRAM"], *command[1].split()], cwd=tmp_path, check=True)
