"""The closed loop, stepped from Python."""

import json
import math
import tempfile

from . import _sumo
from ._errors import Interrupted
from ._options import require, words

_NOBODY = "sumo"  # the built-in controller that leaves everything to SUMO


class Simulation:
    """A SUMO scenario in the closed loop: observe, decide, act, step, report.

    controller: the name of one of mvtp's own, a Controller of one's own, or None: SUMO's drivers
    drive, but for what is said to `traffic` between the steps. output_dir: folder of the same files
    that `mvtp coordinate` writes; None: only the summary. options: those of the command, with
    underscores: seed=3, end=600 (s), junction=["A"], ... With a controller of its own the files are
    those of the command, byte for byte but for wall-clock figures.

    SUMO runs inside this process (libsumo): fast, but one simulation at a time, and a bug in SUMO can
    end the process. separate_process=True: SUMO is a process of its own; slower, and a crash is an
    InputError. To run several at once, use processes (multiprocessing).

    As a context manager it finishes at the end of the block. Raises InputError for bad input.
    """

    def __init__(
        self,
        configuration,
        *,
        controller="escot",
        output_dir=None,
        separate_process=False,
        **options,
    ):
        self._failure = ""
        self._summary = None
        self._temporary = None
        own = isinstance(controller, str)
        require(
            own or controller is None or isinstance(controller, _sumo.Controller),
            "controller",
            f"is {controller!r}; give a name, a mvtp.Controller, or None",
        )
        if output_dir is None:
            self._temporary = tempfile.TemporaryDirectory(prefix="mvtp-")
            output_dir = self._temporary.name
            options = {**options, "no_view": True, "no_fcd": True}
        options = {
            "configuration": configuration,
            "controller": controller if own else _NOBODY,
            "output_dir": output_dir,
            **options,
        }
        try:
            self._session = _sumo.Session(words(options), separate_process)
        except BaseException:
            self._clean_up()
            raise
        self._traffic = self._session.traffic
        self._step_length = self._traffic.step_length
        if not own:
            self._session.plug_in(
                _sumo.Controller() if controller is None else controller,
                "python" if controller is None else type(controller).__name__,
            )

    @property
    def traffic(self):
        """What there is to see, and what may be said to it: a Traffic."""
        return self._traffic

    @property
    def time(self):
        """Simulated time [s]."""
        return self._traffic.time

    @property
    def step_length(self):
        """Duration of a step [s]."""
        return self._step_length

    @property
    def notes(self):
        """What the user should know about the run, a line each."""
        return self._session.notes

    @property
    def summary(self):
        """What summary.json holds, once the run is finished; None before."""
        return self._summary

    def vehicles(self):
        """All vehicles on the road after the last step: Vehicles."""
        return self._traffic.vehicles()

    def people(self):
        """Everyone on foot after the last step: People."""
        return self._traffic.people()

    def step(self):
        """Controllers decide and act, then SUMO steps. False, without a step, once the run has ended.

        It ends when all have arrived, at `end`, or when nobody has moved for 300 s. The GIL is
        released but for what is written in Python.
        """
        try:
            return self._session.step()
        except Exception as error:
            self._failure = self._failure or _line(error)
            raise

    def advance(self, seconds):
        """Steps for so long [s, simulated], at least once. False once the run has ended."""
        require(0 < seconds < math.inf, "seconds", f"is {seconds}; give a finite number > 0")
        for _ in range(max(1, math.floor(seconds / self._step_length + 0.5))):
            if not self.step():
                return False
        return True

    def run(self, *, progress=None):
        """Steps to the end and finishes; returns the summary.

        progress: called with the share that is done, in [0, 1], and a note, at every percent. Ctrl-C
        raises Interrupted, with the summary of what was simulated by then.
        """
        told = -1
        try:
            while self.step():
                done = math.floor(100 * self._session.fraction)
                if progress is not None and done > told:
                    told = done
                    progress(done / 100, f"t = {self.time:.0f} s")
        except KeyboardInterrupt as error:
            raise Interrupted(self.finish()) from error
        return self.finish()

    def report(self):
        """What summary.json would hold if the run were interrupted now, as a dict."""
        return json.loads(self._session.summary_so_far())

    def finish(self):
        """Ends SUMO, writes the files and returns the summary. A run that goes on is "interrupted"."""
        if self._summary is None:
            try:
                self._summary = json.loads(self._session.finish(self._failure))
            finally:
                self._clean_up()
        return self._summary

    def _clean_up(self):
        if self._temporary is not None:
            self._temporary.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, kind, error, traceback):
        if isinstance(error, Exception) and self._summary is None:
            self._failure = self._failure or _line(error)
        self.finish()


def _line(error):
    """An exception in one line."""
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
