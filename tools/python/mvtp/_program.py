"""The commands that run SUMO, in a process of their own: a crash there is an exception here."""

import csv
import json
import os
import re
import shutil
import signal
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from ._errors import Interrupted, RunError
from ._options import require, words
from ._planner import InputError

_PROGRESS = re.compile(r"^\w+: +(\d+) %(?:, (.*))?$")
_NAME = "mvtp: "
_NOTE = "note: "
_BAD_INPUT, _INTERRUPTED = 2, 130


@dataclass(frozen=True)
class Run:
    """What `mvtp coordinate` left behind."""

    folder: Path  #: with all files
    summary: dict  #: summary.json
    succeeded: bool  #: all arrived, and no coordinated vehicle touched another
    notes: list = field(default_factory=list)  #: what the user should know, a line each


@dataclass(frozen=True)
class Comparison:
    """What `mvtp compare` left behind."""

    folder: Path  #: with all files
    figures: dict  #: compare.json: mean and standard deviation of every figure per control
    runs: list  #: compare.csv: a dict for each run
    table: str  #: for people
    succeeded: bool  #: of every run
    notes: list = field(default_factory=list)  #: what the user should know, a line each


def coordinate(configuration, *, output_dir="out", progress=None, **options):
    """Runs a SUMO scenario as `mvtp coordinate` does; returns a Run.

    configuration: path of a *.sumocfg. progress: called with the share that is done, in [0, 1], and
    a note, some ten times. options: those of the command, with underscores: controller="fcfs",
    seed=3, end=600 (s), junction=["A", "B"], no_view=True, sumo=["--step-length", "0.05"], ...

    Raises InputError for bad input, RunError if the run broke off, and Interrupted on Ctrl-C, with a
    Run of what was simulated by then.
    """
    summary = _Fresh(output_dir, "summary.json")
    ended = _run("coordinate", configuration, output_dir, progress, options)
    run = None
    if (figures := summary.read()) is not None:
        run = Run(Path(output_dir), figures, ended.code == 0, ended.notes)
    if ended.code == _INTERRUPTED:
        raise Interrupted(run)
    if run is None or figures["status"] == "failed":
        raise RunError(ended.message, run)
    return run


def compare(configuration, *, output_dir="compare", progress=None, **options):
    """Runs one demand under several controls as `mvtp compare` does; returns a Comparison.

    options: those of the command, with underscores: controllers=["actuated", "escot"], seeds="1-5"
    or [1, 4, 7], jobs=2, ... The rest is as in coordinate().
    """
    if isinstance(seeds := options.get("seeds"), (list, tuple, range)):
        options["seeds"] = ",".join(map(str, seeds))
    results = _Fresh(output_dir, "compare.json")
    ended = _run("compare", configuration, output_dir, progress, options)
    folder = Path(output_dir)
    comparison = None
    if (figures := results.read()) is not None:
        with open(folder / "compare.csv", newline="", encoding="utf-8") as file:
            runs = list(csv.DictReader(file))
        comparison = Comparison(folder, figures, runs, ended.output, ended.code == 0, ended.notes)
    if ended.code == _INTERRUPTED:
        raise Interrupted(comparison)
    if comparison is None:
        raise RunError(ended.message)
    return comparison


@dataclass
class _Ended:
    code: int
    output: str
    notes: list
    message: str  #: what went wrong


def _program():
    """The nearest bin/mvtp above this package: of the same build or installation."""
    for parent in Path(__file__).resolve().parents:
        program = parent / "bin" / "mvtp"
        if program.is_file() and os.access(program, os.X_OK):
            return str(program)
    found = shutil.which("mvtp")
    require(found, "mvtp", "the program is not installed; install the package mvtp")
    return found


def _run(command, configuration, output_dir, progress, options):
    arguments = [_program(), command, f"--configuration={os.fspath(configuration)}"]
    arguments += words({"output_dir": output_dir, **options})
    process = subprocess.Popen(
        arguments,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,  # Ctrl-C reaches this process alone, which passes it on once
        env={**os.environ, "MVTP_PARENT": str(os.getpid())},
    )
    with process:
        try:
            ended = _listen(process, progress)
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
            ended = _listen(process, None)
            ended.code = _INTERRUPTED
        except BaseException:
            process.send_signal(signal.SIGTERM)
            process.communicate()
            raise
    if ended.code == _BAD_INPUT:
        raise InputError(ended.message)
    return ended


def _listen(process, progress):
    """Reads what the program says until it ends."""
    notes, messages = [], []
    for line in process.stderr:
        line = line.rstrip("\n")
        share = _PROGRESS.match(line)
        if share and progress is not None:
            progress(int(share[1]) / 100, share[2] or "")
        elif line.startswith(_NAME + _NOTE):
            notes.append(line[len(_NAME + _NOTE) :])
        elif line.startswith(_NAME):
            messages.append(line[len(_NAME) :])
    output = process.stdout.read()
    message = messages[-1] if messages else f"{process.args[1]} ended without a word"
    return _Ended(process.wait(), output, notes, message)


class _Fresh:
    """A file of results: a run that fails passes off no other's, and bad input costs nobody his."""

    def __init__(self, output_dir, name):
        self._path = Path(output_dir) / name
        self._before = self._stamp()

    def _stamp(self):
        try:
            found = self._path.stat()
        except OSError:
            return None
        return found.st_ino, found.st_mtime_ns

    def read(self):
        """What has been written since; None: nothing."""
        if self._stamp() in (None, self._before):
            return None
        return json.loads(self._path.read_text(encoding="utf-8"))
