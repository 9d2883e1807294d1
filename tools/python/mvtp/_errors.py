"""What is raised beside InputError."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C (SIGINT) ended the work early.

    `result` is what there was by then: the best Plan so far (or None), a Run, a Comparison, or the
    summary of a Simulation.
    """

    def __init__(self, result=None):
        super().__init__("interrupted")
        self.result = result


class RunError(RuntimeError):
    """A run broke off, as when SUMO crashed. `run` holds what was simulated before."""

    def __init__(self, message, run=None):
        super().__init__(message)
        self.run = run
